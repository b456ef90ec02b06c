"""A watch over laws, which may never return: they are compiled, and Python code cannot interrupt compiled code.

While a law is at work, the process notes the member and the step in `turn`. In a worker process that is memory which
the parent shares: the parent ends a worker whose law uses its limit of processor time without any progress. Only laws
are watched: what is compiled meanwhile does not count.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from flocking.types import Ints

STEP_LIMIT_S = 30.0
"""Processor time from one sign of progress to the next: a piece of a kinematic trial is made to take 0.2 s, a robot's
update takes some 0.0001 s."""
NOBODY = -1
SIZE = 5
"""Whole numbers that are shared: the three of `turn`, whether the watch is on, and signs of progress so far."""
_ON, _BEATS = 3, 4


class Turn(NamedTuple):
    """Where a law was at work."""

    step: int
    """Steps done."""
    member: int
    """Index in the herd."""


_shared: Ints = np.array([0, 0, NOBODY, 0, 0], np.int64)
turn: Ints = _shared[:3]
"""The steps done before the current piece of work, the step within it, and the member at work."""


def share(memory: Ints) -> None:
    """Notes everything in `memory`, (`SIZE`,), from now on."""
    global _shared, turn
    memory[:] = 0, 0, NOBODY, 0, 0
    _shared = memory
    turn = memory[:3]


def breathe(_done: int = 0) -> None:
    """Tells that the work goes on: the limit counts from now on."""
    _shared[_BEATS] += 1


def begin(step: int = 0, member: int = NOBODY) -> None:
    """Turns the watch on. Code that knows the step and the member more closely writes them to `turn`."""
    now = _shared
    now[0], now[1], now[2], now[_ON] = 0, step, member, 1
    now[_BEATS] += 1


def end() -> None:
    """Turns the watch off."""
    _shared[_ON] = 0


@contextmanager
def watched() -> Iterator[None]:
    """Keeps the watch on for a block of code."""
    begin()
    try:
        yield
    finally:
        end()


def is_on(memory: Ints) -> bool:
    """Whether a law is at work in the process that notes in `memory`."""
    return bool(memory[_ON])


def whose(memory: Ints) -> Turn | None:
    """The turn of the process that notes in `memory`; None if no member is at work."""
    before, step, member = memory[:3].tolist()
    return None if member == NOBODY or not is_on(memory) else Turn(before + step, member)
