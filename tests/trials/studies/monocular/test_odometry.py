"""Odometry: what was published holds, the contrary does not; and what the Pioneer's odometry is beside it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from tests.trials.made_up_run import finished
from trials import design, simulations
from trials.evidence.claims import published
from trials.evidence.runs import Cells
from trials.studies.monocular import odometry_claims as claims
from trials.studies.monocular.odometry_claims import RATE, SPEED, STOP_M, STOP_RAD
from trials.types import Trial, TrialResult

STUDY = "trials.studies.monocular"
MOVEMENT, TURNING = (published(STUDY, "kirchner2006", table) for table in ("movement", "turning"))
KINDS = list(zip(MOVEMENT["distances_m"], MOVEMENT["speeds_m_s"], MOVEMENT["over_read_m"], strict=True))


ASIDE = np.array(published(STUDY, "kirchner2006", "appendix_b")["rows"])[:, 5].reshape(-1, 2).mean(axis=1)
"""m, mean of the two tests of each of `KINDS`: the table's actual y."""


def as_published(conditions: Mapping[str, Any], factor: float = 1.0, aside: float = 1.0) -> Mapping[str, float]:
    """What a robot measures whose odometry errs as in the tables, times `factor`."""
    distance, angle = conditions[STOP_M], conditions[STOP_RAD]
    told = [over for far, speed, over in KINDS if (far, speed) == (distance, conditions[SPEED])]
    way_over = factor * (told[0] if told else 0.05 * distance)
    turn_over = displaced = 0.0
    if angle:
        turn_over = factor * math.radians(TURNING["over_read_deg"][claims.ANGLES.index(angle)])
        displaced = TURNING["displaced_m"][claims.ANGLES.index(angle)]
    return {
        "counted_way": distance,
        "true_way": distance - way_over if distance else displaced,
        "counted_turn": angle,
        "true_turn": angle - turn_over,
        "moved_aside": aside
        * sum(
            away
            for away, (far, speed, _) in zip(ASIDE, KINDS, strict=True)
            if (far, speed) == (distance, conditions[SPEED])
        ),
    }


def verdicts(**changed: float) -> list[bool | None]:
    """Of a run whose trials differ by 0.1 mm and 0.01 degrees."""
    trials = design.plan("odometry").trials
    run = finished(trials, lambda trial: as_published(trial.conditions, **changed), seed=5, noise=1e-4)
    return [entry.agrees for entry in design.load("odometry").claims(run)]


def test_the_publications_own_odometry_is_the_publications() -> None:
    assert verdicts() == [True] * 17


def test_an_odometry_without_error_is_not() -> None:
    found = verdicts(factor=0.0, aside=0.0)
    assert found[:7] == [False] * 7
    assert [found[7], found[8], found[10]] == [False] * 3
    assert found[13:] == [False] * 4


def test_an_odometry_that_errs_the_other_way_is_not() -> None:
    assert verdicts(factor=-1.0, aside=-0.03)[13:] == [False] * 4


def test_a_robot_that_takes_its_wheels_for_larger_reads_more_by_that_part() -> None:
    trials = [
        dataclasses.replace(
            trial,
            groups=tuple(
                dataclasses.replace(each, law_parameters={**each.law_parameters, "radius_error": 0.05})
                for each in trial.groups
            ),
        )
        for trial in design.plan("odometry").trials
    ]
    run = finished(trials, lambda trial: as_published(trial.conditions, factor=0.0), seed=5, noise=1e-6)
    cells = Cells(run.trials, run.rows(), claims.KEYS)
    np.testing.assert_allclose(claims.over_read_m(cells, 2.0, 0.1), 0.1, atol=1e-4)
    np.testing.assert_allclose(claims.over_read_deg(cells, claims.ANGLES[1], 0.0), 4.5, atol=1e-3)


def test_the_tables_means_are_those_of_its_rows() -> None:
    """The derived numbers of published.toml, from the thesis's rows beside them."""
    rows = np.array(published(STUDY, "kirchner2006", "appendix_b")["rows"])
    for distance, speed, told in KINDS:
        of = rows[(np.abs(rows[:, 1] - distance) < 0.15) & (rows[:, 0] == speed)]
        assert len(of) == 2
        assert (of[:, 1] - of[:, 4]).mean() == pytest.approx(told, abs=1e-9)
    turns = np.array(published(STUDY, "kirchner2006", "appendix_c")["rows"]).reshape(4, 4, 4)
    np.testing.assert_allclose((turns[:, :, 0] - turns[:, :, 1]).mean(1), TURNING["over_read_deg"])
    x, y = turns[:, :, 2].mean(1), turns[:, :, 3].mean(1)
    np.testing.assert_allclose(np.hypot(x, y) / 100.0, TURNING["displaced_m"], atol=5e-5)


def test_the_published_displacement_lies_at_right_angles_to_where_the_robot_faces_then() -> None:
    """So the docs say: within two degrees, at every angle."""
    turns = np.array(published(STUDY, "kirchner2006", "appendix_c")["rows"]).reshape(4, 4, 4).mean(1)
    towards = np.degrees(np.arctan2(turns[:, 3], turns[:, 2]))
    np.testing.assert_allclose(towards, turns[:, 1] - 90.0, atol=2.0)


def trial_with(**given: Any) -> Trial:
    for trial in design.plan("odometry", repeats=1).trials:
        if all(trial.conditions[f"herd.law.{key}"] == value for key, value in given.items()):
            return trial
    raise AssertionError(given)


def ran(**given: Any) -> TrialResult:
    return simulations.run_trial(trial_with(**given), reraise=True)


@pytest.mark.parametrize(("speed", "beyond"), [(0.1, 0.02), (0.2, 0.08)])
def test_a_straight_way_is_read_as_it_is_driven(speed: float, beyond: float) -> None:
    """The contacts let a wheel roll as far as it turns. It stops a little late, as the publication's robots did."""
    measures = ran(stop_m=2.0, leg_1_m_s=speed).measures
    assert measures["counted_way"] == pytest.approx(2.0 + beyond, abs=0.02)
    assert measures["true_way"] == pytest.approx(measures["counted_way"], rel=1e-4)
    assert measures["lost"] < 1e-3
    assert abs(measures["moved_aside"]) < 1e-3


@pytest.mark.parametrize("speed", [claims.IN_PLACE, claims.ONE_SIDE])
def test_turns_are_read_short_by_the_ratio_of_the_tracks(speed: float) -> None:
    """573 mm by contact against the 588 mm that the firmware believes: 2.6 %, in place and on one side's wheels."""
    measures = ran(stop_rad=claims.ANGLES[-1], leg_1_m_s=speed).measures
    assert measures["counted_turn"] == pytest.approx(math.pi, abs=math.radians(3.0))
    assert measures["true_turn"] / measures["counted_turn"] == pytest.approx(1.026, abs=2e-3)
    expected = 0.0 if speed == 0.0 else 2.0 * 0.286
    assert measures["true_way"] == pytest.approx(expected, abs=0.01)


def test_every_distance_and_angle_of_the_publication_is_driven() -> None:
    cells = {tuple(trial.conditions[key] for key in claims.KEYS) for trial in design.plan("odometry").trials}
    assert len(cells) == 6 * 2 + 4 * 2
    for distance, speed, _ in KINDS:
        assert (distance, 0.0, speed, 0.0) in cells
    for angle in claims.ANGLES:
        assert {(0.0, angle, speed, claims.TURN_RAD_S) for speed in (0.0, claims.ONE_SIDE)} <= cells
    assert {RATE, SPEED} < set(claims.KEYS)


def test_trials_whose_robots_reckon_otherwise_have_no_such_measures() -> None:
    """So that the results of every other experiment stay as they are."""
    whole = design.plan("lch-robots", repeats=1).trials[0]
    moment = simulations.of(whole).moment(whole)
    assert "counted_way" not in simulations.run_trial(moment, reraise=True).measures
