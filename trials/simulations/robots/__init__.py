"""Robots in MuJoCo that see through simulated sensors: the loop, each robot's five stages, measures, recordings."""
