"""The tests that decide the 13 claims of Fine 2015's detection case study.

They were fixed before any data was seen, and changed in one point after it (claims 3, 8 and 12: see the docs).

The table in docs/detection.md says, claim by claim, which measure decides in which trials, by which margin and why. The
claims' words and sections stand in the study's published.toml.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from flocking.types import Floats
from trials.evidence import statistics
from trials.evidence.claims import Judged, published
from trials.evidence.outcomes import Outcome, above, decided_by_all, more, ratio, same, weakest
from trials.evidence.runs import Cells, UndecidedError

PIPELINE, EXCLUSION = "herd.pipeline", "herd.law.exclusion_m"
KEYS = (PIPELINE, EXCLUSION)
MEMBER, EXTRAPOLATED, SENSOR, PERFECT = "member-based", "member-extrapolated", "sensor-based", "perfect"
MEANS, READINGS = "perfect-members", "perfect-readings"
SHORT = {
    MEMBER: "member",
    EXTRAPOLATED: "extrapolated",
    SENSOR: "sensor",
    PERFECT: "perfect",
    MEANS: "means",
    READINGS: "readings",
}
PAIRS = ((SENSOR, MEMBER), (EXTRAPOLATED, MEMBER), (EXTRAPOLATED, SENSOR))

BODY_DIAMETER_M = 0.33
EXCLUSIONS_M: list[float] = published(__package__, "fine2015", "detection_case_study")["exclusion_distances_m"]
PROPER_M = EXCLUSIONS_M[1]
"""The exclusion distance at which the publication sees HA behaviour (section 2.4.1)."""

LARGEST_PROPER_M = 1.0
"""Up to it the detections may be alike; far beyond, all three are alike for the trivial reason that all are SNN."""

# Margins: the smallest difference that an onlooker could be said to observe. Choices, with reasons in the docs.
SHARE_MARGIN = 0.10
STRAIGHTNESS_MARGIN = 0.10
SMOOTHNESS_FACTOR = 1.10
ERROR_MARGIN = 0.01
DISTANCE_MARGIN_M = BODY_DIAMETER_M
NUMBER_FACTOR = 2.0
ALWAYS = 0.95
STRONG = 0.75

ACTS = ("share that acts as SNN", "acts_as_snn_share", SHARE_MARGIN)
"""Of all updates with inputs: the robot does what SNN would do."""
HEADS = ("HA share of the approaches", "effective_ha_share", SHARE_MARGIN)
"""Of the SNN and HA way-points: those that point elsewhere than at the nearest input."""
BEHAVIOUR = (ACTS, HEADS, ("straightness", "straightness", STRAIGHTNESS_MARGIN))
"""What an onlooker sees of the behaviour: what the robots do, where they head, and the line that SNN forms."""


class Data(NamedTuple):
    """The trials at hand for one arm of the case study."""

    study: Cells
    ideal: Callable[[], Cells]
    """Of `detection-ideal`; raises `UndecidedError` where there is no such run."""
    sweep: Callable[[], Cells]
    """Of `detection-exclusion-sweep`, likewise."""


LATER = "; an outcome added after data had been seen decides too"

# The 13 claims, in the publication's order.


def _perfect_sensing(data: Data) -> Judged:
    cells = data.ideal()
    at = _nearest(cells.levels(EXCLUSION), BODY_DIAMETER_M)
    outcomes = [
        same(
            f"{name}, means - readings of perfect classification, {at:g} m",
            cells.difference(measure, (MEANS, at), (READINGS, at)),
            margin,
        )
        for name, measure, margin in BEHAVIOUR
    ]
    with suppress(UndecidedError):  # shown beside it, where there are such trials: detections that do err
        outcomes += _alike(cells, at, decides=False)
    with suppress(UndecidedError):
        for pipeline in (MEANS, READINGS, MEMBER, EXTRAPOLATED, SENSOR):
            for name, measure, margin in BEHAVIOUR:
                label = f"{name}, {SHORT[pipeline]} - perfect, {at:g} m"
                differences = cells.difference(measure, (pipeline, at), (PERFECT, at))
                outcomes.append(same(label, differences, margin, decides=False))
    test = f"ideal sensors, every reading correctly classified, exclusion {at:g} m: one mean a member equivalent to "
    return _all(outcomes, f"{test}all readings (which extrapolated and sensor-based then share)")


def _no_effect_member_based(data: Data) -> Judged:
    outcomes = []
    for at in _exclusions(data.study)[1:]:
        for name, measure, margin in (*BEHAVIOUR, ("SNN branch", "reverted_share", SHARE_MARGIN)):
            differences = data.study.difference(measure, (MEMBER, at), (MEMBER, 0.0))
            label = f"{name}, member, {at:g} m - 0 m"
            outcomes.append(same(label, differences, margin, decides=measure != "reverted_share"))
    return _all(outcomes, "member-based at each distance equivalent to it at 0 m")


def _sensor_at_zero_is_snn(data: Data) -> Judged:
    cell = (SENSOR, 0.0)
    named = (
        ("share that acts as SNN", "acts_as_snn_share", True),
        ("SNN share of the approaches", "effective_snn_share", True),
        ("the same, bound 7.5 degrees", "effective_snn_share_tight", False),
        ("the same, bound 30 degrees", "effective_snn_share_wide", False),
        ("straightness", "straightness", False),
    )
    outcomes = [
        above(f"{name}, sensor, 0 m", _array(data.study.values(measure, *cell)), ALWAYS, 1.0 - ALWAYS, decides)
        for name, measure, decides in named
    ]
    return _all(outcomes, f"always = mean shares above {ALWAYS:g}{LATER}; depends on herd.law.beyond_gap")


def _no_strong_convergence(data: Data) -> Judged:
    outcomes = []
    for name, measure in (
        ("share that does not act as SNN", "acts_as_snn_share_late"),
        ("HA share of the approaches", "effective_snn_share_late"),
    ):
        late = 1.0 - _array(data.study.values(measure, SENSOR, PROPER_M))
        label = f"{name}, second half, sensor, {PROPER_M:g} m"
        outcomes.append(above(label, late, 1.0 - STRONG, 1.0 - STRONG))
        with suppress(UndecidedError):  # shown beside it, where there are such trials
            change = data.study.difference(measure, (SENSOR, 0.0), (SENSOR, PROPER_M))
            label = f"{name}, second half, sensor, {PROPER_M:g} m - 0 m"
            outcomes.append(more(label, change, SHARE_MARGIN, decides=False))
    return _all(outcomes, f"strong convergence = an SNN share of {STRONG:g} or more in the second half")


def _too_large_returns(data: Data) -> Judged:
    cells = data.sweep()
    levels = cells.levels(EXCLUSION)
    at = levels[-1]
    if at <= max(EXCLUSIONS_M):
        raise UndecidedError(f"its largest exclusion distance is {at:g} m: not beyond the publication's own")
    outcomes = []
    for name, measure in (("share that acts as SNN", ACTS[1]), ("SNN share of the approaches", "effective_snn_share")):
        change = cells.difference(measure, (SENSOR, at), (SENSOR, PROPER_M))
        outcomes.append(more(f"{name}, sensor, {at:g} m - {PROPER_M:g} m", change, SHARE_MARGIN))
        share = _array(cells.values(measure, SENSOR, at))
        outcomes.append(above(f"{name}, sensor, {at:g} m", share, ALWAYS, 1.0 - ALWAYS))
    with suppress(UndecidedError):
        rising = [level for level in levels if level >= PROPER_M]
        outcomes.append(_trend(cells, ACTS[0], ACTS[1], rising))
        for pipeline in (MEMBER, EXTRAPOLATED):
            change = cells.difference(ACTS[1], (pipeline, at), (pipeline, PROPER_M))
            label = f"{ACTS[0]}, {SHORT[pipeline]}, {at:g} m - {PROPER_M:g} m"
            outcomes.append(more(label, change, SHARE_MARGIN, decides=False))
    return _all(outcomes, f"shares at {at:g} m higher than at {PROPER_M:g} m, and above {ALWAYS:g}")


def _errors(data: Data) -> Judged:
    outcomes = []
    for pipeline in (MEMBER, EXTRAPOLATED):
        for name, measure, sign, decides in (
            ("false negatives, share of members", "fn_share", 1.0, True),
            ("false positives, share of updates", "fp_update_share", -1.0, True),
            ("false negatives, share of beams", "fn_beam_share", 1.0, False),
            ("false positives, share of beams", "fp_beam_share", -1.0, False),
        ):
            differences = sign * _overall(data.study, measure, pipeline, SENSOR)
            first, second = (pipeline, SENSOR) if sign > 0 else (SENSOR, pipeline)
            label = f"{name}, {SHORT[first]} - {SHORT[second]}, all distances"
            outcomes.append(more(label, differences, ERROR_MARGIN, decides=decides))
    return _all(outcomes, "both detections of members miss more and make up less than sensor-based")


def _extrapolated_less_smooth(data: Data) -> Judged:
    return _all(_rougher(data.study, EXTRAPOLATED, (MEMBER,)), "ratio of the way-points' variances above 1")


def _reverts_less(data: Data) -> Judged:
    outcomes = []
    for pipeline in (MEMBER, EXTRAPOLATED):
        for name, measure in (
            ("share that acts as SNN", "acts_as_snn_share"),
            ("SNN branch", "reverted_share"),
            ("SNN share of the approaches", "effective_snn_share"),
        ):
            differences = data.study.difference(measure, (pipeline, PROPER_M), (SENSOR, PROPER_M))
            label = f"{name}, {SHORT[pipeline]} - sensor, {PROPER_M:g} m"
            outcomes.append(more(label, differences, SHARE_MARGIN, decides=measure != "effective_snn_share"))
    return _all(outcomes, f"both others act as SNN and compute it more often than sensor-based{LATER}")


def _some_distance_alike(data: Data) -> Judged:
    cells = data.sweep()
    levels = cells.levels(EXCLUSION)
    groups = {at: _alike(cells, at) for at in levels if at <= LARGEST_PROPER_M}
    if not groups:
        raise UndecidedError(f"it has no exclusion distance up to {LARGEST_PROPER_M:g} m")
    some = statistics.some_hold([[outcome.decision for outcome in group] for group in groups.values()])
    near = _nearest(list(groups), BODY_DIAMETER_M)
    beside = [outcome for outcome in groups[near] if f"{SHORT[SENSOR]} - {SHORT[MEMBER]}" in outcome.label]
    at_diameter = statistics.all_hold([outcome.decision for outcome in beside])
    best = min(groups.values(), key=lambda group: max(outcome.decision.p_holds for outcome in group))
    parts = (some, at_diameter)
    agrees = False if False in parts else None if None in parts else True
    hinge = beside if at_diameter is not True else best
    outcomes = [*beside, *(outcome for outcome in best if outcome not in beside)]
    test = f"at one of {len(groups)} distances every pair equivalent; sensor equivalent to member at {near:g} m"
    return Judged(agrees, weakest(hinge, agrees), outcomes, _described(test, outcomes))


def _more_ha_at_one_metre(data: Data) -> Judged:
    outcomes = [
        more(
            f"{name}, sensor, 1 m - 0 m",
            data.study.difference(measure, (SENSOR, 1.0), (SENSOR, 0.0)),
            SHARE_MARGIN,
            decides=measure == "effective_ha_share",
        )
        for name, measure in (
            ("HA share of the approaches", "effective_ha_share"),
            ("HA branch, of all updates", "ha_share"),
            ("perpendicular branch, of all updates", "perpendicular_share"),
        )
    ]
    return _all(outcomes, "higher at 1 m; depends on herd.law.beyond_gap")


def _sensor_least_smooth(data: Data) -> Judged:
    outcomes = _rougher(data.study, SENSOR, (MEMBER, EXTRAPOLATED))
    return _all(outcomes, "ratios of the way-points' variances above 1")


def _extrapolated_between(data: Data) -> Judged:
    outcomes = []
    for at in _exclusions(data.study)[1:]:
        for name, measure, margin in (ACTS, HEADS):
            responses = {
                pipeline: data.study.difference(measure, (pipeline, at), (pipeline, 0.0))
                for pipeline in (EXTRAPOLATED, SENSOR, MEMBER)
            }
            for other in (SENSOR, MEMBER):
                label = f"change of {name} from 0 to {at:g} m, extrapolated - {SHORT[other]}"
                differences = responses[EXTRAPOLATED] - responses[other]
                outcomes.append(same(label, differences, margin, decides=other == SENSOR))
    for other in (MEMBER, SENSOR):
        for name, measure, margin in BEHAVIOUR:
            label = f"{name}, extrapolated - {SHORT[other]}, all distances"
            differences = _overall(data.study, measure, EXTRAPOLATED, other)
            outcomes.append(same(label, differences, margin, decides=other == MEMBER))
    return _all(outcomes, f"changes with distance equivalent to sensor-based, behaviour to member-based{LATER}")


def _inputs_look_alike(data: Data) -> Judged:
    sensor, member = (SENSOR, 0.0), (MEMBER, 0.0)
    study = data.study
    outcomes = [
        same(
            f"{name} of the distance to those seen (m), sensor - member, 0 m",
            study.difference(measure, sensor, member),
            DISTANCE_MARGIN_M,
        )
        for name, measure in (
            ("lower quartile", "seen_distance_q25"),
            ("median", "seen_distance_q50"),
            ("upper quartile", "seen_distance_q75"),
        )
    ]
    logs = study.log_ratio("inputs_per_update", sensor, member)
    outcomes.append(ratio("number of inputs, sensor / member, 0 m", logs, NUMBER_FACTOR))
    one = study.difference("one_member_share", sensor, member)
    outcomes.append(same("share of updates with one member seen, sensor - member, 0 m", one, SHARE_MARGIN, False))
    return _all(outcomes, "quartiles of the distance equivalent, and more inputs")


JUDGES: tuple[Callable[[Data], Judged], ...] = (
    _perfect_sensing,
    _no_effect_member_based,
    _sensor_at_zero_is_snn,
    _no_strong_convergence,
    _too_large_returns,
    _errors,
    _extrapolated_less_smooth,
    _reverts_less,
    _some_distance_alike,
    _more_ha_at_one_metre,
    _sensor_least_smooth,
    _extrapolated_between,
    _inputs_look_alike,
)


# What several claims share.


def _alike(cells: Cells, at: float, decides: bool = True) -> list[Outcome]:
    """Every pair of the three detections equivalent in behaviour at one exclusion distance."""
    return [
        same(
            f"{name}, {SHORT[first]} - {SHORT[second]}, {at:g} m",
            cells.difference(measure, (first, at), (second, at)),
            margin,
            decides,
        )
        for first, second in PAIRS
        for name, measure, margin in BEHAVIOUR
    ]


def _rougher(cells: Cells, pipeline: str, others: tuple[str, ...]) -> list[Outcome]:
    """Ratios of the way-points' variances, each repeat's averaged (as logarithms) over the exclusion distances."""
    outcomes = []
    for measure, name in (
        ("smoothness", "variance of the way-point about its drift"),
        ("smoothness_approach", "the same without perpendicular way-points"),
        ("way_point_variance", "plain variance of the way-point"),
        ("way_point_bearing_variance", "circular variance of its bearing"),
    ):
        for other in others:
            logs = np.mean([cells.log_ratio(measure, (pipeline, at), (other, at)) for at in _exclusions(cells)], axis=0)
            label = f"{name}, {SHORT[pipeline]} / {SHORT[other]}, all distances"
            outcomes.append(ratio(label, logs, SMOOTHNESS_FACTOR, decides=measure == "smoothness"))
    return outcomes


def _overall(cells: Cells, measure: str, pipeline: str, other: str) -> Floats:
    """(n,) paired differences between two detections, each repeat's averaged over the exclusion distances."""
    each = [cells.difference(measure, (pipeline, at), (other, at)) for at in _exclusions(cells)]
    overall: Floats = np.mean(each, axis=0)
    return overall


def _trend(cells: Cells, name: str, measure: str, levels: list[float]) -> Outcome:
    """The slope of a measure with sensor-based detection over the exclusion distance, repeat by repeat; shown only."""
    each = [cells.values(measure, SENSOR, at) for at in levels]
    repeats = sorted(set.intersection(*(set(values) for values in each)))
    rows = np.array([[values[repeat] for values in each] for repeat in repeats]).reshape(len(repeats), len(levels))
    label = f"slope of {name} from {levels[0]:g} to {levels[-1]:g} m (1/m), sensor"
    scale = SHARE_MARGIN / (levels[-1] - levels[0]) if len(levels) > 1 else math.nan
    return more(label, statistics.slopes(np.array(levels), rows), scale, decides=False)


def _exclusions(cells: Cells) -> list[float]:
    """The publication's exclusion distances; `UndecidedError` if the run lacks one."""
    lacking = [at for at in EXCLUSIONS_M if at not in cells.levels(EXCLUSION)]
    if lacking:
        raise UndecidedError(f"the run has no trials with {EXCLUSION} = {', '.join(f'{at:g}' for at in lacking)}")
    return EXCLUSIONS_M


def _nearest(levels: list[float], to: float) -> float:
    return min(levels, key=lambda level: abs(level - to))


def _array(values: Mapping[int, float]) -> Floats:
    return np.array([values[repeat] for repeat in sorted(values)])


def _all(outcomes: list[Outcome], test: str) -> Judged:
    agrees, shown = decided_by_all(outcomes)
    return Judged(agrees, shown, outcomes, _described(test, outcomes))


def _described(test: str, outcomes: list[Outcome]) -> str:
    deciding = [outcome for outcome in outcomes if outcome.decides]
    kinds = {outcome.kind for outcome in deciding}
    by = {
        "exceeds": "t, 95 % interval",
        "equivalent": "two one-sided t-tests, 90 % interval",
    }
    told = " and ".join(by[kind] for kind in sorted(kinds, reverse=True))
    count = f", all of {len(deciding)} outcomes; fails if one does after Holm's correction" if len(deciding) > 1 else ""
    return f"{test} ({told}, by repeat{count})"
