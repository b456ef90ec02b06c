"""The Hokuyo URG-04LX-UG01: 682 beams over 239.4 degrees, 10 scans a second, 20 to 5600 mm.

What is modelled: the order and bearings of the beams, range limits, noise, whole millimetres, readings between two
surfaces at edges, lost readings, intensity by material, incidence and distance in three modes, and as an option the
sweep, in which every beam is read at its own instant. What is not: weaker returns shorten no range, lasers do not
disturb one another, and the plane of the beams stays level (`planar.TILT_BOUND_RAD`).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter
from flocking.types import Floats, Ints
from sensing.laser import planar, readings, scan, sweep
from sensing.laser.slice import Slice, body_name, moving_body, owner_of, reference_pose, slice_at
from sensing.types import Scan, ScanTruth

BEAMS = planar.BEAMS
STEP_RAD = planar.STEP_RAD
ANGLES: Floats = STEP_RAD * (planar.FIRST_STEP + np.arange(BEAMS, dtype=np.float64))
"""(682,) bearing of each beam in the laser's frame, rad: −119.53 to +119.88 degrees, counter-clockwise."""
MAX_RANGE_M = readings.FARTHEST_M
PERIOD_S = sweep.TURN_S
"""P: 10 scans a second."""
SAME_HEIGHT_M = 1e-3
"""All lasers of a model scan the same plane, to within this."""

MODES = ("ideal", "half-resolution", "strong-code")
"""In the order of `readings.IDEAL` and its siblings."""
_SHEET = "URG-04LX-UG01 data sheet"


class Parameters(NamedTuple):
    """One laser. The defaults are the setting `datasheet`."""

    range_noise_m: Annotated[
        float,
        Parameter(
            "m",
            f"{_SHEET}: 30 mm from 60 to 1000 mm, then 3 %, taken as three standard deviations",
            low=0.0,
            high=1.0,
        ),
    ] = 0.010
    """Standard deviation of a range up to 1 m; beyond, in proportion to the range. The sheet names no quantile;
    published measurements of this laser give millimetres to a centimetre, hence three standard deviations."""
    resolution_mm: Annotated[
        float, Parameter("mm", f"{_SHEET}: whole millimetres", published=True, low=0.0, high=1000.0)
    ] = 1.0
    """0 = not rounded."""
    footprint_rad: Annotated[
        float,
        Parameter("rad", f"{_SHEET}: footprint below 20 mm at 2 m, up to 40 mm at 4 m", low=0.0, high=0.012),
    ] = 0.010
    """Width of a beam, which decides the mixed readings at edges; 0 = none."""
    dropout: Annotated[float, Parameter("", "a choice: one reading in a thousand", low=0.0, high=1.0)] = 0.001
    """Share of readings lost, whatever is hit: they read nan."""
    intensity_noise: Annotated[float, Parameter("", "a choice: a tenth of the intensity", low=0.0, high=1.0)] = 0.10
    """Standard deviation of an intensity, relative to it."""
    intensity_mode: Annotated[
        str,
        Parameter("", "a choice: whether this laser returns intensity is not documented", choices=MODES),
    ] = "ideal"
    """`ideal`: every beam has range and intensity. `half-resolution`: where intensity is read, ranges come from
    the even beams and intensities from their left neighbours, odd beams are nan. `strong-code`: a strong return
    gives code 18 in place of a range, whether intensity is read or not."""
    strong_return: Annotated[float, Parameter("white at 1 m", "a choice: white paper at 0.18 m", low=0.0, high=1e9)] = (
        30.0
    )
    """Least intensity that gives code 18."""
    sweep: Annotated[bool, Parameter("", f"{_SHEET}: one turn in 100 ms")] = False
    """True: each beam at its own instant, the last at the scan's time; false: all at the scan's time."""


SETTINGS: dict[str, Parameters] = {
    "ideal": Parameters(range_noise_m=0.0, resolution_mm=0.0, footprint_rad=0.0, dropout=0.0, intensity_noise=0.0),
    "datasheet": Parameters(),
    # the sheet's figures taken as one standard deviation; the other two are choices
    "harsh": Parameters(range_noise_m=0.030, dropout=0.01, intensity_noise=0.30),
}
"""Named settings of the laser."""

NORMALS: NDArray[np.float32] = ndtri((np.arange(4096) + 0.5) / 4096).astype(np.float32)
"""(4096,) equally likely normal deviates, the middles of as many quantiles: the greatest is 3.7, their standard
deviation 0.9997. A deviate costs 12 random bits and no arithmetic, and the table fits the nearest cache."""
_NO_DRAWS = np.full(BEAMS, 32768, dtype=np.uint16)
_RAW_RANGE, _RAW_INTENSITY = BEAMS // 2, (BEAMS + 3) // 4
"""Numbers of 64 bits drawn a scan: 32 bits a beam for range (noise, drop-out), 16 for intensity."""


class Lasers:
    """The lasers of all robots of one compiled model: robot k carries `sites[k]` and owns all beneath `roots[k]`.

    A laser looks along the x axis of its site, whose z axis is upright. It never sees what its own robot owns. The data
    that they read may be of another model, if its bodies and joints are the same: one without what only lasers see.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        sites: Sequence[str],
        roots: Sequence[int],
        parameters: Sequence[Parameters],
    ) -> None:
        """Raises InputError where a site is unknown, not level or not its robot's, where the lasers' heights
        differ, and where the plane cuts a geom that is no upright prism or has no reflectance (`slice_at`)."""
        if not len(sites) == len(roots) == len(parameters):
            raise InputError(
                f"{len(sites)} sites, {len(roots)} roots and {len(parameters)} sets of laser parameters: "
                "expected one of each a robot"
            )
        self._model = model
        self.parameters = tuple(parameters)
        self.roots = tuple(int(root) for root in roots)
        ids = [_site_id(model, name) for name in sites]
        self.site_ids = tuple(ids)
        data = reference_pose(model)
        heights = [float(data.site_xpos[site][2]) for site in ids]
        for site, height, root, k in zip(ids, heights, self.roots, range(len(ids)), strict=True):
            name = model.site(site).name
            if abs(height - heights[0]) > SAME_HEIGHT_M:
                raise InputError(
                    f"laser {name!r} scans at {height:g} m: expected the height of {model.site(ids[0]).name!r}, "
                    f"{heights[0]:g} m"
                )
            if data.site_xmat[site][8] < math.cos(1e-3):
                raise InputError(f"laser {name!r} leans in the reference pose: expected its z axis upright")
            if owner_of(model, int(model.site_bodyid[site]), self.roots) != k:
                raise InputError(f"laser {name!r} is not mounted on {body_name(model, root)}")
        bodies = [moving_body(model, int(model.site_bodyid[site])) for site in ids]
        height = heights[0] if heights else 0.0
        self.slice: Slice = slice_at(model, height, self.roots, also_moving=bodies)
        self.walls_w: Floats = self.slice.walls_w()
        """(W, 4) fixed segments x0, y0, x1, y1, m."""
        self.silhouette_radii: Floats = self.slice.silhouette_radii(self.roots, model)
        """(N,) m, of each robot's outline at the lasers' height."""
        self.mounts: Floats = np.array(
            [_planar_in(data, site, root) for site, root in zip(ids, self.roots, strict=True)]
        ).reshape(-1, 3)
        """(N, 3) x, y (m) and heading (rad) of each laser in its robot's root body."""
        self.needs_history = any(p.sweep for p in self.parameters)
        """True where some laser sweeps: then `remember` must be called after every physics step."""
        rows = [list(self.slice.bodies).index(body) if body else -1 for body in bodies]
        self._mount_frames = rows
        self._mounts = [_mount_row(_planar_in(data, site, body)) for site, body in zip(ids, bodies, strict=True)]
        self._settings = [_compiled_settings(p) for p in self.parameters]
        self._settings_rows = [np.array(row, dtype=np.float64) for row in self._settings]
        self._beams = planar.beam_directions()
        frames = len(self.slice.bodies)
        self._needs_kinematics = bool(np.any(self.slice.addresses < 0))
        self._addresses = np.where(self.slice.addresses < 0, 0, self.slice.addresses)
        if self._needs_kinematics:
            self._addresses = 7 * self.slice.bodies
            self._placed = mujoco.MjData(model)
        self._poses = np.zeros((1, frames, 4))
        self._lasers = np.zeros((1, 4))
        self._sweep_poses = np.zeros((BEAMS if self.needs_history else 0, frames, 4))
        self._sweep_lasers = np.zeros((len(self._sweep_poses), 4))
        steps = math.ceil(sweep.SWEEP_S / model.opt.timestep) + 2
        self._history: deque[tuple[float, Floats]] = deque(maxlen=steps)
        self._scratch = scan.Scratch(
            np.empty(BEAMS),
            np.empty(BEAMS, np.int64),
            np.empty(BEAMS, np.int64),
            np.empty(BEAMS),
            np.empty(BEAMS),
        )

    def remember(self, data: mujoco.MjData) -> None:
        """Keep where all bodies are now, for lasers that sweep; call it after every physics step."""
        if self._history and data.time <= self._history[-1][0]:
            if data.time == self._history[-1][0]:
                self._history.pop()
            else:
                self._history.clear()
        self._place(data)
        self._history.append((float(data.time), self._poses[0].copy()))

    def trace(self, data: mujoco.MjData, k: int) -> tuple[Floats, Ints]:
        """The cast alone: 1/distance (B,) along laser k's beams now, 1/m, and the number (B,) of the surface hit,
        −1 = none. Both arrays are written over by the next scan."""
        parts, nearness, surfaces = self.slice, self._scratch.nearness, self._scratch.surfaces
        fallen = scan.cast_now(
            k, self._source(data), self._addresses, parts.levels_m, parts.height_m, self._mount_frames[k],
            self._mounts[k], self._poses, self._lasers, *self._shapes(), self._beams, nearness, surfaces,
        )  # fmt: skip
        if fallen != planar.LEVEL:
            raise self._fallen(fallen)
        return nearness, surfaces

    def cast(self, data: mujoco.MjData, k: int) -> tuple[Floats, Ints]:
        """Exact distances (B,) along laser k's beams now, m, inf = nothing within 5.6 m, and the id (B,) of the geom
        that each hits, −1 = none."""
        nearness, surfaces = self.trace(data, k)
        hit = surfaces >= 0
        distances = np.full(BEAMS, math.inf)
        distances[hit] = 1.0 / nearness[hit]
        geoms = np.full(BEAMS, -1, dtype=np.int64)
        geoms[hit] = self.slice.geoms[surfaces[hit] // 4]
        return distances, geoms

    def read(
        self,
        data: mujoco.MjData,
        k: int,
        time: float,
        range_rng: np.random.Generator,
        intensity_rng: np.random.Generator | None = None,
        keep_truth: bool = True,
    ) -> tuple[Scan, ScanTruth]:
        """What laser k reports now, and what no robot can know of it (empty arrays unless `keep_truth`).

        Positions are those in `data.qpos`. `time` is the scan's stamp; a sweep ends at `data.time`. Every scan takes
        the same number of draws from the generators, whatever it sees. Intensities are nan without
        `intensity_rng`.
        Raises InputError where a body leans or is lifted beyond the stated bounds.
        """
        settings, parts = self._settings[k], self.slice
        draws = range_rng.bit_generator.random_raw(_RAW_RANGE).view(np.uint16)
        shines = intensity_rng is not None or settings.mode == readings.STRONG_CODE
        light_draws = _NO_DRAWS
        if intensity_rng is not None:
            light_draws = intensity_rng.bit_generator.random_raw(_RAW_INTENSITY).view(np.uint16)
        ranges, intensities, distances = np.empty((3, BEAMS))
        owners, lit = np.empty(BEAMS, np.int64), np.zeros(len(self.roots), np.int64)
        if self.parameters[k].sweep:
            self.remember(data)
            times = np.array([entry[0] for entry in self._history])
            states = np.stack([entry[1] for entry in self._history])
            sweep.poses_of_beams(times, states, float(data.time), self._sweep_poses)
            poses, lasers, source, addresses = (
                self._sweep_poses,
                self._sweep_lasers,
                _NOTHING,
                self._addresses,
            )
        else:
            poses, lasers, addresses = self._poses, self._lasers, self._addresses
            source = self._source(data)
        fallen = scan.scan(
            self._settings_rows[k], k, shines, source, addresses, parts.levels_m, parts.height_m, self._mount_frames[k],
            self._mounts[k], poses, lasers, *self._shapes(), parts.materials, self._beams, *self._scratch, NORMALS,
            draws, light_draws, ranges, intensities, distances, owners, lit,
        )  # fmt: skip
        if fallen != planar.LEVEL:
            raise self._fallen(fallen)
        if intensity_rng is None:
            intensities.fill(math.nan)
        reading = Scan(time, ANGLES, ranges, intensities)
        return reading, ScanTruth(owners, distances, lit) if keep_truth else _NO_TRUTH

    def _shapes(self) -> tuple[Floats, int, Ints, Ints]:
        return self.slice.shapes, self.slice.rectangles, self.slice.frames, self.slice.owners

    def _source(self, data: mujoco.MjData) -> Floats:
        """Where positions and quaternions stand: qpos, which never lags; else those of all bodies."""
        if not self._needs_kinematics:
            return data.qpos
        placed = self._placed
        placed.qpos[:], placed.mocap_pos[:], placed.mocap_quat[:] = data.qpos, data.mocap_pos, data.mocap_quat
        mujoco.mj_kinematics(self._model, placed)
        return np.concatenate([placed.xpos, placed.xquat], axis=1).ravel()

    def _place(self, data: mujoco.MjData) -> None:
        parts = self.slice
        fallen = planar.place(self._source(data), self._addresses, parts.levels_m, parts.height_m, self._poses[0])
        if fallen != planar.LEVEL:
            raise self._fallen(fallen)

    def _fallen(self, frame: int) -> InputError:
        return InputError(
            f"{body_name(self._model, int(self.slice.bodies[frame]))} leans by more than "
            f"{math.degrees(planar.TILT_BOUND_RAD):g} degrees or stands more than {planar.LIFT_BOUND_M:g} m off its "
            "reference height: expected level motion on the floor, or use the rays of sensing.laser.reference"
        )


_NOTHING = np.empty(0)
_NO_TRUTH = ScanTruth(np.empty(0, np.int64), np.empty(0), np.empty(0, np.int64))


def _site_id(model: mujoco.MjModel, name: str) -> int:
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name)
    if site < 0:
        raise unknown_name("site", name, [model.site(i).name for i in range(model.nsite)])
    return int(site)


def _planar_in(data: mujoco.MjData, site: int, body: int) -> tuple[float, float, float]:
    """x, y and heading of a site in a level body's frame (0 = the world)."""
    turn = np.asarray(data.xmat[body]).reshape(3, 3)
    x, y, _ = turn.T @ (data.site_xpos[site] - data.xpos[body])
    ahead = turn.T @ np.asarray(data.site_xmat[site]).reshape(3, 3)[:, 0]
    return float(x), float(y), math.atan2(ahead[1], ahead[0])


def _mount_row(mount: tuple[float, float, float]) -> Floats:
    return np.array([mount[0], mount[1], math.cos(mount[2]), math.sin(mount[2])])


def _compiled_settings(parameters: Parameters) -> readings.Settings:
    return readings.Settings(
        noise_m=float(parameters.range_noise_m),
        resolution_mm=float(parameters.resolution_mm),
        half_footprint=parameters.footprint_rad / 2.0 / STEP_RAD,
        dropout=float(parameters.dropout),
        intensity_noise=float(parameters.intensity_noise),
        mode=MODES.index(parameters.intensity_mode),
        strong_return=float(parameters.strong_return),
    )
