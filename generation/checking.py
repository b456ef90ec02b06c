"""Environments from outside, checked: what cannot be is refused in one line, what is harmless is mended and told.

Refused are numbers that are none or out of bounds, shapes without an inside or that cross themselves, too many pieces,
and markers inside of a wall. Mended are pieces without a length and walls that are there twice.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import shapely

from flocking.errors import InputError
from flocking.parameters import checked as checked_number
from flocking.parameters import declared
from generation.environment import Environment, Mark
from generation.free_space import clearance, in_solid
from generation.primitives import (
    BOTH,
    KINDS,
    MOST_CORNERS,
    MOST_M,
    Circle,
    Point,
    Polygon,
    Polyline,
    Primitive,
    Segment,
    kind_of,
    segments,
)

MOST_PIECES = 100_000
"""Most straight pieces of an environment. A choice: a plan of a large building has some thousand."""
SAME_M = 1e-6
"""Places nearer than this are one, m. A choice: a micrometre."""
DEEPEST_M = 1e-3
"""How far inside of a wall a marker may be, m, as by rounding. A choice: the laser's resolution."""
_FREE = declared(Circle)["free"]


def checked(environment: Environment, where: str = "") -> tuple[Environment, list[str]]:
    """The environment, mended where that is harmless, and a line for each thing that was mended.

    `where`: the file that it is of, which each line begins with. Raises `InputError`.
    """
    start = f"{where}: " if where else ""
    told: list[str] = []
    parts = {part: _checked_all(getattr(environment, part), part, start, told) for part in ("workspace", "construct")}
    markers = {}
    for name, mark in environment.markers.items():
        if not isinstance(name, str) or not name:
            raise InputError(f"{start}marker {name!r}: expected a name")
        mended = checked_mark(mark, f"{start}marker {name!r}", told)
        if mended is None:
            raise InputError(f"{start}marker {name!r} has no length; expected a point, or two places")
        markers[name] = mended
    reflectance = environment.reflectance
    if isinstance(reflectance, bool) or not isinstance(reflectance, int | float) or not 0.0 < reflectance <= 1.0:
        raise InputError(f"{start}reflectance = {reflectance!r}: expected a number above 0, at most 1")
    count = sum(_pieces(primitive) for part in parts.values() for primitive in part.values())
    if count > MOST_PIECES:
        raise InputError(f"{start}{count} straight pieces of wall: expected at most {MOST_PIECES}")
    known: dict[Any, str] = {}
    workspace, construct = (_once(primitives, part, known, start, told) for part, primitives in parts.items())
    found = dataclasses.replace(
        environment, workspace=workspace, construct=construct, markers=markers, reflectance=float(reflectance)
    )
    _check_markers(found, start)
    return found, told


def checked_mark(mark: Mark, what: str, told: list[str]) -> Any:
    """A primitive or point, checked; without its pieces of no length, which are `told`; None if nothing is left.

    `what`: what it is, for the lines. Raises `InputError`.
    """
    if not isinstance(mark, Point | Primitive):
        raise InputError(f"{what} is {type(mark).__name__}: expected a point or {' or '.join(KINDS)}")
    values = mark._asdict()
    if isinstance(mark, Polyline | Polygon):
        field = "points_m" if isinstance(mark, Polyline) else "corners_m"
        places = checked_places(values[field], f"{what}: {field}", 2 if isinstance(mark, Polyline) else 3)
        kept = _apart(places, closed=isinstance(mark, Polygon))
        if len(kept) < len(places):
            told.append(f"{what}: {len(places) - len(kept)} of its places stood on the one before, and were left out")
        if len(kept) < (3 if isinstance(mark, Polygon) else 2):
            return None
        values[field] = kept
    else:
        values |= {
            name: checked_number(f"{what}: {name}", values[name], parameter)
            for name, parameter in declared(_kind(mark)).items()
        }
    if isinstance(mark, Polygon):
        values["free"] = checked_number(f"{what}: free", values["free"], _FREE)
    found = type(mark)(**values)
    if isinstance(found, Segment) and math.hypot(found.x1_m - found.x0_m, found.y1_m - found.y0_m) < SAME_M:
        told.append(f"{what} has no length, and was left out")
        return None
    if isinstance(found, Polygon) and found.free != BOTH:
        shape = shapely.Polygon(found.corners_m)
        if shape.convex_hull.area < SAME_M * SAME_M:
            raise InputError(f"{what} has no inside: expected corners that are not on one line, or free both")
        if not shape.is_valid:
            told_why = " ".join(shapely.is_valid_reason(shape).split())
            raise InputError(f"{what} crosses or touches itself ({told_why}): expected a simple polygon, or free both")
    return found


def checked_places(given: Any, what: str, fewest: int) -> tuple[tuple[float, float], ...]:
    """Places (x, y) as a tuple of pairs of finite numbers within bounds. Raises `InputError`."""
    if not isinstance(given, Iterable) or isinstance(given, str | bytes | dict):
        raise InputError(f"{what} = {_short(given)}: expected a list of [x, y]")
    pairs = list(given)
    if not fewest <= len(pairs) <= MOST_CORNERS:
        raise InputError(f"{what} has {len(pairs)} places: expected {fewest} to {MOST_CORNERS}")
    for pair in pairs:
        sound = isinstance(pair, list | tuple | np.ndarray) and len(pair) == 2
        if not sound or not all(_is_coordinate(value) for value in pair):
            raise InputError(f"{what} has {_short(pair)}: expected [x, y], two numbers from {-MOST_M:g} to {MOST_M:g}")
    return tuple((float(x), float(y)) for x, y in pairs)


def _kind(mark: Mark) -> type:
    return type(mark)


def _is_coordinate(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and -MOST_M <= value <= MOST_M


def _checked_all(given: Any, part: str, start: str, told: list[str]) -> dict[int, Primitive]:
    """By number, from 1, the primitives of a part that are left."""
    if len(given) > MOST_PIECES:
        raise InputError(f"{start}{part} has {len(given)} primitives: expected at most {MOST_PIECES}")
    found = {}
    for number, primitive in enumerate(given, 1):
        if isinstance(primitive, Point):
            raise InputError(f"{start}{part} {number} is a point: expected {' or '.join(KINDS)}")
        mended = checked_mark(primitive, f"{start}{part} {number}", told)
        if mended is not None:
            found[number] = mended
        elif isinstance(primitive, Polyline | Polygon):
            told.append(f"{start}{part} {number} has too few places that are apart, and was left out")
    return found


def _apart(places: tuple[tuple[float, float], ...], closed: bool) -> tuple[tuple[float, float], ...]:
    """The places without those that stand on the one before; of a closed shape the last is before the first."""
    kept: list[tuple[float, float]] = []
    for x, y in places:
        if not kept or math.hypot(x - kept[-1][0], y - kept[-1][1]) >= SAME_M:
            kept.append((x, y))
    while closed and len(kept) > 1 and math.hypot(kept[-1][0] - kept[0][0], kept[-1][1] - kept[0][1]) < SAME_M:
        kept.pop()
    return tuple(kept)


def _pieces(primitive: Primitive) -> int:
    """How many straight pieces a primitive has."""
    if isinstance(primitive, Segment):
        return 1
    if isinstance(primitive, Polyline | Polygon):
        return len(primitive[0]) - isinstance(primitive, Polyline)
    return len(segments(primitive))


def _once(
    primitives: Mapping[int, Primitive], part: str, known: dict[Any, str], start: str, told: list[str]
) -> tuple[Primitive, ...]:
    """The primitives without those that stand where another one does: the same pieces, in whatever order."""
    kept = []
    for number, primitive in primitives.items():
        what = f"{part} {number}"
        pieces = np.round(segments(primitive) / SAME_M).astype(np.int64).reshape(-1, 2, 2).tolist()
        key = frozenset((*min(a, b), *max(a, b)) for a, b in pieces)
        if key in known:
            told.append(f"{start}{what} ({kind_of(primitive)}) is the same wall as {known[key]}, and was left out")
            continue
        known[key] = what
        kept.append(primitive)
    return tuple(kept)


def _check_markers(environment: Environment, start: str) -> None:
    """Refuses a point, as a herd's start, that lies inside of a wall."""
    points = {name: mark for name, mark in environment.markers.items() if isinstance(mark, Point)}
    if not points:
        return
    places = np.array([[mark.x_m, mark.y_m] for mark in points.values()])
    clear, solid = clearance(environment.faces(), places), in_solid(environment, places)
    for (name, mark), room, inside in zip(points.items(), clear, solid, strict=True):
        if room < -DEEPEST_M or (inside and room > DEEPEST_M):
            raise InputError(
                f"{start}marker {name!r} at ({mark.x_m:g}, {mark.y_m:g}) m is {abs(room):.3g} m inside of a wall: "
                "expected it in the free space"
            )


def _short(value: object) -> str:
    text = " ".join(repr(value)[:200].split())
    return text if len(text) <= 60 else f"{text[:57]}..."
