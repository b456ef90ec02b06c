"""A finished trial as a recording for the Rerun viewer: one `.rrd` file with its own layout.

Entities (times on the timeline `time`, s; lengths in metres, world frame):

    world                       static transform: the viewer's plane has y downwards, the world upwards
    world/walls, world/paths    the walls; the whole path of each robot
    world/standing              the walls that rise and vanish, a row for each change
    world/task/PART             of a guided herd: trajectory, corridor, goal, planned walls, slots, who is sent to them
    world/robots/ROBOT          its pose over time; below it body, name, heading and pressed bumpers, which move with it
    world/trails                the path in pieces (the layout shows those of the last seconds)
    world/scans/ROBOT           returns, coloured by intensity (grey where it was not given)
    world/members/ROBOT         the inputs to the law; false positives in a colour of their own
    world/echoes/ROBOT          arcs on which its sonars' echoes lie; world/obstacles/ROBOT: those taken for obstacles
    world/way_points/ROBOT      from the robot to its way-point, in the colour of the rule that chose it
    world/contacts, events      where a robot began to touch something; the same in words
    rules/ROBOT, bumpers/ROBOT  states, a row for each change
    measures/NAME, rule_shares/RULE, nearest_inputs/ROBOT, task_shares/NAME  series for the plots
    cameras/ROBOT/SIDE          its images, the columns that made inputs, the pixels taken for a cone (SIDE_taken_for)
    eyes/ROBOT/NAME             bearing and distance of the nearest input beside the true ones, time to impact
    herd                        a transform that follows the centre of the herd
    about, legend               the trial in words, and what is drawn

Everything is sent in columns, with one call for each entity instead of one for each row.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from flocking.measures import formation
from flocking.types import Bools, Floats
from trials.simulations.columns import member_colours, name_tag, packed, series, times_column
from trials.simulations.recording_file import opened
from trials.simulations.robots import recorded_cameras, recorded_echoes, recorded_senses, recorded_tasks, screen
from trials.simulations.robots.fields import of_trial
from trials.simulations.robots.measures import GROUP_CUT_M
from trials.types import TrialResult

WALL_COLOUR = 0x6E7B8BFF
STANDING_COLOUR = 0xF0C000FF
PATH_ALPHA = 0x50
HEADING_COLOUR = 0xF5F7FAFF
CONTACT_COLOUR = 0xFFFFFFFF
TRAIL_SAMPLES = 5
"""Samples of a robot's path that are drawn in one piece."""
PLOT_SAMPLES = 2
"""Samples from one point of a plot to the next."""
FOLLOW_S = 2.0
"""Time over which the centre of the herd is averaged for the view that follows it."""
SHARE_S = 1.0
"""Time over which the share of each rule is counted."""


def write(result: TrialResult, path: Path) -> None:
    """Writes the recording of a finished trial to `path`, in place of what is there.

    It holds the scans in `result.scans`; of a failed trial, all that was measured. Raises `OSError` where the file
    cannot be written whole.
    """
    with opened(result.trial, path, screen.blueprint(result)) as recording:
        _world(recording, result)
        _standing(recording, result)
        recorded_tasks.send_task(recording, result)
        _robots(recording, result)
        recorded_senses.send_updates(recording, result)
        recorded_senses.send_scans(recording, result)
        recorded_echoes.send_echoes(recording, result)
        recorded_cameras.send_pictures(recording, result)
        _contacts(recording, result)
        _plots(recording, result)


def _world(recording: rr.RecordingStream, result: TrialResult) -> None:
    recording.log("world", rr.Transform3D(mat3x3=np.diag([1.0, -1.0, 1.0])), static=True)
    walls = result.walls_w.reshape(-1, 2, 2).astype(np.float32)
    if len(walls):
        recording.log("world/walls", rr.LineStrips2D(walls, colors=packed([WALL_COLOUR]), radii=[0.015]), static=True)
    recording.log("about", rr.TextDocument(screen.about(result), media_type="text/markdown"), static=True)
    recording.log("legend", rr.TextDocument(screen.legend(result), media_type="text/markdown"), static=True)


def _standing(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends the walls that rise and vanish while a herd is guided: at each change all that stand from then on."""
    rows = result.tables.get("standing", np.empty((0, 6)))
    if len(rows) == 0:
        return
    times = np.unique(rows[:, :2][np.isfinite(rows[:, :2])])
    stand = [rows[(rows[:, 0] <= time) & ~(rows[:, 1] <= time), 2:].reshape(-1, 2, 2) for time in times]
    strips = np.concatenate(stand).astype(np.float32)
    style = rr.LineStrips2D.from_fields(colors=packed([STANDING_COLOUR]), radii=[0.03], draw_order=5.0)
    recording.log("world/standing", style, static=True)
    columns = rr.LineStrips2D.columns(strips=strips).partition(np.array([len(each) for each in stand]))
    recording.send_columns("world/standing", [times_column(times)], columns)


def _robots(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends poses, bodies, paths, and the frame that follows the herd."""
    sound = np.isfinite(result.poses_w).all(axis=(1, 2))
    times, poses = result.times[sound], result.poses_w[sound]
    colours = member_colours(len(result.robot_names))
    flat = np.concatenate([poses[..., :2], np.zeros_like(poses[..., :1])], axis=2).astype(np.float32)
    turned = np.zeros((*poses.shape[:2], 4), dtype=np.float32)
    turned[..., 2], turned[..., 3] = np.sin(poses[..., 2] / 2.0), np.cos(poses[..., 2] / 2.0)
    for k, name in enumerate(result.robot_names):
        robot = f"world/robots/{name}"
        _body(recording, robot, name, float(result.radii[k]), packed([colours[k]]))
        if len(times):
            columns = rr.Transform3D.columns(translation=flat[:, k], quaternion=turned[:, k])
            recording.send_columns(robot, [times_column(times)], columns)
        _bumpers(recording, result, k)
    if len(times):
        _ways(recording, times, flat[..., :2], colours)
        centre = np.zeros((len(times), 3), dtype=np.float32)
        centre[:, 0], centre[:, 1] = (_averaged(poses[..., i].mean(axis=1), times) for i in (0, 1))
        centre[:, 1] *= -1.0
        recording.send_columns("herd", [times_column(times)], rr.Transform3D.columns(translation=centre))


def _body(recording: rr.RecordingStream, robot: str, name: str, radius: float, colour: NDArray[np.uint32]) -> None:
    """Sends what is fixed in the robot's frame: a disc, an arrow ahead, and its name in front of both."""
    disc = rr.Points2D([[0.0, 0.0]], radii=[radius], colors=colour, draw_order=20.0)
    ahead = rr.Arrows2D(
        origins=[[0.0, 0.0]],
        vectors=[[1.5 * radius, 0.0]],
        colors=packed([HEADING_COLOUR]),
        radii=[0.016],
        draw_order=21.0,
    )
    recording.log(f"{robot}/body", disc, static=True)
    recording.log(f"{robot}/name", name_tag(name), static=True)
    recording.log(f"{robot}/heading", ahead, static=True)


def _ways(
    recording: rr.RecordingStream,
    times: Floats,
    positions: NDArray[np.float32],
    colours: NDArray[np.uint32],
) -> None:
    """Sends the whole path of each robot, faint, and the same cut into pieces, each at the time of its end."""
    robots = positions.shape[1]
    faint = (colours & np.uint32(0xFFFFFF00)) | np.uint32(PATH_ALPHA)
    paths = [np.ascontiguousarray(positions[:, k]) for k in range(robots)]
    recording.log("world/paths", rr.LineStrips2D(paths, colors=faint, radii=[0.006]), static=True)
    pieces = (len(times) - 1) // TRAIL_SAMPLES
    if pieces < 1:
        return
    rows = np.arange(pieces)[:, None] * TRAIL_SAMPLES + np.arange(TRAIL_SAMPLES + 1)
    strips = positions[rows].transpose(0, 2, 1, 3).reshape(pieces * robots, TRAIL_SAMPLES + 1, 2)
    style = rr.LineStrips2D.from_fields(colors=colours, radii=[0.012], draw_order=4.0)
    recording.log("world/trails", style, static=True)
    columns = rr.LineStrips2D.columns(strips=np.ascontiguousarray(strips))
    recording.send_columns(
        "world/trails", [times_column(times[rows[:, -1]])], columns.partition(np.full(pieces, robots))
    )


def _bumpers(recording: rr.RecordingStream, result: TrialResult, k: int) -> None:
    """Sends arcs at the front of the robot while a bumper is pressed, and the same as states; a row for each change."""
    if len(result.times) == 0:
        return
    name, radius = result.robot_names[k], 1.12 * float(result.radii[k])
    pressed: Bools = result.bumpers[:, k]
    changed = np.ones(len(pressed), dtype=bool)
    changed[1:] = (pressed[1:] != pressed[:-1]).any(axis=1)
    times, rows = [times_column(result.times[changed])], pressed[changed]
    bearings = np.radians(np.linspace(5.0, 85.0, 6))
    left = radius * np.stack([np.cos(bearings), np.sin(bearings)], axis=1)
    arcs = np.stack([left, left * np.array([1.0, -1.0])]).astype(np.float32)
    strips = arcs[np.nonzero(rows)[1]]
    columns = rr.LineStrips2D.columns(strips=strips).partition(rows.sum(axis=1))
    entity = f"world/robots/{name}/bumpers"
    style = rr.LineStrips2D.from_fields(colors=packed([CONTACT_COLOUR]), radii=[0.02], draw_order=25.0)
    recording.log(entity, style, static=True)
    recording.send_columns(entity, times, columns)
    states = np.array(["", "left", "right", "left and right"])[rows @ np.array([1, 2])]
    recording.send_columns(f"bumpers/{name}", times, rr.StateChange.columns(state=states.tolist()))


def _contacts(recording: rr.RecordingStream, result: TrialResult) -> None:
    contacts, names = result.contacts, result.robot_names
    if len(contacts.times) == 0:
        return
    times = [times_column(contacts.times)]
    style = rr.Points2D.from_fields(radii=[0.05], colors=packed([CONTACT_COLOUR]), draw_order=50.0)
    recording.log("world/contacts", style, static=True)
    recording.send_columns("world/contacts", times, rr.Points2D.columns(positions=contacts.points_w.astype(np.float32)))
    words = [
        f"{names[k]} touches {names[other] if other >= 0 else 'a wall'}"
        for k, other in zip(contacts.robots, contacts.others, strict=True)
    ]
    levels = ["WARN" if other >= 0 else "INFO" for other in contacts.others]
    recording.send_columns("events", times, rr.TextLog.columns(text=words, level=levels))


def _plots(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends the measures over time, and the share of each rule."""
    sound = np.isfinite(result.poses_w).all(axis=(1, 2))
    times, poses = result.times[sound][::PLOT_SAMPLES], result.poses_w[sound][::PLOT_SAMPLES]
    if len(times):
        positions = poses[..., :2]
        series(
            recording, "measures/polarization", "polarization", 0x56B4E9FF, times, formation.polarization(poses[..., 2])
        )
        series(recording, "measures/straightness", "straightness", 0xE69F00FF, times, formation.straightness(positions))
        series(recording, "measures/mmd", "MMD", 0x2FBF8FFF, times, formation.mmd(positions))
        groups = formation.number_of_groups(positions, GROUP_CUT_M).astype(np.float64)
        series(recording, "measures/groups", "groups", 0xF0E442FF, times, groups)
    if len(times) > 1:
        speeds = formation.group_speed(np.diff(poses[..., :2], axis=0) / np.diff(times)[:, None, None])
        series(recording, "measures/group_speed", "group speed", 0xD58BB8FF, times[1:], speeds)
    for rule, (ends, share) in rule_shares(result).items():
        series(recording, f"rule_shares/{rule}", rule, screen.rule_colours(result)[rule], ends, share)


def rule_shares(result: TrialResult) -> dict[str, tuple[Floats, Floats]]:
    """For each rule: times (s), and its share of all robots' updates in the `SHARE_S` before."""
    updates = result.updates
    if len(updates.times) == 0:
        return {}
    names = screen.rule_names(result)
    of_robot = np.zeros((len(result.rules), max(len(rules) for rules in result.rules)), dtype=np.int64)
    for k, rules in enumerate(result.rules):
        of_robot[k, : len(rules)] = [names.index(rule) for rule in rules]
    spoke = of_robot[updates.robots, updates.rules]
    window = (updates.times / SHARE_S).astype(np.int64)
    counts = np.zeros((window.max() + 1, len(names)))
    np.add.at(counts, (window, spoke), 1.0)
    some = counts.sum(axis=1) > 0
    ends = np.minimum((np.flatnonzero(some) + 1) * SHARE_S, max(updates.times[-1], of_trial(result.trial).duration_s))
    shares = counts[some] / counts[some].sum(axis=1, keepdims=True)
    return {name: (ends, shares[:, i]) for i, name in enumerate(names)}


def _averaged(values: Floats, times: Floats) -> Floats:
    """(T,) running mean over about `FOLLOW_S`, shorter at the ends."""
    if len(times) < 3:
        return values
    reach = max(1, round(FOLLOW_S / 2.0 / float(times[1] - times[0])))
    sums = np.r_[0.0, np.cumsum(values)]
    here = np.arange(len(values))
    low, high = np.maximum(here - reach, 0), np.minimum(here + reach + 1, len(values))
    return (sums[high] - sums[low]) / (high - low)
