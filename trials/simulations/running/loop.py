"""Runs a herd behind its user's creature, looks by looks, and measures it."""

from __future__ import annotations

import dataclasses
import importlib
import math
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from flocking import lawentry
from flocking.errors import InputError
from flocking.herding import HerdMind, MovingHerd
from flocking.herding.loop import Touching, no_touching
from flocking.kinematic.herd import LawFailedError
from flocking.parameters import declared
from flocking.types import Floats
from robots import body as bodies
from robots.physics import DivergedError
from trials.simulations import watch
from trials.simulations.contract import StoppedError
from trials.simulations.running import disturbances, fields, herd, script
from trials.simulations.running.creatures import Creatures, Legged, Particles
from trials.simulations.running.measures import measure
from trials.streams import Purpose, stream
from trials.types import Contacts, Trial, TrialResult, no_updates

MOST_TOUCHES = 100_000
"""Collisions that are kept; later ones are only counted."""
HIGHEST_DROP_M = 0.3
"""Bodies with legs start so high above the ground at the most, so that they do not hop in step. A choice."""
CORNERS = 32
"""Of the obstacle as it is drawn."""


class Ran(NamedTuple):
    """What a run left."""

    times: Floats
    """(T,) s."""
    poses_w: Floats
    """(T, N, 3)."""
    disc: Floats
    """(0, 3) or (1, 3) x, y and radius of the obstacle."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    A law that gives what it must not, and physics that diverge, end the trial: `outcome` is then `failed`, `reason`
    says why, and only the start is kept; with `reraise` the error is raised instead. Raises `InputError` for a trial
    that cannot be set up.
    """
    began = perf_counter()
    herd.check(trial)
    creatures = built(trial)
    touching = no_touching(len(creatures.mind.there), fields.of_trial(trial).collision_m, MOST_TOUCHES)
    ran, outcome, reason = Ran(np.zeros(1), creatures.poses()[None], np.empty((0, 3))), "done", ""
    ready = perf_counter()
    try:
        with watch.watched():
            ran = run(trial, creatures, touching)
    except (LawFailedError, DivergedError) as error:
        if reraise:
            raise
        outcome, reason = "failed", " ".join(str(error).split())
    finished = perf_counter()
    result = result_of(trial, creatures, touching, ran, outcome, reason)
    found = measure(result, int(touching.found[0]), float(touching.closest[0])) if outcome == "done" else {}
    timing = {"build_s": ready - began, "loop_s": finished - ready}
    return dataclasses.replace(result, measures=found, timing=timing)


def built(trial: Trial) -> Creatures:
    """The creatures of a trial at their start. Raises `InputError`."""
    given, group = fields.of_trial(trial), fields.group_of(trial)
    own, start = fields.of_group(group), herd.start_of(trial)
    law = lawentry.load(group.law, group.law_source)
    if given.obstacle_radius_m > 0.0 and "obstacle_radius_m" in declared(law.module.Parameters):
        for parameters in start.parameters:  # the creatures are told how large it is
            parameters.setdefault("obstacle_radius_m", given.obstacle_radius_m)
    kind = MovingHerd if own.body == fields.PARTICLES else HerdMind
    roles = np.arange(group.count) < own.users
    mind = kind(
        law,
        start.positions,
        start.velocities,
        start.parameters,
        text=group.selection,
        roles=roles.astype(np.int64),
        tells=own.velocities == fields.DESIRED,
    )
    if isinstance(mind, MovingHerd):
        return Particles(mind, given.timestep_s)
    rng = stream(trial.seed, trial.repeat, 1, 0, Purpose.PHASE)
    ground = importlib.import_module(fields.ground_of(bodies.load(own.body).name))
    if given.timestep_s > ground.one_legged.TIMESTEP + 1e-12:
        raise InputError(f"timestep_s = {given.timestep_s:g}: expected less with body {own.body!r}")
    poses_w = np.column_stack([mind.herd.positions, mind.herd.headings])
    heights = rng.uniform(0.0, HIGHEST_DROP_M, group.count)
    robots = disturbances.built(trial, ground, poses_w, heights)
    return Legged(mind, robots, given.timestep_s, disturbances.drawn_pushes(trial))


def run(
    trial: Trial,
    creatures: Creatures,
    touching: Touching,
    kept: Callable[[], None] | None = None,
    told: Callable[[float], script.Leg] | None = None,
) -> Ran:
    """Runs all steps of a trial; `kept` is called at each moment that is kept.

    `told`: asked at every look, with the time (s), how the user's creature is to run in place of the trial's script;
    the run ends where it raises `StoppedError`. Raises `LawFailedError` and `DivergedError`.
    """
    given, group = fields.of_trial(trial), fields.group_of(trial)
    own, mind, dt = fields.of_group(group), creatures.mind, given.timestep_s
    count, steps, legs = group.count, fields.steps_of(trial), script.parse(given.script)
    law_rng = stream(trial.seed, trial.repeat, 1, 0, Purpose.LAW)
    error_rng = stream(trial.seed, trial.repeat, 1, 0, Purpose.RANGE_NOISE)
    every, begins = max(1, round(given.every_s / dt)), round(given.settle_s / dt)
    changes = {begins + round(leg.from_s / dt): leg for leg in legs}
    ends = sorted({*range(0, steps, given.refresh_steps), *range(0, steps, every), *changes, steps})
    ends = [end for end in ends if end <= steps]
    times, poses_w, disc = [], [], np.empty((0, 3))
    leg = legs[0]
    for step, end in zip(ends, [*ends[1:], steps], strict=True):
        if told is None:
            leg = changes.get(step, leg) if step >= begins else legs[0]
        elif step % given.refresh_steps == 0:
            try:
                leg = told(step * dt)
            except StoppedError:
                steps = step
        if own.users:
            mind.send(0, np.array([leg.x_m_s, leg.y_m_s]))
        if step == begins:
            touching.found[0], touching.closest[0] = 0, math.inf
            if given.obstacle_radius_m > 0.0:
                disc = _disc(mind, leg, given)
                mind.herd = mind.herd._replace(discs=disc)
        if step % every == 0 or step == steps:
            times.append(step * dt)
            poses_w.append(creatures.poses())
            if kept is not None:
                kept()
        if step == steps:
            break
        if step % given.refresh_steps == 0:
            mind.look(*_errors(own, count, error_rng))
        creatures.advance(step, law_rng.random((end - step, count, mind.law.draws)), touching)
        watch.breathe()
    return Ran(np.array(times), np.array(poses_w), disc)


def _errors(own: fields.GroupFields, count: int, rng: np.random.Generator) -> tuple[Floats | None, Floats | None]:
    """How far each creature errs about each other's place and velocity until the next look; None = not at all."""
    place, velocity = own.place_error_m, own.velocity_error_m_s
    return (
        place * rng.standard_normal((count, count, 2)) if place > 0.0 else None,
        velocity * rng.standard_normal((count, count, 2)) if velocity > 0.0 else None,
    )


def _disc(mind: HerdMind, leg: script.Leg, given: fields.TrialFields) -> Floats:
    """(1, 3) where the obstacle appears: ahead of the herd's centre, where the user's creature is told to run."""
    ahead = np.array([leg.x_m_s, leg.y_m_s]) / max(leg.speed, 1e-9)
    centre = mind.herd.positions[mind.there].mean(axis=0)
    return np.array([[*(centre + given.obstacle_ahead_m * ahead), given.obstacle_radius_m]])


def result_of(
    trial: Trial, creatures: Creatures, touching: Touching, ran: Ran, outcome: str, reason: str
) -> TrialResult:
    """What a run has left, not measured yet."""
    group, given = fields.group_of(trial), fields.of_trial(trial)
    count, kept = group.count, min(int(touching.found[0]), MOST_TOUCHES)
    poses_w = ran.poses_w.copy()
    poses_w[..., 2] = np.unwrap(poses_w[..., 2], axis=0)
    return TrialResult(
        trial=trial,
        times=ran.times,
        poses_w=poses_w,
        odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), np.bool_),
        robot_names=tuple(f"{group.name}-{k + 1}" for k in range(count)),
        radii=np.full(count, given.collision_m / 2.0),
        rules=(),
        walls_w=_outline(ran.disc),
        period_m=math.nan,
        updates=no_updates(count),
        contacts=Contacts(
            touching.times[:kept].copy(),
            touching.pairs[:kept, 0].copy(),
            touching.pairs[:kept, 1].copy(),
            touching.places[:kept].copy(),
        ),
        scans=None,
        measures={},
        outcome=outcome,
        reason=reason,
        timing={},
        tables={"obstacle": ran.disc, "fallen_s": creatures.fallen_at, "causes": np.array(creatures.causes)},
    )


def _outline(disc: Floats) -> Floats:
    """(W, 4) the obstacle as a polygon's sides."""
    if len(disc) == 0:
        return np.empty((0, 4))
    x, y, radius = disc[0]
    angles = np.linspace(0.0, 2.0 * math.pi, CORNERS + 1)
    corners = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
    return np.hstack([corners[:-1], corners[1:]])
