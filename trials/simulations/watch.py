"""A watch over laws, which may never return: they are compiled, and Python code cannot interrupt compiled code.

A worker process that is armed is ended by SIGALRM, whose default action needs no Python, when more than its limit of
wall time has passed since the last call of `breathe`. In a process that is not armed, such as a user's notebook,
`breathe` does nothing. Hardly any code is compiled while the watch is on, so that the limit applies to laws alone.
"""

from __future__ import annotations

import mmap
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from flocking.types import Ints

STEP_LIMIT_S = 30.0
"""Wall time from one call of `breathe` to the next: a piece of a kinematic trial is made to take 0.2 s, a robot's
update takes some 0.0001 s."""
NOBODY = -1
_SIZE = 3
"""Whole numbers in `turn`."""

_limit_s = 0.0
turn: Ints = np.zeros(_SIZE, np.int64)
"""The steps done before the current piece of work, the step within it, and the member at work. In an armed worker this
is the content of a file, which the parent can read."""


def arm(limit_s: float = STEP_LIMIT_S, folder: Path | None = None) -> None:
    """Makes this process end when its work hangs. A file of the folder, named by its process id, holds its `turn`."""
    global _limit_s, turn
    _limit_s = limit_s
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    if folder is not None:
        try:
            with (folder / str(os.getpid())).open("w+b") as file:
                file.write(np.array([0, 0, NOBODY], np.int64).tobytes())
                file.flush()
                turn = np.frombuffer(mmap.mmap(file.fileno(), 0), np.int64)
        except OSError:  # a full disk: no member will be named
            return


def whose(folder: Path, pid: int | None) -> tuple[int, int] | None:
    """The steps done and the member at work when a worker ended; None if no member was at work."""
    try:
        before, step, member = np.frombuffer((folder / str(pid)).read_bytes(), np.int64).tolist()
    except (OSError, ValueError):
        return None
    return None if member == NOBODY else (before + step, member)


def breathe(_done: int = 0) -> None:
    """Tells that the work goes on: the limit counts from now on."""
    if _limit_s:
        signal.setitimer(signal.ITIMER_REAL, _limit_s)


def begin(step: int = 0, member: int = NOBODY) -> None:
    """Turns the watch on. Code that knows the step and the member more closely writes them to `turn`."""
    turn[0], turn[1], turn[2] = 0, step, member
    breathe()


def end() -> None:
    """Turns the watch off."""
    if _limit_s:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@contextmanager
def watched() -> Iterator[None]:
    """Keeps the watch on for a block of code."""
    begin()
    try:
        yield
    finally:
        end()
