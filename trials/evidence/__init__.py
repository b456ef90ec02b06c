"""What decides: statistics, published claims held against a run, measures over repeats."""
