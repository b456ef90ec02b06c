"""Trials of herds: the loop, the experiments, batches, results, recordings, reports and the `herd` command."""
