"""Herds that are guided through tasks: what is refused, and that walls stand while they are to stand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.errors import InputError
from flocking.types import Floats
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.course import course, passed
from trials.simulations import run_trial
from trials.simulations.robots import checks, guided
from trials.studies.piloting import design, piloting
from trials.types import Trial, TrialResult, Value, with_setup


def given(**setup: Value) -> Trial:
    """The study's trial of task 1 with some keys of its own, by underscores for points."""
    keys = {"piloting." + key.removeprefix("piloting_") if "piloting_" in key else key: v for key, v in setup.items()}
    return piloting.finish(with_setup(piloting.base(1), keys))


def near_the_turn(guides: str, seconds: float = 25.0, **setup: Value) -> Trial:
    """Two members 0.3 and 0.8 m before the first turn of task 1."""
    trial = given(piloting_guides=guides, **setup)
    task = tasks.load("task-1")
    turn, way = task.trajectory[1], np.array([0.0, 1.0])
    poses = [[*(turn - (0.3 + 0.5 * k) * way), np.pi / 2] for k in range(2)]
    herd = dataclasses.replace(trial.groups[0], count=2)
    placed = dataclasses.replace(trial, groups=(herd, *trial.groups[1:]), formation="start.csv")
    text = "x_m,y_m,heading_deg\n" + "".join(f"{x},{y},90\n" for x, y, _ in poses)
    return with_setup(_from(placed, text), {"duration_s": seconds})


def _from(trial: Trial, text: str) -> Trial:
    return dataclasses.replace(trial, formation_source=text, formation_parameters={})


@pytest.mark.parametrize(
    ("setup", "told"),
    [
        ({"piloting_walls": "27 315"}, "expected its anchor, its angle in degrees and its length"),
        ({"piloting_walls": "27 315 0.75"}, "has 1 walls, and task-1 3 turns"),
        ({"piloting_walls": "99 0 1, 27 0 1, 27 0 1", "piloting_guides": "walls"}, "anchors 1 to 64"),
        ({"piloting_walls": "19 60 0.5, 30 255 1.5, 46 195 1.5", "piloting_guides": "pilots"}, "has no room for 3"),
        ({"piloting_guides": "pilots", "piloting_robots_a_wall": 4, "pilots": 6}, "expected a multiple"),
        ({"piloting_guides": "pilots", "pilots": 5}, "5 pilots for walls of 3 robots"),
        ({"piloting_guides": "pilots", "pilots": 12}, "12 pilots for 3 walls"),
        ({"piloting_guides": "walls", "pilots": 6}, "with a group 'pilots'"),
    ],
)
def test_guides_that_do_not_fit_the_task_are_refused_in_one_line(setup: dict[str, Value], told: str) -> None:
    def make_and_check() -> None:
        trial = given(**{key: value for key, value in setup.items() if key != "pilots"})
        if "pilots" in setup:
            trial = dataclasses.replace(trial, groups=(trial.groups[0], design.pilots(int(setup["pilots"]))))
        checks.check(trial)

    with pytest.raises(InputError, match=told) as refused:
        make_and_check()
    assert "\n" not in str(refused.value)


def test_the_studys_trials_are_right() -> None:
    for task in tasks.names():
        for guides in (guided.WALLS, guided.PILOTS):
            checks.check(given(task=task, piloting_guides=guides))


@pytest.fixture(scope="module")
def walls() -> TrialResult:
    return run_trial(near_the_turn("walls", piloting_at_once=1))


def stages(result: TrialResult) -> Floats:
    found: Floats = result.tables["stages"]
    return found


def test_a_stage_begins_when_all_members_on_course_have_cleared_the_turn(walls: TrialResult) -> None:
    assert walls.outcome == "done", walls.reason
    assert len(stages(walls)) >= 2, "for this test to mean anything"
    task, places = tasks.load("task-1"), walls.poses_w[:, :2, :2]
    of = course(task, places)
    for number, began in enumerate(stages(walls)[1:, 0]):
        through = passed(task, places, of, task.turns[number], guided.parameters(walls.trial).beyond_m)
        cleared = through.any(axis=1) & (through | of.astray).all(axis=1)
        after = walls.times > stages(walls)[number, 0]
        assert walls.times[after & cleared][0] == pytest.approx(began, abs=1e-9)


def test_walls_stand_from_stage_to_stage_as_the_table_says(walls: TrialResult) -> None:
    """One at a time: each from the begin of its stage to that of the next, where the plan puts it."""
    task, plan, rows = tasks.load("task-1"), plans.shipped("task-1"), walls.tables["standing"]
    began = stages(walls)[:, 0]
    assert len(rows) == min(len(began), len(plan.walls))
    for k, row in enumerate(rows):
        assert row[0] == began[k]
        assert row[1] == began[k + 1] if k + 1 < len(began) else np.isnan(row[1])
        assert_array_equal(row[2:], plan.walls[k].segment(task))


def test_all_walls_stand_from_the_start_to_the_end_where_none_vanishes() -> None:
    rows = run_trial(near_the_turn("walls", seconds=1.0)).tables["standing"]
    task, plan = tasks.load("task-1"), plans.shipped("task-1")
    assert_array_equal(rows[:, 2:], plan.segments(task))
    assert (rows[:, 0] == 0.0).all()
    assert np.isnan(rows[:, 1]).all()


def test_where_nothing_guides_nothing_stands() -> None:
    result = run_trial(near_the_turn("nothing", seconds=1.0))
    assert result.outcome == "done", result.reason
    assert len(result.tables["standing"]) == 0
    assert result.measures["arrived_share"] == 0.0


def test_pilots_begin_at_their_places_and_are_measured() -> None:
    result = run_trial(near_the_turn("pilots", seconds=2.0))
    assert result.outcome == "done", result.reason
    starts = guided.pilot_starts(result.trial)
    assert_array_equal(result.poses_w[0, 2:, :2], starts[:, :2])
    # nobody is sent anywhere yet: they stay where they are to stand
    assert np.hypot(*(result.poses_w[-1, 2:, :2] - starts[:, :2]).T).max() < 0.1
    assert result.measures["pilot_way"] < 0.2
    assert stages(result)[0].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("guides", ["walls", "pilots"])
def test_the_same_trial_twice_or_with_its_scans_kept_gives_the_same_result(guides: str) -> None:
    trial = near_the_turn(guides, seconds=3.0)
    first, again, recorded = run_trial(trial), run_trial(trial), run_trial(trial, scans="some")
    for other in (again, recorded):
        assert_array_equal(first.poses_w, other.poses_w)
        assert_array_equal(first.updates.commands, other.updates.commands)
        for name in first.tables:
            assert_array_equal(first.tables[name], other.tables[name])
        assert first.measures == pytest.approx(other.measures, nan_ok=True, abs=0.0)
