"""How the detections are held against one another: what several of the case study's claims share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from flocking.types import Floats
from trials.evidence import statistics
from trials.evidence.claims import Judged
from trials.evidence.outcomes import Outcome, decided_by_all, more, ratio, same
from trials.evidence.power import power
from trials.evidence.runs import Cells, UndecidedError
from trials.studies.detection.conditions import (
    BEHAVIOUR,
    BY,
    EXCLUSION,
    EXCLUSIONS_M,
    PAIRS,
    PUBLISHED_REPEATS,
    SENSOR,
    SHARE_MARGIN,
    SHORT,
    SMOOTHNESS_FACTOR,
    Cell,
)


def all_alike(cells: Cells, at: float, decides: bool = True) -> list[Outcome]:
    """Every pair of the three detections equivalent in behaviour at one exclusion distance."""
    return [
        alike_at(f"{name}, {SHORT[first]} - {SHORT[second]}", cells, measure, (first, second), at, margin, decides)
        for first, second in PAIRS
        for name, measure, margin in BEHAVIOUR
    ]


def rougher(cells: Cells, pipeline: str, others: tuple[str, ...]) -> list[Outcome]:
    """Ratios of the way-points' variances, each repeat's averaged (as logarithms) over the exclusion distances."""
    outcomes = []
    for measure, name in (
        ("smoothness", "variance of the way-point about its drift"),
        ("smoothness_approach", "the same without perpendicular way-points"),
        ("way_point_variance", "plain variance of the way-point"),
        ("way_point_bearing_variance", "circular variance of its bearing"),
    ):
        for other in others:
            logs = np.mean([cells.log_ratio(measure, (pipeline, at), (other, at)) for at in exclusions(cells)], axis=0)
            label = f"{name}, {SHORT[pipeline]} / {SHORT[other]}, all distances"
            outcomes.append(ratio(label, logs, SMOOTHNESS_FACTOR, decides=measure == "smoothness"))
    return outcomes


def alike_at(
    label: str, cells: Cells, measure: str, pair: tuple[str, str], at: float, margin: float, decides: bool = True
) -> Outcome:
    """Two detections equivalent in a measure at one exclusion distance."""
    first, second = ((pipeline, at) for pipeline in pair)
    differences, exact = cells.difference(measure, first, second), tested_exactly(cells, measure, first, second)
    return same(f"{label}, {at:g} m", differences, margin, decides, exact)


def exceeds_by(
    label: str, cells: Cells, measure: str, first: Cell, second: Cell, margin: float, decides: bool = True
) -> Outcome:
    """A measure greater in the first cell than in the second, by more than the margin."""
    differences, exact = cells.difference(measure, first, second), tested_exactly(cells, measure, first, second)
    return more(label, differences, margin, decides=decides, exact=exact)


def tested_exactly(cells: Cells, measure: str, *compared: Cell) -> bool:
    """Whether differences between cells are to be tested exactly: shares, of which one lies near 0 or 1."""
    bounded = "share" in measure or measure == "straightness"
    return bounded and any(statistics.near_a_bound(cells.array(measure, *cell)) for cell in compared)


def overall(cells: Cells, measure: str, pipeline: str, other: str) -> tuple[Floats, bool]:
    """(n,) paired differences between two detections, each repeat's averaged over the exclusion distances, and whether
    they are to be tested exactly."""
    levels = exclusions(cells)
    found: Floats = np.mean([cells.difference(measure, (pipeline, at), (other, at)) for at in levels], axis=0)
    return found, tested_exactly(cells, measure, *product((pipeline, other), levels))


def trend(cells: Cells, name: str, measure: str, levels: list[float]) -> Outcome:
    """The slope of a measure with sensor-based detection over the exclusion distance, repeat by repeat; shown only."""
    each = [cells.values(measure, SENSOR, at) for at in levels]
    repeats = sorted(set.intersection(*(set(values) for values in each)))
    rows = np.array([[values[repeat] for values in each] for repeat in repeats]).reshape(len(repeats), len(levels))
    label = f"slope of {name} from {levels[0]:g} to {levels[-1]:g} m (1/m), sensor"
    scale = SHARE_MARGIN / (levels[-1] - levels[0]) if len(levels) > 1 else math.nan
    return more(label, statistics.slopes(np.array(levels), rows), scale, decides=False)


def exclusions(cells: Cells) -> list[float]:
    """The publication's exclusion distances; `UndecidedError` if the run lacks one."""
    lacking = [at for at in EXCLUSIONS_M if at not in cells.levels(EXCLUSION)]
    if lacking:
        raise UndecidedError(f"the run has no trials with {EXCLUSION} = {', '.join(f'{at:g}' for at in lacking)}")
    return EXCLUSIONS_M


def nearest(levels: list[float], to: float) -> float:
    """Of several distances the one nearest to another."""
    return min(levels, key=lambda level: abs(level - to))


def all_of(outcomes: list[Outcome], test: str) -> Judged:
    """The verdict of a claim that holds if every outcome that decides does; `test`: what is tested, in words."""
    agrees, shown = decided_by_all(outcomes)
    return judged(agrees, shown, outcomes, test, outcomes)


def judged(
    agrees: bool | None, shown: Outcome, outcomes: list[Outcome], test: str, weighed: Sequence[Outcome]
) -> Judged:
    """A verdict with its tests and their power in words; `weighed`: the outcomes whose power is told."""
    deciding = [outcome for outcome in outcomes if outcome.decides]
    kinds = {(outcome.kind, outcome.tested is not None and outcome.tested.exact) for outcome in deciding}
    told = " and ".join(BY[kind] for kind in sorted(kinds, reverse=True))
    count = f", all of {len(deciding)} outcomes; fails if one does after Holm's correction" if len(deciding) > 1 else ""
    strength = power(weighed, PUBLISHED_REPEATS)
    shows = f"; if true, {PUBLISHED_REPEATS} repeats show it in {100.0 * strength:.0f} % of runs"
    words = f"{test} ({told}, by repeat{count}{shows if math.isfinite(strength) else ''})"
    return Judged(agrees, shown, outcomes, words, strength)
