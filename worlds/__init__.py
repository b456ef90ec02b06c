"""Worlds: walls, starting formations, and how robots are put into one MuJoCo model."""
