"""A limit of processor time for code of the user's own that runs in this process.

It is for code in Python, which a signal interrupts between two of its steps; compiled code is watched from outside
(`trials.simulations.watch`).
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from flocking.errors import InputError
from flocking.found import is_path
from flocking.types import Floats
from generation import behaviours
from generation.behaviours import Behaviour
from generation.environment import Environment

AGAIN_S = 1.0
"""Processor time after which a block that caught the error meets it once more."""


@contextmanager
def limited(what: str, limit_s: float) -> Iterator[None]:
    """Raises `InputError` in a block that uses more processor time (s).

    Signals are the main thread's: in another one the block has no limit.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def late(*_: object) -> None:
        raise InputError(f"{what} did not return within {limit_s:g} s of processor time")

    before = signal.signal(signal.SIGVTALRM, late)
    try:
        signal.setitimer(signal.ITIMER_VIRTUAL, limit_s, AGAIN_S)
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


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
