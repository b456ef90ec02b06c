"""Stages 1 and 2: what a robot senses, and which members and obstacles it makes of it."""
