"""Whether this process may execute the law files of users: those that plan and report need not, and do not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_executed: ContextVar[bool] = ContextVar("executed", default=True)


def are_executed() -> bool:
    """Whether a user's law file may be executed here and now."""
    return _executed.get()


@contextmanager
def executed(allowed: bool) -> Iterator[None]:
    """Allows or forbids it within the block."""
    before = _executed.set(allowed)
    try:
        yield
    finally:
        _executed.reset(before)
