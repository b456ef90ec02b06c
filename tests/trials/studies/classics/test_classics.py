"""The classics on made-up runs: what was published holds, the contrary does not."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from tests.trials.studies.judged import verdicts
from trials import design, simulations
from trials.evidence.claims import published

STUDY = "trials.studies.classics"


def order(conditions: Mapping[str, Any], sizes_alike: bool = False) -> Mapping[str, float]:
    """Falls with the noise from 1, at large noise as one over the root of the number of members."""
    count, noise = conditions["herd.count"], conditions["herd.law.noise_rad"]
    left = 1.0 / math.sqrt(100 if sizes_alike else count)
    return {"polarization": 1.0 - (1.0 - left) * min(1.0, noise / 4.0) ** 2}


def test_an_order_that_falls_further_in_larger_herds_is_vicseks() -> None:
    assert verdicts("vicsek-transition", order) == [True, True]


def test_an_order_that_no_noise_or_no_size_changes_is_not() -> None:
    assert verdicts("vicsek-transition", lambda conditions: {"polarization": 0.9}) == [False, False]
    assert verdicts("vicsek-transition", lambda conditions: order(conditions, sizes_alike=True)) == [True, False]


def accuracy(conditions: Mapping[str, Any], exponent: float = 1.0) -> Mapping[str, float]:
    """Grows with the number of informed members (exponent 1) or with their share alone (0)."""
    count, share = conditions["herd.count"], conditions["herd.informed_share"]
    informed = round(count * share)
    if informed == 0:
        return {"goal_alignment": math.nan}
    drive = share * (count / 50.0) ** exponent
    return {"goal_alignment": math.tanh(10.0 * drive)}


def test_accuracy_that_grows_with_the_number_of_the_informed_is_couzins() -> None:
    assert verdicts("couzin-leaders", accuracy) == 2 * [True, True]  # each claim at either speed


def test_accuracy_that_knows_no_size_or_no_share_is_not() -> None:
    assert verdicts("couzin-leaders", lambda conditions: accuracy(conditions, exponent=0.0)) == 2 * [True, False]
    assert verdicts("couzin-leaders", lambda conditions: {"goal_alignment": 0.5})[0] is False


def test_hamiltons_groups() -> None:
    def many(conditions: Mapping[str, Any], merged: float = 1.0) -> Mapping[str, float]:
        groups = merged if conditions["herd.law"] == "hamilton-merging" else 20.0
        return {"groups_end": groups, "largest_share_end": 1.0 / groups, "mmd_start": 15.0, "mmd_end": 10.0}

    assert verdicts("hamilton-1971", many) == [True, True, True]
    assert verdicts("hamilton-1971", lambda conditions: many(conditions, merged=3.0)) == [True, True, False]
    one = {"groups_end": 1.0, "largest_share_end": 1.0, "mmd_start": 15.0, "mmd_end": 16.0}
    assert verdicts("hamilton-1971", lambda conditions: one) == [False, False, False]


def test_vicseks_herds_have_the_published_sizes_density_and_speed() -> None:
    figure, made = published(STUDY, "vicsek1995", "figure_2"), design.plan("vicsek-transition")
    assert set(made.conditions["herd.count"]) < set(figure["particles"])
    values = {row.key: row.value for row in made.parameters}
    assert values["herd.count"] / values["world.size_m"] ** 2 == pytest.approx(figure["density"])
    assert values["herd.law.speed_m_s"] == figure["speed"]


def test_couzins_groups_have_the_published_sizes_and_weight() -> None:
    figure, made = published(STUDY, "couzin2005", "figure_1"), design.plan("couzin-leaders")
    assert made.conditions["herd.count"] == figure["group_sizes"]
    assert {row.key: row.value for row in made.parameters}["herd.law.omega"] == figure["weight"]


def test_the_order_of_updating_makes_the_order_that_it_does_elsewhere() -> None:
    """Noise 3, 400 members: 0.567 with positions moved by the old velocities, 0.539 by the new ones, measured with code
    of others to 0.002. Five trials' mean is held to three standard errors, their own and that."""
    for updating, expected in (("forward", 0.567), ("backward", 0.539)):
        asked = {"herd.count": 400, "herd.law.noise_rad": 3.0, "updating": updating, "steps": 1200}
        trials = design.plan("vicsek-transition", repeats=5, settings=asked).trials
        found = np.array([simulations.run_trial(trial, reraise=True).measures["polarization"] for trial in trials])
        error = math.hypot(found.std(ddof=1) / math.sqrt(len(found)), 0.002)
        assert found.mean() == pytest.approx(expected, abs=3.0 * error)
        assert error < 0.02
