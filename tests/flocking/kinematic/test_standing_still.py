"""Members that fail: they stand from their step on, are still seen, and the others draw what they drew before."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.kinematic import Band, Failures, History, Schedule, herd, simulate, start_uniform
from flocking.types import Ints

COUNT, STEPS = 12, 40
NEVER = 10_000
POSES = start_uniform(COUNT, 4.0, np.random.default_rng(3))


def moved(failures: Failures | None, law: str = "random-motion", bands: int = 1, **schedule: Any) -> History:
    made = [Band(lawentry.load(law), COUNT // bands) for _ in range(bands)]
    plan = Schedule(0.1, STEPS, **schedule)
    return simulate(made, POSES, plan, rng=np.random.default_rng(4), speeds_m_s=0.5, failures=failures)


def steps(**failing: int) -> Ints:
    found = np.full(COUNT, NEVER)
    for name, step in failing.items():
        found[int(name.removeprefix("member_"))] = step
    return found


@pytest.mark.parametrize("synchronous", [True, False])
@pytest.mark.parametrize("bands", [1, 2])
def test_it_stands_from_its_step_on(bands: int, synchronous: bool) -> None:
    found = moved(Failures(steps(member_2=0, member_7=15)), bands=bands, synchronous=synchronous)
    still = np.ptp(found.positions_w, axis=0).max(axis=1) == 0.0
    assert still.tolist() == [k == 2 for k in range(COUNT)]
    assert np.ptp(found.positions_w[15:, 7], axis=0).max() == 0.0
    assert (np.diff(found.positions_w[:16, 7], axis=0) != 0.0).any(axis=1).all()
    assert np.ptp(found.headings_w[15:, 7]) == 0.0
    assert (found.velocities_w[16:, 7] == 0.0).all()


@pytest.mark.parametrize("bands", [1, 2])
def test_the_others_draw_what_they_drew_before(bands: int) -> None:
    whole, some = moved(None, bands=bands), moved(Failures(steps(member_2=10)), bands=bands)
    others = np.arange(COUNT) != 2
    np.testing.assert_array_equal(whole.positions_w[:, others], some.positions_w[:, others])


def test_nobody_that_fails_changes_nothing() -> None:
    for law in ("random-motion", "couzin"):
        np.testing.assert_array_equal(moved(None, law).poses_w, moved(Failures(steps()), law).poses_w)


def test_all_may_fail() -> None:
    for synchronous in (True, False):
        found = moved(Failures(np.full(COUNT, 5)), synchronous=synchronous)
        assert np.ptp(found.positions_w[5:], axis=0).max() == 0.0


def test_the_others_still_see_it() -> None:
    """Two that go side by side, and the law of the way to the mean heading: who stands keeps its heading."""
    found = moved(Failures(steps(member_0=0)), "couzin")
    gone = moved(None, "couzin")
    assert (found.positions_w[-1, 1:] != gone.positions_w[-1, 1:]).any()


def test_the_one_in_the_middle_fails() -> None:
    failures = Failures(steps(member_0=3), [(10, np.arange(6))])
    found = moved(failures)
    places = found.positions_w[10, 1:6]
    middle = 1 + int(np.hypot(*(places - places.mean(axis=0)).T).argmin())
    assert failures.steps[middle] == 10
    assert np.flatnonzero(failures.steps < STEPS).tolist() == sorted([0, middle])
    assert np.ptp(found.positions_w[10:, middle], axis=0).max() == 0.0
    assert math.isfinite(found.positions_w.sum())


@pytest.mark.parametrize("synchronous", [True, False])
def test_one_history_however_many_steps_are_done_at_a_time(synchronous: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Step by step, and in pieces that end where somebody fails."""

    def once() -> History:
        failing = Failures(steps(member_0=3, member_4=17), [(25, np.arange(COUNT))])
        return moved(failing, "vicsek", synchronous=synchronous)

    pieces = once()
    monkeypatch.setattr(herd, "FIRST_DECISIONS", 1)
    monkeypatch.setattr(herd, "PIECE_S", 1e-9)
    np.testing.assert_array_equal(pieces.poses_w, once().poses_w)
