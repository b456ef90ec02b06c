"""A watch over what may never return: a law in compiled code, which no Python code can interrupt.

A worker process that is armed ends itself by SIGALRM, whose default is carried out without Python, when more than its
limit has passed since it last breathed. Everywhere else breathing does nothing: nobody's notebook is ended.
Next to nothing is compiled while the watch is on, so that it measures laws and not this machine.
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
"""Wall time from one breath to the next: a piece of a kinematic trial is made to take 0.2 s, a robot's update takes
some 0.0001 s."""
NOBODY = -1
_SIZE = 3
"""Whole numbers of a turn."""

_limit_s = 0.0
turn: Ints = np.zeros(_SIZE, np.int64)
"""Steps done before, the step since then, and the member at work. The parent can read an armed worker's."""


def arm(limit_s: float = STEP_LIMIT_S, folder: Path | None = None) -> None:
    """Makes this process end when its work hangs; whose turn it was then stands in a file of the folder."""
    global _limit_s, turn
    _limit_s = limit_s
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    if folder is not None:
        try:
            with (folder / str(os.getpid())).open("w+b") as file:
                file.write(np.array([0, 0, NOBODY], np.int64).tobytes())
                file.flush()
                turn = np.frombuffer(mmap.mmap(file.fileno(), 0), np.int64)
        except OSError:  # a full disk: then nobody is named
            return


def whose(folder: Path, pid: int | None) -> tuple[int, int] | None:
    """The steps done before, and the member at work, in a worker that has ended; None if nobody was."""
    try:
        before, step, member = np.frombuffer((folder / str(pid)).read_bytes(), np.int64).tolist()
    except (OSError, ValueError):
        return None
    return None if member == NOBODY else (before + step, member)


def breathe(_done: int = 0) -> None:
    """The work goes on: the limit counts anew from here."""
    if _limit_s:
        signal.setitimer(signal.ITIMER_REAL, _limit_s)


def begin(step: int = 0, member: int = NOBODY) -> None:
    """From here on the process must breathe; whoever knows better whose turn it is writes to `turn`."""
    turn[0], turn[1], turn[2] = 0, step, member
    breathe()


def end() -> None:
    """From here on it need not."""
    if _limit_s:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@contextmanager
def watched() -> Iterator[None]:
    """Within it the process must breathe."""
    begin()
    try:
        yield
    finally:
        end()
