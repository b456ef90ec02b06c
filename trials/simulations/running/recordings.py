"""A finished running trial as a recording for the Rerun viewer: one `.rrd` file with its own screen layout.

Entities (times on the timeline `time`, s; lengths in metres, world frame):

    world                   static transform: the viewer's plane has y downwards, ours upwards
    world/obstacle          the obstacle
    world/creatures         all creatures, a row a moment; the user's is red, who has fallen is grey
    space/NAME              of bodies with legs: that limb of all of them, in three dimensions
    world/trails            the way of each since the moment before (the layout shows the last of it)
    measures/NAME           series for the plots
    about                   the trial in words
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from trials.simulations import views
from trials.simulations.columns import packed, series, times_column
from trials.simulations.recording_file import opened
from trials.simulations.running import fields
from trials.simulations.running.measures import centres_of
from trials.simulations.tracks import strips
from trials.types import TrialResult

HERD, USER, FALLEN, OBSTACLE, TRAIL = 0x56B4E9FF, 0xD62728FF, 0x6E7B8BFF, 0xE69F00FF, 0x8FA3B880
TRAIL_S = 3.0
SOLID = rr.components.FillMode.Solid


def write(result: TrialResult, path: Path) -> None:
    """Writes the recording to `path`, replacing what is there. Raises `OSError` where it cannot be written whole."""
    with opened(result.trial, path, blueprint(result)) as recording:
        recording.log("world", rr.Transform3D(mat3x3=np.diag([1.0, -1.0, 1.0])), static=True)
        recording.log("about", rr.TextDocument(about(result), media_type="text/markdown"), static=True)
        if len(result.walls_w):
            lines = result.walls_w.reshape(-1, 2, 2).astype(np.float32)
            recording.log(
                "world/obstacle", rr.LineStrips2D(lines, colors=packed([OBSTACLE]), radii=[0.05]), static=True
            )
        sound = np.flatnonzero(np.isfinite(result.poses_w).all(axis=(1, 2)))
        times, places = result.times[sound], result.poses_w[sound, :, :2].astype(np.float32)
        counts = np.full(len(sound), places.shape[1])
        colours = np.full(places.shape[:2], HERD, dtype=np.uint32)
        if fields.of_group(fields.group_of(result.trial)).users:
            colours[:, 0] = USER
        colours[times[:, None] >= result.tables["fallen_s"]] = FALLEN
        points = rr.Points2D.columns(
            positions=places.reshape(-1, 2), colors=colours.ravel(), radii=np.tile(result.radii, len(sound))
        )
        recording.send_columns("world/creatures", [times_column(times)], points.partition(counts))
        if len(sound) > 1:
            pieces, lengths = strips(result.poses_w[sound, :, :2], None)
            style = rr.LineStrips2D.from_fields(colors=packed([TRAIL]), radii=[0.02], draw_order=4.0)
            recording.log("world/trails", style, static=True)
            columns = rr.LineStrips2D.columns(strips=np.ascontiguousarray(pieces))
            recording.send_columns("world/trails", [times_column(times[1:])], columns.partition(lengths))
        if fields.of_group(fields.group_of(result.trial)).body != fields.PARTICLES and len(sound) == len(result.times):
            _limbs(recording, result)
        away = np.hypot(*np.moveaxis(places - centres_of(result)[sound, None], 2, 0))
        series(recording, "measures/radius", "outer radius", 0x56B4E9FF, times, away.max(axis=1).astype(np.float64))
        series(recording, "measures/user", "the user's creature", USER, times, away[:, 0].astype(np.float64))


def _limbs(recording: rr.RecordingStream, result: TrialResult) -> None:
    """The limbs of all, moment by moment; spheres are drawn as capsules without a length."""
    from trials.simulations.running.limbs import limbs_of, replayed

    limbs = limbs_of(fields.of_group(fields.group_of(result.trial)).body)
    moments = replayed(result.trial, limbs)
    count, times = moments.shape[2], [times_column(result.times)]
    for number, limb in enumerate(limbs):
        at = moments[:, number].reshape(-1, 7)
        colour = packed([int.from_bytes(np.round(255 * limb.rgba).astype(np.uint8).tobytes(), "big")])
        size: dict[str, Any] = {"lengths": [limb.length], "radii": [limb.radius], "colors": colour, "fill_mode": SOLID}
        if limb.kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            style: Any = rr.Cylinders3D.from_fields(**size)
            columns = rr.Cylinders3D.columns(centers=at[:, :3], quaternions=at[:, 3:])
        else:  # a capsule of Rerun's begins at its place; limbs lie about theirs
            begins = at[:, :3] - 0.5 * limb.length * _axis(at[:, 3:])
            style = rr.Capsules3D.from_fields(**size)
            columns = rr.Capsules3D.columns(translations=begins, quaternions=at[:, 3:])
        recording.log(f"space/{limb.name}", style, static=True)
        lengths = np.full(len(result.times), count)
        recording.send_columns(f"space/{limb.name}", times, columns.partition(lengths))


def _axis(turns: NDArray[np.float32]) -> NDArray[np.float32]:
    """(K, 3) the z axes of quaternions x, y, z, w (K, 4)."""
    x, y, z, w = turns.T
    return np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)], axis=1)


def blueprint(result: TrialResult) -> rrb.Blueprint:
    """The plane on the left, plots and words on the right."""
    places = result.poses_w[..., :2].reshape(-1, 2)
    ends = np.concatenate([places[np.isfinite(places).all(axis=1)], np.zeros((1, 2))])
    low, high = ends.min(axis=0) - 2.0, ends.max(axis=0) + 2.0
    plane: Any = views.plan(
        "Plane", ["+ /world/**"], (low[0], high[0]), (-high[1], -low[1]), shown_s={"world/trails": TRAIL_S}
    )
    if fields.of_group(fields.group_of(result.trial)).body != fields.PARTICLES:
        plane = rrb.Tabs(rrb.Spatial3DView(origin="/space", name="Space"), plane)
    plots = [
        views.plot("From the herd's centre (m)", ["/measures/radius", "/measures/user"]),
        rrb.TextDocumentView(origin="/about", name="About"),
    ]
    return views.layout(rrb.Horizontal(plane, rrb.Vertical(*plots), column_shares=[2, 1]))


def about(result: TrialResult) -> str:
    """The trial in words (Markdown)."""
    given, group = fields.of_trial(result.trial), fields.group_of(result.trial)
    own = fields.of_group(group)
    course = f"{given.duration_s:g} s in steps of {given.timestep_s:g} s; the user tells {given.script}"
    return views.about(result, course, [f"{own.count} {own.body}, {group.law}, {own.velocities} velocities"])
