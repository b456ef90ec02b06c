"""One plain law asked with its own selections, and a kinematic herd that runs it. For the tests of laws of biology."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from flocking import lawentry, selection
from flocking.kinematic import Band, History, Schedule, Space, simulate, start_uniform
from flocking.types import NO_OBSTACLES, Floats, Members, Motion, Own

EXACT = 1e-12
"""m, rad; closed forms of a few operations on numbers below 100 leave rounding of some 1e-14."""
FAR = 1e6
"""m; a goal so far away is a direction: members move less than 1e-3 of it."""


def decide(
    name: str,
    positions: Sequence[Sequence[float]] | Floats,
    *,
    velocities: Sequence[Sequence[float]] | None = None,
    headings: Sequence[float] | None = None,
    goal: Sequence[float] = (math.nan, math.nan),
    compass: float = 0.0,
    role: int = 0,
    dt: float = 0.2,
    u: float = 0.3,
    **parameters: float,
) -> Motion:
    """One call of the plain law, its own selections made from all members."""
    law = lawentry.load(name)
    places = np.array(positions, dtype=np.float64).reshape(-1, 2)
    count = len(places)
    members = Members(
        places,
        np.arctan2(places[:, 1], places[:, 0]),
        np.full(count, math.nan) if headings is None else np.array(headings, dtype=np.float64),
        np.full((count, 2), math.nan) if velocities is None else np.array(velocities, dtype=np.float64),
        np.arange(count),
    )
    given = law.parameters(parameters)
    steps = selection.parse_sets("all", law.sets, law.parameter_names)
    masks = np.array([selection.select(selection.resolved(one, given._asdict()), members) for one in steps])
    own = Own(np.zeros(2), 0.0, compass, np.array(goal, dtype=np.float64), np.zeros(2, dtype=bool), dt, 99, role)
    return law.function(own, members, masks, NO_OBSTACLES, given, np.zeros(law.memory), np.full(law.draws, u))


def moved(motion: Motion) -> Floats:
    return np.array([motion.x, motion.y])


def rule(name: str, motion: Motion) -> str:
    return lawentry.load(name).rules[motion.rule]


def herd(
    name: str,
    starts: Floats,
    steps: int,
    *,
    seed: int = 0,
    dt: float = 1.0,
    speed: float = 0.0,
    selection_text: str = "all",
    goals: Floats | None = None,
    space: Space | None = None,
    **parameters: float,
) -> History:
    band = Band(lawentry.load(name), len(starts), parameters, selection=selection_text, goals_w=goals)
    rng = np.random.default_rng([seed, 1])
    return simulate(band, starts, Schedule(dt, steps), rng=rng, speeds_m_s=speed, space=space)


def square(count: int, side: float, seed: int) -> Floats:
    return start_uniform(count, side, np.random.default_rng([seed, 0]))
