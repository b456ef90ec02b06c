"""What a recording shows of a task, read back from its file."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from generation.piloting import course
from generation.piloting.formations import slots
from tests.trials.simulations.robots.test_recordings import F32, Recording
from trials.design import plan
from trials.simulations.robots import guided, loop, recorded_tasks
from trials.simulations.robots.recordings import write
from trials.types import TrialResult


@pytest.fixture(scope="module")
def result() -> TrialResult:
    """Ten seconds of pilots in task 1, in which a user clears the first wall at two."""
    settings = {"task": "task-1", "piloting.guides": "pilots", "duration_s": 10.0}
    made = plan("piloting", repeats=1, settings=settings).trials[0]
    return loop.run_trial(made, reraise=True, watcher=lambda time, passed, *_: passed == 0 and time >= 1.95)


@pytest.fixture(scope="module")
def recording(result: TrialResult, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("task") / "0001.rrd"
    write(result, path)
    return Recording(path)


def of(recording: Recording, entity: str, component: str) -> list[tuple[float, np.ndarray]]:
    return recording.rows(f"/world/task/{entity}", component)


def test_the_task_and_the_walls_as_planned_come_back(result: TrialResult, recording: Recording) -> None:
    task, planned = guided.task_of(result.trial), guided.plan_of(result.trial)
    ((_, line),) = of(recording, "trajectory", "LineStrips2D:strips")
    np.testing.assert_allclose(np.array(line[0].tolist()), task.trajectory, atol=F32)
    ((_, corridor),) = of(recording, "corridor", "LineStrips2D:radii")
    assert corridor.tolist() == [task.corridor_m]
    ((_, walls),) = of(recording, "planned", "LineStrips2D:strips")
    segments = [wall.segment(task) for wall in planned.walls]
    np.testing.assert_allclose(np.array(walls.tolist()).reshape(-1, 4), segments, atol=F32)
    assert len(of(recording, "goal", "LineStrips2D:strips")) == 1


def test_slots_are_those_of_the_walls_that_are_held_and_each_line_leads_from_a_pilot_to_its_own(
    result: TrialResult, recording: Recording
) -> None:
    task, planned = guided.task_of(result.trial), guided.plan_of(result.trial)
    rows = [row for row in of(recording, "slots", "Points2D:positions") if np.isfinite(row[0])]
    assert [time for time, _ in rows] == pytest.approx([0.0, 2.0])
    for (_, places), held in zip(rows, ((0, 1), (1, 2)), strict=True):
        wanted = np.concatenate([slots(planned.walls[wall].segment(task)) for wall in held])
        found = np.array(places.tolist())
        np.testing.assert_allclose(found[np.lexsort(found.T)], wanted[np.lexsort(wanted.T)], atol=F32)
    pilots = guided.members(result.trial, pilots=True)
    last_time, strips = of(recording, "sent", "LineStrips2D:strips")[-1]
    lines = np.array(strips.tolist())
    at = int(np.abs(result.times - last_time).argmin())
    np.testing.assert_allclose(lines[:, 0], result.poses_w[at, pilots, :2], atol=F32)
    assert len(np.unique(lines[:, 1].round(3), axis=0)) == len(pilots)
    sent = result.tables["sent"]
    assert set(sent[sent[:, 0] > 0.0, 2].tolist()) == {2.0}  # to the third wall, by those of the first


def test_fitness_over_time_ends_with_the_measure_and_never_falls(result: TrialResult, recording: Recording) -> None:
    """Robots that are put along the trajectory arrive one after the other."""
    rows = recording.rows("/task_shares/arrived", "Scalars:scalars")
    assert len(rows) > 0
    task, herd = guided.task_of(result.trial), guided.members(result.trial, pilots=False)
    poses = np.repeat(result.poses_w[:1], len(result.times), axis=0)
    steps = np.linspace(0, len(task.trajectory) - 1, len(result.times) - 20)
    along = [np.interp(steps, range(len(task.trajectory)), task.trajectory[:, k]) for k in (0, 1)]
    for place, robot in enumerate(herd[:2]):
        poses[: len(steps), robot, :2] = np.stack(along, axis=1)
        poses[len(steps) :, robot, :2] = task.trajectory[-1] if place == 0 else (0.0, -50.0)
    moved = dataclasses.replace(result, poses_w=poses)
    times, arrived, astray = recorded_tasks.fitness(moved)
    assert len(times) == len(result.times)
    assert (np.diff(arrived) >= 0.0).all()
    assert arrived[0] == 0.0
    assert arrived[-1] == course.fitness(task, poses[:, herd, :2]) == 0.5
    assert astray[-1] == 0.0  # who was there once has arrived
