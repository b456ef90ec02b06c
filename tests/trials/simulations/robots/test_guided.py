"""Trials in which a herd is guided through a task: what is refused, which walls stand when, and who decides it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.errors import InputError
from generation.piloting import course
from generation.piloting import plan as plans
from trials import simulations
from trials.design import plan
from trials.simulations.robots import guided, loop
from trials.types import Trial, TrialResult, Value


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
    asked: list[tuple[float, int, int, int]] = []

    def watcher(time: float, passed: int, through: int, on_course: int) -> bool:
        asked.append((time, passed, through, on_course))
        return time >= 2.0

    made = trial("walls", **{"piloting.at_once": 2, "duration_s": 3.0})
    found = loop.run_trial(made, reraise=True, watcher=watcher)
    assert_array_equal(found.tables["stages"][:, 0].round(9), [0.0, 2.0, 2.1, 2.2])
    assert asked[0][1:] == (0, 0, 4)


def test_pilots_start_in_formation_and_the_same_trial_is_the_same_whether_it_is_recorded_or_not() -> None:
    made = trial("pilots", duration_s=4.0)
    one, other = simulations.run_trial(made, reraise=True), simulations.run_trial(made, scans="some", reraise=True)
    assert_array_equal(one.poses_w, other.poses_w)
    assert one.tables["stages"][0].tolist() == [0.0, 0.0]  # it stands from the start on
    pilots = guided.members(made, pilots=True)
    assert one.contacts.times.size == 0 or not np.isin(one.contacts.robots, pilots).any()
    # they hold their places: a Create at rest may be a tenth of a metre off
    assert np.hypot(*(one.poses_w[-1, pilots, :2] - one.poses_w[0, pilots, :2]).T).max() < 0.1


def test_a_herd_that_nothing_guides_has_the_same_measures_without_those_of_pilots() -> None:
    found = simulations.run_trial(trial("nothing", duration_s=2.0), reraise=True).measures
    assert found["arrived_share"] == 0.0
    assert np.isnan(found["change_s"])


def test_a_trial_without_a_task_has_no_key_of_guides() -> None:
    free = dataclasses.replace(trial("nothing"), setup={"duration_s": 1.0})
    assert not guided.has_guides(free)
    assert_array_equal(guided.herd(free), np.arange(4))
