"""A herd that decides by those whom it sees, from Python: point masses (`MovingHerd`), or the minds of bodies that move
otherwise (`HerdMind`). Metres, seconds, radians; world frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from flocking import selection
from flocking.errors import InputError, StorageError
from flocking.herding import loop
from flocking.herding.loop import Herd, Mood, Touching
from flocking.herding.pointer import address_of
from flocking.herding.sight import look
from flocking.kinematic.herd import LawFailedError
from flocking.lawentry import Law
from flocking.perception import ARGUMENTS, Step
from flocking.types import Bools, Floats, Ints

__all__ = ["HerdMind", "Mood", "MovingHerd"]

NOT_HERE = (Step.GRAPH, Step.FIXED_SET, Step.VORONOI)
"""Selections by links, which these herds have not."""


def steps_of(law: str, text: str, sets: Mapping[str, str], names: Sequence[str]) -> list[selection.Chosen]:
    """The steps by which a herd's members see others: those of the law's only set, limited by `text`.

    Raises `InputError` for a law of several sets, and for a selection by ids, graphs or Voronoi cells.
    """
    if len(sets) != 1:
        raise InputError(f"law {law!r} has {len(sets)} sets of neighbours; expected a law with one, as hodgins-brogan")
    steps = selection.parse_sets(text, sets, names)[0]
    if any(chosen.step in NOT_HERE for chosen in steps):
        raise InputError(f"law {law!r}, selection {text!r}: expected none of fixed-set and voronoi here")
    return steps


class HerdMind:
    """The minds of N members under one law: whom each sees, and what it decides.

    `herd` holds all arrays; whoever moves the members writes their `positions` and their `actual` velocities.
    """

    HAVE_DYNAMICS = True
    """Whether actual velocities are others than the desired ones."""

    def __init__(
        self,
        law: Law,
        positions: Floats,
        velocities: Floats,
        parameters: Sequence[Mapping[str, Any]],
        *,
        text: str = "all",
        roles: Ints | None = None,
        tells: bool = True,
        discs: Floats | None = None,
        sight_m: float = math.inf,
    ) -> None:
        """`positions` and `velocities` (N, 2) at the start, which are the desired velocities too; `parameters`: the
        law's, one mapping a member; `text`: a selection that limits the law's; `tells`: members are told of one
        another's desired velocities, else of the actual ones (`Herd.tells`); `discs` (K, 3) x, y and radius of
        obstacles.

        Raises `InputError` for what does not fit.
        """
        positions = np.array(positions, dtype=np.float64)
        count = len(positions)
        if positions.shape != (count, 2) or count == 0 or not np.isfinite(positions).all():
            raise InputError(f"positions of shape {positions.shape}: expected (N, 2) finite numbers, N at least 1")
        if np.shape(velocities) != (count, 2) or len(parameters) != count:
            raise InputError(f"{np.shape(velocities)} velocities and {len(parameters)} sets of parameters for {count}")
        self.law, names = law, law.parameter_names
        self.entry = address_of(law.entry)
        steps = steps_of(law.name, text, law.sets, names)
        rows = [law.parameters(given) for given in parameters]
        resolved = [selection.resolved(steps, row._asdict()) for row in rows]
        self.steps = np.array([int(chosen.step) for chosen in steps], dtype=np.int64)
        self.given = np.full((count, len(steps), ARGUMENTS), np.nan)
        for i, own in enumerate(resolved):
            for k, (_, numbers) in enumerate(own):
                self.given[i, k, : len(numbers)] = numbers
        mood = Mood(
            np.array(rows, dtype=np.float64).reshape(count, -1),
            np.zeros(count, np.int64) if roles is None else np.array(roles, dtype=np.int64),
            np.full((count, 2), np.nan),
            np.zeros((count, law.memory)),
        )
        desired = np.array(velocities, dtype=np.float64)
        self.there = np.ones(count, np.bool_)
        self.turn = np.zeros(2, np.int64)
        self.herd = Herd(
            positions,
            desired.copy() if self.HAVE_DYNAMICS else desired,
            desired,
            np.arctan2(desired[:, 1], desired[:, 0]),
            np.full((count, 3), np.nan),
            np.zeros((count, 4)),
            mood,
            np.zeros((count, count), np.int64),
            np.zeros(count, np.int64),
            np.empty((0, 0, 2)),
            np.empty((0, 0, 2)),
            np.empty((0, 3)) if discs is None else np.array(discs, dtype=np.float64).reshape(-1, 3),
            float(sight_m),
            "bearings" in law.needs,
            "headings" in law.needs,
            tells and self.HAVE_DYNAMICS,
        )

    def look(self, place_errors: Floats | None = None, velocity_errors: Floats | None = None) -> None:
        """Every member looks whom it sees; until the next look it errs by the given (N, N, 2) about them, m and m/s.

        Only those are seen who are `there` (N,).
        """
        none = np.empty((0, 0, 2))
        self.herd = self.herd._replace(
            place_errors=none if place_errors is None else np.ascontiguousarray(place_errors, np.float64),
            velocity_errors=none if velocity_errors is None else np.ascontiguousarray(velocity_errors, np.float64),
        )
        herd = self.herd
        look(
            self.steps, self.given, herd.positions, herd.headings, self.there, herd.place_errors, herd.seen, herd.counts
        )

    def send(self, member: int, velocity: Floats) -> None:
        """Gives a member that the user controls the velocity (2,) in m/s that it is nominally to have.

        Its law reads the way of it as its goal's direction, and its amount as the parameter `nominal_m_s`.
        """
        at = self.law.parameter_names.index("nominal_m_s")
        speed = math.hypot(velocity[0], velocity[1])
        self.herd.mood.parameters[member, at] = speed
        self.herd.mood.ways[member] = np.array(velocity) / speed if speed > 0.0 else math.nan

    def decide(self, who: Bools, draws: Floats, dt: float, step: int = 0) -> None:
        """Members `who` (N,) decide by those whom they saw last; `draws` (N, DRAWS). `step`: for messages, from 0.

        Raises `LawFailedError`.
        """
        self._run(partial(loop.decide, self.entry, self.herd, who, draws, dt, self.turn), step)

    def touches(self, touching: Touching, time: float) -> None:
        """Notes who has come within the distance of whom, of those who are there."""
        loop.touches(self.herd, self.there, touching, time)

    def _run(self, work: Callable[[], int], step: int) -> None:
        """A piece of work of compiled code. Raises `LawFailedError` if the law fails in it."""
        raised, self.turn[:] = "", 0
        try:
            failed = work()
        except StorageError:
            raise
        except Exception as error:  # whatever a law of the user's may raise
            failed, raised = 1, " ".join(f"{type(error).__name__}: {error}".split())
        if failed:
            at, member = self.turn.tolist()
            kind, x, y, _ = self.herd.motions[member]
            what = f"raised {raised}" if raised else f"returned kind {kind:g}, x {x:g}, y {y:g}"
            expected = "" if raised else "; expected a kind of 0 to 5 and finite numbers"
            raise LawFailedError(
                f"law {self.law.name!r} {what} for member {member + 1} at step {step + at + 1}{expected}"
            )


class MovingHerd(HerdMind):
    """Point masses: they move with the velocity that they decided on, from the next step on, without any limit."""

    HAVE_DYNAMICS = False

    def advance(self, draws: Floats, step: int, dt: float, touching: Touching, noted_every: int = 1) -> None:
        """Steps after so many, `draws` (steps, N, DRAWS); touches are noted after every so many. Raises
        `LawFailedError`."""
        run = partial(loop.advance, self.entry, self.herd, draws, step, noted_every, dt, touching, self.turn)
        self._run(run, step)
