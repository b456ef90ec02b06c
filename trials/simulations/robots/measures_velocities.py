"""How far the velocities that robots are told of their neighbours are from how these move, and would like to move.

Hodgins and Brogan 1994, section 3.2, has the herding algorithm read desired velocities and says that a sensor could not
measure them: here as numbers. Errors are the length of a difference of two velocities; the root of their mean square
is what a mean over neighbours hands on to a law, the median is what most of them have. An input counts as one neighbour
told of; inputs that belong to nobody have no velocity to err from.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.types import Floats
from trials.types import Measure

TOLD, ACTUAL, WISHED = slice(0, 2), slice(2, 4), slice(4, 6)
"""Columns of `Told.rows`."""

ABOUT: dict[str, Measure] = {
    "told_off_actual": Measure("m/s", "velocity told of a neighbour less its actual one, root of the mean square"),
    "told_off_actual_q50": Measure("m/s", "the same: median"),
    "told_off_desired": Measure("m/s", "velocity told of a neighbour less its desired one, root of the mean square"),
    "told_off_desired_q50": Measure("m/s", "the same: median"),
    "actual_off_desired": Measure(
        "m/s", "actual velocity of a neighbour told of less its desired one, root of the mean square"
    ),
    "no_velocity_share": Measure(
        "", "of the inputs: share that is dropped, since no velocity of it (or heading, where needed) is known"
    ),
}
"""Of trials with a law that needs velocities."""


class Told(NamedTuple):
    """What robots were told in a trial; K inputs that belong to a member."""

    rows: Floats
    """(K, 6) velocities in the world, m/s: as told, as it was then, and as the neighbour desired it then."""
    inputs: int
    """All inputs with a velocity, those that belong to nobody too."""
    dropped: int
    """Inputs without."""


def of_velocities(told: Told) -> dict[str, float]:
    """The measures of `ABOUT`; nan where nobody was told of."""
    found = dict.fromkeys(ABOUT, math.nan)
    whole = told.inputs + told.dropped
    if whole > 0:
        found["no_velocity_share"] = told.dropped / whole
    if len(told.rows) == 0:
        return found
    actual, desired = _apart(told.rows, TOLD, ACTUAL), _apart(told.rows, TOLD, WISHED)
    return found | {
        "told_off_actual": _root_mean_square(actual),
        "told_off_actual_q50": float(np.median(actual)),
        "told_off_desired": _root_mean_square(desired),
        "told_off_desired_q50": float(np.median(desired)),
        "actual_off_desired": _root_mean_square(_apart(told.rows, ACTUAL, WISHED)),
    }


def _apart(rows: Floats, one: slice, other: slice) -> Floats:
    """(K,) length of the difference, m/s."""
    difference = rows[:, one] - rows[:, other]
    return np.hypot(difference[:, 0], difference[:, 1])


def _root_mean_square(values: Floats) -> float:
    return math.sqrt(float((values**2).mean()))
