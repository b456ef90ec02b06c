"""The kinematic herd from Python: its start, its schedule, and its simulation in pieces of some 0.2 s of wall time.

Metres, seconds, radians; world frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from types import ModuleType
from typing import NamedTuple

import numpy as np

from flocking.angles import wrapped
from flocking.errors import InputError, StorageError
from flocking.kinematic.arrays import Bodies, HerdArrays, Limits, Minds, Tracks
from flocking.kinematic.bands import Band, Space, check_linked
from flocking.kinematic.failing import Failures
from flocking.perception import Step
from flocking.tessellation import tessellated
from flocking.types import Bools, Floats, Ints, Kind

__all__ = [
    "Band",
    "Failures",
    "History",
    "KinematicHerd",
    "LawFailedError",
    "Progress",
    "Schedule",
    "Space",
    "simulate",
    "start_uniform",
]

PIECE_S = 0.2
"""Wall time after which a kernel returns to Python, so that Ctrl-C is heard: well below half a second."""
MOST_DRAWS = 4_000_000
"""Random numbers held at a time."""
FIRST_LOOKS, FIRST_DECISIONS = 4_000_000, 500
"""Most looks of one member at another, and most decisions, in the first piece, before any time has been taken. The
project's laws need far less than 0.1 s for them, and a law a thousand times as slow half a second."""
FASTER = 4
"""A piece has at most so many times the decisions of the one before."""


class LawFailedError(ValueError):
    """A law raised an error or returned no valid motion; the message names law, member and step in one line."""


@dataclass(frozen=True)
class History:
    """The states of a herd of N members at the T times that were kept; world frame."""

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


class Schedule(NamedTuple):
    """How a simulation goes on: its time step, its length, what is kept of it, and in which order members act."""

    dt_s: float
    steps: int
    every: int = 1
    """One step in so many is kept, and the start."""
    synchronous: bool = True
    """All members decide on the same state and then move; otherwise one after the other within each step, in an order
    drawn anew."""
    forward: bool = False
    """Members move by their old velocity and then take up the new one, as in some publications; otherwise the other way
    round."""

    def checked(self) -> Schedule:
        """Itself, with whole numbers as `int`. Raises `InputError` for numbers that no simulation can have."""
        dt_s, steps, every = self.dt_s, self.steps, self.every
        if not 0.0 < dt_s < math.inf or steps < 0 or every < 1 or steps % 1 or every % 1:
            raise InputError(
                f"dt_s = {dt_s:g}, steps = {steps}, every = {every}: expected a finite positive time, and whole "
                "numbers of at least 0 and 1"
            )
        return self._replace(steps=int(steps), every=int(every))


class Progress(NamedTuple):
    """How others learn how far a simulation has come."""

    said: Callable[[int], None] | None = None
    """Is told the steps done after each piece of work."""
    turn: Ints | None = None
    """(3,) is written to: the steps done before a piece, the step in it and the member at work, all from 0."""


def start_uniform(count: int, side_m: float, rng: np.random.Generator) -> Floats:
    """(count, 3) poses drawn uniformly from the square [0, side]² and from all headings."""
    return np.column_stack([rng.uniform(0.0, side_m, (count, 2)), rng.uniform(-math.pi, math.pi, count)])


def simulate(
    bands: Sequence[Band] | Band,
    poses_w: Floats,
    schedule: Schedule,
    *,
    rng: np.random.Generator,
    space: Space | None = None,
    speeds_m_s: float | Floats = 0.0,
    velocities_w: Floats | None = None,
    graph: Bools | None = None,
    progress: Progress | None = None,
    failures: Failures | None = None,
) -> History:
    """Simulates the bands, whose members start at `poses_w` (N, 3), one band after the other.

    They start with `speeds_m_s` along their headings, or with `velocities_w` (N, 2). `graph` (N, N): who is in whose
    fixed set. Raises `InputError` for what does not fit and `LawFailedError` if a law fails. Of `failures`, the steps
    of members that fail in the middle of others are written to it.
    """
    bands = [bands] if isinstance(bands, Band) else list(bands)
    dt_s, steps, every, synchronous, forward = schedule.checked()
    said, turn = progress or Progress()
    run = KinematicHerd(bands, poses_w, space or Space(), graph, dt_s, rng, turn, forward)
    run.start(velocities_w, speeds_m_s)
    run.failures = failures
    tracks = np.empty((steps // every + 1, len(run.positions), 5))
    _kernel().record(run.bodies, tracks[0])
    run.advance(steps, tracks[1:], every, 0, synchronous, said)
    times = np.arange(len(tracks), dtype=np.float64) * (every * dt_s)
    return History(times, tracks[..., :2].copy(), tracks[..., 2].copy(), tracks[..., 3:].copy())


def _kernel() -> ModuleType:
    """The compiled loop. Its import compiles it, which takes a minute where this machine has not done so yet."""
    from flocking.kinematic import kernel

    return kernel


def _starting(poses_w: Floats, count: int, space: Space) -> Floats:
    """The poses of `count` members at the start, checked, their headings wrapped, inside of the space's walls."""
    poses_w = np.array(poses_w, dtype=np.float64)
    if poses_w.shape != (count, 3) or count == 0:
        raise InputError(f"starting poses of shape {poses_w.shape} for {count} members; expected ({count}, 3)")
    if not np.isfinite(poses_w).all():
        raise InputError(f"starting pose {_first_not_finite(poses_w)} is not finite; expected x, y, heading")
    poses_w[:, 2] = wrapped(poses_w[:, 2])
    places = poses_w[:, :2]
    if space.kind == "periodic":
        places %= space.size_m
        places[places >= space.size_m] = 0.0  # what the remainder makes of the smallest negative numbers
    if space.kind == "bounded":
        outside = np.flatnonzero(((places < 0.0) | (places > space.size_m)).any(axis=1))
        if len(outside):
            x, y = places[outside[0]]
            raise InputError(
                f"member {outside[0] + 1} starts at {x:g}, {y:g}, outside of the bounded space; "
                f"expected 0 to {space.size_m:g} m"
            )
        clearance = space.clearance_m
        np.clip(places, clearance, space.size_m - clearance, out=places)
    return poses_w


def _first_not_finite(rows: Floats) -> int:
    return int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]) + 1


class KinematicHerd:
    """A herd that is being simulated: its arrays, its random numbers, and how much work a piece may hold."""

    def __init__(
        self,
        bands: Sequence[Band],
        poses_w: Floats,
        space: Space,
        graph: Bools | None,
        dt: float,
        rng: np.random.Generator,
        turn: Ints | None = None,
        forward: bool = False,
    ) -> None:
        count = sum(band.checked().count for band in bands)
        self.bands = bands
        place = space.place(graph, count)
        poses_w = _starting(poses_w, count, space)
        # one stream each, so that the number of steps done at a time does not change what is drawn
        self.law_rng, self.order_rng = rng.spawn(2)
        self.stages = [band.stages() for band in bands]
        ends = np.cumsum([band.count for band in bands])
        self.members = [np.arange(end - band.count, end) for band, end in zip(bands, ends, strict=True)]
        self.band_of = np.repeat(np.arange(len(bands)), [band.count for band in bands])
        self.positions = poses_w[:, :2].copy()
        steps = [int(step) for stages in self.stages for step in stages.steps.ravel()]
        self.voronoi = Step.VORONOI in steps
        if Step.GRAPH in steps and graph is None:
            raise InputError(
                "selection 'fixed-set' without ids: this herd has no graph; "
                "expected one (simulate(graph=...)) or fixed-set(0, 3)"
            )
        if self.voronoi or graph is not None:
            check_linked(count)
        parameters = np.zeros((count, max(stages.parameters for stages in self.stages)))
        goals = np.full((count, 2), np.nan)
        for band, who in zip(bands, self.members, strict=True):
            parameters[who, : len(band.law.parameter_names)] = band.rows()
            if band.goals_w is not None:
                goals[who] = band.goals_w
        if len(bands) == 1 and isinstance(bands[0].parameters, Mapping):
            parameters = parameters[:1].copy()
        minds = Minds(parameters, goals)
        limits = Limits(
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
        motions, axes = np.zeros((count, 4)), np.full((count, 3), np.nan)
        self.arrays = HerdArrays(self.bodies, limits, minds, place, float(dt), motions, forward, axes)
        self.draws = [band.law.draws for band in bands]
        self.most_steps = max(1, MOST_DRAWS // (count * (1 + max(self.draws))))
        self.pace = max(1, min(FIRST_DECISIONS, FIRST_LOOKS // count))
        self.turn = np.zeros(3, np.int64) if turn is None else turn
        self.failures: Failures | None = None
        self.working = np.ones(count, np.bool_)

    def start(self, velocities_w: Floats | None, speeds: float | Floats) -> None:
        """Gives the members their first velocities."""
        headings, count = self.bodies.headings, len(self.positions)
        if velocities_w is None:
            speeds = np.asarray(speeds, dtype=np.float64)
            if speeds.shape not in ((), (count,)):
                raise InputError(f"speeds of shape {speeds.shape} for {count} members; expected one, or one each")
            if not np.isfinite(speeds).all():
                raise InputError(f"a starting speed is {speeds[~np.isfinite(speeds)].flat[0]:g}; expected finite ones")
            velocities_w = (np.stack([np.cos(headings), np.sin(headings)]) * speeds).T
        given = np.asarray(velocities_w, dtype=np.float64)
        if given.shape != (count, 2):
            raise InputError(f"velocities of shape {given.shape} for {count} members; expected ({count}, 2)")
        if not np.isfinite(given).all():
            raise InputError(f"the starting velocity of member {_first_not_finite(given)} is not finite")
        self.bodies.velocities[:] = given

    def advance(
        self,
        steps: int,
        tracks: Floats,
        every: int,
        done: int,
        synchronous: bool,
        said: Callable[[int], None] | None = None,
    ) -> None:
        """Does so many steps more, after `done`, and writes every `every`-th of them to `tracks` (T, N, 5).

        The kernel returns to Python after some `PIECE_S`, even within a step; `said` is told the steps done after each
        piece.
        """
        first, end, count = done - done % every, done + steps, len(self.positions)
        while done < end:
            self._tessellate()
            self._fail(done)
            if len(self.bands) > 1 or self.voronoi or self.pace < count or not self.working.any():
                if synchronous:
                    self._together(done)
                else:
                    self._in_turn(done)
                done += 1
                if done % every == 0:
                    _kernel().record(self.bodies, tracks[(done - first) // every - 1])
            else:
                piece = min(end - done, self.pace // count, self.most_steps)
                if self.failures is not None:
                    piece = min(piece, self.failures.until_next(done))
                kept = Tracks(tracks, every, done - first)
                if synchronous:
                    draws = self.law_rng.random((piece, count, self.draws[0]))
                    who, draws = self._of_working(self.members[0], draws)
                    self._run(_kernel().synchronous, 0, who, draws, kept, done, (0,))
                else:
                    order = np.argsort(self.order_rng.random((piece, count)), axis=1)
                    order = np.ascontiguousarray(order[self.working[order]].reshape(piece, -1))
                    draws = self.law_rng.random((*order.shape, self.draws[0]))
                    self._run(_kernel().asynchronous, 0, order, draws, kept, done)
                done += piece
            if said is not None:
                said(done)

    def _together(self, step: int) -> None:
        """One synchronous step, of several bands or in parts."""
        for band, who in enumerate(self.members):
            first = 0
            while first < len(who):
                part = who[first : first + self.pace]
                draws = self.law_rng.random((1, len(part), self.draws[band]))
                first += len(part)
                part, draws = self._of_working(part, draws)
                if len(part):
                    self._run(_kernel().synchronous, band, part, draws, self._nothing, step, (1,))
        _kernel().move_all(self.arrays, np.empty_like(self.positions))

    def _of_working(self, who: Ints, draws: Floats) -> tuple[Ints, Floats]:
        """Those of the members that have not failed, and their draws (steps, n, DRAWS)."""
        works = self.working[who]
        return (who, draws) if works.all() else (who[works], np.ascontiguousarray(draws[:, works]))

    def _fail(self, step: int) -> None:
        """Lets those members stand, from now on, that fail at the begin of this step."""
        if self.failures is None:
            return
        failed = self.failures.due(step, self.working, self.positions)
        self.working[failed] = False
        self.arrays.motions[failed] = (float(Kind.STOP), 0.0, 0.0, 0.0)
        self.bodies.velocities[failed] = 0.0
        self.bodies.turn_rates[failed] = 0.0

    def _in_turn(self, step: int) -> None:
        """One asynchronous step in an order drawn anew, by runs of one band each or in parts."""
        turns = np.argsort(self.order_rng.random(len(self.positions)))
        turns = turns[self.working[turns]]
        if len(turns) == 0:
            return
        for run in np.split(turns, np.flatnonzero(np.diff(self.band_of[turns])) + 1):
            band, first = int(self.band_of[run[0]]), 0
            block = _kernel().part_of(len(self.positions), self.stages[band].reach)
            while first < len(run):
                part = np.ascontiguousarray(run[None, first : first + max(1, self.pace // block) * block])
                draws = self.law_rng.random((1, part.shape[1], self.draws[band]))
                self._run(_kernel().asynchronous, band, part, draws, self._nothing, step)
                first += part.shape[1]

    @property
    def _nothing(self) -> Tracks:
        """Keeps no step of a piece of one: `advance` records the step once all parts of it are done."""
        return Tracks(np.empty((0, len(self.positions), 5)), 2, 0)

    def _tessellate(self) -> None:
        if self.voronoi:
            place = self.arrays.place
            place = place._replace(tessellated=tessellated(self.positions, place.period))
            self.arrays = self.arrays._replace(place=place)

    def _run(
        self,
        work: Callable[..., int],
        band: int,
        who: Ints,
        draws: Floats,
        tracks: Tracks,
        done: int,
        more: tuple[int, ...] = (),
    ) -> None:
        """One piece of work of the kernel. Raises `LawFailedError` if the law fails in it."""
        law, started = self.bands[band].law, perf_counter()
        raised, self.turn[0] = "", done
        try:
            failed = work(law.entry, self.stages[band], self.arrays, who, draws, tracks, self.turn[1:], *more)
        except StorageError:
            raise
        except Exception as error:  # whatever a law of the user's may raise
            failed, raised = 1, " ".join(f"{type(error).__name__}: {error}".split())
        if failed:
            step, member = self.turn[1:].tolist()
            kind, x, y, _ = self.arrays.motions[member]
            what = f"raised {raised}" if raised else f"returned kind {kind:g}, x {x:g}, y {y:g}"
            expected = "" if raised else "; expected a kind of 0 to 5 and finite numbers"
            raise LawFailedError(f"law {law.name!r} {what} for member {member + 1} at step {done + step + 1}{expected}")
        decided = draws.shape[0] * draws.shape[1]
        pace = PIECE_S * decided / max(perf_counter() - started, 1e-9)
        self.pace = max(1, min(int(pace), FASTER * max(decided, self.pace)))
