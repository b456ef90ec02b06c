"""Builds what a running trial needs from its names and numbers, and refuses what does not fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from flocking import lawentry, selection
from flocking.errors import InputError, unknown_name
from flocking.herding.herd import steps_of
from flocking.parameters import declared
from flocking.types import Floats
from robots import body as bodies
from trials.simulations import spread
from trials.simulations.running import fields, script
from trials.streams import Purpose, stream
from trials.types import Trial

GOLDEN = math.pi * (3.0 - math.sqrt(5.0))
"""rad from one creature to the next on Vogel's spiral, which fills a disc evenly."""
MOST_KEPT = 100_000_000
"""Creatures times moments kept."""


@dataclass(frozen=True)
class Start:
    """The herd at the start."""

    positions: Floats
    """(N, 2) m; the first creature, which the user controls, is in the middle."""
    velocities: Floats
    """(N, 2) m/s."""
    parameters: list[dict[str, Any]]
    """Of each creature's law."""


def start_of(trial: Trial) -> Start:
    """The start of a trial's repeat."""
    group, given = fields.group_of(trial), fields.formation_of(trial)
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    places = _ellipse(group.count - given.breakaway, given)
    if given.breakaway:
        behind = _ellipse(given.breakaway, given)
        behind[:, 0] += places[:, 0].min() - behind[:, 0].max() - given.breakaway_m
        places = np.vstack([places, behind])
    places += rng.uniform(-given.jitter_m, given.jitter_m, (group.count, 2))
    usual = dict(group.law_parameters)
    each = [spread.parameters(trial, 0, member, usual) if group.spread else usual for member in range(group.count)]
    return Start(places, np.tile([given.speed_m_s, 0.0], (group.count, 1)), each)


def _ellipse(count: int, given: fields.FormationFields) -> Floats:
    """(count, 2) places spread evenly over an ellipse about the origin, the first in the middle."""
    k = np.arange(count)
    along = given.spacing_m * math.sqrt(count / (math.pi * given.aspect))
    radius, angle = np.sqrt((k + 0.5) / count), k * GOLDEN
    return along * np.column_stack([radius * np.cos(angle), given.aspect * radius * np.sin(angle)])


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`."""
    given, group = fields.of_trial(trial), fields.group_of(trial)
    if trial.world_parameters:
        raise unknown_name("parameter", f"world.{next(iter(trial.world_parameters))}", [])
    formation = fields.formation_of(trial)
    if formation.breakaway >= group.count:
        raise InputError(
            f"formation.breakaway = {formation.breakaway}: expected fewer than {group.name}.count = {group.count}"
        )
    own = fields.of_group(group)
    script.parse(given.script)
    top = bodies.load(own.body).top_speed if own.body != fields.PARTICLES else math.inf
    if formation.speed_m_s > top:
        raise InputError(
            f"formation.speed_m_s = {formation.speed_m_s:g}: expected at most {top:g}, the most of body {own.body!r}"
        )
    if given.settle_s >= given.duration_s:
        raise InputError(
            f"settle_s = {given.settle_s:g}: expected less than duration_s = {given.duration_s:g}, when the trial ends"
        )
    if group.count * given.duration_s / given.every_s > MOST_KEPT:
        raise InputError(f"every_s = {given.every_s:g}: expected more, so that at most {MOST_KEPT} places are kept")
    module = lawentry.module_of(group.law, group.law_source)
    values = lawentry.parameters_of(group.law, module, group.law_parameters, f"{group.name}.law.")._asdict()
    selection.resolved(steps_of(group.law, group.selection, lawentry.sets_of(module), list(values)), values)
    if own.users and "nominal_m_s" not in declared(module.Parameters):
        raise InputError(
            f"{group.name}.users = 1: law {group.law!r} has no nominal_m_s that a user could set; expected users = 0"
        )
    spread.check(trial, 0, group.law_parameters)
