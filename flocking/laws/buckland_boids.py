"""Boids of a book on games: walls, obstacles and a predator first, then separation, alignment, cohesion and wandering.

Source: Buckland 2005 (Programming Game AI by Example, chapter 3) and the source code that comes with it, with its
defaults, as Kirchner 2006 used it (section 3.3): half a disc of sight ahead, 100 px/s. A pixel is `pixel_m`: 1 ft of
robots is 38.1 px. Metres and seconds outside, Buckland's pixels inside; unit mass, body frame, x ahead.

Each behaviour is a force in px/s², times its weight and the tweaker. They are added in the order of their priority
until the strongest force is reached; of the one that goes beyond, as much is added as is left. With v the own velocity,
s the top speed, and p and u the place and the velocity of another:

1. wall: three feelers, ahead and half as long at 45 degrees to either side; the normal of the wall that is crossed
   first, times how far that feeler reaches through it.
2. obstacle: of the discs ahead that a box as wide as the body would meet, the first: away from it to the side, stronger
   the nearer, and a fifth of a brake.
3. evade: s (away from p + u |p| / (s + |u|)) - v for each threat.
4. separation: the sum of the vectors away from each flockmate, divided by the square of its distance.
5. alignment: the flockmates' mean heading vector minus the own one.
6. cohesion: the unit vector of s (towards the flockmates' centre) - v.
7. wander: a point on a circle ahead that moves at random.

Memory: the point on the circle. Reads positions, velocities, headings of members at rest, and obstacles. Who is a
threat, and who a disc, is a matter of selection: by default nobody is. They are no flockmates.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import direction, length_of, limited, unit, unit_or_ahead
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities", "headings", "obstacles"})
RULES = ("wander", "wall", "obstacle", "evade", "flock")
NOBODY = "distance-based(0, 0)"
SEEN = "distance-based(0, view_m) & angle(sight_deg)"
SETS = {"flockmates": SEEN, "threats": NOBODY, "discs": NOBODY}
FLOCKMATES, THREATS, DISCS = range(3)
MEMORY, DRAWS = 2, 2
SIDEWAYS = math.sqrt(0.5)
"""Cosine and sine of the angle of the outer feelers, 45 degrees."""
BRAKE = 0.2
"""Buckland: the weight of the brake before an obstacle."""

BOOK = "Buckland 2005, the defaults of its code"
THESIS = "Kirchner 2006, section 3.3"


class Parameters(NamedTuple):
    """Of Buckland's boids, with the limits of Kirchner's robots."""

    view_m: Annotated[
        float,
        Parameter("m", f"{THESIS}: 201 px, 305 of the camera less 104 of a safety bubble", published=True, low=0.0),
    ] = 1.608
    sight_deg: Annotated[float, Parameter("deg", f"{THESIS}: to either side", published=True, low=0.0, high=180.0)] = (
        90.0
    )
    top_speed_m_s: Annotated[float, Parameter("m/s", f"{THESIS}: 100 px/s", published=True, low=0.0)] = 0.8
    turn_rate_rad_s: Annotated[
        float, Parameter("rad/s", f"{THESIS}; 0 = none: nothing obeys it in the book's code", published=True, low=0.0)
    ] = 2.0
    pixel_m: Annotated[float, Parameter("m", f"{THESIS}: 1 ft is 38.1 px", published=True, low=1e-6)] = 0.008
    tweaker: Annotated[float, Parameter("px/s²", f"{BOOK}: of all forces", published=True, low=0.0)] = 200.0
    strongest: Annotated[float, Parameter("", f"{BOOK}: the strongest force", published=True, low=0.0)] = 2.0
    wall_weight: Annotated[float, Parameter("1/px", BOOK, published=True, low=0.0)] = 10.0
    obstacle_weight: Annotated[float, Parameter("1/px", BOOK, published=True, low=0.0)] = 10.0
    evade_weight: Annotated[float, Parameter("s/px", BOOK, published=True, low=0.0)] = 0.01
    separation_weight: Annotated[float, Parameter("px", BOOK, published=True, low=0.0)] = 1.0
    alignment_weight: Annotated[float, Parameter("", BOOK, published=True, low=0.0)] = 1.0
    cohesion_weight: Annotated[float, Parameter("", BOOK, published=True, low=0.0)] = 2.0
    wander_weight: Annotated[float, Parameter("1/px", BOOK, published=True, low=0.0)] = 1.0
    feeler_px: Annotated[float, Parameter("px", f"{BOOK}: of the longest feeler", published=True, low=0.0)] = 40.0
    box_px: Annotated[
        float,
        Parameter("px", f"{BOOK}: how far ahead obstacles count at rest; twice at top speed", published=True, low=1e-6),
    ] = 40.0
    body_px: Annotated[float, Parameter("px", f"{BOOK}: radius of a vehicle", published=True, low=0.0)] = 3.0
    disc_px: Annotated[float, Parameter("px", f"radius of a disc; {BOOK}: 10 to 30", low=0.0)] = 20.0
    wander_radius_px: Annotated[float, Parameter("px", f"{BOOK}: of the circle", published=True, low=1e-6)] = 1.2
    wander_distance_px: Annotated[float, Parameter("px", f"{BOOK}: of the circle", published=True, low=0.0)] = 2.0
    wander_jitter_px_s: Annotated[
        float, Parameter("px/s", f"{BOOK}: most that the point moves along an axis", published=True, low=0.0)
    ] = 80.0


FILLED = (
    Filled(
        "neighbour selection",
        "the thesis relaxes 220 degrees of sight to half a disc, whose border it does not tell",
        "the border, exactly beside it, is not seen",
    ),
    Filled(
        "motion computation",
        "the book pushes to its left before any obstacle, on whichever side that is",
        "away from the obstacle's middle, by what the radii of both leave of the way to the side",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "the book's last feeler decides how strong the push off a wall is, even where another met it",
        "the feeler that meets the nearest wall; the push is mostly the strongest force either way",
        misprint=True,
    ),
    Filled(
        "sensing",
        "feelers cross walls, of which a member here knows the nearest points",
        "each wall is the straight line through its nearest point, across the way there",
    ),
    Filled(
        "physical motion",
        "the thesis sets a turn rate in the book's code, in which nothing obeys it",
        "it is obeyed (0 = as in the code): what lies across the nose is lost, and who is pushed back goes on turning "
        "to the side to which it turns, or it would stand before a wall for ever",
    ),
)
TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", False, True, True, True)
VALIDATION = Validation("S", True, "global", "global", "global", "bounded obstacles")
NO_ROW = "Fine 2015 does not have it: another reading of Reynolds 1987, which Kirchner 2006 took for his simulation"
HERD = Herd(spacing_m=0.8, speed_m_s=0.8, dt_s=1.0 / 30.0)
CREATE = {"view_m": 3.0, "top_speed_m_s": 0.25, "pixel_m": 0.06, "tweaker": 3.0, "feeler_px": 15.0}
"""Ten pixels, at which two keep from one another, are then 0.6 m."""


@compiled
def added(x: float, y: float, more_x: float, more_y: float, most: float) -> tuple[float, float]:
    """(x, y) and as much of the force (more_x, more_y) as keeps their lengths' sum within `most`."""
    left = most - length_of(x, y)
    if left <= 0.0:
        return x, y
    length = length_of(more_x, more_y)
    if length < left:
        return x + more_x, y + more_y
    return x + more_x / length * left, y + more_y / length * left


@compiled
def off_walls(points: Floats, pixel: float, feeler: float) -> tuple[float, float]:
    """Normal of the wall that a feeler crosses first, times how far that feeler reaches through it, px; or (0, 0)."""
    nearest, push_x, push_y = math.inf, 0.0, 0.0
    for k in range(len(points)):
        x, y = points[k, 0] / pixel, points[k, 1] / pixel
        d = length_of(x, y)
        if d == 0.0:
            continue
        nx, ny = x / d, y / d
        for f in range(3):
            tip = feeler if f == 0 else 0.5 * feeler
            along = nx if f == 0 else SIDEWAYS * (nx + ny if f == 1 else nx - ny)
            if tip * along > d and d / along < nearest:
                nearest = d / along
                push_x, push_y = -nx * (tip - nearest), -ny * (tip - nearest)
    return push_x, push_y


@compiled
def off_discs(
    positions: Floats, discs: Bools, pixel: float, box: float, disc: float, body: float
) -> tuple[float, float]:
    """The force, px, off the first of the discs that the body would meet within a box of that length; or (0, 0)."""
    first, at_x, at_y = math.inf, 0.0, 0.0
    for j in range(len(discs)):
        if not discs[j]:
            continue
        x, y = positions[j, 0] / pixel, positions[j, 1] / pixel
        wide = disc + body
        if x < 0.0 or abs(y) >= wide or length_of(x, y) >= box + disc:
            continue
        across = math.sqrt(wide * wide - y * y)
        meets = x - across if x > across else x + across
        if meets < first:
            first, at_x, at_y = meets, x, y
    if first == math.inf:
        return 0.0, 0.0
    side = -1.0 if at_y > 0.0 else 1.0
    return (disc - at_x) * BRAKE, side * (disc + body - abs(at_y)) * (1.0 + (box - at_x) / box)


@compiled
def evading(
    positions: Floats, velocities: Floats, threats: Bools, vx: float, vy: float, top: float, pixel: float
) -> tuple[float, float]:
    """Away from where each threat will be, at top speed, less the own velocity; px/s."""
    force_x = force_y = 0.0
    for j in range(len(threats)):
        if threats[j]:
            x, y = positions[j, 0] / pixel, positions[j, 1] / pixel
            ux, uy = velocities[j, 0] / pixel, velocities[j, 1] / pixel
            ahead = 0.0
            if top > 0.0 or ux != 0.0 or uy != 0.0:
                ahead = length_of(x, y) / (top + length_of(ux, uy))
            away_x, away_y = unit(-x - ux * ahead, -y - uy * ahead)
            force_x += top * away_x - vx
            force_y += top * away_y - vy
    return force_x, force_y


@compiled
def triangular(u: float) -> float:
    """Of a uniform number, one between -1 and 1 with the density of the difference of two; of 1 - u its negative."""
    if u < 0.5:
        return math.sqrt(2.0 * u) - 1.0
    return 1.0 - math.sqrt(2.0 * (1.0 - u))


@compiled
def wandering(memory: Floats, u: Floats, radius: float, distance: float, jitter: float) -> tuple[float, float]:
    """The target, px, once its point on the circle, in `memory`, has moved by at most `jitter`, px, along each axis."""
    if memory[0] == 0.0 and memory[1] == 0.0:
        memory[0], memory[1] = radius * math.cos(2.0 * math.pi * u[0]), radius * math.sin(2.0 * math.pi * u[0])
    # ahead by a number whose mirror image it is itself, as 1 - u is that of u
    x = memory[0] + jitter * triangular(abs(2.0 * u[1] - 1.0))
    y = memory[1] + jitter * triangular(u[0])
    x, y = unit_or_ahead(x, y)
    memory[0], memory[1] = radius * x, radius * y
    return distance + radius * x, radius * y


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading and speed after the forces in the order of their priority, up to the strongest."""
    of, pixel, t = parameters, parameters.pixel_m, parameters.tweaker
    top, most = of.top_speed_m_s / pixel, of.strongest * t
    vx, vy = own.velocity[0] / pixel, own.velocity[1] / pixel
    away_x = away_y = with_x = with_y = to_x = to_y = 0.0
    found = 0
    for j in range(len(members.ids)):
        if sets[FLOCKMATES, j] and not sets[THREATS, j] and not sets[DISCS, j]:
            found += 1
            x, y = members.positions[j, 0] / pixel, members.positions[j, 1] / pixel
            to_x += x
            to_y += y
            d = length_of(x, y)
            if d > 0.0:
                away_x -= x / d / d
                away_y -= y / d / d
            hx, hy = unit(members.velocities[j, 0], members.velocities[j, 1])
            if hx == 0.0 and hy == 0.0:
                hx, hy = math.cos(members.headings[j]), math.sin(members.headings[j])
            with_x += hx
            with_y += hy
    box = of.box_px * (1.0 + (length_of(vx, vy) / top if top > 0.0 else 0.0))
    wall_x, wall_y = off_walls(obstacles.points, pixel, of.feeler_px)
    disc_x, disc_y = off_discs(members.positions, sets[DISCS], pixel, box, of.disc_px, of.body_px)
    evade_x, evade_y = evading(members.positions, members.velocities, sets[THREATS], vx, vy, top, pixel)
    x, y = added(0.0, 0.0, of.wall_weight * t * wall_x, of.wall_weight * t * wall_y, most)
    x, y = added(x, y, of.obstacle_weight * t * disc_x, of.obstacle_weight * t * disc_y, most)
    x, y = added(x, y, of.evade_weight * t * evade_x, of.evade_weight * t * evade_y, most)
    if found > 0:
        ux, uy = unit(to_x, to_y)
        ux, uy = unit(top * ux - vx, top * uy - vy)
        x, y = added(x, y, of.separation_weight * t * away_x, of.separation_weight * t * away_y, most)
        w = of.alignment_weight * t
        x, y = added(x, y, w * (with_x / found - 1.0), w * (with_y / found), most)
        x, y = added(x, y, of.cohesion_weight * t * ux, of.cohesion_weight * t * uy, most)
    to_x, to_y = wandering(memory, u, of.wander_radius_px, of.wander_distance_px, of.wander_jitter_px_s * own.dt)
    x, y = added(x, y, of.wander_weight * t * to_x, of.wander_weight * t * to_y, most)
    rule = 4 if found > 0 else 0
    if wall_x != 0.0 or wall_y != 0.0:
        rule = 1
    elif disc_x != 0.0 or disc_y != 0.0:
        rule = 2
    elif evade_x != 0.0 or evade_y != 0.0:
        rule = 3
    wx, wy = limited(own.velocity[0] + x * pixel * own.dt, own.velocity[1] + y * pixel * own.dt, of.top_speed_m_s)
    bearing = direction(wx, wy)
    speed = length_of(wx, wy)
    if of.turn_rate_rad_s > 0.0 and abs(bearing) > of.turn_rate_rad_s * own.dt:
        side = own.turn_rate if abs(bearing) > 0.5 * math.pi and own.turn_rate != 0.0 else bearing
        bearing = math.copysign(of.turn_rate_rad_s * own.dt, side)
        speed = max(0.0, wx * math.cos(bearing) + wy * math.sin(bearing))
    return Motion(Kind.HEADING, bearing, speed, rule)
