"""Chooses the thresholds of the detection pipelines on random scenes, which are not those of the experiment.

    python -m scripts.calibrate_detection [--models 300] [--scans 10] [--seed 20151] [--setting datasheet]

A scene is a rectangular room with the focal Create, other Creates, boxes (sides 0.05 to 1 m) and posts (radius 0.03 to
0.5 m, which includes the radius of a Create), all at random places, so that some hide others. The laser is at its
data-sheet setting unless another is named.

Criterion for the splitting distance and the warping threshold: Youden's index, the share of members detected minus
the share of other objects taken for members. A member counts if at least half of the beams that would fall on it alone
do; another object counts if any beam falls on it; the walls of a room are one object a scan. An object is taken for
a member if any segment is accepted of which most beams fell on it. Criterion for the intensity threshold: the same
index over single readings.
"""

from __future__ import annotations

import argparse
import itertools
import math
from typing import NamedTuple

import mujoco
import numpy as np

from flocking.types import Bools, Floats
from robots import body as bodies
from robots.physics import apply_options
from sensing.laser.draws import intensity_draws, range_draws
from sensing.laser.hokuyo import ANGLES, SETTINGS, STEP_RAD, Lasers
from sensing.pipelines import sensor_based
from sensing.shapes import recognition
from sensing.shapes.recognition import Recogniser, recogniser
from sensing.shapes.segments import shape_of, split
from sensing.shapes.templates import group_at
from sensing.shapes.warping import nearest_shape
from sensing.types import Scan, ScanTruth
from worlds.walls import Walls, add_walls, closed

CREATE = bodies.load("create")
MEMBERS, BOXES, POSTS = 5, 3, 3
OBJECTS = MEMBERS + BOXES + POSTS
FORMS = ((32, 5), (16, 3), (16, 1), (12, 1), (8, 1), (6, 1))
SPLITS_M = (0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.1, 0.15, 0.2, 0.3)
THRESHOLDS_M = np.arange(1, 101) / 2000.0
INTENSITIES = np.array(
    [m * 10.0**e for e in (-1, 0, 1, 2) for m in (1, 1.2, 1.4, 1.7, 2, 2.4, 2.8, 3.3, 4, 5, 6, 7, 8.5)]
)
BANDS_M = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


class Scene(NamedTuple):
    """A room with objects that can be placed anew."""

    model: mujoco.MjModel
    data: mujoco.MjData
    lasers: Lasers
    room: tuple[float, float]
    """m, half sides."""
    radii: Floats
    """(1 + OBJECTS,) m, circles in which the focal Create and each object stand."""


class Outcomes(NamedTuple):
    """One row an object in view: O rows."""

    is_member: Bools
    distances: Floats
    """(O,) m from laser to centre; nan for walls."""
    shares: Floats
    """(O,) of the beams that would fall on it if nothing hid it, the share that does; nan where it is no member."""
    costs: Floats
    """(O, forms, splits) m, least warping cost of its segments."""


def build(rng: np.random.Generator, setting: str) -> Scene:
    """A room with its objects, sizes and reflectances drawn from `rng`; they are placed later."""
    spec = mujoco.MjSpec()
    apply_options(spec)
    half = rng.uniform(1.2, 5.0, 2)
    room = closed([(-half[0], -half[1]), (half[0], -half[1]), (half[0], half[1]), (-half[0], half[1])])
    add_walls(spec, Walls(room, rng.uniform(0.2, 0.9)))
    names = []
    for k in range(1 + MEMBERS):
        names.append(f"member-{k}/")
        spec.attach(CREATE.spec(), prefix=names[-1], frame=spec.worldbody.add_frame())
    radii = [CREATE.silhouette_radius] * (1 + MEMBERS)
    for k in range(BOXES + POSTS):
        names.append(f"thing-{k}/")
        body = spec.worldbody.add_body(name=f"{names[-1]}base")
        body.add_freejoint()
        body.add_site(
            name=f"{names[-1]}laser", pos=(0, 0, CREATE.mount("laser").height_m)
        )  # a robot to the truth: it is told apart
        paint = [rng.uniform(0.05, 0.95), 0.0]
        if k < BOXES:
            sides = rng.uniform(0.05, 1.0, 2) / 2
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[*sides, 0.5], pos=(0, 0, 0.5), userdata=paint)
            radii.append(math.hypot(*sides))
        else:
            radius = rng.uniform(0.03, 0.5)
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[radius, 0.5, 0], pos=(0, 0, 0.5), userdata=paint)
            radii.append(radius)
    model = spec.compile()
    lasers = Lasers(
        model,
        [f"{name}laser" for name in names],
        [model.body(f"{name}base").id for name in names],
        [SETTINGS[setting]] * len(names),
    )
    return Scene(model, mujoco.MjData(model), lasers, (float(half[0]), float(half[1])), np.array(radii))


def place(scene: Scene, rng: np.random.Generator) -> Floats:
    """Places all at random without overlaps, what finds no place far outside. Returns places (1 + OBJECTS, 2), m."""
    half = np.array(scene.room)
    places = np.full((len(scene.radii), 2), np.nan)
    for k, radius in enumerate(scene.radii):
        outside = np.array([1000.0 + 10.0 * k, 1000.0])
        places[k] = outside
        for _ in range(50 if np.all(half > radius) else 0):
            spot = rng.uniform(-half + radius, half - radius)
            if np.all(np.hypot(*(places[:k] - spot).T) > scene.radii[:k] + radius):
                places[k] = spot
                break
        yaw = rng.uniform(-math.pi, math.pi)
        address = scene.model.jnt_qposadr[scene.model.body_jntadr[scene.lasers.roots[k]]]
        pose = scene.data.qpos[address : address + 7]
        pose[:] = [*places[k], 0.0, math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
    return places


def costs_by_owner(scan: Scan, truth: ScanTruth, state: Recogniser, split_m: float) -> Floats:
    """(1 + OBJECTS + 1,) least cost (m) of the segments that each object owns, the walls last; inf = none."""
    segments, _ = split(scan.ranges, state.directions, 0.0, 0.0, split_m, state.points, state.readings, state.starts)
    least = np.full(len(truth.lit) + 1, np.inf)
    for s in range(segments):
        first, last = state.starts[s], state.starts[s + 1]
        owner = np.bincount(truth.owners[state.readings[first:last]] + 1).argmax() - 1
        distance = shape_of(state.points, state.readings, first, last, 0.0, 0.0, state.shape)
        group = group_at(distance, state.limits_m)
        alike = state.templates[state.groups[group] : state.groups[group + 1]]
        cost = nearest_shape(state.shape, alike, state.band, 1.0, 0.0, state.rows)
        least[owner] = min(least[owner], cost)
    return least


def observe(models: int, scans: int, seed: int, setting: str) -> tuple[Outcomes, Floats, Floats]:
    """All outcomes, and the intensities of members' readings and of all others."""
    rng = np.random.default_rng(seed)
    draws = range_draws(rng, ahead=1), intensity_draws(rng, ahead=1)
    member, chosen = CREATE.spec().compile(), recognition.Parameters()
    states = [
        recogniser(chosen, member, CREATE.mount("laser").height_m, ANGLES, samples, band) for samples, band in FORMS
    ]
    is_member, distances, shares, costs = [], [], [], []
    bright: list[Floats] = []
    dark: list[Floats] = []
    for _ in range(models):
        scene = build(rng, setting)
        for _ in range(scans):
            places = place(scene, rng)
            scan, truth = scene.lasers.read(scene.data, 0, 0.0, *draws)
            apart = np.hypot(*(places - places[0]).T)
            owned = np.array([[costs_by_owner(scan, truth, state, d) for d in SPLITS_M] for state in states])
            for k in range(1, 1 + OBJECTS):
                if truth.lit[k] > 0:
                    alone = 2.0 * math.asin(min(1.0, scene.radii[k] / apart[k])) / STEP_RAD
                    is_member.append(k <= MEMBERS)
                    distances.append(apart[k])
                    shares.append(truth.lit[k] / alone if k <= MEMBERS else math.nan)
                    costs.append(owned[:, :, k])
            is_member.append(False)
            distances.append(math.nan)
            shares.append(math.nan)
            costs.append(owned[:, :, -1])
            readings = np.isfinite(scan.ranges)
            on_member = (truth.owners > 0) & (truth.owners <= MEMBERS)
            bright.append(scan.intensities[readings & on_member])
            dark.append(scan.intensities[readings & ~on_member])
    outcomes = Outcomes(np.array(is_member), np.array(distances), np.array(shares), np.array(costs))
    return outcomes, np.concatenate(bright), np.concatenate(dark)


def share_accepted(costs: Floats) -> Floats:
    """(len(THRESHOLDS_M),) share of `costs` (n,) at or below each threshold."""
    return np.searchsorted(np.sort(costs), THRESHOLDS_M, side="right") / max(1, len(costs))


def report_recognition(outcomes: Outcomes) -> tuple[float, float]:
    """Prints the tables of recognition by shape; returns the chosen splitting distance and threshold, m."""
    whole, members = outcomes.shares >= 0.95, outcomes.shares >= 0.5
    others = ~outcomes.is_member
    walls = others & np.isnan(outcomes.distances)
    print(f"{members.sum()} members at least half in sight, {others.sum()} other objects")
    best: dict[tuple[int, int], tuple[float, int, int]] = {}
    for form, key in enumerate(FORMS):
        best[key] = (-1.0, 0, 0)
        for column in range(len(SPLITS_M)):
            costs = outcomes.costs[:, form, column]
            gains = share_accepted(costs[members]) - share_accepted(costs[others])
            k = int(np.argmax(gains))
            best[key] = max(best[key], (float(gains[k]), column, k))
    print("\nsamples  band  split_m  threshold_m  Youden's index")
    for (samples, band), (gain, column, k) in best.items():
        print(f"{samples:7d}  {band:4d}  {SPLITS_M[column]:7.3f}  {THRESHOLDS_M[k]:11.4f}  {gain:.3f}")

    form = FORMS.index((recognition.SAMPLES, recognition.BAND))
    _, column, chosen = best[FORMS[form]]
    print(f"\n{recognition.SAMPLES} samples, band {recognition.BAND}")
    print("split_m  threshold_m  detected  taken for one  Youden's index")
    for row, split_m in enumerate(SPLITS_M):
        right, wrong = (share_accepted(outcomes.costs[which, form, row]) for which in (members, others))
        k = int(np.argmax(right - wrong))
        print(f"{split_m:7.3f}  {THRESHOLDS_M[k]:11.4f}  {right[k]:8.3f}  {wrong[k]:13.3f}  {right[k] - wrong[k]:.3f}")

    costs = outcomes.costs[:, form, column]
    print(f"\nROC at split_m = {SPLITS_M[column]}\nthreshold_m  detected  taken for one  (things)  (walls)")
    shares = [share_accepted(costs[which]) for which in (members, others, others & ~walls, walls)]
    for k in sorted({*range(3, 90, 6), chosen}):
        cells = "  ".join(f"{share[k]:8.3f}" for share in shares)
        print(f"{THRESHOLDS_M[k]:11.4f}  {cells}{'  <- chosen' if k == chosen else ''}")

    accepted = costs <= THRESHOLDS_M[chosen]
    print("\nShare accepted by distance of the centre, m")
    print("            members whole  half in sight  any beam       things")
    for low, high in itertools.pairwise(BANDS_M):
        near = (outcomes.distances >= low) & (outcomes.distances < high)
        groups = [near & whole, near & members, near & outcomes.is_member, near & others]
        cells = "  ".join(f"{accepted[g].mean() if g.any() else math.nan:.3f} of {g.sum():4d}" for g in groups)
        print(f"{low:.1f} to {high:.1f}  {cells}")
    return SPLITS_M[column], float(THRESHOLDS_M[chosen])


def report_intensity(bright: Floats, dark: Floats) -> float:
    """Prints the ROC of single readings' intensities; returns the chosen threshold."""
    print("\nintensity  members' readings above  other readings above")
    right, wrong = (1.0 - np.searchsorted(np.sort(values), INTENSITIES) / len(values) for values in (bright, dark))
    chosen = int(np.argmax(right - wrong))
    for k in sorted({*range(0, len(INTENSITIES), 4), chosen}):
        print(f"{INTENSITIES[k]:9.2f}  {right[k]:.5f}  {wrong[k]:.5f}{'  <- chosen' if k == chosen else ''}")
    return float(INTENSITIES[chosen])


def main() -> None:
    """Prints the tables and the choices."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=int, default=300, help="rooms (default 300)")
    parser.add_argument("--scans", type=int, default=10, help="scans a room (default 10)")
    parser.add_argument("--seed", type=int, default=20151)
    parser.add_argument("--setting", choices=sorted(SETTINGS), default="datasheet", help="of the laser")
    given = parser.parse_args()
    outcomes, bright, dark = observe(given.models, given.scans, given.seed, given.setting)
    split_m, threshold_m = report_recognition(outcomes)
    threshold = report_intensity(bright, dark)
    print(f"\nchosen: split_m = {split_m}, threshold_m = {threshold_m}, threshold = {threshold:g}")
    print(f"stand:  {recognition.Parameters()}, {sensor_based.Parameters()}")


if __name__ == "__main__":
    main()
