"""The Hokuyo URG-04LX-UG01: 682 beams over 239.4 degrees, 10 scans a second, 20 to 5600 mm.

What is modelled: the order and bearings of the beams, range limits, noise, whole millimetres, readings between two
surfaces at edges, lost readings, intensity by material, incidence and distance in three modes, and as options a
narrower view and the sweep, in which every beam is read at its own instant. What is not: a laser looks through its own
robot, whose cylinder would hide some of the rear, weaker returns shorten no range, lasers do not disturb one another,
and the plane of the beams stays level (`planar.TILT_BOUND_RAD`).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import mujoco
import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter
from flocking.types import Floats, Ints
from sensing.laser import planar, readings, scan, sweep
from sensing.laser.draws import Draws
from sensing.laser.slice import Slice, body_name, moving_body, owner_of, reference_pose, slice_at
from sensing.types import NOBODY, Scan, ScanTruth

BEAMS = planar.BEAMS
STEP_RAD = planar.STEP_RAD
ANGLES: Floats = STEP_RAD * (planar.FIRST_STEP + np.arange(BEAMS, dtype=np.float64))
"""(682,) bearing of each beam in the laser's frame, rad: −119.53 to +119.88 degrees, counter-clockwise."""
MAX_RANGE_M = readings.FARTHEST_M
PERIOD_S = sweep.TURN_S
"""P: 10 scans a second."""
SAME_HEIGHT_M = 1e-3
"""All lasers of a model scan the same plane, to within this."""

MODES = IDEAL, HALF_RESOLUTION, STRONG_CODE = ("ideal", "half-resolution", "strong-code")
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
            plausible=(0.002, 0.015),
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
        Parameter(
            "rad",
            f"{_SHEET}: footprint below 20 mm at 2 m, up to 40 mm at 4 m",
            low=0.0,
            high=0.012,
            plausible=(0.005, 0.012),
        ),
    ] = 0.010
    """Width of a beam, which decides the mixed readings at edges; 0 = none."""
    dropout: Annotated[
        float, Parameter("", "a choice: one reading in a thousand", low=0.0, high=1.0, plausible=(0.0, 0.01))
    ] = 0.001
    """Share of readings lost, whatever is hit: they read nan."""
    intensity_noise: Annotated[float, Parameter("", "a choice: a tenth of the intensity", low=0.0, high=1.0)] = 0.10
    """Standard deviation of an intensity, relative to it."""
    intensity_mode: Annotated[
        str,
        Parameter(
            "", "a choice: whether this laser returns intensity is not documented", choices=MODES, plausible=MODES
        ),
    ] = "ideal"
    """`ideal`: every beam has range and intensity. `half-resolution`: where intensity is read, ranges come from
    the even beams and intensities from their left neighbours, odd beams are nan. `strong-code`: a strong return
    gives code 18 in place of a range, whether intensity is read or not."""
    strong_return: Annotated[float, Parameter("white at 1 m", "a choice: white paper at 0.18 m", low=0.0, high=1e9)] = (
        30.0
    )
    """Least intensity that gives code 18."""
    sweep: Annotated[bool, Parameter("", f"{_SHEET}: one turn in 100 ms", plausible=(False, True))] = False
    """True: each beam at its own instant, the last at the scan's time; false: all at the scan's time."""
    view_deg: Annotated[
        float,
        Parameter(
            "deg",
            f"{_SHEET}: 240; less where the robot's own cylinder hides the rear",
            low=0.0,
            high=240.0,
            plausible=(180.0, 240.0),
        ),
    ] = 240.0
    """Width of the view about straight ahead; 240 has all beams (239.4 degrees from the first to the last). The beams
    beyond it read inf, as where nothing returns."""


SETTINGS: dict[str, Parameters] = {
    "ideal": Parameters(range_noise_m=0.0, resolution_mm=0.0, footprint_rad=0.0, dropout=0.0, intensity_noise=0.0),
    "datasheet": Parameters(),
    # the sheet's figures taken as one standard deviation; the other two are choices
    "harsh": Parameters(range_noise_m=0.030, dropout=0.01, intensity_noise=0.30),
}
"""Named settings of the laser."""

NO_INTENSITIES: Floats = np.full(BEAMS, math.nan)
"""(682,) the intensities of every scan of which nobody reads them; not to be written to."""
NO_INTENSITIES.flags.writeable = False
_NO_NOISE = np.full(BEAMS, 32768, dtype=np.uint16)
"""Draws of the middle of the noise's distribution, for intensities of which the laser itself makes use (code 18)."""
_NOTHING = np.empty(0)


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
        marked: Sequence[bool] = (),
    ) -> None:
        """`marked`: which robots can be told as members, by default all; in what the laser's truth says, the others are
        parts of walls.

        Raises InputError where a site is unknown, not level or not its robot's, where the lasers' heights
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
        self._unmarked = np.flatnonzero(~np.array(marked, dtype=np.bool_))
        self._truly: Ints = np.arange(len(roots) + 1)
        """(N + 1,) whom each owner of a reading counts as; the last is nobody."""
        self._truly[self._unmarked] = self._truly[-1] = NOBODY
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
        frames, addresses = len(self.slice.bodies), self.slice.addresses
        self._needs_kinematics = bool(np.any(addresses < 0))
        self._frames = planar.Frames(
            7 * self.slice.bodies if self._needs_kinematics else addresses, self.slice.levels_m, self.slice.height_m
        )
        if self._needs_kinematics:
            self._placed = mujoco.MjData(model)
        self._now = planar.Places(np.zeros((1, frames, 4)), np.zeros((1, 4)))
        instants = BEAMS if self.needs_history else 0
        self._sweep = planar.Places(np.zeros((instants, frames, 4)), np.zeros((instants, 4)))
        steps = math.ceil(sweep.SWEEP_S / model.opt.timestep) + 2
        self._history: deque[tuple[float, Floats]] = deque(maxlen=steps)
        self._surfaces, self._partners = np.empty((2, BEAMS), np.int64)
        self._nearness, self._shares, self._returns, self._light, self._distances = np.empty((5, BEAMS))
        rows = [list(self.slice.bodies).index(body) if body else -1 for body in bodies]
        mounts = [_mount_row(_planar_in(data, site, body)) for site, body in zip(ids, bodies, strict=True)]
        mountings = [planar.Mounting(*each) for each in zip(range(len(ids)), rows, mounts, strict=True)]
        self._at_once = [self._fixed(mounting, self._now) for mounting in mountings]
        self._own_way = [
            self._fixed(mounting, self._sweep) if laser.sweep else at_once
            for laser, mounting, at_once in zip(self.parameters, mountings, self._at_once, strict=True)
        ]

    def _fixed(self, mounting: planar.Mounting, places: planar.Places) -> tuple[Any, ...]:
        """A laser's `scan.Fixed` as a plain tuple."""
        parts, laser = self.slice, self.parameters[mounting.own]
        first_beam, last_beam = _in_view(laser.view_deg)
        fixed = scan.Fixed(
            settings_row=_settings_row(laser),
            own=mounting.own,
            mount_frame=mounting.frame,
            mount=mounting.pose,
            addresses=self._frames.addresses,
            levels_m=parts.levels_m,
            height_m=parts.height_m,
            outlines=parts.shapes,
            rectangles=parts.rectangles,
            frames=parts.frames,
            owners=parts.owners,
            materials=parts.materials,
            poses=places.poses,
            lasers=places.lasers,
            nearness=self._nearness,
            surfaces=self._surfaces,
            partners=self._partners,
            shares=self._shares,
            returns=self._returns,
            first_beam=first_beam,
            last_beam=last_beam,
        )
        return tuple(fixed)

    def remember(self, data: mujoco.MjData) -> None:
        """Keep where all bodies are now, for lasers that sweep; call it after every physics step."""
        if self._history and data.time <= self._history[-1][0]:
            if data.time == self._history[-1][0]:
                self._history.pop()
            else:
                self._history.clear()
        self._expect_level(planar.place(self._source(data), self._frames, self._now.poses[0]))
        self._history.append((float(data.time), self._now.poses[0].copy()))

    def trace(self, data: mujoco.MjData, k: int) -> tuple[Floats, Ints]:
        """The rays alone, all at once: 1/distance (B,) along laser k's beams now, 1/m, and the number (B,) of the
        surface hit, −1 = none. Both arrays are written over by the next scan."""
        self._expect_level(scan.cast(self._at_once[k], self._source(data)))
        return self._nearness, self._surfaces

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
        range_draws: Draws,
        intensity_draws: Draws | None = None,
        exact: bool = True,
    ) -> tuple[Scan, ScanTruth]:
        """What laser k reports now, and what no robot can know of it.

        Positions are those in `data.qpos`. `time` is the scan's stamp; a sweep ends at `data.time`. Without
        `intensity_draws` the intensities are not read: all scans share one array of nan for them. Without `exact` the
        exact ranges of the truth are left out. All other arrays are the caller's own.
        Raises InputError where a body leans or is lifted beyond the stated bounds.
        """
        draws = range_draws.next_scan()
        if intensity_draws is None:
            light_draws, intensities = _NO_NOISE, self._light
        else:
            light_draws, intensities = intensity_draws.next_scan(), np.empty(BEAMS)
        ranges, distances = np.empty(BEAMS), np.empty(BEAMS) if exact else self._distances
        owners, lit = np.empty(BEAMS, np.int64), np.empty(len(self.roots), np.int64)
        laser = self.parameters[k]
        shines = intensity_draws is not None or laser.intensity_mode == STRONG_CODE
        source = self._remembered(data) if laser.sweep else self._source(data)
        fallen = scan.scan(
            self._own_way[k], source, shines, draws, light_draws, ranges, intensities, distances, owners, lit
        )
        self._expect_level(fallen)
        if len(self._unmarked):
            owners = self._truly[owners]
            lit[self._unmarked] = 0
        reading = Scan(time, ANGLES, ranges, NO_INTENSITIES if intensity_draws is None else intensities)
        return reading, ScanTruth(owners, distances if exact else _NOTHING, lit)

    def _remembered(self, data: mujoco.MjData) -> Floats:
        """Fills in where all bodies were at each instant of a sweep that ends now; the rays need no other source."""
        self.remember(data)
        times = np.array([entry[0] for entry in self._history])
        states = np.stack([entry[1] for entry in self._history])
        sweep.poses_of_beams(times, states, float(data.time), self._sweep.poses)
        return _NOTHING

    def _source(self, data: mujoco.MjData) -> Floats:
        """Where positions and quaternions stand: qpos, which never lags; else those of all bodies."""
        if not self._needs_kinematics:
            return data.qpos
        placed = self._placed
        placed.qpos[:], placed.mocap_pos[:], placed.mocap_quat[:] = data.qpos, data.mocap_pos, data.mocap_quat
        mujoco.mj_kinematics(self._model, placed)
        return np.concatenate([placed.xpos, placed.xquat], axis=1).ravel()

    def _expect_level(self, fallen: int) -> None:
        """Raises InputError for a frame that leans or is lifted; `LEVEL` = none."""
        if fallen == planar.LEVEL:
            return
        raise InputError(
            f"{body_name(self._model, int(self.slice.bodies[fallen]))} leans by more than "
            f"{math.degrees(planar.TILT_BOUND_RAD):g} degrees or stands more than {planar.LIFT_BOUND_M:g} m off its "
            "reference height: expected level motion on the floor, or use the rays of sensing.laser.reference"
        )


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


def _in_view(view_deg: float) -> tuple[int, int]:
    """First and last beam within a view of that width; the beam straight ahead always is."""
    seen = np.flatnonzero(np.abs(ANGLES) <= math.radians(view_deg) / 2.0)
    return int(seen[0]), int(seen[-1])


def _settings_row(parameters: Parameters) -> Floats:
    """(7,) `readings.Settings`, as `readings.settings_of` takes it."""
    settings = readings.Settings(
        noise_m=parameters.range_noise_m,
        resolution_mm=parameters.resolution_mm,
        half_footprint=parameters.footprint_rad / 2.0 / STEP_RAD,
        dropout=parameters.dropout,
        intensity_noise=parameters.intensity_noise,
        mode=MODES.index(parameters.intensity_mode),
        strong_return=parameters.strong_return,
    )
    return np.array(settings, dtype=np.float64)
