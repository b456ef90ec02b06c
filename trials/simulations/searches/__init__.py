"""Searches for environments that steer a herd robustly, and constructs decomposed: one trial is one of them."""
