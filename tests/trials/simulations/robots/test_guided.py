"""Trials in which a herd is guided through a task: what is refused, which walls stand when, and who decides it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from scipy.spatial.distance import cdist

from flocking.errors import InputError
from generation.free_space import distance
from generation.piloting import course
from generation.piloting import plan as plans
from generation.piloting.formations import slots
from generation.piloting.pilots import ARRIVED_M
from trials import simulations
from trials.design import plan
from trials.simulations.contract import StoppedError
from trials.simulations.robots import guided, loop, measures_guided
from trials.types import Trial, TrialResult, Value, with_setup
from worlds.walls import FENCE


def trial(guides: str, **setup: Value) -> Trial:
    """The first repeat of the first task, guided so, of `piloting`."""
    settings = {"task": "task-1", "piloting.guides": guides, **setup}
    return plan("piloting", repeats=1, settings=settings).trials[0]


@pytest.mark.parametrize(
    ("guides", "setup", "told"),
    [
        ("walls", {"piloting.walls": "27 315"}, "expected its anchor, its angle in degrees and its length"),
        ("walls", {"piloting.walls": "19 60 2.12"}, "has 1 walls, and task-1 3 turns; expected one a turn"),
        ("walls", {"piloting.walls": "99 60 2.12, 21 30 2.12, 37 60 2.12"}, "has anchors 1 to 64"),
        ("walls", {"piloting.walls": "19 60 2.12, 21 30 2.12, 37 240 2.12"}, "wall 3 of task-1 lies within a solid"),
        ("pilots", {"piloting.walls": "19 60 2.12, 21 30 2.12, 37 240 2.12"}, "wall 3 of task-1 lies within a solid"),
        ("pilots", {"pilots.count": 5}, "5 pilots for walls of 3 robots; expected a multiple, as 6"),
        ("pilots", {"pilots.count": 12}, "12 pilots for 3 walls of 3 robots; expected at most 9"),
        ("pilots", {"piloting.robots_a_wall": 7}, "has no room for 7 robots"),
        ("towers", {}, "towers"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(guides: str, setup: dict[str, Value], told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        simulations.check(trial(guides, **setup))
    assert "\n" not in str(refused.value)


@pytest.fixture(scope="module")
def changing() -> TrialResult:
    """Half a minute among walls of which two stand at a time."""
    return simulations.run_trial(trial("walls", **{"piloting.at_once": 2, "duration_s": 30.0}), reraise=True)


def test_the_next_walls_stand_once_all_on_their_course_have_cleared_one_and_not_before(changing: TrialResult) -> None:
    task, given = guided.task_of(changing.trial), guided.parameters(changing.trial)
    stages, standing = changing.tables["stages"], changing.tables["standing"]
    assert len(stages) >= 2
    positions = changing.poses_w[..., :2]
    of = course.course(task, positions)
    cleared = course.passed(task, positions, of, task.turns[0], given.beyond_m)
    done = (cleared | of.astray).all(axis=1) & cleared.any(axis=1)
    assert stages[1, 0] == pytest.approx(changing.times[done.argmax()])
    walls = np.array([wall.segment(task) for wall in plans.of_words(given.walls)])
    assert_array_equal(standing[:3, 2:], walls)
    assert_array_equal(standing[:3, 0], [0.0, 0.0, stages[1, 0]])
    assert standing[0, 1] == stages[1, 0]


def test_who_watches_decides_in_place_of_the_herds_course() -> None:
    asked: list[tuple[float, ...]] = []

    def watcher(time: float, *told: int) -> bool:
        asked.append((time, *told))
        return time >= 2.0

    made = trial("walls", **{"piloting.at_once": 2, "duration_s": 3.0})
    found = loop.run_trial(made, reraise=True, watcher=watcher)
    assert_array_equal(found.tables["stages"][:, 0].round(9), [0.0, 2.0, 2.1, 2.2])
    assert asked[0][1:] == (0, 3, 0, 4)
    assert [time for time, *_ in asked] == pytest.approx(np.arange(1, 31) * 0.1)  # after the last wall as well
    assert asked[-1][1:] == (3, 0, 0, 4)


def test_who_watches_can_end_a_trial_and_what_was_measured_until_then_is_kept() -> None:
    def watcher(time: float, *told: int) -> bool:
        if time >= 1.0:
            raise StoppedError
        return False

    found = loop.run_trial(trial("walls", **{"piloting.at_once": 2, "duration_s": 3.0}), watcher=watcher)
    assert (found.outcome, found.reason) == ("stopped", "stopped at 1.00 s")
    assert found.times[-1] == pytest.approx(0.9)
    assert found.measures["arrived_share"] == 0.0


def test_a_wall_rises_once_no_robot_stands_in_its_place() -> None:
    """The second wall lies across the start: it waits for the herd to leave it, and no robot is ever within it."""
    made = trial("walls", **{"piloting.at_once": 2, "duration_s": 12.0})
    task = guided.task_of(made)
    first, place = guided.plan_of(made).walls[0], np.array([task.start.x_m, task.start.y_m])
    number, anchor = min(task.anchors.items(), key=lambda each: np.hypot(*(each[1] - place)))
    angle = float(np.degrees(np.arctan2(*(place - anchor)[::-1])))
    across = plans.Wall(number, angle, float(np.hypot(*(place - anchor))))
    walls = plans.words([first, across, guided.plan_of(made).walls[2]])
    found = loop.run_trial(with_setup(made, {"piloting.walls": walls}), reraise=True)
    standing = {tuple(row[2:]): row[0] for row in found.tables["standing"].tolist()}
    (own,) = [wall.segment(task) for wall in plans.of_words(walls)[1:2]]
    rose = next(began for segment, began in standing.items() if np.allclose(segment, own))
    assert 0.0 < rose < 12.0
    after = found.times >= rose
    apart = distance(own[None], found.poses_w[after, :, :2].reshape(-1, 2))
    assert apart.min() > found.radii[0]
    before = distance(own[None], found.poses_w[~after, :, :2].reshape(-1, 2)).reshape(-1, 4).min(axis=1)
    assert (before < found.radii[0] + FENCE / 2.0).all()  # it waited no longer than it had to


def test_pilots_start_in_formation_and_the_same_trial_is_the_same_whether_it_is_recorded_or_not() -> None:
    made = trial("pilots", duration_s=4.0)
    one, other = simulations.run_trial(made, reraise=True), simulations.run_trial(made, scans="some", reraise=True)
    assert_array_equal(one.poses_w, other.poses_w)
    assert one.tables["stages"][0].tolist() == [0.0, 0.0]  # it stands from the start on
    pilots = guided.members(made, pilots=True)
    assert one.contacts.times.size == 0 or not np.isin(one.contacts.robots, pilots).any()
    # they hold their places: a Create at rest may be a tenth of a metre off
    assert np.hypot(*(one.poses_w[-1, pilots, :2] - one.poses_w[0, pilots, :2]).T).max() < 0.1


def test_a_change_of_formation_ends_when_those_that_were_sent_stand_in_their_places() -> None:
    """The user's second key comes while they are on their way, and sends nobody: the first change goes on."""
    made = trial("pilots", duration_s=40.0)
    found = loop.run_trial(made, reraise=True, watcher=lambda time, passed, *_: time >= (1.95, 4.95, 99.0)[passed])
    (_, began), (first, stood), (second, at_once) = found.tables["stages"].tolist()
    assert (began, first, second, at_once) == pytest.approx((0.0, 2.0, 5.0, 5.0))
    pilots, task = guided.members(made, pilots=True), guided.task_of(made)
    places = slots(guided.plan_of(made).walls[2].segment(task))
    off = cdist(places, found.poses_w[:, pilots[:3], :2].reshape(-1, 2)).reshape(3, -1, 3).min(axis=2)
    there = (off <= ARRIVED_M).all(axis=0)
    assert stood == pytest.approx(found.times[there.argmax()])
    assert stood > 5.0
    assert found.measures["change_s"] == pytest.approx(stood - 2.0)


@pytest.mark.parametrize(("stood", "late"), [(9.0, 0.0), (11.0, 1.0), (np.nan, 1.0)])
def test_pilots_are_late_at_a_wall_that_they_do_not_hold_when_the_first_robot_comes_to_its_turn(
    stood: float, late: float
) -> None:
    """One robot stands at the start until it is put 0.9 m before the third corner, ten seconds later."""
    made = trial("pilots", duration_s=20.0, **{"herd.count": 1})
    task = guided.task_of(made)
    times = np.arange(21.0)
    herd = np.array([task.trajectory[0], *task.trajectory[1:4]])
    at = np.concatenate([np.repeat(herd[:1], 8, axis=0), herd[1:3], np.repeat(herd[3:], 11, axis=0)])
    poses = np.zeros((21, 7, 3))
    poses[:, 0, :2] = at
    result = dataclasses.replace(
        loop.run_trial(trial("pilots", duration_s=0.1, **{"herd.count": 1}), reraise=True),
        times=times, poses_w=poses, tables={"stages": np.array([[0.0, 0.0], [5.0, stood], [6.0, 6.0]])},
    )  # fmt: skip
    found = measures_guided.guidance(result)
    assert found["late_share"] == late


def test_a_herd_that_nothing_guides_has_the_same_measures_without_those_of_pilots() -> None:
    found = simulations.run_trial(trial("nothing", duration_s=2.0), reraise=True).measures
    assert found["arrived_share"] == 0.0
    assert np.isnan(found["change_s"])


def test_a_trial_without_a_task_has_no_key_of_guides() -> None:
    free = dataclasses.replace(trial("nothing"), setup={"duration_s": 1.0})
    assert not guided.has_guides(free)
    assert_array_equal(guided.herd(free), np.arange(4))
