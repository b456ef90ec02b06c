"""Stages 3 and 4 of one member of the kinematic herd: whom it selects, what its law decides, and obstacles. Compiled.

Nothing here makes arrays: all is written into the one `Scratch` that the whole herd uses in turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from flocking.avoidance import avoid_in, virtual_members
from flocking.compilation import borrowing, inlined
from flocking.kinematic.arrays import BELOW, COSINE, LEAST, HerdArrays, Minds, Place, Stages
from flocking.kinematic.cells import Cells
from flocking.kinematic.motion import axes_of
from flocking.kinematic.obstacles import obstacles_seen
from flocking.kinematic.sight import Crowd, Focal, Scratch, detected
from flocking.kinematic.views import first, folded
from flocking.obstacle_selection import keep_selected
from flocking.perception import ARGUMENTS, Step, keep, keep_between, keep_cone, keep_within
from flocking.types import ANONYMOUS, Bools, Floats, Ints, Kind


@inlined
def with_virtual(found: int, points: Floats, stages: Stages, room: Scratch) -> int:
    """The set D with a virtual member for each obstacle within their range; returns its size."""
    vx, vy = room.own[0], room.own[1]
    added = virtual_members(points, vx, vy, stages.virtual_range, room.positions[found:], room.virtual_velocities)
    count = found
    for k in range(added):
        ux, uy = room.virtual_velocities[k, 0], room.virtual_velocities[k, 1]
        if stages.headings and ux == 0.0 and uy == 0.0:
            continue
        x, y = room.positions[found + k, 0], room.positions[found + k, 1]
        room.positions[count, 0], room.positions[count, 1] = x, y
        room.bearings[count] = math.atan2(y, x)
        room.headings[count] = math.atan2(uy, ux)
        room.velocities[count, 0], room.velocities[count, 1] = ux, uy
        room.ids[count] = ANONYMOUS
        count += 1
    return count


@borrowing
def links(i: int, found: int, graph: Bools, ids: Ints, linked: Bools) -> None:
    """Writes which inputs are of members that the graph joins to member i."""
    for k in range(found):
        linked[k] = ids[k] >= 0 and graph[i, ids[k]]


@inlined
def select(i: int, found: int, stages: Stages, minds: Minds, place: Place, room: Scratch) -> None:
    """Stage 3: writes the masks of all sets into `room.sets`."""
    if len(place.graph) > 0:
        links(i, found, place.graph, room.ids, room.linked)
    if len(place.tessellated) > 0:
        links(i, found, place.tessellated, room.ids, room.tessellated)
    steps, given, named = stages.steps, stages.given, stages.named
    positions, bearings, ids = room.positions[:found], room.bearings[:found], room.ids[:found]
    linked, tessellated = room.linked[:found], room.tessellated[:found]
    sets, numbers, parameters = room.sets, room.given, minds.parameters
    row = min(i, len(parameters) - 1)
    for set_ in range(steps.shape[0]):
        mask = sets[set_ * found : (set_ + 1) * found]
        for k in range(found):
            mask[k] = True
        for k in range(steps.shape[1]):
            if steps[set_, k] == Step.ALL:
                continue
            for a in range(ARGUMENTS if stages.varied else 0):
                at = named[set_, k, a]
                numbers[a] = parameters[row, at] if at >= 0 else given[set_, k, a]
            own = numbers if stages.varied else given[set_, k]
            step = steps[set_, k]
            if step == Step.DISTANCE_BASED:
                if stages.varied:
                    keep_within(positions, own[0], own[1], mask)
                else:
                    keep_between(room.flat_positions, own[LEAST], own[BELOW], mask)
            elif step == Step.ANGLE and not stages.bearings:
                keep_cone(positions, math.cos(math.radians(own[0])) if stages.varied else own[COSINE], mask)
            else:
                keep(step, own, positions, bearings, ids, linked, tessellated, mask)


@inlined
def know_oneself(focal: Focal, vx: float, vy: float, stages: Stages, herd: HerdArrays, own: Floats) -> None:
    """Writes what the focal member knows of itself, as `flocking.lawentry.packed_own` packs it.

    (vx, vy) is its velocity, world frame.
    """
    i, c, s = focal.id, focal.cosine, focal.sine
    own[0], own[1] = c * vx + s * vy, c * vy - s * vx
    own[2] = herd.bodies.turn_rates[i]
    own[3] = focal.heading
    own[4] = own[5] = math.nan
    if stages.goal:
        gx, gy = herd.minds.goals[i, 0] - focal.x, herd.minds.goals[i, 1] - focal.y
        own[4], own[5] = c * gx + s * gy, c * gy - s * gx
    own[6] = own[7] = 0.0
    if stages.contacts:
        own[6] = 1.0 if herd.bodies.contacts[i, 0] else 0.0
        own[7] = 1.0 if herd.bodies.contacts[i, 1] else 0.0
    own[8] = herd.dt
    own[9] = i
    own[10] = stages.role


@inlined
def decide(
    law: Callable[..., None],
    i: int,
    row: int,
    stages: Stages,
    herd: HerdArrays,
    crowd: Crowd,
    cells: Cells,
    near_walls: int,
    u: Floats,
    room: Scratch,
) -> bool:
    """Stages 2 to 4 of member i; writes its motion to `room.motion`. False if the law returned no valid motion.

    `row` is its row of the crowd; `near_walls` of the walls it may see, as
    `room.near_walls` has them; `u` (DRAWS,) are its random numbers.
    """
    bodies, minds, place = herd.bodies, herd.minds, herd.place
    heading = crowd.headings[row]
    cosine, sine = axes_of(i, heading, herd.axes)
    focal = Focal(i, crowd.positions[row, 0], crowd.positions[row, 1], heading, cosine, sine)
    know_oneself(focal, crowd.velocities[row, 0], crowd.velocities[row, 1], stages, herd, room.own)
    found = detected(focal, stages, crowd, cells, place.period, room)
    blocks = 0
    if stages.obstacles or stages.avoids or stages.virtual:
        blocks = obstacles_seen(
            focal,
            room.walls,
            room.near_walls,
            near_walls,
            # in periodic space nothing is farther away than half the diagonal
            stages.sight if place.period == 0.0 else min(stages.sight, 0.7072 * place.period),
            stages.sight_lines,
            room.obstacles,
        )
        blocks = keep_selected(stages.obstacle_steps, stages.obstacle_given, room.obstacles, blocks)
        if stages.virtual:
            found = with_virtual(found, room.obstacles[:blocks], stages, room)
    if not room.between.only:
        select(i, found, stages, minds, place, room)
    motion = room.motion
    law(
        room.own,
        first(room.positions, found),
        first(room.bearings, found),
        first(room.headings, found),
        first(room.velocities, found),
        first(room.ids, found),
        folded(room.sets, stages.steps.shape[0], found),
        first(room.obstacles, blocks if stages.obstacles else 0),
        first(minds.parameters[min(i, len(minds.parameters) - 1)], stages.parameters),
        first(bodies.memory[i], stages.memory),
        u,
        motion,
    )
    kind = int(motion[0])
    if not 0 <= kind <= 5:
        return False
    if stages.avoids and blocks > 0:
        kind, x, y, _ = avoid_in(
            kind,
            motion[1],
            motion[2],
            room.own[0],
            room.own[1],
            herd.dt,
            first(room.obstacles, blocks),
            stages.look_ahead,
            stages.margin,
            room.ways,
        )
        motion[0], motion[1], motion[2] = kind, x, y
    if kind == Kind.HOLD or kind == Kind.STOP:
        return True
    return abs(motion[1]) + abs(motion[2]) < math.inf
