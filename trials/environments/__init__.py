"""Environments tried with groups: robots as a group, and validation shared among worker processes."""
