"""One law asked once, and a herd of members that all run one law. For the tests of single laws."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking import lawentry
from flocking.kinematic.herd import Band, History, Schedule, Space, simulate
from flocking.selection import parse_sets, resolved, select
from flocking.types import Floats, Members, Motion, Obstacles, Own


def ask(
    name: str,
    positions: object = (),
    headings: object = 0.0,
    velocities: object = (0.0, 0.0),
    ids: object = None,
    *,
    own_velocity: tuple[float, float] = (0.0, 0.0),
    goal: tuple[float, float] = (math.nan, math.nan),
    contacts: tuple[bool, bool] = (False, False),
    turn_rate: float = 0.0,
    dt: float = 0.1,
    own_id: int = 0,
    obstacles: object = (),
    u: object = 0.5,
    memory: Floats | None = None,
    **given: Any,
) -> tuple[Motion, str]:
    """What the law, not compiled, decides with its own sets, and the name of the rule that spoke."""
    law = lawentry.load(name)
    places = np.array(positions, dtype=float).reshape(-1, 2)
    count = len(places)
    members = Members(
        places,
        np.arctan2(places[:, 1], places[:, 0]),
        np.broadcast_to(np.array(headings, dtype=float), count).copy(),
        np.broadcast_to(np.array(velocities, dtype=float), (count, 2)).copy(),
        np.arange(1, count + 1) if ids is None else np.array(ids, dtype=np.int64),
    )
    parameters = law.parameters(given)
    steps = parse_sets("all", law.sets, law.parameter_names)
    sets = np.array([select(resolved(each, parameters._asdict()), members) for each in steps])
    own = Own(
        np.array(own_velocity, dtype=float), turn_rate, math.nan, np.array(goal), np.array(contacts), dt, own_id, 0
    )
    motion = law.function(
        own,
        members,
        sets.reshape(len(steps), count),
        Obstacles(np.array(obstacles, dtype=float).reshape(-1, 2)),
        parameters,
        np.zeros(law.memory) if memory is None else memory,
        np.broadcast_to(np.array(u, dtype=float), law.draws),
    )
    return motion, law.rules[motion.rule]


def run(
    name: str,
    poses: Floats,
    *,
    steps: int,
    dt: float,
    given: dict[str, Any] | None = None,
    speed: float = 0.0,
    space: Space | None = None,
    every: int = 1,
    seed: int = 0,
    **band: Any,
) -> History:
    return simulate(
        Band(lawentry.load(name), len(poses), given or {}, **band),
        poses,
        Schedule(dt, steps, every),
        rng=np.random.default_rng(seed),
        space=space,
        speeds_m_s=speed,
    )
