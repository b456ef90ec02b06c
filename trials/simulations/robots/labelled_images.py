"""What the cameras of a trial's robots see, as labelled images: pictures, masks, bearings and distances."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import mujoco
import numpy as np

from flocking.angles import wrapped
from flocking.errors import InputError
from flocking.types import Floats
from robots import body as bodies
from robots.eyes import CONE_RADIUS
from sensing.camera import palette, setting
from sensing.camera.labels import Labelled, coco
from sensing.camera.rendering import Cameras
from trials.simulations.robots import seen
from trials.simulations.robots.checks import check
from trials.simulations.robots.fields import of_group, of_trial
from trials.simulations.robots.herd import assemble
from trials.simulations.robots.log import Log
from trials.simulations.robots.loop import run
from trials.simulations.robots.resolved import Resolved
from trials.types import Trial
from worlds.assemble import prefix

LABELS = "labels.json"
SIDES = ("left", "right")


def write_images(trial: Trial, folder: Path, every_s: float) -> int:
    """Runs a trial and writes what all robots with cameras see at its start and every so many seconds into a folder.

    The images of both cameras as PNG, and `labels.json` in COCO's format (`sensing.camera.labels`). Returns the number
    of images. Raises `InputError` for a trial whose robots have no cameras, and where nothing renders.
    """
    check(trial)
    groups = [Resolved(group) for group in trial.groups for _ in range(group.count)]
    if not any("cameras" in its.body.mounts for its in groups):
        names = ", ".join(dict.fromkeys(its.body.name for its in groups))
        raise InputError(
            f"no robot of {trial.experiment!r} carries cameras (body {names}); expected --set {trial.groups[0].name}"
            f".body=… one that does: {', '.join(bodies.carrying('cameras'))}"
        )
    herd = assemble(trial, record=False)
    world = herd.world
    lenses = [setting.lens_of(its.cameras) if "cameras" in its.body.mounts else None for its in groups]
    colours = None
    if any(its.cameras.colours == setting.ONE_EACH for its in groups):
        colours = [palette.rgb(k) for k in range(len(groups))]
    cameras = Cameras(world.seen(), [prefix(name) for name in world.names], lenses, colours=colours)
    cones = np.array([seen.cone_of(of_group(group).body) for group in trial.groups for _ in range(group.count)])
    taken: list[Labelled] = []
    every = max(1, round(every_s / herd.timestep))

    def take(data: mujoco.MjData) -> None:
        if world.tick % every == 0:
            taken.extend(_pictures(cameras, data, world.fleet.poses(data), cones, folder, len(taken)))

    take(world.data)
    world.observers.append(take)
    log = Log(trial, len(herd.robots), "none")
    run(herd, log, last=round(of_trial(trial).duration_s / herd.timestep))
    text = json.dumps(
        coco(taken, f"{trial.experiment}, trial {trial.index}, seed {trial.seed}"), indent=1, allow_nan=False
    )
    (folder / LABELS).write_text(text + "\n", encoding="utf-8")
    return len(taken)


def _pictures(
    cameras: Cameras, data: mujoco.MjData, poses_w: Floats, cones: Floats, folder: Path, begun: int
) -> list[Labelled]:
    """The pictures of all robots with cameras at one moment, written to files."""
    made: list[Labelled] = []
    c, s = np.cos(poses_w[:, 2]), np.sin(poses_w[:, 2])
    has_cone = np.isfinite(cones[:, 0])  # of a robot without one, bearing and distance are those of its centre
    cones, radii = np.where(has_cone[:, None], cones, 0.0), np.where(has_cone, CONE_RADIUS, 0.0)
    places = poses_w[:, :2] + np.stack([c * cones[:, 0] - s * cones[:, 1], s * cones[:, 0] + c * cones[:, 1]], axis=1)
    for k, lens in enumerate(cameras.lenses):
        if lens is None:
            continue
        images, shown = cameras.look(data, k, data.time), cameras.shown(data, k)
        bearings = wrapped(np.arctan2(*(places - poses_w[k, :2]).T[::-1]) - poses_w[k, 2])
        for side, picture, owners, robots in (
            (SIDES[0], images.left, shown.left, shown.left_robots),
            (SIDES[1], images.right, shown.right, shown.right_robots),
        ):
            at = cameras.place(data, k, side == SIDES[1])
            distances = np.hypot(*(places - at).T) - radii
            name = f"{begun + len(made) + 1:06d}.png"
            if not cv2.imwrite(str(folder / name), picture[:, :, ::-1]):
                raise InputError(f"{folder / name}: the image cannot be written")
            own = np.where(robots == k, -1, robots)  # its own housings are nobody that it could meet
            made.append(Labelled(name, k, side, float(data.time), owners, own, bearings, distances))
    return made
