"""Robots in MuJoCo that see through simulated sensors: the loop, their minds, what is measured and recorded."""
