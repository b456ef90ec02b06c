"""Shape grammars of two-dimensional lines, after Stiny 1980: `Introduction to shape and shape grammars`."""
