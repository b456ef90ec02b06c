"""Looks at the cone and measures what the detection makes of it."""

from __future__ import annotations

import math
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from flocking import found
from flocking.angles import wrap
from flocking.parameters import filled
from flocking.types import Floats, Own
from robots import body as bodies
from robots.eyes import CONE_RADIUS
from sensing.camera import imperfections, setting
from sensing.camera.lens import column_angles
from sensing.types import Images, Senses
from trials.simulations.cones import fields
from trials.simulations.cones.measures import ABOUT
from trials.simulations.cones.scene import SHOWN_CONE, Scene, axis_of, blurred_over
from trials.streams import Purpose, stream
from trials.types import Trial, TrialResult, no_contacts, no_updates

ASIDE = math.radians(5.0)
"""An input within this of the cone's bearing is the cone's; others are false. A choice."""
NEAR = 0.5
"""The cone is detected if the distance of such an input is right to within this part of it. A choice: a few pixels that
a segmentation still finds say that something is there, and nothing of where."""
BLENDED = 4
"""Pictures that an exposure is made of where the cone moves. A choice."""


class Look(NamedTuple):
    """What one look gave: nan where the cone was not found."""

    distance: float
    bearing_error: float
    false: int
    columns: int
    pixels_found: float
    """Share of the pixels that show the cone which the segmentation took for a cone's."""
    pixels_false: float
    """Share of the pixels taken for a cone's that show none."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result. Raises `InputError` where nothing
    renders, and for what cannot be set up."""
    began = perf_counter()
    given, group = fields.of_trial(trial), fields.group_of(trial)
    cameras, imperfect = fields.cameras_of(group), fields.imperfections_of(group)
    lens, rng = setting.lens_of(cameras), stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    scene = Scene(fields.of_group(group).body, lens, given, rng)
    pipeline = found.load(fields.PIPELINES, group.pipeline, "pipeline")
    parameters = filled(pipeline.Parameters, group.pipeline_parameters, prefix=f"{group.name}.pipeline.")
    member = bodies.load(fields.of_group(group).body).spec().compile()
    angles = np.stack([column_angles(lens)] * 2)
    noise = stream(trial.seed, trial.repeat, 1, 0, Purpose.IMAGES)
    memory = imperfections.begun(imperfect, noise, lens.height_px, lens.width_px)
    built, looks = perf_counter(), []
    for number in range(given.looks):
        placed = rng.normal(0.0, given.placed_m, size=2)
        images, memory = imperfections.seen(_taken(scene, given, placed, float(number)), imperfect, memory, noise)
        state = pipeline.start(parameters, member, 0.0, angles)  # a look knows nothing of the one before
        for again in range(
            2 if "velocities" in getattr(pipeline, "GIVES", ()) else 1
        ):  # what follows cones looks twice
            seen = None if images is None else images._replace(time=float(number) + 0.1 * again)
            detection, state = pipeline.detect(Senses(None, None, images=seen), _at_rest(), state)
        judged = _judged(given, scene, placed, detection.members.positions, detection.beams)
        found_share, false_share = _pixels(given, scene, placed, getattr(state, "labels", None))
        looks.append(judged._replace(pixels_found=found_share, pixels_false=false_share))
    measures = _measures(given, looks)
    return _result(trial, measures, looks, {"build_s": built - began, "loop_s": perf_counter() - built})


def _at_rest() -> Own:
    return Own(np.zeros(2), 0.0, math.nan, np.full(2, math.nan), np.zeros(2, np.bool_), 0.1, 0, 0)


def _taken(scene: Scene, given: fields.TrialFields, placed: Floats, time: float) -> Images:
    """The images of one look: one picture each, or the mean over the exposure where the cone moves across the view."""
    moves = given.speed_m_s * given.exposure_s if given.cone else 0.0
    bearing = math.radians(given.bearing_deg)
    aside = np.array([-math.sin(bearing), math.cos(bearing)])
    taken = []
    for part in np.linspace(-0.5, 0.5, BLENDED) if moves > 0.0 else (0.0,):
        if given.cone:
            scene.put(*(placed + part * moves * aside))
        taken.append(scene.cameras.look(scene.data, 0, time))
    if len(taken) == 1:
        return taken[0]
    left, right = blurred_over([each.left for each in taken]), blurred_over([each.right for each in taken])
    return Images(time, left, right)


def _judged(given: fields.TrialFields, scene: Scene, placed: Floats, positions: Floats, columns: Floats) -> Look:
    """The input nearest to the cone held against it; all that are far from it are false."""
    lens = np.array(scene.lens_xy)
    if not given.cone:
        return Look(math.nan, math.nan, len(positions), 0, math.nan, math.nan)
    axis = np.array(axis_of(scene.lens_xy, given.distance_m, given.bearing_deg)) + placed
    true, found_at = axis - lens, positions - lens
    away = float(np.hypot(*true)) - CONE_RADIUS
    distances, bearings = np.hypot(*found_at.T), np.arctan2(found_at[:, 1], found_at[:, 0])
    errors = np.array([wrap(float(each) - math.atan2(true[1], true[0])) for each in bearings])
    own = (np.abs(errors) <= ASIDE) if len(positions) else np.zeros(0, np.bool_)
    if not own.any():
        return Look(math.nan, math.nan, len(positions), 0, math.nan, math.nan)
    nearest = int(np.flatnonzero(own)[np.abs(distances[own] - away).argmin()])
    # distances are told as if each had been placed exactly: what placing adds is no error of the detection
    return Look(
        float(distances[nearest]) - away + given.distance_m,
        abs(float(errors[nearest])),
        int((~own).sum()),
        int((columns == nearest).sum()),
        math.nan,
        math.nan,
    )


def _pixels(given: fields.TrialFields, scene: Scene, placed: Floats, labels: Any) -> tuple[float, float]:
    """Both shares of pixels of a look; `labels`: 0 where a pixel was taken for no colour, (H, W) of each image.

    Of a cone that moves, by where it is in the middle of the exposure. nan where there is nothing to have a share of.
    """
    if labels is None:
        return math.nan, math.nan
    if given.cone:
        scene.put(*placed)
    shown = scene.cameras.shown(scene.data, 0)
    cone = np.concatenate([shown.left, shown.right]) == SHOWN_CONE
    taken = np.concatenate(list(labels)) > 0
    right = int((taken & cone).sum())
    return _share(right, int(cone.sum())), 1.0 - _share(right, int(taken.sum()))


def _share(part: int, whole: int) -> float:
    return part / whole if whole else math.nan


def _measures(given: fields.TrialFields, looks: list[Look]) -> dict[str, float]:
    table = np.array(looks, dtype=np.float64).reshape(-1, len(Look._fields))
    seen = np.isfinite(table[:, 0])
    measures = dict.fromkeys(ABOUT, math.nan) | {"false_inputs": float(table[:, 2].mean())}
    if given.cone:
        near = np.abs(table[:, 0] / given.distance_m - 1.0) <= NEAR  # nan compares false
        measures["detected"] = float(near.mean())
    for name in ("pixels_found", "pixels_false"):
        shares = table[:, Look._fields.index(name)]
        if np.isfinite(shares).any():
            measures[name] = float(np.nanmean(shares))
    if seen.any():
        distances = table[seen, 0]
        measures |= {
            "distance": float(distances.mean()),
            "distance_error": float(distances.mean()) / given.distance_m - 1.0,
            "distance_deviation": float(distances.std(ddof=1)) if len(distances) > 1 else 0.0,
            "distance_deviates": float(np.abs(distances / given.distance_m - 1.0).mean()),
            "bearing_error": float(table[seen, 1].mean()),
            "run": float(table[seen, 3].mean()),
        }
    return measures


def _result(trial: Trial, measures: dict[str, float], looks: list[Look], timing: dict[str, float]) -> TrialResult:
    """A result whose one robot stands still for as many seconds as it looks."""
    count = len(looks)
    return TrialResult(
        trial=trial,
        times=np.arange(count + 1, dtype=np.float64),
        poses_w=np.zeros((count + 1, 1, 3)),
        odometry=np.empty((0, 1, 3)),
        bumpers=np.empty((0, 1, 2), np.bool_),
        robot_names=(f"{fields.EYES}-1",),
        radii=np.array([0.165]),
        rules=(),
        walls_w=np.empty((0, 4)),
        period_m=math.nan,
        updates=no_updates(1),
        contacts=no_contacts(),
        scans=None,
        measures=measures,
        outcome="done",
        reason="",
        timing=timing,
        tables={"looks": np.array(looks, dtype=np.float64)},
    )
