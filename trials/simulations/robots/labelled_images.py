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
from sensing.camera import imperfections, palette, setting
from sensing.camera.labels import Labelled, coco
from sensing.camera.rendering import Cameras
from trials.simulations.robots.checks import check
from trials.simulations.robots.fields import of_trial
from trials.simulations.robots.herd import assemble
from trials.simulations.robots.log import Log
from trials.simulations.robots.loop import run
from trials.simulations.robots.resolved import Resolved
from trials.streams import Purpose, stream
from trials.types import Trial
from worlds.assemble import prefix

LABELS = "labels.json"
SIDES = ("left", "right")


def write_images(trial: Trial, folder: Path, every_s: float) -> int:
    """Runs a trial and writes what its robots' cameras see at its start and every so many seconds into a folder.

    They are the robots whose detection reads images, or, where none's does, all that carry cameras. The images of both
    cameras are PNG, with what is imperfect about the cameras; `labels.json` is in COCO's format
    (`sensing.camera.labels`), with how each robot's cameras are set. A pair that the cameras lose, or do not take by
    their own frame rate, is not written.
    Returns the number of images. Raises `InputError` for a trial whose robots have no cameras, and where nothing
    renders.
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
    numbers = [(g, k) for g, group in enumerate(trial.groups) for k in range(group.count)]
    eyes = [
        _Eyes(cameras, index, its.imperfections, stream(trial.seed, trial.repeat, g + 1, k, Purpose.IMAGES))
        for index, (its, (g, k)) in enumerate(zip(groups, numbers, strict=True))
        if lenses[index] is not None and (its.reads_images or not any(other.reads_images for other in groups))
    ]
    taken: list[Labelled] = []
    every = max(1, round(every_s / herd.timestep))

    def take(data: mujoco.MjData) -> None:
        if world.tick % every == 0:
            for each in eyes:
                taken.extend(each.pictures(data, folder, len(taken)))

    take(world.data)
    world.observers.append(take)
    log = Log(trial, len(herd.robots), "none")
    run(herd, log, last=round(of_trial(trial).duration_s / herd.timestep))
    settings = {
        each.robot: {"cameras": groups[each.robot].cameras._asdict(), "imperfections": each.given._asdict()}
        for each in eyes
    }
    about = f"{trial.experiment}, trial {trial.index}, seed {trial.seed}"
    text = json.dumps(coco(taken, about, settings), indent=1, allow_nan=False)
    (folder / LABELS).write_text(text + "\n", encoding="utf-8")
    return len(taken)


class _Eyes:
    """The cameras of one robot, with what is imperfect about them."""

    def __init__(
        self, cameras: Cameras, robot: int, given: imperfections.Parameters, generator: np.random.Generator
    ) -> None:
        self._cameras, self.robot, self.given, self._generator = cameras, robot, given, generator
        self._memory = imperfections.begun(given, generator, *cameras.size(robot))

    def pictures(self, data: mujoco.MjData, folder: Path, begun: int) -> list[Labelled]:
        """The pictures of both cameras at one moment, written to files that are numbered on from `begun`; none where no
        pair is due or the pair is lost."""
        cameras, k, given = self._cameras, self.robot, self.given
        time, lag_s, pair = float(data.time), given.capture_offset_s, None
        if imperfections.due(given, self._memory, time):
            pair = cameras.look(data, k, time, lag_s)
        images, self._memory = imperfections.seen(pair, given, self._memory, self._generator)
        if pair is None or images is None or images.time != pair.time:
            return []
        shown, made = cameras.shown(data, k, lag_s), list[Labelled]()
        for side, picture, owners, robots in (
            (SIDES[0], images.left, shown.left, shown.left_robots),
            (SIDES[1], images.right, shown.right, shown.right_robots),
        ):
            name = f"{begun + len(made) + 1:06d}.png"
            if not cv2.imwrite(str(folder / name), picture[:, :, ::-1]):
                raise InputError(f"{folder / name}: the image cannot be written")
            at = cameras.standing(data, k, side == SIDES[1], lag_s)
            own = np.where(robots == k, -1, robots)  # its own housings are nobody that it could meet
            cones_at, robots_at = _from(at.lens_w, at.cones_w, CONE_RADIUS), _from(at.lens_w, at.robots_w, 0.0)
            when = time + (lag_s if side == SIDES[1] else 0.0)
            made.append(Labelled(name, k, side, when, owners, own, cones_at, robots_at))
        return made


def _from(lens_w: Floats, places_w: Floats, radius: float) -> Floats:
    """(N, 2) bearing off a lens's axis, rad, and distance to the near side, m, of what stands at these places."""
    x, y = (places_w - lens_w[:2]).T
    return np.stack([wrapped(np.arctan2(y, x) - lens_w[2]), np.hypot(x, y) - radius], axis=1)
