"""Akama and Naruse 2014: the link tension index, and which links of a flock break."""
