"""The kinematic herd: the laws of `flocking.laws` for thousands of members, compiled, without sensors or wheels."""

from flocking.kinematic.herd import Band, History, LawFailedError, Progress, Schedule, Space, simulate, start_uniform

__all__ = ["Band", "History", "LawFailedError", "Progress", "Schedule", "Space", "simulate", "start_uniform"]
