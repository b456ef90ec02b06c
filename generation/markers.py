"""Markers that behaviours and filters read."""

from __future__ import annotations

from typing import Any

from flocking.errors import InputError
from generation.environment import Environment, Mark


def marker(environment: Environment, name: str, reader: str, *kinds: type) -> Any:
    """A marker that a behaviour or a filter (`reader`) needs.

    Raises `InputError` where it is missing, or none of these kinds.
    """
    found: Mark | None = environment.markers.get(name)
    if not isinstance(found, kinds):
        expected = " or ".join(kind.__name__.lower() for kind in kinds)
        given = "is missing" if found is None else f"is a {type(found).__name__.lower()}"
        others = ", ".join(sorted(environment.markers)) or "none"
        raise InputError(f"{reader}: marker {name!r} {given}; expected a {expected} (markers: {others})")
    return found
