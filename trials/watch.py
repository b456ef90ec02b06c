"""A watch over what may never return: a law in compiled code, which no Python code can interrupt.

A worker process that is armed ends itself by SIGALRM, whose default is carried out without Python, when more than its
limit has passed since it last breathed. Everywhere else breathing does nothing: nobody's notebook is ended.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

STEP_LIMIT_S = 30.0
"""Wall time from one breath to the next: a piece of a kinematic trial is made to take 0.2 s, a robot's update takes
some 0.0001 s."""

_limit_s = 0.0


def arm(limit_s: float = STEP_LIMIT_S) -> None:
    """Makes this process end when its work hangs."""
    global _limit_s
    _limit_s = limit_s
    signal.signal(signal.SIGALRM, signal.SIG_DFL)


def breathe(_done: int = 0) -> None:
    """The work goes on: the limit counts anew from here."""
    if _limit_s:
        signal.setitimer(signal.ITIMER_REAL, _limit_s)


@contextmanager
def watched() -> Iterator[None]:
    """Within it the process must breathe."""
    breathe()
    try:
        yield
    finally:
        if _limit_s:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
