"""Searches for the environments that steer a herd most robustly, and constructs decomposed: one trial is one of them."""
