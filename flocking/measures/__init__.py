"""Measures of a herd: its formation and motion, its groups, hulls, links, and distances in periodic space."""
