"""What a recording shows of a task: its trajectory and goal, the walls as planned, who is sent where, and fitness."""

from __future__ import annotations

import numpy as np
import rerun as rr

from flocking.types import Floats
from generation.piloting import course
from trials.simulations.columns import packed, series, times_column
from trials.simulations.robots import guided
from trials.types import TrialResult

TRAJECTORY_COLOUR, CORRIDOR_COLOUR, GOAL_COLOUR = 0xDDE3EAFF, 0xDDE3EA14, 0x44C26DFF
PLANNED_COLOUR, SLOT_COLOUR, SENT_COLOUR = 0xF0C00080, 0xF0C000FF, 0xF0C00090
FITNESS_COLOUR, ASTRAY_COLOUR = 0x44C26DFF, 0xDC267FFF
SAMPLES = 5
"""Samples from one line between a pilot and its place to the next."""
LEGEND = """
- **light line**: the trajectory, in its corridor; **green outline**: the goal
- **yellow line**: a wall that stands; **faint yellow line**: one of the plan
- **yellow dot**: a place of the formation; **line to it**: from the pilot that is sent there
"""
"""What is drawn, in Markdown."""


def send_task(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends all of it, where the trial has a task."""
    if not guided.has_task(result.trial):
        return
    task, plan = guided.task_of(result.trial), guided.plan_of(result.trial)
    line = [task.trajectory.astype(np.float32)]
    corridor = rr.LineStrips2D(line, colors=packed([CORRIDOR_COLOUR]), radii=[task.corridor_m], draw_order=-20.0)
    recording.log("world/task/corridor", corridor, static=True)
    trajectory = rr.LineStrips2D(line, colors=packed([TRAJECTORY_COLOUR]), radii=[0.012], draw_order=-10.0)
    recording.log("world/task/trajectory", trajectory, static=True)
    outline = [np.concatenate([task.goal, task.goal[:1]]).astype(np.float32)]
    goal = rr.LineStrips2D(outline, colors=packed([GOAL_COLOUR]), radii=[0.02], draw_order=-10.0)
    recording.log("world/task/goal", goal, static=True)
    if plan.walls:
        segments = np.array([wall.segment(task) for wall in plan.walls]).reshape(-1, 2, 2).astype(np.float32)
        planned = rr.LineStrips2D(segments, colors=packed([PLANNED_COLOUR]), radii=[0.015], draw_order=-5.0)
        recording.log("world/task/planned", planned, static=True)
    _formation(recording, result)
    _fitness(recording, result)


def _formation(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends the places of the formation from each change on, and the lines to them over time."""
    sent = result.tables.get("sent", np.empty((0, 5)))
    sound = np.isfinite(result.poses_w).all(axis=(1, 2))
    times, poses = result.times[sound][::SAMPLES], result.poses_w[sound][::SAMPLES, :, :2]
    if len(sent) == 0 or len(times) == 0:
        return
    changes = np.unique(sent[:, 0])
    places = [_places(sent, time) for time in changes]
    style = rr.Points2D.from_fields(colors=packed([SLOT_COLOUR]), radii=[0.05], draw_order=6.0)
    recording.log("world/task/slots", style, static=True)
    flat = np.concatenate([np.array(list(each.values())) for each in places]).astype(np.float32)
    columns = rr.Points2D.columns(positions=flat).partition(np.array([len(each) for each in places]))
    recording.send_columns("world/task/slots", [times_column(changes)], columns)
    strips, counts = [], []
    for time, where in zip(times, poses, strict=True):
        now = _places(sent, time)
        counts.append(len(now))
        strips += [np.stack([where[robot], place]) for robot, place in now.items()]
    style = rr.LineStrips2D.from_fields(colors=packed([SENT_COLOUR]), radii=[0.008], draw_order=5.0)
    recording.log("world/task/sent", style, static=True)
    lines = rr.LineStrips2D.columns(strips=np.array(strips, dtype=np.float32)).partition(np.array(counts))
    recording.send_columns("world/task/sent", [times_column(times)], lines)


def _places(sent: Floats, time: float) -> dict[int, Floats]:
    """The place (2,) of each pilot at a time, s: the last that it was sent to."""
    return {int(row[1]): row[3:5] for row in sent if row[0] <= time}


def _fitness(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends the shares of the herd that have arrived, and that have gone astray, over time."""
    times, arrived, astray = fitness(result)
    if len(times):
        series(recording, "task_shares/arrived", "arrived", FITNESS_COLOUR, times, arrived)
        series(recording, "task_shares/astray", "astray", ASTRAY_COLOUR, times, astray)


def fitness(result: TrialResult) -> tuple[Floats, Floats, Floats]:
    """(T,) times, s, and the shares of the guided robots that had arrived, and had gone astray before, until then."""
    sound = np.isfinite(result.poses_w).all(axis=(1, 2))
    task, herd = guided.task_of(result.trial), guided.members(result.trial, pilots=False)
    positions = result.poses_w[sound][:, herd, :2]
    of = course.course(task, positions)
    there = np.logical_or.accumulate(course.in_goal(task, positions, of), axis=0)
    return result.times[sound], there.mean(axis=1), (of.astray & ~there).mean(axis=1)
