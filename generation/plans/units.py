"""Units of length of drawings."""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.errors import InputError, unknown_name

METRES = {
    "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3,
    "in": 0.0254, "ft": 0.3048, "yd": 0.9144,
    "pt": 0.0254 / 72.0, "pc": 0.0254 / 6.0, "px": 0.0254 / 96.0,
}  # fmt: skip
"""Metres, by name. Points, picas and pixels are those of CSS 2.1, section 4.3.2: 72, 6 and 96 an inch."""
SMALLEST_M, LARGEST_M = 1e-6, 1e4
"""Bounds of a scale, metres per unit. A choice: from a micrometre to ten kilometres."""


class Unit(NamedTuple):
    """What one unit of a drawing is."""

    metres: float
    name: str
    """As it is told, such as `mm` or `0.05 m`."""


def named(name: str) -> Unit:
    """The unit of that name. Raises `InputError`."""
    if name not in METRES:
        raise unknown_name("unit", name, METRES)
    return Unit(METRES[name], name)


def scaled(metres: float) -> Unit:
    """A unit of so many metres. Raises `InputError`."""
    if not (math.isfinite(metres) and SMALLEST_M <= metres <= LARGEST_M):
        raise InputError(f"scale {metres!r}: expected metres per unit, from {SMALLEST_M:g} to {LARGEST_M:g}")
    return Unit(metres, f"{metres:.10g} m")


def chosen(own: Unit | None, given: Unit | None, where: str, lacking: str) -> tuple[Unit, str]:
    """The unit of a drawing, and the line that tells it. Raises `InputError` if there is none.

    `own`: the drawing's; `given`: the user's, which goes first; `lacking`: what the drawing lacks if it has none.
    """
    if given is not None:
        aside = f"; the drawing's own, {own.name}, is set aside" if own is not None and own != given else ""
        return given, f"one unit is {given.name}, as given{aside}"
    if own is None:
        raise InputError(f"{where} is without units ({lacking}): expected --unit mm (or another), or --scale METRES")
    return own, f"one unit is {own.name}"
