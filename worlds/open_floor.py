"""An open floor without walls."""

from __future__ import annotations

from typing import NamedTuple

from generation.environment import Environment


class Parameters(NamedTuple):
    """The open floor has none."""


def environment(parameters: Parameters) -> Environment:
    """Nothing stands in it."""
    return Environment()
