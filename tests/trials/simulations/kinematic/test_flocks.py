"""The flocks of a kinematic trial, and members that fail in it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking.errors import InputError
from trials import keys, simulations
from trials.simulations.kinematic import failures, fields, flocks
from trials.simulations.kinematic.herd import assemble, check
from trials.simulations.kinematic.loop import FAILED_S
from trials.types import Trial

EVERYBODY = np.ones(6, np.bool_)
PLACES = np.array([[0.0, 0.0], [0.3, 0.0], [0.6, 0.0], [5.0, 0.0], [5.0, 0.2], [9.0, 9.0]])


def test_a_chain_is_a_flock_and_one_by_itself_is_one_without_a_width() -> None:
    found = flocks.flocks_at(PLACES, EVERYBODY, 0.3 + 1e-9)
    assert found.labels.tolist() == [0, 0, 0, 1, 1, 2]
    assert found.sizes.tolist() == [3, 2, 1]
    # 0.3, 0, 0.3 m from the middle: mean 0.2, squares' mean 0.06; and 0.1 m twice
    np.testing.assert_allclose(found.std, [math.sqrt(0.02), 0.0, np.nan], atol=1e-12)
    np.testing.assert_allclose(found.rms, [math.sqrt(0.06), 0.1, np.nan])
    assert len(flocks.flocks_at(PLACES, EVERYBODY, 0.29).sizes) == 5


def test_who_failed_is_in_no_flock_and_joins_none() -> None:
    works = EVERYBODY.copy()
    works[1] = False
    found = flocks.flocks_at(PLACES, works, 0.31)
    assert found.labels.tolist() == [0, -1, 1, 2, 2, 3]
    assert len(flocks.flocks_at(PLACES, ~EVERYBODY, 0.31).sizes) == 0


def test_measures_of_a_made_up_trial() -> None:
    """Six robots: at first as above; after 2 s the second fails; at the end the last joins the pair."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    positions = np.repeat(PLACES[None], 5, axis=0)
    positions[4, 5] = 5.0, 0.5
    failed_s = np.full(6, np.nan)
    failed_s[1] = 2.0
    found = flocks.measure(times, positions, failed_s, flocks.Parameters(0.31, 1.0, 1.0), 2.0)
    assert {name: found[name] for name in ("flocks_start", "flocks_before", "flocks_after", "flocks_end")} == {
        "flocks_start": 3.0, "flocks_before": 3.0, "flocks_after": 4.0, "flocks_end": 3.0,
    }  # fmt: skip
    assert (found["alone_end"], found["alone_after"], found["failed_end"]) == (2.0, 3.0, 1.0)
    assert found["largest_flock_end"] == pytest.approx(3.0 / 5.0)
    assert (found["flocks_later"], found["flocks_least"], found["flocks_most"]) == (3.5, 3.0, 4.0)
    assert found["flock_nearest_end"] == pytest.approx((0.2 + 0.2 + 0.3) / 3.0)
    assert found.keys() == flocks.ABOUT.keys()


def herd(count: int = 20, **more: Any) -> Trial:
    own = {key: more.pop(key) for key in ("failure_probability", "failure_time_s") if key in more}
    return fields.trial("made-up", 1, [fields.group("vicsek", count, **own)], **{"steps": 50, **more})


def test_they_are_measured_where_asked_for() -> None:
    assert not flocks.ABOUT.keys() & simulations.run_trial(herd()).measures.keys()
    asked = keys.put(herd(), "flocks.gap_m", 0.5)
    found = simulations.run_trial(asked).measures
    assert flocks.ABOUT.keys() <= found.keys()
    assert found["flocks_end"] >= 1.0
    assert found["failed_end"] == 0.0


def test_a_failing_trial_tells_who_failed_and_when() -> None:
    done = simulations.run_trial(herd(failure_probability=0.02), reraise=True)
    failed_s = done.tables[FAILED_S]
    assert 0 < np.isfinite(failed_s).sum() < 20
    for k in np.flatnonzero(np.isfinite(failed_s)):
        assert np.ptp(done.poses_w[done.times >= failed_s[k] - 1e-9, k], axis=0).max() == 0.0
    assert simulations.run_trial(herd(failure_probability=0.02)).poses_w.tobytes() == done.poses_w.tobytes()


def test_failures_come_at_the_rate_that_is_given() -> None:
    """Of 4000 members within 50 steps; the chance of each is 1 - 0.99^50. Four standard errors."""
    found = failures.failures_of(herd(4000, failure_probability=0.01))
    assert found is not None
    expected = 1.0 - 0.99**50
    assert (found.steps < 50).mean() == pytest.approx(expected, abs=4.0 * math.sqrt(expected * (1 - expected) / 4000))
    assert (found.steps == 0).mean() == pytest.approx(0.01, abs=4.0 * math.sqrt(0.01 * 0.99 / 4000))


def test_certain_failures_come_at_once_and_none_are_none() -> None:
    found = failures.failures_of(herd(failure_probability=1.0))
    assert found is not None
    assert (found.steps == 0).all()
    assert failures.failures_of(herd()) is None
    assert np.isnan(failures.times_of(failures.Failures(np.full(3, 50)), 0.1, 50)).all()


def test_the_one_in_the_middle_fails_at_its_time() -> None:
    done = simulations.run_trial(herd(9, failure_time_s=20.0), reraise=True)
    assert np.isfinite(done.tables[FAILED_S]).sum() == 1
    assert np.nanmin(done.tables[FAILED_S]) == 20.0


def test_a_group_of_nobody_is_no_group() -> None:
    alone = fields.trial("made-up", 1, [fields.group("vicsek", 6)], steps=20)
    nobody = fields.group("couzin", 0, name="others")
    both = fields.trial("made-up", 1, [fields.group("vicsek", 6), nobody], steps=20)
    check(both)
    assert simulations.run_trial(both).poses_w.tobytes() == simulations.run_trial(alone).poses_w.tobytes()
    with pytest.raises(InputError, match="expected at least 1 member"):
        check(fields.trial("made-up", 1, [fields.group("vicsek", 0)], steps=20))


def test_groups_that_differ_in_parameters_alone_move_as_one_band_or_as_two() -> None:
    """Vicsek's law with two noises; a limit that is never reached keeps the groups apart."""
    first = fields.group("vicsek", 7, law_parameters={"noise_rad": 0.1})
    second = {"name": "others", "law_parameters": {"noise_rad": 2.0}}
    one = fields.trial("made-up", 1, [first, fields.group("vicsek", 5, **second)], steps=50)  # type: ignore[arg-type]
    limited = fields.group("vicsek", 5, max_speed_m_s=1e6, **second)  # type: ignore[arg-type]
    two = fields.trial("made-up", 1, [first, limited], steps=50)
    assert [len(assemble(trial).bands) for trial in (one, two)] == [1, 2]
    assert simulations.run_trial(one).poses_w.tobytes() == simulations.run_trial(two).poses_w.tobytes()
