"""A folder for each study: its experiments, claims, figures, and the numbers of its publication."""
