"""A law that does as it is told, member by member, and short ways to run kinematic herds. For the tests of the herd."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking import lawentry
from flocking.kinematic import Band, History, Schedule, Space, simulate
from flocking.types import Floats

TOLD = """
import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.types import Kind, Motion

NEEDS = frozenset({"compass", "positions", "contacts"})
RULES = ("told",)
DRAWS = 2
MEMORY = 1


class Parameters(NamedTuple):
    kind: Annotated[int, Parameter("", "a test")] = 3
    x: Annotated[float, Parameter("", "a test: world axes for kinds 2, 3 and 5")] = 0.0
    y: Annotated[float, Parameter("", "a test")] = 0.0
    random: Annotated[float, Parameter("", "a test: longest of a vector drawn anew, added to (x, y)")] = 0.0
    back_off: Annotated[bool, Parameter("", "a test: the other way in the step after a bumper was pressed")] = False
    see: Annotated[float, Parameter("m", "a test: range of the set", low=0.0)] = 1.0


SETS = {"neighbours": "distance-based(0, see)"}


def law(own, members, sets, obstacles, parameters, memory, u):
    angle = 2.0 * math.pi * u[0]
    length = parameters.random * 10.0 ** (-4.0 * u[1])
    x, y = parameters.x + length * math.cos(angle), parameters.y + length * math.sin(angle)
    if parameters.back_off and (own.contacts[0] or own.contacts[1]):
        x, y = -x, -y
    if parameters.kind != 4:
        c, s = math.cos(own.compass), math.sin(own.compass)
        x, y = c * x + s * y, c * y - s * x
    memory[0] += 1.0
    return Motion(parameters.kind, x, y, 0)
"""
"""Moves as its parameters say; random lengths are spread over four powers of ten."""


def law_of(source: str, name: str = "/made/up/told.py") -> lawentry.Law:
    """A law of a user's own, from its text."""
    return lawentry.load(name, source)


def told(count: int, given: Any = None, **band: Any) -> Band:
    """Members that do as told: by one mapping of parameters, or by one each."""
    return Band(law_of(TOLD), count, {} if given is None else given, **band)


def poses(places: Any, headings: Any = 0.0) -> Floats:
    """(N, 3) of positions (N, 2) and one heading, or one each."""
    places = np.asarray(places, dtype=float).reshape(-1, 2)
    return np.column_stack([places, np.broadcast_to(np.asarray(headings, dtype=float), len(places))])


def run(
    bands: Any,
    starts: Floats,
    steps: int,
    *,
    dt_s: float = 1.0,
    every: int = 1,
    synchronous: bool = True,
    forward: bool = False,
    seed: int = 0,
    **more: Any,
) -> History:
    schedule = Schedule(dt_s, steps, every, synchronous, forward)
    return simulate(bands, starts, schedule, rng=np.random.default_rng(seed), **more)


def same(one: History, other: History) -> bool:
    """Bit for bit."""
    return all(np.array_equal(getattr(one, field), getattr(other, field)) for field in History.__dataclass_fields__)


def differences(one: History, other: History, period_m: float = 0.0) -> Floats:
    """Largest difference of a coordinate at each recorded time, in periodic space the short way."""
    gaps = one.positions_w - other.positions_w
    if period_m:
        gaps -= period_m * np.round(gaps / period_m)
    turns = np.abs((one.headings_w - other.headings_w + math.pi) % (2.0 * math.pi) - math.pi)
    found: Floats = np.maximum(np.abs(gaps).max(axis=(1, 2)), turns.max(axis=1))
    return found


def segments_cross(starts: Floats, ends: Floats, wall: Floats) -> Floats:
    """Which straight ways (K, 2) -> (K, 2) cross the wall (4,); from the sides on which their ends lie."""

    def side(origin: Floats, along: Floats, point: Floats) -> Floats:
        return along[..., 0] * (point - origin)[..., 1] - along[..., 1] * (point - origin)[..., 0]

    a, b = wall[:2], wall[2:]
    apart = side(a, b - a, starts) * side(a, b - a, ends) < 0.0
    through = side(starts, ends - starts, a) * side(starts, ends - starts, b) < 0.0
    found: Floats = apart & through
    return found


SQUARE = Space("bounded", 10.0)
