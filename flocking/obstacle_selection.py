"""Stage 7, obstacle selection: which of the obstacles seen reach the law, the avoidance and the virtual members.

Source: Fine 2015, section 3.6.1 and figure 3.3, which name the stage and leave its functions open. Text as for
neighbours (`flocking.selection`): `all`, `nearest`, `within(1.5)` (m), `ahead(180)` (width in degrees), joined by `&`,
each seeing only what the last one kept.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from flocking import avoidance
from flocking.compilation import borrowing
from flocking.errors import InputError, unknown_name
from flocking.geometry import before
from flocking.types import Bools, Floats, Ints, Obstacles


class Step(IntEnum):
    """The functions, as the compiled code tells them apart."""

    NEAREST = 0
    WITHIN = 1
    AHEAD = 2


class Function(NamedTuple):
    """What a name stands for."""

    step: Step
    function: Callable[..., Bools]
    arguments: int
    high: float
    """The largest number that it takes; the smallest is 0."""


def _ahead(obstacles: Obstacles, width_deg: float) -> Bools:
    """Mask (K,) of the obstacles in the sector of that width about straight ahead, its edges excluded."""
    return avoidance.ahead(obstacles, math.radians(width_deg))


OBSTACLE_SELECTIONS = {
    "nearest": Function(Step.NEAREST, avoidance.nearest, 0, 0.0),
    "within": Function(Step.WITHIN, avoidance.within, 1, math.inf),
    "ahead": Function(Step.AHEAD, _ahead, 1, 360.0),
}
"""Beside `all`, which keeps everything."""

Steps = list[tuple[Function, tuple[float, ...]]]
_CALL = re.compile(r"^\s*([a-z-]+)\s*(?:\(([^()]*)\))?\s*$")


def parse(text: str) -> Steps:
    """The steps that a selection's text names. Raises `InputError` if it names none."""
    steps: Steps = []
    for part in text.split("&"):
        match = _CALL.match(part)
        if match is None:
            raise InputError(f"obstacle selection {text!r}: expected names such as nearest or within(1), joined by &")
        name = match.group(1)
        if name != "all" and name not in OBSTACLE_SELECTIONS:
            raise unknown_name("obstacle selection", name, ["all", *OBSTACLE_SELECTIONS])
        about = OBSTACLE_SELECTIONS.get(name, OBSTACLE_SELECTIONS["nearest"])
        pieces = [piece.strip() for piece in (match.group(2) or "").split(",") if piece.strip()]
        try:
            given = tuple(map(float, pieces))
        except ValueError:
            given = (math.nan,)
        if len(pieces) != about.arguments or not all(0.0 <= value <= about.high for value in given):
            most = f" to {about.high:g}" if math.isfinite(about.high) else " on"
            wanted = f"one number from 0{most}" if about.arguments else "no number"
            raise InputError(f"obstacle selection {part.strip()!r}: {name} takes {wanted}")
        if name != "all":
            steps.append((about, given))
    return steps


def select(steps: Sequence[tuple[Function, tuple[float, ...]]], obstacles: Obstacles) -> Obstacles:
    """The obstacles that every step keeps."""
    for about, given in steps:
        obstacles = Obstacles(obstacles.points[about.function(obstacles, *given)])
    return obstacles


def program(steps: Steps) -> tuple[Ints, Floats]:
    """The steps (K,) and their numbers (K,), nan where none, as the kinematic herd's compiled code takes them."""
    return (
        np.array([about.step for about, _ in steps], dtype=np.int64),
        np.array([given[0] if given else math.nan for _, given in steps], dtype=np.float64),
    )


@borrowing
def keep_selected(steps: Ints, given: Floats, points: Floats, count: int) -> int:
    """`select` in place, for the first `count` of `points`: those kept come first; returns their number."""
    for s in range(len(steps)):
        kept = 0
        if steps[s] == Step.NEAREST:
            best = 0
            for k in range(1, count):
                if before(points, k, best):
                    best = k
            if count > 0:
                points[0, 0], points[0, 1] = points[best, 0], points[best, 1]
                kept = 1
        else:
            for k in range(count):
                x, y = points[k, 0], points[k, 1]
                if steps[s] == Step.WITHIN:
                    keeps = math.hypot(x, y) < given[s]
                else:
                    keeps = abs(math.atan2(y, x)) < math.radians(given[s]) / 2.0
                if keeps:
                    points[kept, 0], points[kept, 1] = x, y
                    kept += 1
        count = kept
    return count
