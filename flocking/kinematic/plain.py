"""The kinematic herd in plain Python and NumPy, one member at a time: tests compare the compiled herd with it.

It has perfect detection, goals, roles, graphs, obstacles with all that the shared stages make of them, ideal and
limited motion, unbounded and periodic space. Walls stop nobody here: tests leave out members that touched one.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking import avoidance, obstacle_selection, selection
from flocking.angles import wrap, wrapped
from flocking.kinematic.arrays import Bodies
from flocking.kinematic.herd import Band
from flocking.tessellation import tessellated
from flocking.types import NO_OBSTACLES, Bools, Floats, Kind, Members, Motion, Obstacles, Own, only


class Surroundings(NamedTuple):
    """What a step has around its N members; world frame."""

    dt_s: float
    period_m: float
    """Side of the periodic square; 0 = the space is not periodic."""
    graph: Bools | None
    """(N, N): who is in whose fixed set."""
    touching: Bools | None
    """(N, N): whose Voronoi cells touch; None if no selection reads it."""
    walls_w: Floats | None
    """(W, 4) segments."""
    forward: bool
    """Whether members move by their old velocity, before they take up the new one."""


class Mind(NamedTuple):
    """What one member decides by."""

    band: Band
    number: int
    """Of the member in its band, from 0."""
    sets: Sequence[Sequence[selection.Chosen]]
    parameters: Any
    """Of its law, as that law's `Parameters`."""


def step(
    bands: Sequence[Band],
    before: Bodies,
    draws: Sequence[Floats],
    dt_s: float,
    period_m: float = 0.0,
    graph: Bools | None = None,
    walls_w: Floats | None = None,
    members: Collection[int] | None = None,
    forward: bool = False,
) -> Bodies:
    """One synchronous step of all bands from the state `before`, which is left as it is.

    `draws`: for each band (count, DRAWS) uniform numbers. Selections may limit the herd by Voronoi cells, which are
    then those of all members. `walls_w` (W, 4) segments, not in periodic space. `members`: who is to take the step,
    None = all; the others stay as they are. `forward` as in `flocking.kinematic.herd.Schedule`.
    """
    after = Bodies._make(array.copy() for array in before)
    first = 0
    parsed = [selection.parse_sets(band.selection, band.law.sets, band.law.parameter_names) for band in bands]
    voronoi = any(chosen.step is selection.Step.VORONOI for sets in parsed for steps in sets for chosen in steps)
    touching = tessellated(before.positions, period_m) if voronoi else None
    around = Surroundings(dt_s, period_m, graph, touching, walls_w, forward)
    for band, sets, numbers in zip(bands, parsed, draws, strict=True):
        for i in range(first, first + band.count):
            if members is not None and i not in members:
                continue
            given = band.parameters if isinstance(band.parameters, Mapping) else band.parameters[i - first]
            mind = Mind(band, i - first, sets, band.law.parameters(given))
            motion = _decided(i, mind, before, after.memory, numbers[i - first], around)
            _move(i, band, motion, before, after, around)
        first += band.count
    return after


def _decided(i: int, mind: Mind, now: Bodies, memory: Floats, u: Floats, around: Surroundings) -> Motion:
    """Stages 2 to 4 of member i; `memory` (N, MEMORY) is written to, `u` (DRAWS,) are its random numbers."""
    band, number, sets, parameters = mind
    dt, period, graph, touching, walls, _ = around
    heading = now.headings[i]
    to_body = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
    others = np.delete(np.arange(len(now.positions)), i)
    offsets = now.positions[others] - now.positions[i]
    if period:
        offsets = offsets - period * np.round(offsets / period)
    positions = offsets @ to_body.T
    members = Members(
        positions,
        np.arctan2(positions[:, 1], positions[:, 0]),
        wrapped(now.headings[others] - heading),
        now.velocities[others] @ to_body.T,
        others.astype(np.int64),
    )
    velocity = to_body @ now.velocities[i]
    obstacles = NO_OBSTACLES
    if walls is not None:
        obstacles = _obstacles(now.positions[i], to_body, walls, band)
    if band.obstacles == "virtual-members":
        members = avoidance.with_virtual_members(members, obstacles, velocity, band.avoidance.virtual_range_m)
        reads = band.law.needs | selection.needs(chosen for steps in sets for chosen in steps)
        if "headings" in reads:
            members = only(members, np.flatnonzero(~np.isnan(members.headings)))
    if graph is not None:
        graph = np.append(graph[i, others], np.zeros(len(members.ids) - len(others), dtype=np.bool_))
    masks = np.ones((len(sets), len(members.ids)), dtype=np.bool_)
    for s, steps in enumerate(sets):
        chosen = selection.resolved(steps, parameters._asdict())
        if chosen and chosen[0].step is selection.Step.VORONOI:
            assert touching is not None
            kept = np.flatnonzero(touching[i, others])
            masks[s] = False
            near = Members._make(column[kept] for column in members)
            masks[s, kept] = selection.select(chosen[1:], near)
        else:
            masks[s] = selection.select(chosen, members, graph)
    goal = np.full(2, math.nan)
    if band.goals_w is not None:
        goal = to_body @ (band.goals_w[number] - now.positions[i])
    own = Own(
        velocity,
        float(now.turn_rates[i]),
        float(heading),
        goal,
        now.contacts[i],
        dt,
        i,
        band.role,
    )
    seen = obstacles if "obstacles" in band.law.needs else NO_OBSTACLES
    motion = band.law.function(own, members, masks, seen, parameters, memory[i, : band.law.memory], u)
    if band.obstacles == "avoid":
        shared = band.avoidance
        kind, x, y, _ = avoidance.avoid(
            int(motion.kind), motion.x, motion.y, *velocity, dt, obstacles.points, shared.look_ahead_m, shared.margin_m
        )
        return Motion(kind, x, y, motion.rule)
    return motion


def _obstacles(position: Floats, to_body: Floats, walls: Floats, band: Band) -> Obstacles:
    """The nearest points of the walls in sight, body frame, as far as the group selects them."""
    starts, ends = walls[:, :2], walls[:, 2:]
    along = ends - starts
    parts = ((position - starts) * along).sum(axis=1) / (along * along).sum(axis=1)
    offsets = starts + np.clip(parts, 0.0, 1.0)[:, None] * along - position
    seen = np.hypot(*offsets.T) <= band.sight_m
    if band.sight_lines:
        seen &= [not any(_cross(position, offset, wall) for wall in walls) for offset in offsets]
    points = offsets[seen] @ to_body.T
    return obstacle_selection.select(obstacle_selection.parse(band.obstacle_selection), Obstacles(points))


def _cross(position: Floats, offset: Floats, wall: Floats) -> bool:
    """Whether the way from a position by an offset, but for its very end, crosses a wall (4,)."""
    along, way = wall[2:] - wall[:2], (1.0 - 1e-9) * offset
    across = way[0] * along[1] - way[1] * along[0]
    if across == 0.0:
        return False
    to_wall = wall[:2] - position
    part = (to_wall[0] * along[1] - to_wall[1] * along[0]) / across
    share = (to_wall[0] * way[1] - to_wall[1] * way[0]) / across
    return bool(0.0 <= part <= 1.0 and 0.0 <= share <= 1.0)


def _move(i: int, band: Band, motion: Motion, now: Bodies, after: Bodies, around: Surroundings) -> None:
    """Stage 5 of member i."""
    dt, period = around.dt_s, around.period_m
    heading, velocity = now.headings[i], now.velocities[i].copy()
    to_world = np.array([[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]])
    given = np.array([motion.x, motion.y])
    turned = heading
    if motion.kind == Kind.STOP:
        velocity[:] = 0.0
    elif motion.kind == Kind.HEADING:
        turned = heading + motion.x
        velocity = motion.y * np.array([math.cos(turned), math.sin(turned)])
    else:
        if motion.kind == Kind.WAY_POINT:
            distance = math.hypot(*given)
            speed = min(distance / dt, band.cruise_m_s)
            velocity = to_world @ (given / distance * speed) if distance > 0.0 else np.zeros(2)
        elif motion.kind == Kind.VELOCITY:
            velocity = to_world @ given
        elif motion.kind == Kind.ACCELERATION:
            velocity = velocity + to_world @ given * dt
        if velocity.any():
            turned = math.atan2(velocity[1], velocity[0])
    speed = math.hypot(*velocity)
    if speed > band.max_speed_m_s:
        velocity = velocity / speed * band.max_speed_m_s
    turn = wrap(turned - heading)
    if abs(turn) > band.max_turn_rate_rad_s * dt:
        turned = heading + math.copysign(band.max_turn_rate_rad_s * dt, turn)
        nose = np.array([math.cos(turned), math.sin(turned)])
        along = float(velocity @ nose)
        backwards = motion.kind == Kind.HEADING and motion.y < 0.0
        velocity = (min(0.0, along) if backwards else max(0.0, along)) * nose
    after.headings[i] = wrap(turned)
    after.turn_rates[i] = wrap(after.headings[i] - heading) / dt
    after.contacts[i] = False
    after.velocities[i] = velocity
    after.positions[i] = now.positions[i] + (now.velocities[i] if around.forward else velocity) * dt
    if period:
        after.positions[i] %= period
