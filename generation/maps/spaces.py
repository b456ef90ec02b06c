"""The part of a schema's parameter space that a map covers: a box of the parameters that are refined."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import declared
from flocking.types import Bools, Floats, Ints

MOST_AXES = 4
"""Parameters of one map. A choice: each level has 2^d times as many cells."""
MOST_CELLS = 2**24
"""Cells of a map at its finest resolution. A choice: 16 MB for each array of truth values."""
TURN_DEG = 360.0


class Axis(NamedTuple):
    """One refined parameter."""

    name: str
    unit: str
    low: float
    high: float
    cells: int
    """Of the first iteration."""

    @property
    def wraps(self) -> bool:
        """Whether its ends are one place: a full turn."""
        return self.unit == "deg" and math.isclose(self.high - self.low, TURN_DEG)


@dataclass(frozen=True)
class Box:
    """Axes of a map, d of them. Cells at level r: those of the first iteration, halved r times along each axis."""

    axes: tuple[Axis, ...]

    @property
    def lows(self) -> Floats:
        """(d,)."""
        return np.array([axis.low for axis in self.axes], dtype=np.float64)

    @property
    def spans(self) -> Floats:
        """(d,)."""
        return np.array([axis.high - axis.low for axis in self.axes], dtype=np.float64)

    @property
    def wraps(self) -> Bools:
        """(d,)."""
        return np.array([axis.wraps for axis in self.axes], dtype=np.bool_)

    def shape(self, level: int) -> tuple[int, ...]:
        """Cells along each axis. Raises `InputError` for more than can be kept."""
        shape = tuple(axis.cells << level for axis in self.axes)
        if math.prod(shape) > MOST_CELLS:
            told = " x ".join(map(str, shape))
            raise InputError(f"{level} refinements make {told} cells: expected at most {MOST_CELLS}, so fewer of them")
        return shape

    def centres(self, level: int, cells: Ints) -> Floats:
        """(C, d) the values in the middle of cells (C, d)."""
        found: Floats = self.lows + (np.asarray(cells) + 0.5) * self.spans / np.array(self.shape(level))
        return found


def box_of(
    parameters: type, refined: Sequence[str], cells: Sequence[int], bounds: Sequence[tuple[float, float]] = ()
) -> Box:
    """The box of these parameters of a schema, between their declared bounds or those given.

    `cells`: of the first iteration, one number for all or one for each. Raises `InputError` for what cannot be mapped.
    """
    known = declared(parameters)
    if not 1 <= len(refined) <= MOST_AXES:
        raise InputError(f"{len(refined)} refined parameters: expected 1 to {MOST_AXES}")
    if len(set(refined)) < len(refined):
        raise InputError(f"refined {', '.join(refined)}: expected each parameter once")
    if len(cells) not in (1, len(refined)) or any(count < 1 for count in cells):
        raise InputError(
            f"grid {', '.join(map(str, cells))}: expected one whole number of at least 1, or one for each of "
            f"{', '.join(refined)}"
        )
    each = list(cells) * len(refined) if len(cells) == 1 else list(cells)
    axes = []
    for number, name in enumerate(refined):
        if name not in known:
            raise unknown_name("parameter", name, mappable(parameters))
        about = known[name]
        low, high = bounds[number] if bounds else (about.about.low, about.about.high)
        if about.type is not float or not (math.isfinite(low) and math.isfinite(high) and low < high):
            valid = ", ".join(mappable(parameters)) or "none of this schema's"
            raise InputError(f"parameter {name!r} cannot be refined: expected a number between finite bounds ({valid})")
        axes.append(Axis(name, about.about.unit, float(low), float(high), each[number]))
    return Box(tuple(axes))


def mappable(parameters: type) -> list[str]:
    """The parameters of a schema that can be refined: numbers between finite bounds, in the order of declaration."""
    return [
        name
        for name, parameter in declared(parameters).items()
        if parameter.type is float and math.isfinite(parameter.about.low) and math.isfinite(parameter.about.high)
    ]


def names(text: str) -> list[str]:
    """Names that commas join."""
    return [part.strip() for part in text.split(",") if part.strip()]


def whole_numbers(text: str, what: str) -> list[int]:
    """Whole numbers that commas join. Raises `InputError`."""
    parts: Iterable[str] = names(text)
    if not text.strip() or not all(part.isdigit() and len(part) <= 6 for part in parts):
        raise InputError(f"{what} = {text!r}: expected whole numbers joined by commas, as in 8 or 8,4")
    return [int(part) for part in parts]
