"""Stage 5 of the kinematic herd: from a law's motion to the member's next pose. Compiled.

Ideal members do what they decide within one step; limits of speed and turn rate constrain them (Fine 2015, section
3.3.1: mobility). Velocities are changed before positions (semi-implicit Euler). A wall stops the motion into it and
leaves that along it. Members with a radius cannot enter one another: the step ends at the touch.
"""

from __future__ import annotations

import math

from flocking.angles import wrap
from flocking.compilation import borrowing
from flocking.kinematic.arrays import Bodies, Limits, Place
from flocking.types import Floats, Kind

CLEARANCE = 1e-9
"""Part of a step by which it ends before a wall, and of a wall by which it is longer than drawn: rounding must not carry
a member through, least of all at a corner."""
BOTH_BUMPERS_RAD = math.radians(15.0)
"""A touch this near to the nose presses both bumpers. (choice)"""


@borrowing
def shortest(offset: float, period: float) -> float:
    """An offset in periodic space by the shorter way; as it is where `period` is 0."""
    if abs(offset) > 0.5 * period and period > 0.0:
        return offset - period * math.floor(offset / period + 0.5)
    return offset


@borrowing
def wanted(
    kind: int, x: float, y: float, heading: float, vx: float, vy: float, cruise: float, dt: float
) -> tuple[float, float, float]:
    """Velocity (world) and heading that a motion means, before any limit."""
    c, s = math.cos(heading), math.sin(heading)
    if kind == Kind.STOP:
        return 0.0, 0.0, heading
    if kind == Kind.WAY_POINT:
        distance = math.hypot(x, y)
        if distance == 0.0:
            return 0.0, 0.0, heading
        speed = min(distance / dt, cruise)
        x, y = x / distance * speed, y / distance * speed
        vx, vy = c * x - s * y, s * x + c * y
    elif kind == Kind.VELOCITY:
        vx, vy = c * x - s * y, s * x + c * y
    elif kind == Kind.HEADING:
        heading += x
        return y * math.cos(heading), y * math.sin(heading), heading
    elif kind == Kind.ACCELERATION:
        vx += (c * x - s * y) * dt
        vy += (s * x + c * y) * dt
    if vx != 0.0 or vy != 0.0:
        heading = math.atan2(vy, vx)
    return vx, vy, heading


@borrowing
def within_limits(
    vx: float,
    vy: float,
    heading: float,
    before: float,
    backwards: bool,
    max_speed: float,
    max_turn_rate: float,
    dt: float,
) -> tuple[float, float, float]:
    """The velocity and heading that the body manages: speed first, then turn; what lies across its nose is lost.

    Only a body that is told to go `backwards` does.
    """
    speed = math.hypot(vx, vy)
    if speed > max_speed:
        vx, vy = vx / speed * max_speed, vy / speed * max_speed
    turn = wrap(heading - before)
    most = max_turn_rate * dt
    if abs(turn) > most:
        heading = before + math.copysign(most, turn)
        along = vx * math.cos(heading) + vy * math.sin(heading)
        along = min(0.0, along) if backwards else max(0.0, along)
        vx, vy = along * math.cos(heading), along * math.sin(heading)
    return vx, vy, wrap(heading)


@borrowing
def crossing(x: float, y: float, dx: float, dy: float, wall: Floats) -> float:
    """Part of the step (dx, dy) from (x, y) after which it crosses the wall (4,); 2 if it does not.

    A step that starts on the wall does not cross it: members end their steps at a clearance before it.
    """
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    across = dx * ey - dy * ex
    if across == 0.0:
        return 2.0
    ox, oy = wall[0] - x, wall[1] - y
    part = (ox * ey - oy * ex) / across
    along = (ox * dy - oy * dx) / across
    if 0.0 < part <= 1.0 and -CLEARANCE <= along <= 1.0 + CLEARANCE:
        return part
    return 2.0


@borrowing
def first_crossing(x: float, y: float, dx: float, dy: float, walls: Floats) -> tuple[float, int]:
    """The first wall that a step crosses and where; (2, −1) if none."""
    best, which = 2.0, -1
    for w in range(len(walls)):
        part = crossing(x, y, dx, dy, walls[w])
        if part < best:
            best, which = part, w
    return best, which


@borrowing
def along_walls(x: float, y: float, dx: float, dy: float, walls: Floats) -> tuple[float, float, float, float]:
    """The step that walls leave of (dx, dy), and the direction of the one that was hit first, (0, 0) if none.

    The part beyond a wall goes on along it, as far as the next wall.
    """
    part, which = first_crossing(x, y, dx, dy, walls)
    if which < 0:
        return dx, dy, 0.0, 0.0
    ex, ey = walls[which, 2] - walls[which, 0], walls[which, 3] - walls[which, 1]
    length = math.hypot(ex, ey)
    ex, ey = ex / length, ey / length
    foot = (walls[which, 0] - x) * -ey + (walls[which, 1] - y) * ex
    into = math.copysign(1.0, -dx * ey + dy * ex)
    hit_x, hit_y = -ey * into, ex * into
    step = math.hypot(dx, dy)
    # up to the wall, but for a clearance normal to it
    near = max(0.0, abs(foot) - CLEARANCE * max(1.0, step))
    to_wall = abs(-dx * ey + dy * ex)
    done = min(part, near / to_wall) if to_wall > 0.0 else 0.0
    first_x, first_y = dx * done, dy * done
    rest = (dx * ex + dy * ey) * (1.0 - done)
    slide_x, slide_y = rest * ex, rest * ey
    part, again = first_crossing(x + first_x, y + first_y, slide_x, slide_y, walls)
    if again >= 0:
        scale = max(0.0, part - CLEARANCE)
        if part * abs(rest) <= CLEARANCE * max(1.0, step):
            scale = 0.0
        slide_x, slide_y = slide_x * scale, slide_y * scale
    return first_x + slide_x, first_y + slide_y, hit_x, hit_y


@borrowing
def out_of_walls(x: float, y: float, radius: float, walls: Floats) -> tuple[float, float, float, float]:
    """A disc's centre pushed out of the walls that it overlaps, and the direction of the deepest, (0, 0) if none."""
    hit_x, hit_y, deepest = 0.0, 0.0, 0.0
    for w in range(len(walls)):
        nx, ny = nearest_point(x, y, walls[w])
        ox, oy = x - nx, y - ny
        d = math.hypot(ox, oy)
        if d < radius and d > 0.0:
            if radius - d > deepest:
                deepest, hit_x, hit_y = radius - d, -ox / d, -oy / d
            x, y = nx + ox / d * radius, ny + oy / d * radius
    return x, y, hit_x, hit_y


@borrowing
def nearest_point(x: float, y: float, wall: Floats) -> tuple[float, float]:
    """The point of the wall (4,) that is nearest to (x, y)."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    squared = ex * ex + ey * ey
    if squared == 0.0:
        return wall[0], wall[1]
    part = ((x - wall[0]) * ex + (y - wall[1]) * ey) / squared
    part = min(max(part, 0.0), 1.0)
    return wall[0] + part * ex, wall[1] + part * ey


@borrowing
def until_touch(
    i: int, x: float, y: float, dx: float, dy: float, positions: Floats, limits: Limits, period: float
) -> tuple[float, float, float]:
    """Part of the step after which member i touches another, and the direction of that one; (1, 0, 0) if none."""
    part, hit_x, hit_y = 1.0, 0.0, 0.0
    radius, squared = limits.radii[i], dx * dx + dy * dy
    for j in range(len(positions)):
        if j == i or limits.radii[j] == 0.0:
            continue
        ox = shortest(positions[j, 0] - x, period)
        oy = shortest(positions[j, 1] - y, period)
        reach = radius + limits.radii[j]
        ahead = ox * dx + oy * dy
        if ahead <= 0.0 or squared == 0.0:
            continue
        gap = ox * ox + oy * oy - reach * reach
        root = ahead * ahead - squared * gap
        if root <= 0.0:
            continue
        touch = max(0.0, (ahead - math.sqrt(root)) / squared)
        if touch < part:
            d = math.hypot(ox - dx * touch, oy - dy * touch)
            part = touch
            if d > 0.0:
                hit_x, hit_y = (ox - dx * touch) / d, (oy - dy * touch) / d
            else:
                hit_x, hit_y = dx / math.sqrt(squared), dy / math.sqrt(squared)
    return part, hit_x, hit_y


@borrowing
def press(bodies: Bodies, i: int, hit_x: float, hit_y: float) -> None:
    """Presses the bumpers of member i on the side of a touch in that direction (world)."""
    bearing = wrap(math.atan2(hit_y, hit_x) - bodies.headings[i])
    if abs(bearing) <= math.pi / 2.0:
        if bearing >= -BOTH_BUMPERS_RAD:
            bodies.contacts[i, 0] = True
        if bearing <= BOTH_BUMPERS_RAD:
            bodies.contacts[i, 1] = True


@borrowing
def move(
    i: int, kind: int, x: float, y: float, bodies: Bodies, others: Floats, limits: Limits, place: Place, dt: float
) -> None:
    """Moves member i by one step. `others` (N, 2) are the positions that it may run into."""
    before = bodies.headings[i]
    px, py = bodies.positions[i, 0], bodies.positions[i, 1]
    vx, vy, heading = wanted(kind, x, y, before, bodies.velocities[i, 0], bodies.velocities[i, 1], limits.cruise[i], dt)
    backwards = kind == Kind.HEADING and y < 0.0
    vx, vy, heading = within_limits(
        vx, vy, heading, before, backwards, limits.max_speed[i], limits.max_turn_rate[i], dt
    )
    dx, dy = vx * dt, vy * dt
    bodies.headings[i] = heading
    bodies.turn_rates[i] = wrap(heading - before) / dt
    bodies.contacts[i, 0] = bodies.contacts[i, 1] = False
    solid = limits.radii[i] > 0.0
    if solid:
        part, hit_x, hit_y = until_touch(i, px, py, dx, dy, others, limits, place.period)
        if part < 1.0:
            dx, dy = dx * part, dy * part
            press(bodies, i, hit_x, hit_y)
    if len(place.walls) > 0:
        dx, dy, hit_x, hit_y = along_walls(px, py, dx, dy, place.walls)
        if hit_x != 0.0 or hit_y != 0.0:
            press(bodies, i, hit_x, hit_y)
        if solid:
            nx, ny, hit_x, hit_y = out_of_walls(px + dx, py + dy, limits.radii[i], place.walls)
            if hit_x != 0.0 or hit_y != 0.0:
                press(bodies, i, hit_x, hit_y)
            dx, dy = nx - px, ny - py
    if solid or len(place.walls) > 0:
        vx, vy = dx / dt, dy / dt
    bodies.velocities[i, 0], bodies.velocities[i, 1] = vx, vy
    px, py = px + dx, py + dy
    if place.period > 0.0:
        px, py = px % place.period, py % place.period
    bodies.positions[i, 0], bodies.positions[i, 1] = px, py
