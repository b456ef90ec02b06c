"""A finished kinematic trial as a recording for the Rerun viewer: one `.rrd` file with its own screen layout.

Entities (times on the timeline `time`, s; lengths in metres, world frame):

    world                   static transform: the viewer's plane has y downwards, ours upwards
    world/walls             walls, and the border of a periodic world
    world/members           all members, a row a moment
    world/headings          an arrow from each along its heading
    world/trails            the way of each since the moment before (the layout shows the last of it)
    measures/NAME           series for the plots
    about, legend           the trial in words, and what is drawn
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr

from flocking.measures import formation, groups
from flocking.types import Ints
from trials.simulations.columns import packed, series, times_column
from trials.simulations.kinematic import fields, screen
from trials.simulations.recording_file import opened
from trials.simulations.tracks import period_of, strips
from trials.types import TrialResult

MOST_ROWS = 2_000_000
"""Members times moments that are recorded: beyond that, fewer moments are."""
WALL_COLOUR = 0x6E7B8BFF
HEADING_COLOUR = 0xF5F7FAFF


def write(result: TrialResult, path: Path) -> None:
    """Writes the recording to `path`, replacing what is there. Raises `OSError` where it cannot be written whole."""
    shown = picked(result)
    with opened(result.trial, path, screen.blueprint(result)) as recording:
        _world(recording, result)
        if len(shown):
            _members(recording, result, shown)
            _trails(recording, result, shown)
            _plots(recording, result, shown)


def picked(result: TrialResult) -> Ints:
    """The moments that are recorded: all whose poses are finite, or every so many of them."""
    sound = np.flatnonzero(np.isfinite(result.poses_w).all(axis=(1, 2)))
    return sound[:: max(1, -(-len(sound) * len(result.robot_names) // MOST_ROWS))]


def _world(recording: rr.RecordingStream, result: TrialResult) -> None:
    recording.log("world", rr.Transform3D(mat3x3=np.diag([1.0, -1.0, 1.0])), static=True)
    walls, period = result.walls_w, period_of(result)
    if period is not None:
        a = period
        walls = np.array([[0, 0, a, 0], [a, 0, a, a], [a, a, 0, a], [0, a, 0, 0]], dtype=np.float64)
    if len(walls):
        lines = walls.reshape(-1, 2, 2).astype(np.float32)
        style = rr.LineStrips2D(lines, colors=packed([WALL_COLOUR]), radii=[0.1 * screen.size_of(result)])
        recording.log("world/walls", style, static=True)
    recording.log("about", rr.TextDocument(screen.about(result), media_type="text/markdown"), static=True)
    recording.log("legend", rr.TextDocument(screen.legend(result), media_type="text/markdown"), static=True)


def _members(recording: rr.RecordingStream, result: TrialResult, shown: Ints) -> None:
    times, poses, size = result.times[shown], result.poses_w[shown].astype(np.float32), screen.size_of(result)
    rows = [times_column(times)]
    counts = np.full(len(times), poses.shape[1])
    radii = np.where(result.radii > 0.0, result.radii, 0.35 * size)
    style = rr.Points2D.from_fields(colors=screen.colours(result), radii=radii, draw_order=20.0)
    recording.log("world/members", style, static=True)
    points = rr.Points2D.columns(positions=poses[..., :2].reshape(-1, 2))
    recording.send_columns("world/members", rows, points.partition(counts))
    ahead = size * np.stack([np.cos(poses[..., 2]), np.sin(poses[..., 2])], axis=-1)
    style = rr.Arrows2D.from_fields(colors=packed([HEADING_COLOUR]), radii=[0.08 * size], draw_order=21.0)
    recording.log("world/headings", style, static=True)
    arrows = rr.Arrows2D.columns(origins=poses[..., :2].reshape(-1, 2), vectors=ahead.reshape(-1, 2))
    recording.send_columns("world/headings", rows, arrows.partition(counts))


def _trails(recording: rr.RecordingStream, result: TrialResult, shown: Ints) -> None:
    if len(shown) < 2:
        return
    pieces, counts = strips(result.poses_w[shown, :, :2], period_of(result))
    style = rr.LineStrips2D.from_fields(
        colors=packed([screen.TRAIL_COLOUR]), radii=[0.05 * screen.size_of(result)], draw_order=4.0
    )
    recording.log("world/trails", style, static=True)
    columns = rr.LineStrips2D.columns(strips=np.ascontiguousarray(pieces))
    recording.send_columns("world/trails", [times_column(result.times[shown[1:]])], columns.partition(counts))


def _plots(recording: rr.RecordingStream, result: TrialResult, shown: Ints) -> None:
    period, cut = period_of(result), fields.of_trial(result.trial).cut_m
    times, poses = result.times[shown], result.poses_w[shown]
    positions = poses[..., :2]
    sizes = groups.group_sizes(groups.group_labels(positions, cut, period))
    for name, told, colour, values in (
        ("polarization", "polarization", 0x56B4E9FF, formation.polarization(poses[..., 2])),
        ("largest_share", "largest group's share", 0xE69F00FF, sizes.max(axis=1) / positions.shape[1]),
        ("mmd", "MMD", 0x2FBF8FFF, formation.mmd(positions, period)),
        ("groups", "groups", 0xF0E442FF, (sizes > 0).sum(axis=1).astype(np.float64)),
        ("net_displacement", "net displacement", 0xD58BB8FF, formation.net_displacement(positions, period)),
    ):
        series(recording, f"measures/{name}", told, colour, times, values)
