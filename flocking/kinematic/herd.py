"""A kinematic herd from Python: who it is made of, where it is, and its simulation piece by piece.

Metres, seconds, radians; world frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np

from flocking import avoidance, selection
from flocking.errors import InputError
from flocking.kinematic import detection, kernel
from flocking.kinematic.arrays import BEARINGS, POSES, Bodies, Limits, Minds, Place, Stages
from flocking.lawentry import Law
from flocking.perception import Step
from flocking.types import Bools, Floats

PIECE_S = 0.2
"""Wall time after which a kernel returns to Python, so that Ctrl-C is heard: well below half a second."""
CLEARANCE = 1e-9
"""Radius of a point as walls know it, in units of their largest coordinate or 1 m: far above rounding, so that nobody
gets through, and far below what matters."""
MOST_DRAWS = 4_000_000
"""Random numbers held at a time."""
MOST_LINKED = 5000
"""Members for which links are kept as a square array."""
DETECTIONS = {member.name.lower().replace("_", "-"): int(member) for member in detection.Detection}
OBSTACLES = ("as-law", "avoid", "virtual-members")
INFORMATION = {"poses": POSES, "bearings": BEARINGS}


class LawFailedError(ValueError):
    """A law gave what it must not; the message names the law, the member and the step in one line."""


@dataclass(frozen=True)
class Space:
    """Where a herd lives. A bounded space is a square of walls, a periodic one has none at its border."""

    kind: str = "unbounded"
    """`unbounded`, `bounded` or `periodic`."""
    size_m: float = math.inf
    """Side of the square [0, size]² of a bounded or periodic space."""
    walls: Floats = field(default_factory=lambda: np.empty((0, 4)))
    """(W, 4) segments x0, y0, x1, y1 in it."""

    def place(self, graph: Bools | None = None) -> Place:
        """As the compiled code takes it. Raises `InputError` for a kind or a size that there is not."""
        if self.kind not in ("unbounded", "bounded", "periodic"):
            raise InputError(f"space {self.kind!r}: expected unbounded, bounded or periodic")
        if self.kind != "unbounded" and not 0.0 < self.size_m < math.inf:
            raise InputError(f"{self.kind} space of side {self.size_m:g} m: expected a finite positive side")
        walls = np.ascontiguousarray(self.walls, dtype=np.float64).reshape(-1, 4)
        if self.kind == "bounded":
            a = self.size_m
            walls = np.vstack([[[0, 0, a, 0], [a, 0, a, a], [a, a, 0, a], [0, a, 0, 0]], walls]).astype(np.float64)
        none = np.empty((0, 0), np.bool_)
        period = float(self.size_m) if self.kind == "periodic" else 0.0
        clearance = CLEARANCE * max(1.0, float(np.abs(walls).max(initial=0.0)))
        return Place(period, walls, clearance, none if graph is None else np.ascontiguousarray(graph, np.bool_), none)


@dataclass(frozen=True)
class Band:
    """Members that run one law."""

    law: Law
    count: int
    parameters: Mapping[str, Any] | Sequence[Mapping[str, Any]] = field(default_factory=dict)
    """The law's, by name: for all members, or one mapping a member (heterogeneous groups)."""
    selection: str = "all"
    """What all of the law's sets select from, or other selections for its sets (`flocking.selection.parse_sets`)."""
    cruise_m_s: float = math.inf
    """Speed towards a way-point; inf = it is reached within the step."""
    max_speed_m_s: float = math.inf
    max_turn_rate_rad_s: float = math.inf
    radius_m: float = 0.0
    """0 = points that nothing touches; else discs that cannot enter one another or a wall."""
    goals_w: Floats | None = None
    """(count, 2); nan = none."""
    role: int = 0
    detection: str = "perfect"
    """`perfect`, `member-based`, `member-extrapolated` or `sensor-based`."""
    information: str = "poses"
    """`poses`, or `bearings`: every input then stands at `assumed_distance_m`."""
    assumed_distance_m: float = 1.0
    silhouette_m: float = 0.165
    """Radius of the members as the detections other than perfect see them."""
    sight_m: float = math.inf
    """Range of those detections, of obstacles and of virtual members."""
    obstacles: str = "as-law"
    """`as-law`; `avoid`: the shared avoidance is added; `virtual-members`: obstacles become members."""
    avoidance: avoidance.Parameters = field(default_factory=avoidance.Parameters)

    def rows(self) -> Floats:
        """(count, P) parameters, checked."""
        given = self.parameters
        if isinstance(given, Mapping):
            row = np.array(self.law.parameters(given), dtype=np.float64)
            return np.tile(row, (self.count, 1))
        if len(given) != self.count:
            raise InputError(f"{len(given)} sets of parameters for {self.count} members of law {self.law.name!r}")
        return np.array([self.law.parameters(one) for one in given], dtype=np.float64).reshape(self.count, -1)

    def stages(self) -> Stages:
        """As the compiled code takes them. Raises `InputError` for what does not fit."""
        names, law = self.law.parameter_names, self.law
        sets = selection.parse_sets(self.selection, law.sets, names)
        for steps in sets:
            if any(chosen.step is Step.VORONOI for chosen in steps[1:]):
                raise InputError(f"law {law.name!r}: in a kinematic herd voronoi must come first in a selection")
        program = selection.program(sets, names)
        for name, value, valid in (
            ("detection", self.detection, DETECTIONS),
            ("information", self.information, INFORMATION),
            ("obstacles", self.obstacles, OBSTACLES),
        ):
            if value not in valid:
                raise InputError(f"{name} = {value!r}: expected {' or '.join(valid)}")
        rows = self.rows()
        reach = max(
            (
                selection.reach(steps, dict(zip(names, row, strict=True)))
                for steps in sets
                for row in np.unique(rows, axis=0)
            ),
            default=math.inf,
        )
        perfect = self.detection == "perfect"
        if self.information == "bearings" or any(s.step is Step.UNOCCLUDED for steps in sets for s in steps[:1]):
            reach = math.inf
        if not perfect:
            reach = min(reach, self.sight_m) + self.silhouette_m
        read = law.needs | selection.needs(chosen for steps in sets for chosen in steps)
        return Stages(
            *program,
            parameters=len(names),
            memory=law.memory,
            reach=float(reach),
            bearings="bearings" in read,
            headings="headings" in read,
            detection=DETECTIONS[self.detection],
            information=INFORMATION[self.information],
            assumed_distance=float(self.assumed_distance_m),
            silhouette=float(self.silhouette_m),
            sight=float(self.sight_m),
            obstacles="obstacles" in law.needs,
            avoids=self.obstacles == "avoid",
            virtual=self.obstacles == "virtual-members",
            look_ahead=float(self.avoidance.look_ahead_m),
            margin=float(self.avoidance.margin_m),
        )


@dataclass(frozen=True)
class History:
    """What a herd of N members did, at T times."""

    times: Floats
    """(T,) s, from 0."""
    positions_w: Floats
    """(T, N, 2); in periodic space within [0, size)."""
    headings_w: Floats
    """(T, N)."""
    velocities_w: Floats
    """(T, N, 2)."""

    @property
    def poses_w(self) -> Floats:
        """(T, N, 3)."""
        return np.concatenate([self.positions_w, self.headings_w[..., None]], axis=2)


def start_uniform(count: int, side_m: float, rng: np.random.Generator) -> Floats:
    """(count, 3) poses drawn uniformly from the square [0, side]² and from all headings."""
    return np.column_stack([rng.uniform(0.0, side_m, (count, 2)), rng.uniform(-math.pi, math.pi, count)])


def simulate(
    bands: Sequence[Band] | Band,
    poses_w: Floats,
    *,
    dt_s: float,
    steps: int,
    rng: np.random.Generator,
    space: Space | None = None,
    speeds_m_s: float | Floats = 0.0,
    velocities_w: Floats | None = None,
    synchronous: bool = True,
    every: int = 1,
    graph: Bools | None = None,
    said: Callable[[int], None] | None = None,
) -> History:
    """Simulates the bands, whose members stand one after the other at `poses_w` (N, 3).

    They start with `speeds_m_s` along their headings, or with `velocities_w` (N, 2). Synchronous: all decide on the
    same state, then all move; otherwise one after the other within each step, in an order drawn anew. Every
    `every`-th step is kept. `graph` (N, N): who is in whose fixed set. `said` is told the steps done after each piece.
    Raises `InputError` for what does not fit and `LawFailedError` if a law fails.
    """
    bands = [bands] if isinstance(bands, Band) else list(bands)
    poses_w = np.asarray(poses_w, dtype=np.float64).reshape(-1, 3)
    count = len(poses_w)
    if count == 0 or sum(band.count for band in bands) != count:
        raise InputError(f"{count} starting poses for {sum(band.count for band in bands)} members")
    if not np.isfinite(poses_w).all() or not 0.0 < dt_s < math.inf or steps < 0 or every < 1:
        raise InputError(f"start, dt_s = {dt_s:g}, steps = {steps}, every = {every}: expected finite and positive")
    run = KinematicHerd(bands, poses_w, space or Space(), graph, dt_s, rng)
    run.start(velocities_w, speeds_m_s)
    frames = steps // every
    tracks = np.empty((frames + 1, count, 5))
    kernel.record(run.bodies, tracks[0])
    done, piece = 0, 1
    while done < steps:
        chunk = min(piece * every, steps - done)
        first = done // every + 1
        started = perf_counter()
        run.advance(chunk, tracks[first : first + chunk // every], every, done, synchronous)
        took = perf_counter() - started
        done += chunk
        if said is not None:
            said(done)
        piece = max(1, min(int(PIECE_S / max(took / chunk, 1e-9)) // every, 4 * piece, run.most_steps // every))
    times = np.arange(frames + 1, dtype=np.float64) * (every * dt_s)
    return History(times, tracks[..., :2].copy(), tracks[..., 2].copy(), tracks[..., 3:].copy())


class KinematicHerd:
    """A herd at work."""

    def __init__(
        self,
        bands: Sequence[Band],
        poses_w: Floats,
        space: Space,
        graph: Bools | None,
        dt: float,
        rng: np.random.Generator,
    ) -> None:
        count = len(poses_w)
        self.bands, self.dt = bands, float(dt)
        # one stream each, so that the number of steps done at a time does not change what is drawn
        self.law_rng, self.order_rng = rng.spawn(2)
        self.stages = [band.stages() for band in bands]
        ends = np.cumsum([band.count for band in bands])
        self.members = [np.arange(end - band.count, end) for band, end in zip(bands, ends, strict=True)]
        self.band_of = np.repeat(np.arange(len(bands)), [band.count for band in bands])
        self.place = space.place(graph)
        self.positions = poses_w[:, :2].copy()
        if self.place.period:
            self.positions %= self.place.period
        steps = [int(step) for stages in self.stages for step in stages.steps.ravel()]
        self.voronoi = Step.VORONOI in steps
        if Step.GRAPH in steps and graph is None:
            raise InputError("selection 'fixed-set' without ids: this herd has no graph; expected fixed-set(0, 3)")
        if (self.voronoi or graph is not None) and count > MOST_LINKED:
            raise InputError(f"{count} members: Voronoi cells and graphs are kept for at most {MOST_LINKED}")
        parameters = np.zeros((count, max(stages.parameters for stages in self.stages)))
        goals = np.full((count, 2), np.nan)
        for band, who in zip(bands, self.members, strict=True):
            parameters[who, : len(band.law.parameter_names)] = band.rows()
            if band.goals_w is not None:
                goals[who] = band.goals_w
        roles = np.repeat(np.array([band.role for band in bands], dtype=np.int64), [band.count for band in bands])
        self.minds = Minds(parameters, goals, roles)
        self.limits = Limits(
            *(
                np.repeat([float(getattr(band, name)) for band in bands], [band.count for band in bands])
                for name in ("cruise_m_s", "max_speed_m_s", "max_turn_rate_rad_s", "radius_m")
            )
        )
        self.bodies = Bodies(
            self.positions,
            poses_w[:, 2].copy(),
            np.zeros((count, 2)),
            np.zeros(count),
            np.zeros((count, 2), np.bool_),
            np.zeros((count, max(stages.memory for stages in self.stages))),
        )
        self.motions = np.zeros((count, 4))
        self.draws = [band.law.draws for band in bands]
        self.most_steps = max(1, MOST_DRAWS // (count * (1 + max(self.draws))))

    def start(self, velocities_w: Floats | None, speeds: float | Floats) -> None:
        """Gives the members their first velocities."""
        if velocities_w is not None:
            self.bodies.velocities[:] = velocities_w
            return
        headings = self.bodies.headings
        self.bodies.velocities[:] = (np.stack([np.cos(headings), np.sin(headings)]) * speeds).T

    def advance(self, steps: int, tracks: Floats, every: int, done: int, synchronous: bool) -> None:
        """So many steps more, after `done`; every `every`-th of them is written to `tracks` (T, N, 5)."""
        if self.voronoi or len(self.bands) > 1:
            for step in range(steps):
                self._tessellate()
                if synchronous:
                    self._together(done + step)
                else:
                    self._in_turn(self.order_rng.random((1, len(self.positions))), self._nothing, 2, done + step)
                if (step + 1) % every == 0:
                    kernel.record(self.bodies, tracks[(step + 1) // every - 1])
        elif synchronous:
            draws = self.law_rng.random((steps, len(self.positions), self.draws[0]))
            code = kernel.synchronous(*self._shared(0), self.members[0], draws, self.dt, self.motions, tracks, every, 0)
            self._check(code, done)
        else:
            self._in_turn(self.order_rng.random((steps, len(self.positions))), tracks, every, done)

    @property
    def _nothing(self) -> Floats:
        """Room for no record."""
        return np.empty((0, len(self.positions), 5))

    def _shared(self, band: int) -> tuple[Any, ...]:
        return (self.bands[band].law.entry, self.stages[band], self.bodies, self.limits, self.minds, self.place)

    def _tessellate(self) -> None:
        if self.voronoi:
            touching = selection.tessellated(self.positions, self.place.period)
            self.place = self.place._replace(tessellated=touching)

    def _together(self, step: int) -> None:
        """One synchronous step of several bands."""
        for band, who in enumerate(self.members):
            draws = self.law_rng.random((1, len(who), self.draws[band]))
            code = kernel.synchronous(*self._shared(band), who, draws, self.dt, self.motions, self._nothing, 2, 1)
            self._check(code, step)
        kernel.move_all(self.bodies, self.limits, self.place, self.dt, self.motions)

    def _in_turn(self, lots: Floats, tracks: Floats, every: int, done: int) -> None:
        """Asynchronous steps in the order of the `lots` (steps, N); of several bands by runs of one band each."""
        order = np.argsort(lots, axis=1)
        if len(self.bands) == 1:
            draws = self.law_rng.random((*order.shape, self.draws[0]))
            code = kernel.asynchronous(*self._shared(0), order, draws, self.dt, self.motions, tracks, every)
            self._check(code, done)
            return
        (turns,) = order
        for run in np.split(turns, np.flatnonzero(np.diff(self.band_of[turns])) + 1):
            band = int(self.band_of[run[0]])
            draws = self.law_rng.random((1, len(run), self.draws[band]))
            turn = np.ascontiguousarray(run[None])
            code = kernel.asynchronous(*self._shared(band), turn, draws, self.dt, self.motions, self._nothing, 2)
            self._check(code, done)

    def _check(self, code: int, done: int) -> None:
        if code < 0:
            return
        step, member = divmod(code, len(self.positions))
        kind, x, y, _ = self.motions[member]
        law = self.bands[int(self.band_of[member])].law
        raise LawFailedError(
            f"law {law.name!r} returned kind {kind:g}, x {x:g}, y {y:g} for member {member + 1} at step "
            f"{done + step + 1}; expected a kind of 0 to 5 and finite numbers"
        )
