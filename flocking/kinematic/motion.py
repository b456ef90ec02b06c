"""Stage 5 of the kinematic herd: from a law's motion to the member's next pose. Compiled.

Ideal members do what they decide within one step; limits of speed and turn rate constrain them (Fine 2015, section
3.3.1: mobility). Velocities are changed before positions (semi-implicit Euler), or, in herds that update `forward`, as
some publications do, positions by the old velocities first. A wall stops the motion into it and leaves that along it.
Members with a radius cannot enter one another: the step ends at the touch.
"""

from __future__ import annotations

import math

from flocking.angles import wrap
from flocking.compilation import borrowing, inlined
from flocking.kinematic.arrays import Bodies, HerdArrays, Limits, Place
from flocking.kinematic.walls import until_touch, until_wall
from flocking.types import Floats, Kind

MOST_TURNS = 4
"""Most walls that one step may turn along; what is left of the step after the last is lost."""
BOTH_BUMPERS_RAD = math.radians(15.0)
"""A touch this near to the nose presses both bumpers. (choice)"""


@borrowing
def axes_of(i: int, heading: float, axes: Floats) -> tuple[float, float]:
    """Cosine and sine of the heading of member i, out of `axes` where they are known; else `axes` has them then."""
    if axes[i, 0] != heading:
        axes[i, 0], axes[i, 1], axes[i, 2] = heading, math.cos(heading), math.sin(heading)
    return axes[i, 1], axes[i, 2]


@borrowing
def wanted(
    i: int, kind: int, x: float, y: float, vx: float, vy: float, heading: float, axes: Floats, cruise: float, dt: float
) -> tuple[float, float, float]:
    """Velocity (world) and heading that a motion of member i means, before any limit."""
    if kind == Kind.STOP:
        return 0.0, 0.0, heading
    if kind == Kind.HEADING:
        heading += x
        c, s = axes_of(i, heading, axes)
        return y * c, y * s, heading
    c, s = axes_of(i, heading, axes)
    if kind == Kind.WAY_POINT:
        distance = math.sqrt(x * x + y * y)
        if distance == 0.0:
            return 0.0, 0.0, heading
        speed = min(distance / dt, cruise)
        x, y = x / distance * speed, y / distance * speed
        vx, vy = c * x - s * y, s * x + c * y
    elif kind == Kind.VELOCITY:
        vx, vy = c * x - s * y, s * x + c * y
    elif kind == Kind.ACCELERATION:
        vx += (c * x - s * y) * dt
        vy += (s * x + c * y) * dt
    if vx != 0.0 or vy != 0.0:
        heading = math.atan2(vy, vx)
    return vx, vy, heading


@borrowing
def within_limits(
    i: int,
    vx: float,
    vy: float,
    heading: float,
    axes: Floats,
    before: float,
    backwards: bool,
    max_speed: float,
    max_turn_rate: float,
    dt: float,
) -> tuple[float, float, float]:
    """The velocity and heading that the body manages: speed first, then turn; what lies across its nose is lost.

    Only a body that is told to go `backwards` does.
    """
    speed = math.sqrt(vx * vx + vy * vy)
    if speed > max_speed:
        vx, vy = vx / speed * max_speed, vy / speed * max_speed
    turn = wrap(heading - before)
    most = max_turn_rate * dt
    if abs(turn) > most:
        heading = before + math.copysign(most, turn)
        c, s = axes_of(i, heading, axes)
        along = vx * c + vy * s
        along = min(0.0, along) if backwards else max(0.0, along)
        vx, vy = along * c, along * s
    return vx, vy, wrap(heading)


@borrowing
def press(bodies: Bodies, i: int, hit_x: float, hit_y: float) -> None:
    """Presses the bumpers of member i on the side of a touch in that direction (world)."""
    bearing = wrap(math.atan2(hit_y, hit_x) - bodies.headings[i])
    if abs(bearing) <= math.pi / 2.0:
        if bearing >= -BOTH_BUMPERS_RAD:
            bodies.contacts[i, 0] = True
        if bearing <= BOTH_BUMPERS_RAD:
            bodies.contacts[i, 1] = True


@inlined
def stopped(
    i: int, x: float, y: float, dx: float, dy: float, bodies: Bodies, others: Floats, limits: Limits, place: Place
) -> tuple[float, float]:
    """Where a step from (x, y) ends: before another member, along walls. Presses the bumpers that touch."""
    radius = limits.radii[i]
    for _ in range(MOST_TURNS):
        part, away_x, away_y, depth = until_wall(x, y, dx, dy, max(radius, place.clearance), place.walls)
        if radius > 0.0:
            touch, hit_x, hit_y = until_touch(i, x, y, dx, dy, others, limits, place.period)
            if touch <= part and touch <= 1.0:
                press(bodies, i, hit_x, hit_y)
                return x + touch * dx, y + touch * dy
        if part > 1.0:
            return x + dx, y + dy
        press(bodies, i, -away_x, -away_y)
        # a member that rounding left too near the wall is put back; one that started too near must move away itself
        out = min(depth, 0.5 * place.clearance) if depth <= place.clearance else 0.0
        x, y = x + part * dx + out * away_x, y + part * dy + out * away_y
        into = dx * away_x + dy * away_y
        dx, dy = (1.0 - part) * (dx - into * away_x), (1.0 - part) * (dy - into * away_y)
    return x, y


@borrowing
def within(x: float, period: float) -> float:
    """A coordinate brought into [0, period); as it is where `period` is 0."""
    if period > 0.0:
        x = x % period
        if x >= period:
            return 0.0
    return x


@inlined
def displace(i: int, herd: HerdArrays, others: Floats) -> None:
    """Moves member i by its velocity for one step; what stops it stops its velocity too."""
    bodies, limits, place, dt = herd.bodies, herd.limits, herd.place, herd.dt
    px, py = bodies.positions[i, 0], bodies.positions[i, 1]
    vx, vy = bodies.velocities[i, 0], bodies.velocities[i, 1]
    if limits.radii[i] > 0.0 or len(place.walls) > 0:
        nx, ny = stopped(i, px, py, vx * dt, vy * dt, bodies, others, limits, place)
        bodies.velocities[i, 0], bodies.velocities[i, 1] = (nx - px) / dt, (ny - py) / dt
    else:
        nx, ny = px + vx * dt, py + vy * dt
    bodies.positions[i, 0], bodies.positions[i, 1] = within(nx, place.period), within(ny, place.period)


@inlined
def move(i: int, herd: HerdArrays, others: Floats) -> None:
    """Moves member i by one step, as it decided. `others` (N, 2) are the positions that it may run into."""
    bodies, limits, dt = herd.bodies, herd.limits, herd.dt
    kind, x, y = int(herd.motions[i, 0]), herd.motions[i, 1], herd.motions[i, 2]
    before = bodies.headings[i]
    bodies.contacts[i, 0] = bodies.contacts[i, 1] = False
    if herd.forward:
        displace(i, herd, others)
    vx, vy, axes = bodies.velocities[i, 0], bodies.velocities[i, 1], herd.axes
    vx, vy, heading = wanted(i, kind, x, y, vx, vy, before, axes, limits.cruise[i], dt)
    backwards = kind == Kind.HEADING and y < 0.0
    vx, vy, heading = within_limits(
        i, vx, vy, heading, axes, before, backwards, limits.max_speed[i], limits.max_turn_rate[i], dt
    )
    bodies.headings[i] = heading
    bodies.turn_rates[i] = wrap(heading - before) / dt
    bodies.velocities[i, 0], bodies.velocities[i, 1] = vx, vy
    if not herd.forward:
        displace(i, herd, others)
