"""A limit of processor time, and of waiting, for code of the user's own that runs in this process.

It is for code in Python, which a signal interrupts between two of its steps; compiled code is watched from outside
(`trials.simulations.watch`).
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import process_time
from typing import Any

from flocking.errors import InputError
from flocking.found import is_path
from flocking.types import Floats
from generation import behaviours
from generation.behaviours import Behaviour
from generation.environment import Environment
from trials.batch.patience import LEAST_S, STILL_S

AGAIN_S = 1.0
"""Processor time after which a block that caught the error meets it once more."""


@contextmanager
def limited(what: str, limit_s: float, still_s: float = STILL_S) -> Iterator[None]:
    """Raises `InputError` in a block that uses more processor time (s), or none for `still_s` of wall time.

    Signals are the main thread's: in another one the block has no limit.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def late(*_: object) -> None:
        raise InputError(f"{what} did not return within {limit_s:g} s of processor time")

    used_s = process_time()

    def still(*_: object) -> None:
        nonlocal used_s
        now = process_time()
        if now - used_s < LEAST_S:
            raise InputError(f"{what} waited for something that did not come within {still_s:g} s")
        used_s = now

    before = {number: signal.signal(number, how) for number, how in ((signal.SIGVTALRM, late), (signal.SIGALRM, still))}
    try:
        signal.setitimer(signal.ITIMER_VIRTUAL, limit_s, AGAIN_S)
        signal.setitimer(signal.ITIMER_REAL, still_s, still_s)
        yield
    finally:
        for timer in (signal.ITIMER_VIRTUAL, signal.ITIMER_REAL):
            signal.setitimer(timer, 0.0)
        for number, how in before.items():
            signal.signal(number, how)


def loaded(name: str, limit_s: float) -> Behaviour:
    """The behaviour of that name; that of a user's own file must return within so much processor time, each call.

    Raises `InputError` with the nearest names, or with what a file lacks.
    """
    if not is_path(name):
        return behaviours.load(name)
    what = f"behaviour {name!r}"
    with limited(what, limit_s):
        found = behaviours.load(name)

    def fitness(positions: Floats, environment: Environment, parameters: Any) -> Any:
        with limited(what, limit_s):
            return found.fitness(positions, environment, parameters)

    return replace(found, fitness=fitness)
