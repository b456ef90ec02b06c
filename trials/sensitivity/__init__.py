"""What a verdict hangs on: the choices of an experiment varied within plausible ranges, with a claim as the output."""
