"""The flocks of a trial's first group: how many there are, how wide, and what a failure does to them.

Source: Kirchner 2006, section 3.3: a flock is a group of robots "in which no robot is separated from the others by more
than 48 pixels". Read as single linkage: two robots are of one flock where a chain of robots joins them, each link of
which is at most the gap. A robot by itself is a flock of one, which has no width. Robots that failed are in no flock.

The "standard deviation of the distance of each robot from the centroid" is read as it stands, as that of the distances;
the root of their mean square is measured beside it.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.measures.groups import group_labels
from flocking.parameters import Parameter
from flocking.types import Floats, Ints
from trials.types import Measure

SOURCE = "Kirchner 2006, section 3.3"

ABOUT: dict[str, Measure] = {
    "flocks_start": Measure("", "number of flocks of the first group at the start, robots by themselves among them"),
    "flocks_end": Measure("", "the same at the end"),
    "alone_end": Measure("", "robots by themselves, at the end"),
    "largest_flock_end": Measure("", "share of the robots that work in the largest flock, at the end"),
    "flock_std_end": Measure("m", "SD of the distances from the flock's centroid, mean over flocks of two or more"),
    "flock_std_largest": Measure("m", "the same of the largest flock"),
    "flock_std_others": Measure("m", "the same, mean over all other flocks of two or more"),
    "flock_rms_end": Measure("m", "root of the mean square of those distances, mean over flocks of two or more"),
    "flock_nearest_end": Measure("m", "distance of the nearest robot of the same flock, mean over those who have one"),
    "flocks_later": Measure("", "number of flocks, mean over the moments kept after `settled_s`"),
    "flocks_least": Measure("", "the least number of flocks at any of these moments"),
    "flocks_most": Measure("", "the most"),
    "failed_end": Measure("", "robots of the first group that failed"),
    "flocks_before": Measure("", "number of flocks at the last moment kept before the failure in the middle"),
    "flocks_after": Measure("", "the same `after_s` later, without the robot that failed"),
    "alone_after": Measure("", "robots by themselves then"),
}
"""Of trials that are given one of `Parameters`."""


class Parameters(NamedTuple):
    """How the flocks of a trial are measured; only a trial that is given one of these has them measured."""

    gap_m: Annotated[
        float, Parameter("m", f"{SOURCE}: 48 px, a foot and the ideal ten pixels", published=True, low=1e-9)
    ] = 0.384
    settled_s: Annotated[float, Parameter("s", f"{SOURCE}: after one minute", published=True, low=0.0)] = 60.0
    after_s: Annotated[float, Parameter("s", "a choice: Kirchner 2006, section 4.5: several time steps", low=0.0)] = 5.0


class Flocks(NamedTuple):
    """The flocks of N robots at one moment."""

    labels: Ints
    """(N,) the number of each robot's flock, from 0; −1 = it failed."""
    sizes: Ints
    """(F,) robots of each flock."""
    std: Floats
    """(F,) standard deviation of its robots' distances from its centroid, m; nan of a robot by itself."""
    rms: Floats
    """(F,) root of their mean square."""


def flocks_at(positions: Floats, works: np.ndarray, gap_m: float) -> Flocks:
    """The flocks of robots at `positions` (N, 2), of whom those in `works` (N,) have not failed."""
    labels = np.full(len(positions), -1, dtype=np.int64)
    if works.any():
        labels[works] = group_labels(positions[works], gap_m)
    count = int(labels.max(initial=-1)) + 1
    sizes, std, rms = np.zeros(count, dtype=np.int64), np.full(count, np.nan), np.full(count, np.nan)
    for flock in range(count):
        own = positions[labels == flock]
        sizes[flock] = len(own)
        if len(own) > 1:
            distances = np.hypot(*(own - own.mean(axis=0)).T)
            std[flock], rms[flock] = distances.std(), math.sqrt(float((distances**2).mean()))
    return Flocks(labels, sizes, std, rms)


def works_at(time_s: float, failed_s: Floats) -> np.ndarray:
    """(N,) which robots, that failed at these times (nan = never), had not failed before or at that time."""
    return ~(failed_s <= time_s)


def measure(
    times: Floats, positions: Floats, failed_s: Floats, given: Parameters, failure_time_s: float
) -> dict[str, float]:
    """The measures of `ABOUT` of the moments (T,) that were kept of N robots: positions (T, N, 2), failures (N,).

    `failure_time_s`: of the one in the middle; negative = there is none.
    """
    moments = [
        flocks_at(there, works_at(time, failed_s), given.gap_m) for time, there in zip(times, positions, strict=True)
    ]
    end, numbers = moments[-1], np.array([len(moment.sizes) for moment in moments], dtype=np.float64)
    later = numbers[times >= given.settled_s]
    largest = int(end.sizes.argmax()) if len(end.sizes) else 0
    found = dict.fromkeys(ABOUT, math.nan) | {
        "flocks_start": numbers[0],
        "flocks_end": numbers[-1],
        "alone_end": (end.sizes == 1).sum(),
        "failed_end": (failed_s <= times[-1]).sum(),
        "flock_std_end": _mean(end.std),
        "flock_rms_end": _mean(end.rms),
        "flock_nearest_end": _mean(_nearest(positions[-1], end)),
        "flock_std_others": _mean(np.delete(end.std, largest)) if len(end.sizes) else math.nan,
    }
    if len(end.sizes):
        found |= {"largest_flock_end": end.sizes.max() / end.sizes.sum(), "flock_std_largest": end.std[largest]}
    if len(later):
        found |= {"flocks_later": later.mean(), "flocks_least": later.min(), "flocks_most": later.max()}
    before, after = times < failure_time_s, times >= failure_time_s + given.after_s
    if failure_time_s >= 0.0 and before.any() and after.any():
        then = moments[int(after.argmax())]
        found |= {
            "flocks_before": numbers[before][-1],
            "flocks_after": float(len(then.sizes)),
            "alone_after": (then.sizes == 1).sum(),
        }
    return {name: float(value) for name, value in found.items()}


def _nearest(positions: Floats, flocks: Flocks) -> Floats:
    """(N,) the distance of the nearest robot of the same flock; nan of those who have none or failed."""
    gaps = np.hypot(*np.moveaxis(positions[:, None] - positions[None], -1, 0))
    alike = (flocks.labels[:, None] == flocks.labels[None]) & (flocks.labels[:, None] >= 0)
    np.fill_diagonal(alike, False)
    return np.where(alike.any(axis=1), np.where(alike, gaps, np.inf).min(axis=1), np.nan)


def _mean(values: Floats) -> float:
    """Mean of those that are no nan; nan where there are none."""
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else math.nan
