"""Which files of users this process may execute.

Laws are executed by workers alone: those that plan need only what a law declares. Reports execute nothing at all: what
a run's folder holds may come from anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from flocking.errors import InputError

_laws: ContextVar[bool] = ContextVar("laws", default=True)
_others: ContextVar[bool] = ContextVar("others", default=True)


def are_executed() -> bool:
    """Whether a user's law file may be executed here and now."""
    return _laws.get()


def check_executed(kind: str, name: str) -> None:
    """Raises `InputError` where a user's world or body (`kind`) may not be executed."""
    if not _others.get():
        raise InputError(f"{kind} {name!r} is a user's own file, which a report does not execute")


@contextmanager
def executed(laws: bool, others: bool = True) -> Iterator[None]:
    """Allows or forbids it within the block: of laws, and of worlds and bodies."""
    before = _laws.set(laws), _others.set(others)
    try:
        yield
    finally:
        _laws.reset(before[0])
        _others.reset(before[1])
