"""The tests that decide the 13 claims of Fine 2015's detection case study.

They were fixed before any data was seen, and changed in one point after it (claims 3, 8 and 12: see the docs).

The table in docs/detection.md says, claim by claim, which measure decides in which trials, by which margin and why. The
claims' words and sections stand in the study's published.toml.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from itertools import product
from typing import NamedTuple

from trials.evidence import statistics
from trials.evidence.claims import Judged
from trials.evidence.outcomes import above, more, ratio, same, weakest
from trials.evidence.runs import Cells, UndecidedError
from trials.studies.detection.comparisons import (
    alike_at,
    all_alike,
    all_of,
    exceeds_by,
    exclusions,
    judged,
    nearest,
    overall,
    rougher,
    tested_exactly,
    trend,
)
from trials.studies.detection.conditions import (
    ACTS,
    ALWAYS,
    BEHAVIOUR,
    BODY_DIAMETER_M,
    DISTANCE_MARGIN_M,
    ERROR_MARGIN,
    EXCLUSION,
    EXCLUSIONS_M,
    EXTRAPOLATED,
    HEADS,
    LARGEST_PROPER_M,
    MEANS,
    MEMBER,
    NUMBER_FACTOR,
    PERFECT,
    PROPER_M,
    READINGS,
    SENSOR,
    SHARE_MARGIN,
    SHORT,
    SMOOTHNESS_FACTOR,
    STRONG,
)


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
    at = nearest(cells.levels(EXCLUSION), BODY_DIAMETER_M)
    outcomes = [
        alike_at(f"{name}, means - readings of perfect classification", cells, measure, (MEANS, READINGS), at, margin)
        for name, measure, margin in BEHAVIOUR
    ]
    with suppress(UndecidedError):  # shown beside it, where there are such trials: detections that do err
        outcomes += all_alike(cells, at, decides=False)
    with suppress(UndecidedError):
        for pipeline in (MEANS, READINGS, MEMBER, EXTRAPOLATED, SENSOR):
            for name, measure, margin in BEHAVIOUR:
                label = f"{name}, {SHORT[pipeline]} - perfect"
                outcomes.append(alike_at(label, cells, measure, (pipeline, PERFECT), at, margin, decides=False))
    test = f"ideal sensors, every reading correctly classified, exclusion {at:g} m: one mean a member equivalent to "
    return all_of(outcomes, f"{test}all readings (which extrapolated and sensor-based then share)")


def _no_effect_member_based(data: Data) -> Judged:
    outcomes = []
    for at in exclusions(data.study)[1:]:
        for name, measure, margin in (*BEHAVIOUR, ("SNN branch", "reverted_share", SHARE_MARGIN)):
            pair = (MEMBER, at), (MEMBER, 0.0)
            differences, exact = data.study.difference(measure, *pair), tested_exactly(data.study, measure, *pair)
            label = f"{name}, member, {at:g} m - 0 m"
            outcomes.append(same(label, differences, margin, measure != "reverted_share", exact))
    return all_of(outcomes, "member-based at each distance equivalent to it at 0 m")


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
        above(f"{name}, sensor, 0 m", data.study.array(measure, *cell), ALWAYS, 1.0 - ALWAYS, decides, (0.0, 1.0))
        for name, measure, decides in named
    ]
    return all_of(outcomes, f"always = shares above {ALWAYS:g}{LATER}; depends on herd.law.beyond_gap")


def _no_strong_convergence(data: Data) -> Judged:
    outcomes = []
    for name, measure in (
        ("share that does not act as SNN", "acts_as_snn_share_late"),
        ("HA share of the approaches", "effective_snn_share_late"),
    ):
        late = 1.0 - data.study.array(measure, SENSOR, PROPER_M)
        label = f"{name}, second half, sensor, {PROPER_M:g} m"
        outcomes.append(above(label, late, 1.0 - STRONG, 1.0 - STRONG, bounds=(0.0, 1.0)))
        with suppress(UndecidedError):  # shown beside it, where there are such trials
            label = f"{name}, second half, sensor, {PROPER_M:g} m - 0 m"
            pair = (SENSOR, 0.0), (SENSOR, PROPER_M)
            outcomes.append(exceeds_by(label, data.study, measure, *pair, SHARE_MARGIN, decides=False))
    return all_of(outcomes, f"strong convergence = an SNN share of {STRONG:g} or more in the second half")


def _too_large_returns(data: Data) -> Judged:
    cells = data.sweep()
    levels = cells.levels(EXCLUSION)
    at = levels[-1]
    if at <= max(EXCLUSIONS_M):
        raise UndecidedError(f"its largest exclusion distance is {at:g} m: not beyond the publication's own")
    outcomes = []
    for name, measure in (("share that acts as SNN", ACTS[1]), ("SNN share of the approaches", "effective_snn_share")):
        label, pair = f"{name}, sensor, {at:g} m", ((SENSOR, at), (SENSOR, PROPER_M))
        outcomes.append(exceeds_by(f"{label} - {PROPER_M:g} m", cells, measure, *pair, SHARE_MARGIN))
        share = cells.array(measure, SENSOR, at)
        outcomes.append(above(label, share, ALWAYS, 1.0 - ALWAYS, bounds=(0.0, 1.0)))
    with suppress(UndecidedError):
        rising = [level for level in levels if level >= PROPER_M]
        outcomes.append(trend(cells, ACTS[0], ACTS[1], rising))
        for pipeline in (MEMBER, EXTRAPOLATED):
            label = f"{ACTS[0]}, {SHORT[pipeline]}, {at:g} m - {PROPER_M:g} m"
            pair = (pipeline, at), (pipeline, PROPER_M)
            outcomes.append(exceeds_by(label, cells, ACTS[1], *pair, SHARE_MARGIN, decides=False))
    return all_of(outcomes, f"shares at {at:g} m higher than at {PROPER_M:g} m by the margin, and above {ALWAYS:g}")


def _errors(data: Data) -> Judged:
    outcomes = []
    for pipeline in (MEMBER, EXTRAPOLATED):
        for name, measure, sign, decides in (
            ("false negatives, share of members", "fn_share", 1.0, True),
            ("false positives, share of updates", "fp_update_share", -1.0, True),
            ("false negatives, share of beams", "fn_beam_share", 1.0, False),
            ("false positives, share of beams", "fp_beam_share", -1.0, False),
        ):
            differences, exact = overall(data.study, measure, pipeline, SENSOR)
            first, second = (pipeline, SENSOR) if sign > 0 else (SENSOR, pipeline)
            label = f"{name}, {SHORT[first]} - {SHORT[second]}, all distances"
            outcomes.append(more(label, sign * differences, ERROR_MARGIN, decides=decides, exact=exact))
    return all_of(outcomes, "both detections of members miss more and make up less than sensor-based, by the margin")


def _extrapolated_less_smooth(data: Data) -> Judged:
    return all_of(
        rougher(data.study, EXTRAPOLATED, (MEMBER,)), f"ratio of the way-points' variances above {SMOOTHNESS_FACTOR:g}"
    )


def _reverts_less(data: Data) -> Judged:
    outcomes = []
    for pipeline in (MEMBER, EXTRAPOLATED):
        for name, measure in (
            ("share that acts as SNN", "acts_as_snn_share"),
            ("SNN branch", "reverted_share"),
            ("SNN share of the approaches", "effective_snn_share"),
        ):
            label = f"{name}, {SHORT[pipeline]} - sensor, {PROPER_M:g} m"
            pair, decides = ((pipeline, PROPER_M), (SENSOR, PROPER_M)), measure != "effective_snn_share"
            outcomes.append(exceeds_by(label, data.study, measure, *pair, SHARE_MARGIN, decides))
    return all_of(outcomes, f"both others act as SNN and compute it more often than sensor-based{LATER}")


def _some_distance_alike(data: Data) -> Judged:
    cells = data.sweep()
    levels = cells.levels(EXCLUSION)
    groups = {at: all_alike(cells, at) for at in levels if at <= LARGEST_PROPER_M}
    if not groups:
        raise UndecidedError(f"it has no exclusion distance up to {LARGEST_PROPER_M:g} m")
    some = statistics.some_hold([[outcome.decision for outcome in group] for group in groups.values()])
    near = nearest(list(groups), BODY_DIAMETER_M)
    beside = [outcome for outcome in groups[near] if f"{SHORT[SENSOR]} - {SHORT[MEMBER]}" in outcome.label]
    at_diameter = statistics.all_hold([outcome.decision for outcome in beside])
    best = min(groups.values(), key=lambda group: max(outcome.decision.p_holds for outcome in group))
    parts = (some, at_diameter)
    agrees = False if False in parts else None if None in parts else True
    hinge = beside if at_diameter is not True else best
    outcomes = [*beside, *(outcome for outcome in best if outcome not in beside)]
    test = f"at one of {len(groups)} distances every pair equivalent; sensor equivalent to member at {near:g} m"
    return judged(agrees, weakest(hinge, agrees), outcomes, test, beside)


def _more_ha_at_one_metre(data: Data) -> Judged:
    outcomes = [
        exceeds_by(
            f"{name}, sensor, 1 m - 0 m",
            data.study,
            measure,
            (SENSOR, 1.0),
            (SENSOR, 0.0),
            SHARE_MARGIN,
            decides=measure == "effective_ha_share",
        )
        for name, measure in (
            ("HA share of the approaches", "effective_ha_share"),
            ("HA branch, of all updates", "ha_share"),
            ("perpendicular branch, of all updates", "perpendicular_share"),
        )
    ]
    return all_of(outcomes, "higher at 1 m by the margin; depends on herd.law.beyond_gap")


def _sensor_least_smooth(data: Data) -> Judged:
    outcomes = rougher(data.study, SENSOR, (MEMBER, EXTRAPOLATED))
    return all_of(outcomes, f"ratios of the way-points' variances above {SMOOTHNESS_FACTOR:g}")


def _extrapolated_between(data: Data) -> Judged:
    outcomes = []
    for at in exclusions(data.study)[1:]:
        for name, measure, margin in (ACTS, HEADS):
            responses = {
                pipeline: data.study.difference(measure, (pipeline, at), (pipeline, 0.0))
                for pipeline in (EXTRAPOLATED, SENSOR, MEMBER)
            }
            for other in (SENSOR, MEMBER):
                label = f"change of {name} from 0 to {at:g} m, extrapolated - {SHORT[other]}"
                differences = responses[EXTRAPOLATED] - responses[other]
                exact = tested_exactly(data.study, measure, *product((EXTRAPOLATED, other), (at, 0.0)))
                outcomes.append(same(label, differences, margin, decides=other == SENSOR, exact=exact))
    for other in (MEMBER, SENSOR):
        for name, measure, margin in BEHAVIOUR:
            label = f"{name}, extrapolated - {SHORT[other]}, all distances"
            differences, exact = overall(data.study, measure, EXTRAPOLATED, other)
            outcomes.append(same(label, differences, margin, decides=other == MEMBER, exact=exact))
    return all_of(outcomes, f"changes with distance equivalent to sensor-based, behaviour to member-based{LATER}")


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
    label = "share of updates with one member seen, sensor - member"
    outcomes.append(alike_at(label, study, "one_member_share", (SENSOR, MEMBER), 0.0, SHARE_MARGIN, decides=False))
    return all_of(
        outcomes, f"quartiles of the distance equivalent, and inputs more than {NUMBER_FACTOR:g} times as many"
    )


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
