"""What the publication's robots do not meet: other grounds, pushes, weak motors, noise, delay. Off by default.

Hodgins and Brogan 1994, section 5, names them as what its simulation leaves out. They are of bodies with legs: point
masses touch no ground and have no motors.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter, filled
from flocking.types import Floats, Ints
from trials.rows import below
from trials.simulations.running import fields, script
from trials.streams import Purpose, stream
from trials.types import Trial

GROUND, PUSH, IMPERFECTIONS = "ground.", "push.", "imperfections."
"""Prefixes of the keys; the last is of the herd."""
LEFT_OUT = f"{fields.SOURCE}, section 5, leaves it out"
FURTHER = 1.3
"""Times the way that the user's creature is told, for which there is uneven ground. A choice."""
ROUND_M = 25.0
"""m of ground beyond that way and the herd's start. A choice."""
CELLS_A_BUMP, MOST_CELLS = 5, 4000
"""Places from bump to bump whose heights are drawn, and most of them a side: 64 MB."""


class GroundFields(NamedTuple):
    """What the feet meet."""

    friction: Annotated[
        float, Parameter("", f"a choice, of a foot on the ground; slippery: {LEFT_OUT}", low=0.01, high=5.0)
    ] = 1.0
    uneven_m: Annotated[
        float, Parameter("m", f"0: flat. {LEFT_OUT}; standard deviation of its heights", low=0.0, high=1.0)
    ] = 0.0
    bump_m: Annotated[
        float, Parameter("m", "a choice: from bump to bump, about; where it is uneven", low=0.2, high=50.0)
    ] = 2.0


class PushFields(NamedTuple):
    """Pushes against the middle of each robot's body, at random times and in random horizontal directions."""

    impulse_n_s: Annotated[float, Parameter("N s", "0: none; a choice", low=0.0, high=1e4)] = 0.0
    every_s: Annotated[
        float, Parameter("s", "a choice: each robot is pushed once in each such time of the test", low=0.1, high=1e5)
    ] = 10.0


class ImperfectionFields(NamedTuple):
    """Of the motors, and of what the controllers read; noise is normal and new at each step."""

    torque_n_m: Annotated[
        float, Parameter("N m", f"300: the control's own bound. {LEFT_OUT}; most torque at a hinge of the hip", low=0.0)
    ] = 300.0
    velocity_m_s: Annotated[
        float, Parameter("m/s", f"0: none. {LEFT_OUT}; noise of each component of the body's velocity", low=0.0)
    ] = 0.0
    angle_deg: Annotated[
        float, Parameter("deg", f"0: none. {LEFT_OUT}; noise of the body's and of the hip's angles", low=0.0)
    ] = 0.0
    rate_deg_s: Annotated[
        float, Parameter("deg/s", f"0: none. {LEFT_OUT}; noise of the body's and of the hip's turn rates", low=0.0)
    ] = 0.0
    delay_s: Annotated[
        float, Parameter("s", f"0: none. {LEFT_OUT}; from a state to the torques that answer it", low=0.0, high=1.0)
    ] = 0.0


class Pushes(NamedTuple):
    """P pushes in the order of time."""

    steps: Ints
    """(P,) in which step."""
    robots: Ints
    """(P,) whom."""
    impulses_w: Floats
    """(P, 3) N s."""


def ground_of(trial: Trial) -> GroundFields:
    """The ground, with everything filled in. Raises `InputError`."""
    found: GroundFields = filled(GroundFields, below(trial.setup, GROUND), prefix=GROUND)
    return found


def pushes_of(trial: Trial) -> PushFields:
    """Likewise, the pushes."""
    found: PushFields = filled(PushFields, below(trial.setup, PUSH), prefix=PUSH)
    return found


def imperfections_of(trial: Trial) -> ImperfectionFields:
    """Likewise, the imperfections of the herd's robots."""
    group = fields.group_of(trial)
    prefix = f"{group.name}.{IMPERFECTIONS}"
    found: ImperfectionFields = filled(ImperfectionFields, below(group.setup, IMPERFECTIONS), prefix=prefix)
    return found


def check(trial: Trial) -> None:
    """Refuses, with `InputError`, what does not fit: disturbed point masses, and too much uneven ground."""
    given, own = fields.of_trial(trial), fields.of_group(fields.group_of(trial))
    ground, pushes, imperfect = ground_of(trial), pushes_of(trial), imperfections_of(trial)
    if own.body == fields.PARTICLES:
        name = fields.group_of(trial).name
        for prefix, found, kind in (
            (GROUND, ground, GroundFields),
            (PUSH, pushes, PushFields),
            (f"{name}.{IMPERFECTIONS}", imperfect, ImperfectionFields),
        ):
            for key, value in found._asdict().items():
                if value != kind._field_defaults[key]:
                    raise InputError(
                        f"{prefix}{key} = {value:g} does nothing to point masses; expected {name}.body=one-legged"
                    )
    steps = imperfect.delay_s / given.timestep_s
    if abs(steps - round(steps)) > 1e-6:
        raise InputError(
            f"{fields.group_of(trial).name}.{IMPERFECTIONS}delay_s = {imperfect.delay_s:g}: expected a multiple of "
            f"timestep_s, such as {round(steps) * given.timestep_s:g}"
        )
    cells = 2.0 * reach_m(trial) * CELLS_A_BUMP / ground.bump_m
    if ground.uneven_m > 0.0 and cells > MOST_CELLS:
        raise InputError(
            f"{GROUND}bump_m = {ground.bump_m:g}: expected at least {ground.bump_m * cells / MOST_CELLS:.3g} where the "
            f"herd runs for {given.duration_s:g} s, or a shorter duration_s"
        )


def reach_m(trial: Trial) -> float:
    """How far from the origin there is uneven ground, m: as far as the herd can be thought to run, and more."""
    given, start = fields.of_trial(trial), fields.formation_of(trial)
    legs = script.parse(given.script)
    fastest = max(start.speed_m_s, *(leg.speed for leg in legs))
    wide = start.spacing_m * math.sqrt(fields.group_of(trial).count / start.aspect)
    return FURTHER * fastest * given.duration_s + wide + ROUND_M


def built(trial: Trial, module: Any, poses_w: Floats, heights: Floats) -> Any:
    """The robots of a body's `module` of its ground, disturbed as the trial says; see its `build`."""
    ground, imperfect = ground_of(trial), imperfections_of(trial)
    return module.build(
        poses_w,
        heights,
        timestep_s=fields.of_trial(trial).timestep_s,
        surface=module.Surface(ground.friction, ground.uneven_m, ground.bump_m, reach_m(trial)),
        imperfections=module.Imperfections(
            imperfect.torque_n_m,
            imperfect.velocity_m_s,
            math.radians(imperfect.angle_deg),
            math.radians(imperfect.rate_deg_s),
            imperfect.delay_s,
        ),
        rng=stream(trial.seed, trial.repeat, 1, 0, Purpose.WORLD),
    )


def drawn_pushes(trial: Trial) -> Pushes:
    """The pushes of a trial's repeat: each robot's at a random moment of each period of the test."""
    given, pushes, count = fields.of_trial(trial), pushes_of(trial), fields.group_of(trial).count
    periods = math.ceil((given.duration_s - given.settle_s) / pushes.every_s) if pushes.impulse_n_s > 0.0 else 0
    rng = stream(trial.seed, trial.repeat, 1, 0, Purpose.FAILURE)
    times = given.settle_s + pushes.every_s * (np.arange(periods)[:, None] + rng.random((periods, count)))
    angles = 2.0 * np.pi * rng.random((periods, count))
    order = np.argsort(times.ravel(), kind="stable")
    towards = np.column_stack([np.cos(angles.ravel()), np.sin(angles.ravel()), np.zeros(angles.size)])
    return Pushes(
        np.floor(times.ravel()[order] / given.timestep_s).astype(np.int64),
        np.tile(np.arange(count), periods)[order],
        pushes.impulse_n_s * towards[order],
    )
