"""A ring of sonars in one level plane: what each of them hears first.

A sonar sends its sound into a cone about its axis and reports the nearest surface in it, at whatever angle: within
`HALF_WIDTH_RAD` it does not know where. Here its cone is `RAYS` level rays, evenly spread, and the nearest hit counts.
The world is cut at the ring's height as for the laser (`sensing.laser.slice`), so that what is lower or higher is not
heard (a Create's laser cylinder is lower than a Pioneer's ring), and what is narrower than the gap between two rays (a
sixtieth of its distance) may be missed.

Not modelled: echoes that a smooth wall throws away at a slant, cross-talk, the order in which sonars fire, noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from flocking.compilation import borrowing
from flocking.errors import InputError, unknown_name
from flocking.types import Floats, Ints
from sensing.laser import planar
from sensing.laser.slice import Slice, body_name, moving_body, owner_of, reference_pose, slice_at
from sensing.types import Echoes

RING: tuple[tuple[float, float, float], ...] = tuple(
    (1e-3 * x, 1e-3 * y, math.radians(degrees))
    for x, y, degrees in (
        (147, 136, 90), (193, 119, 50), (227, 79, 30), (245, 27, 10), (245, -27, -10), (227, -79, -30),
        (193, -119, -50), (147, -136, -90), (-144, -136, -90), (-189, -119, -130), (-223, -79, -150), (-241, -27, -170),
        (-241, 27, 170), (-223, 79, 150), (-189, 119, 130), (-144, 136, 90),
    )
)  # fmt: skip
"""x, y (m) and heading (rad) of the Pioneer P2-AT8's sonars in its frame, in the order of their numbers.
C: ARIA's parameters of the p2at8 (SonarUnit)."""

LEAST_M = 0.1  # m: what is nearer reads as this; ?
MOST_M = 5.0  # m: what is farther is not heard; ?
HALF_WIDTH_RAD = math.radians(15.0)  # rad of a cone to either side of its axis; ?
RAYS = 31  # a cone: one along its axis, and every degree; ?
SAME_HEIGHT_M = 1e-6  # m; ?: rounding
AHEAD = 340
"""The laser's beam that looks straight ahead (`planar.COSINES`): a ray is that beam of a laser that looks along it."""


class Sonars:
    """The sonars of all robots of one compiled model: robot k's ring is centred on `sites[k]`, and it owns all beneath
    `roots[k]`, which it does not hear.

    A site is level, and its x axis looks ahead. The data that they read may be of another model, if its bodies and
    joints are the same.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        sites: Sequence[str],
        roots: Sequence[int],
        ring: Sequence[tuple[float, float, float]] = RING,
    ) -> None:
        """Raises InputError where a site is unknown, leans, or is not its robot's, where heights differ, and where the
        plane cuts a geom that is no upright prism (`slice_at`)."""
        if len(sites) != len(roots):
            raise InputError(f"{len(sites)} sites and {len(roots)} roots: expected one of each a robot")
        self._model, self._data = model, reference_pose(model)
        self.roots = tuple(int(root) for root in roots)
        ids = [self._checked(name, k) for k, name in enumerate(sites)]
        heights = [float(self._data.site_xpos[site][2]) for site in ids]
        for name, found in zip(sites, heights, strict=True):
            if abs(found - heights[0]) > SAME_HEIGHT_M:
                raise InputError(
                    f"sonar {name!r} listens at {found:g} m: expected {heights[0]:g} m, as of {sites[0]!r}"
                )
        height = heights[0] if heights else 0.0
        bodies = [moving_body(model, int(model.site_bodyid[site])) for site in ids]
        self.slice: Slice = slice_at(model, height, self.roots, also_moving=bodies)
        rows = {int(body): row for row, body in enumerate(self.slice.bodies)}
        self.ring: Floats = np.array(ring, dtype=np.float64).reshape(-1, 3)
        """(S, 3) x, y (m) and heading (rad) of each sonar in the frame of the site."""
        self._poses = np.zeros((len(rows), 4))
        self._frames = [rows.get(body, -1) for body in bodies]
        self._mounts = [self._mounted(site, body) for site, body in zip(ids, bodies, strict=True)]
        self._rings = [self._ring_of(k) for k in range(len(ids))]
        self._silhouettes = self.slice.silhouette_radii(self.roots, model)
        lags = bool(np.any(self.slice.addresses < 0))
        self._placed = mujoco.MjData(model) if lags else None
        self._addresses: Ints = 7 * self.slice.bodies if lags else self.slice.addresses

    def read(self, data: mujoco.MjData, k: int) -> Floats:
        """(S,) ranges of robot k's sonars, m: `LEAST_M` to `MOST_M`, inf = nothing heard.

        Positions are those in `data.qpos`. Raises InputError where a body leans or is lifted beyond the laser's bounds.
        """
        ranges, cut = np.empty(len(self.ring)), self.slice
        fallen = _heard(
            self._source(data), self._addresses, cut.levels_m, cut.height_m, cut.shapes, cut.rectangles, cut.frames,
            cut.owners, cut.materials, self._poses, k, self._frames[k], self._mounts[k], self.ring, ranges,
        )  # fmt: skip
        if fallen != planar.LEVEL:
            raise InputError(
                f"{body_name(self._model, int(cut.bodies[fallen]))} leans by more than "
                f"{math.degrees(planar.TILT_BOUND_RAD):g} degrees or stands more than {planar.LIFT_BOUND_M:g} m off "
                "its reference height: expected level motion on the floor"
            )
        return ranges

    def listen(self, data: mujoco.MjData, k: int, cone: tuple[float, float]) -> Echoes:
        """What robot k hears; `cone`: where its own kind's cone stands in its frame, m (nan where that has none)."""
        return Echoes(self.read(data, k), self._rings[k], float(self._silhouettes[k]) + math.hypot(*cone))

    def _ring_of(self, k: int) -> Floats:
        """(S, 3) x, y (m) and heading (rad) of each sonar in robot k's frame."""
        x, y, cosine, sine = self._mounts[k]
        across, along, heading = self.ring.T
        turned = heading + math.atan2(sine, cosine)
        return np.column_stack([x + cosine * across - sine * along, y + sine * across + cosine * along, turned])

    def _checked(self, name: str, k: int) -> int:
        model, data = self._model, self._data
        site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name)
        if site < 0:
            raise unknown_name("site", name, [model.site(i).name for i in range(model.nsite)])
        if data.site_xmat[site][8] < math.cos(1e-3):
            raise InputError(f"sonar {name!r} leans in the reference pose: expected its z axis upright")
        if owner_of(model, int(model.site_bodyid[site]), self.roots) != k:
            raise InputError(f"sonar {name!r} is not mounted on {body_name(model, self.roots[k])}")
        return int(site)

    def _mounted(self, site: int, body: int) -> Floats:
        """(4,) x, y, cosine and sine of a site's heading in a level body's frame (0 = the world)."""
        data = self._data
        turn = np.asarray(data.xmat[body]).reshape(3, 3)
        x, y, _ = turn.T @ (data.site_xpos[site] - data.xpos[body])
        ahead = turn.T @ np.asarray(data.site_xmat[site]).reshape(3, 3)[:, 0]
        return np.array([x, y, *(ahead[:2] / np.hypot(*ahead[:2]))])

    def _source(self, data: mujoco.MjData) -> Floats:
        """Where positions and quaternions stand: qpos, which never lags; else those of all bodies."""
        placed = self._placed
        if placed is None:
            return data.qpos
        placed.qpos[:], placed.mocap_pos[:], placed.mocap_quat[:] = data.qpos, data.mocap_pos, data.mocap_quat
        mujoco.mj_kinematics(self._model, placed)
        return np.concatenate([placed.xpos, placed.xquat], axis=1).ravel()


@borrowing
def _heard(
    source: Floats, addresses: Ints, levels_m: Floats, height_m: float, outlines: Floats, rectangles: int,
    frames: Ints, owners: Ints, materials: Floats, poses: Floats, own: int, frame: int, mount: Floats, ring: Floats,
    ranges: Floats,
) -> Any:  # fmt: skip
    """Fills `ranges` (S,). Returns the frame that leans or is lifted, `planar.LEVEL` if none.

    Arguments as in `planar.Frames`, `planar.Shapes` and `planar.Mounting`; poses (F, 4) is written over.
    """
    shapes = planar.Shapes(outlines, rectangles, frames, owners, materials)
    fallen = planar.place(source, planar.Frames(addresses, levels_m, height_m), poses)
    if fallen != planar.LEVEL:
        return fallen
    middle = planar.laser_pose(poses, planar.Mounting(own, frame, mount))
    for s in range(len(ring)):
        x = middle.x + middle.cosine * ring[s, 0] - middle.sine * ring[s, 1]
        y = middle.y + middle.sine * ring[s, 0] + middle.cosine * ring[s, 1]
        heading = math.atan2(middle.sine, middle.cosine) + ring[s, 2]
        nearness = 0.0
        for ray in range(RAYS):
            along = heading + HALF_WIDTH_RAD * (2.0 * ray / (RAYS - 1) - 1.0)
            looking = planar.Pose(x, y, math.cos(along), math.sin(along))
            near, surface = planar.cast_one(AHEAD, looking, own, MOST_M, poses, shapes)
            if surface >= 0:
                nearness = max(nearness, near)
        ranges[s] = max(1.0 / nearness, LEAST_M) if nearness > 0.0 else math.inf
    return planar.LEVEL
