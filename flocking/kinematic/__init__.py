"""The kinematic herd: the laws of `flocking.laws` for thousands of members, compiled, without sensors or wheels."""

from flocking.kinematic.herd import (
    Band,
    Failures,
    History,
    LawFailedError,
    Progress,
    Schedule,
    Space,
    simulate,
    start_uniform,
)

__all__ = [
    "Band",
    "Failures",
    "History",
    "LawFailedError",
    "Progress",
    "Schedule",
    "Space",
    "simulate",
    "start_uniform",
]
