"""The space of a search: some of a schema's declared parameters, between bounds, as points of the unit cube."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared, declared
from flocking.types import Bools, Floats

TURN_DEG = 360.0


class Axis(NamedTuple):
    """One searched parameter: a number, or a whole number."""

    name: str
    unit: str
    low: float
    high: float
    whole: bool

    @property
    def wraps(self) -> bool:
        """Whether its ends are one place: a full turn."""
        return not self.whole and self.unit == "deg" and math.isclose(self.high - self.low, TURN_DEG)

    def value(self, share: float) -> float | int:
        """The value at a share of the way from `low` to `high`; whole numbers have equal shares of it."""
        if self.whole:
            return int(self.low) + min(int(share * (self.high - self.low + 1)), int(self.high - self.low))
        return min(max(self.low + share * (self.high - self.low), self.low), self.high)


@dataclass(frozen=True)
class Space:
    """A schema's parameters, of which d are searched and the others stay as they are."""

    parameters: Any
    """The schema's `Parameters` with the values of those that are not searched."""
    axes: tuple[Axis, ...]

    @property
    def wraps(self) -> Bools:
        """(d,) which coordinates of the unit cube are circles."""
        return np.array([axis.wraps for axis in self.axes], np.bool_)

    def folded(self, points: Floats) -> Floats:
        """Points (n, d) as points of the unit cube: around where an axis is a circle, otherwise to the nearest face."""
        return np.where(self.wraps, np.asarray(points) % 1.0, np.clip(points, 0.0, 1.0))

    def values(self, points: Floats) -> Floats:
        """(n, d) the parameters' values at points (n, d) of the unit cube, in their own units."""
        return np.array(
            [[axis.value(share) for axis, share in zip(self.axes, point, strict=True)] for point in points.tolist()],
            dtype=np.float64,
        ).reshape(-1, len(self.axes))

    def at(self, point: Floats) -> Any:
        """The schema's `Parameters` at a point (d,) of the unit cube."""
        return self.parameters._replace(
            **{axis.name: axis.value(share) for axis, share in zip(self.axes, point.tolist(), strict=True)}
        )


def searchable(parameters: type) -> list[str]:
    """The parameters that a search can vary: numbers and whole numbers between finite bounds, as they are declared."""
    return [
        name
        for name, found in declared(parameters).items()
        if found.type in (int, float) and math.isfinite(found.about.low) and math.isfinite(found.about.high)
    ]


def usual(parameters: type) -> list[str]:
    """The parameters that are searched by default: those that are searchable and no whole numbers."""
    return [name for name in searchable(parameters) if declared(parameters)[name].type is float]


def space_of(parameters: Any, searched: Sequence[str] = ()) -> Space:
    """The space of these parameters of a schema between their declared bounds; by default the `usual` ones.

    `parameters`: an instance of its `Parameters`. Raises `InputError` for what cannot be searched.
    """
    kind: Any = type(parameters)
    known, names = declared(kind), list(searched) or usual(kind)
    valid = ", ".join(searchable(kind)) or "none of this schema's"
    if not names:
        raise InputError(f"no parameter to search: expected numbers between finite bounds ({valid})")
    if len(set(names)) < len(names):
        raise InputError(f"searched = {','.join(names)}: expected each parameter once")
    return Space(parameters, tuple(_axis(name, known, valid) for name in names))


def _axis(name: str, known: Any, valid: str) -> Axis:
    if name not in known:
        raise unknown_name("parameter", name, known)
    found: Declared = known[name]
    low, high = found.about.low, found.about.high
    if found.type not in (int, float) or not (math.isfinite(low) and math.isfinite(high) and low < high):
        told = (
            "text" if found.type is str else "a truth value" if found.type is bool else "a number without finite bounds"
        )
        raise InputError(f"parameter {name!r} is {told} and cannot be searched: expected one of {valid}")
    return Axis(name, found.about.unit, float(low), float(high), found.type is int)
