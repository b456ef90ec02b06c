"""Small worlds in which any law can be asked, and what it is to move, turn and mirror them. For the contract tests."""

from __future__ import annotations

import math
from functools import cache
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from flocking import selection
from flocking.lawentry import OF_MEMBERS, Law, load
from flocking.types import ANONYMOUS, Bools, Floats, Ints, Kind, Members, Motion, Obstacles, Own

EVERYTHING = OF_MEMBERS | {"compass", "goal", "contacts", "obstacles"}
CREATE_SPACING_M, CREATE_SPEED_M_S, CREATE_DT_S = 1.0, 0.25, 0.1


class World(NamedTuple):
    """N members and K obstacles, world frame; member 0 is the focal one."""

    positions: Floats
    headings: Floats
    velocities: Floats
    turn_rates: Floats
    goals: Floats
    """(N, 2); nan = none."""
    contacts: Bools
    """(N, 2) left, right."""
    roles: Ints
    ids: Ints
    obstacles: Floats
    graph: Bools
    u: Floats
    """(DRAWS,) of the focal member."""


class Scene(NamedTuple):
    """A world, and the numbers with which a law is asked in it."""

    world: World
    parameters: Any
    spacing_m: float
    dt_s: float


class Inputs(NamedTuple):
    """What a law is called with, but for its memory."""

    own: Own
    members: Members
    sets: Bools
    obstacles: Obstacles
    parameters: Any
    u: Floats


def scenes(law: Law) -> tuple[Scene, ...]:
    """Worlds at the scale of the publication, and as many at that of Creates: sparse, dense, alone, at rest."""
    return _scenes(law.name)


@cache
def _scenes(name: str, count: int = 18) -> tuple[Scene, ...]:
    law = load(name)
    rng = np.random.default_rng(7)
    herd = law.herd
    settings = (
        (law.parameters({}), herd.spacing_m, herd.speed_m_s, herd.dt_s),
        (law.parameters(law.create), CREATE_SPACING_M, CREATE_SPEED_M_S, CREATE_DT_S),
    )
    made = []
    for parameters, spacing_m, speed_m_s, dt_s in settings:
        for k in range(count):
            world = _world(rng, law.draws, int(rng.integers(2, 11)), spacing_m * (0.3, 1.0, 2.0)[k % 3], speed_m_s)
            if k % 6 == 5:
                world = world._replace(velocities=np.zeros_like(world.velocities))
            made.append(Scene(world, parameters, spacing_m, dt_s))
        for others in (0, 1, 1):
            world = _world(rng, law.draws, 1 + others, spacing_m, speed_m_s)
            made.append(Scene(world, parameters, spacing_m, dt_s))
    return tuple(made)


def _world(rng: np.random.Generator, draws: int, count: int, spacing_m: float, speed_m_s: float) -> World:
    side = spacing_m * math.sqrt(count)
    headings = rng.uniform(-math.pi, math.pi, count)
    courses = headings + rng.normal(0.0, 0.3, count)  # nobody moves exactly where the body points
    speeds = speed_m_s * rng.uniform(0.2, 1.5, count)
    goals = rng.uniform(-2.0 * side, 3.0 * side, (count, 2))
    goals[rng.random(count) < 0.5] = np.nan
    graph = np.triu(rng.random((count, count)) < 0.6, 1)
    return World(
        positions=rng.uniform(0.0, side, (count, 2)),
        headings=headings,
        velocities=speeds[:, None] * np.stack([np.cos(courses), np.sin(courses)], axis=1),
        turn_rates=rng.uniform(-0.5, 0.5, count),
        goals=goals,
        contacts=rng.random((count, 2)) < 0.3,
        roles=rng.integers(0, 2, count),
        ids=rng.permutation(count).astype(np.int64),
        obstacles=rng.uniform(0.0, side, (int(rng.integers(0, 4)), 2)),
        graph=graph | graph.T,
        u=rng.random(draws),
    )


def transformed(world: World, matrix: Floats, shift: Floats) -> World:
    """The world seen after x -> matrix x + shift, a rotation or a reflection. A reflection mirrors the draws."""
    reflects = np.linalg.det(matrix) < 0.0
    noses = np.stack([np.cos(world.headings), np.sin(world.headings)], axis=1) @ matrix.T
    return world._replace(
        positions=world.positions @ matrix.T + shift,
        headings=np.arctan2(noses[:, 1], noses[:, 0]),
        velocities=world.velocities @ matrix.T,
        turn_rates=-world.turn_rates if reflects else world.turn_rates,
        goals=world.goals @ matrix.T + shift,
        contacts=world.contacts[:, ::-1].copy() if reflects else world.contacts,
        obstacles=world.obstacles @ matrix.T + shift,
        u=1.0 - world.u if reflects else world.u,
    )


def inputs(law: Law, scene: Scene, world: World | None = None, known: frozenset[str] | None = None) -> Inputs:
    """What the focal member of the scene's world (or of `world`) knows.

    `known`: what it is told; by default what the law says that it needs. What it is not told is nan, −1 or nothing.
    """
    known = law.needs if known is None else known
    if world is not None and world is not scene.world:
        return _told(law, scene, world, known)
    key = law.name, id(scene), known
    if key not in _of_scenes:
        _of_scenes[key] = scene, _told(law, scene, scene.world, known)
    own, members, sets, obstacles, parameters, u = _of_scenes[key][1]
    return Inputs(
        own._replace(velocity=own.velocity.copy(), goal=own.goal.copy(), contacts=own.contacts.copy()),
        Members._make(column.copy() for column in members),
        sets.copy(),
        Obstacles(obstacles.points.copy()),
        parameters,
        u.copy(),
    )


_of_scenes: dict[tuple[str, int, frozenset[str]], tuple[Scene, Inputs]] = {}
"""What is known in a scene's own world, which test after test asks for; with the scene, whose identity is the key."""


def _told(law: Law, scene: Scene, world: World, known: frozenset[str]) -> Inputs:
    heading = float(world.headings[0])
    others = np.arange(1, len(world.positions))
    positions = _in_body(world.positions[others] - world.positions[0], heading)
    all_known = Members(
        positions,
        np.arctan2(positions[:, 1], positions[:, 0]),
        (world.headings[others] - heading + math.pi) % (2.0 * math.pi) - math.pi,
        _in_body(world.velocities[others], heading),
        world.ids[others],
    )
    linked = np.ascontiguousarray(world.graph[0, 1:])
    steps = _steps(law.name)
    values = scene.parameters._asdict()
    sets = [selection.select(selection.resolved(each, values), all_known, linked) for each in steps]
    told = {name: value for name, value in zip(Members._fields, all_known, strict=True) if name in known}
    nobody = {
        "positions": np.full((len(others), 2), np.nan),
        "bearings": np.full(len(others), np.nan),
        "headings": np.full(len(others), np.nan),
        "velocities": np.full((len(others), 2), np.nan),
        "ids": np.full(len(others), ANONYMOUS, dtype=np.int64),
    }
    own = Own(
        velocity=_in_body(world.velocities[:1], heading)[0],
        turn_rate=float(world.turn_rates[0]),
        compass=heading if "compass" in known else math.nan,
        goal=_in_body(world.goals[:1] - world.positions[0], heading)[0] if "goal" in known else np.full(2, np.nan),
        contacts=world.contacts[0].copy() if "contacts" in known else np.zeros(2, dtype=np.bool_),
        dt=scene.dt_s,
        id=int(world.ids[0]),
        role=int(world.roles[0]),
    )
    points = world.obstacles if "obstacles" in known else np.empty((0, 2))
    return Inputs(
        own,
        Members(**{**nobody, **told}),
        np.array(sets, dtype=np.bool_).reshape(len(steps), len(others)),
        Obstacles(_in_body(points - world.positions[0], heading)),
        scene.parameters,
        world.u,
    )


@cache
def _steps(name: str) -> tuple[tuple[selection.Chosen, ...], ...]:
    law = load(name)
    return tuple(map(tuple, selection.parse_sets("all", law.sets, law.parameter_names)))


def _in_body(vectors: Floats, heading: float) -> Floats:
    """World vectors (M, 2) in the axes of a body that points to `heading`."""
    c, s = math.cos(heading), math.sin(heading)
    return np.stack([c * vectors[:, 0] + s * vectors[:, 1], -s * vectors[:, 0] + c * vectors[:, 1]], axis=1)


def ask(law: Law, given: Inputs, memory: Floats | None = None, plain: bool = False) -> Motion:
    """The law's decision; `memory` is written to, zeros if None."""
    call = uncompiled(law.function) if plain else law.decide
    memory = np.zeros(law.memory) if memory is None else memory
    kind, x, y, rule = call(*given[:5], memory, given.u)
    return Motion(int(kind), float(x), float(y), int(rule))


_uncompiled: dict[FunctionType, FunctionType] = {}


def uncompiled(function: Any) -> FunctionType:
    """The function as it is written, and so all of ours that it calls: nothing of it is compiled."""
    written: FunctionType = getattr(function, "py_func", function)
    if written not in _uncompiled:
        known = dict(written.__globals__)
        _uncompiled[written] = FunctionType(written.__code__, known, written.__name__, written.__defaults__)
        for name in written.__code__.co_names:
            if name in known:
                known[name] = _as_written(known[name])
    return _uncompiled[written]


def _as_written(value: Any) -> Any:
    """A function of ours, or all those of a module of ours, uncompiled; anything else as it is."""
    if isinstance(value, ModuleType) and value.__name__.startswith("flocking."):
        return SimpleNamespace(**{name: _as_written(part) for name, part in vars(value).items()})
    return uncompiled(value) if hasattr(value, "py_func") else value


class Moved(NamedTuple):
    """A motion in the world: a vector that turns with it and a speed that does not."""

    kind: int
    rule: int
    vector: Floats
    """Way to the way-point, velocity, acceleration, or the unit vector of the heading."""
    speed: float


def in_world(motion: Motion, heading: float) -> Moved:
    """A motion decided by a body that points to `heading`."""
    c, s = math.cos(heading), math.sin(heading)
    if motion.kind in (Kind.HOLD, Kind.STOP):
        return Moved(motion.kind, motion.rule, np.zeros(2), 0.0)
    if motion.kind == Kind.HEADING:
        turned = heading + motion.x
        return Moved(motion.kind, motion.rule, np.array([math.cos(turned), math.sin(turned)]), motion.y)
    return Moved(motion.kind, motion.rule, np.array([c * motion.x - s * motion.y, s * motion.x + c * motion.y]), 0.0)
