"""Perfect detection: global knowledge instead of a sensor, for ideal cases.

A member is detected while any part of its silhouette is in range, inside the field of view and, with
`occlusion`, in sight: hidden neither by a wall nor by another member's disc. The defaults are the laser's own
range and field of view, so that what differs from the laser's pipelines is detection alone.

The geometry of the inputs differs from theirs, and a claim of equivalence must allow for it: here a position is the
member's centre. Member-based detection gives the mean of the facing surface, 0.80 to 0.92 radii nearer (0.13 to
0.15 m for Creates); member-extrapolated and sensor-based detection give points on the surface itself, up to one
radius (0.165 m) nearer and up to one radius to either side. A member of which 1/16 shows is an input here, while
member-based detection wants its whole shape.

The obstacles are the nearest point of each wall in range and in the field of view, which nothing hides, and of each
robot in view that is not marked as a member.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, NamedTuple

import mujoco
import numpy as np

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.types import Bools, Floats, Ints, Members, Obstacles, Own
from sensing.types import Detection, Senses

READS = frozenset({"truth"})
GIVES = frozenset({"positions", "bearings", "headings", "velocities", "ids", "obstacles"})

SIGHT_LINES = 16
"""Lines of sight evenly across each silhouette; choice: less than 1/16 of a member may go unseen."""
NO_BEAMS = np.empty(0, np.int64)
ROUNDING = 1e-9
"""rad: a point on the border of the field of view is in view."""


class Parameters(NamedTuple):
    """How far global knowledge reaches."""

    field_of_view_rad: Annotated[
        float, Parameter("rad", "Hokuyo URG-04LX-UG01, 681 steps of 1/1024 turn", low=0.0, high=2.0 * math.pi)
    ] = 681 * 2.0 * math.pi / 1024
    """Symmetric about straight ahead; 2π = all round."""
    range_m: Annotated[float, Parameter("m", "Hokuyo URG-04LX-UG01, data sheet", low=0.0)] = 5.6
    """From the focal member's centre to the nearest visible part of a member."""
    occlusion: Annotated[bool, Parameter("", "choice: as the laser")] = True
    """Whether members and walls hide what is behind them."""


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> Parameters:
    """Nothing is prepared or remembered."""
    return parameters


def detect(senses: Senses, own: Own, state: Parameters) -> tuple[Detection, Parameters]:
    """One row a member in view, in the order of their indices; one obstacle a wall in view."""
    truth = senses.truth
    assert truth is not None
    *found, obstacles = _detect(
        truth.poses_w,
        truth.velocities_w,
        truth.radii,
        _all_marked(len(truth.radii)) if truth.marked is None else truth.marked,
        truth.focal,
        truth.walls_w,
        float(state.field_of_view_rad),
        float(state.range_m),
        bool(state.occlusion),
    )
    return Detection(Members(*found), Obstacles(obstacles), NO_BEAMS), state


@cache
def _all_marked(robots: int) -> Bools:
    return np.ones(robots, dtype=np.bool_)


@compiled
def _detect(
    poses_w: Floats,
    velocities_w: Floats,
    radii: Floats,
    marked: Bools,
    focal: int,
    walls_w: Floats,
    field_of_view: float,
    reach: float,
    occlusion: bool,
) -> tuple[Floats, Floats, Floats, Floats, Ints, Floats]:
    """The fields of the members (M,), and the obstacles (K, 2): those of the walls first, then unmarked robots."""
    robots = len(poses_w)
    heading = poses_w[focal, 2]
    cosine, sine = math.cos(heading), math.sin(heading)
    positions = np.empty((robots, 2))
    for k in range(robots):
        x, y = poses_w[k, 0] - poses_w[focal, 0], poses_w[k, 1] - poses_w[focal, 1]
        positions[k, 0] = cosine * x + sine * y
        positions[k, 1] = cosine * y - sine * x
    walls = np.empty((len(walls_w) if occlusion else 0, 4))
    for w in range(len(walls)):
        for end in range(0, 4, 2):
            x, y = walls_w[w, end] - poses_w[focal, 0], walls_w[w, end + 1] - poses_w[focal, 1]
            walls[w, end] = cosine * x + sine * y
            walls[w, end + 1] = cosine * y - sine * x

    obstacles = np.empty((len(walls_w) + robots, 2))
    surfaces = _walls(poses_w[focal], walls_w, field_of_view, reach, obstacles)
    seen = np.empty(robots, np.int64)
    count = 0
    for k in range(robots):
        if k == focal or not _in_view(k, focal, positions, radii, walls, field_of_view, reach, occlusion):
            continue
        if marked[k]:
            seen[count] = k
            count += 1
            continue
        distance = math.hypot(positions[k, 0], positions[k, 1])
        nearer = max(distance - radii[k], 0.0) / max(distance, 1e-9)
        obstacles[surfaces, 0], obstacles[surfaces, 1] = positions[k, 0] * nearer, positions[k, 1] * nearer
        surfaces += 1
    bearings, headings = np.empty(count), np.empty(count)
    found, velocities = np.empty((count, 2)), np.empty((count, 2))
    for row in range(count):
        k = seen[row]
        found[row, 0], found[row, 1] = positions[k, 0], positions[k, 1]
        bearings[row] = math.atan2(positions[k, 1], positions[k, 0])
        headings[row] = wrap(poses_w[k, 2] - heading)
        velocities[row, 0] = cosine * velocities_w[k, 0] + sine * velocities_w[k, 1]
        velocities[row, 1] = cosine * velocities_w[k, 1] - sine * velocities_w[k, 0]
    return found, bearings, headings, velocities, seen[:count].copy(), obstacles[:surfaces].copy()


@compiled
def _walls(pose_w: Floats, walls_w: Floats, field_of_view: float, reach: float, points: Floats) -> int:
    """How many walls are in view: fills the first rows of points (W, 2) with the nearest one of each, body frame.

    A wall's nearest point in view is the foot of the perpendicular, an end, or where the field's border crosses it.
    """
    cosine, sine = math.cos(pose_w[2]), math.sin(pose_w[2])
    count = 0
    shares = np.empty(5)
    for w in range(len(walls_w)):
        from_x, from_y = walls_w[w, 0] - pose_w[0], walls_w[w, 1] - pose_w[1]
        to_x, to_y = walls_w[w, 2] - pose_w[0], walls_w[w, 3] - pose_w[1]
        x, y = cosine * from_x + sine * from_y, cosine * from_y - sine * from_x
        along_x = cosine * to_x + sine * to_y - x
        along_y = cosine * to_y - sine * to_x - y
        squared = along_x * along_x + along_y * along_y
        shares[0], shares[1] = 0.0, 1.0
        shares[2] = -(x * along_x + y * along_y) / squared if squared > 0.0 else 0.0
        for side in range(2):
            border = (0.5 - side) * field_of_view
            across = along_y * math.cos(border) - along_x * math.sin(border)
            crossing = (x * math.sin(border) - y * math.cos(border)) / across if across != 0.0 else -1.0
            shares[3 + side] = crossing
        nearest = math.inf
        for s in range(5):
            if not 0.0 <= shares[s] <= 1.0:
                continue
            px, py = x + shares[s] * along_x, y + shares[s] * along_y
            distance = math.hypot(px, py)
            in_view = abs(math.atan2(py, px)) <= 0.5 * field_of_view + ROUNDING
            if in_view and distance <= reach and distance < nearest:
                nearest = distance
                points[count, 0], points[count, 1] = px, py
        if nearest < math.inf:
            count += 1
    return count


@compiled
def _in_view(
    k: int,
    focal: int,
    positions: Floats,
    radii: Floats,
    walls: Floats,
    field_of_view: float,
    reach: float,
    occlusion: bool,
) -> bool:
    """Whether any line of sight ends on member k's disc."""
    distance = math.hypot(positions[k, 0], positions[k, 1])
    if distance - radii[k] > reach:
        return False
    if distance <= radii[k]:
        return True
    bearing = math.atan2(positions[k, 1], positions[k, 0])
    for line in range(SIGHT_LINES):
        aside = radii[k] * ((2 * line + 1) / SIGHT_LINES - 1.0)
        angle = bearing + math.asin(aside / distance)
        if abs(wrap(angle)) > 0.5 * field_of_view:
            continue
        x, y = math.cos(angle), math.sin(angle)
        far = _disc_distance(x, y, positions[k, 0], positions[k, 1], radii[k])
        if far <= reach and (not occlusion or _is_clear(x, y, far, k, focal, positions, radii, walls)):
            return True
    return False


@compiled
def _is_clear(
    x: float, y: float, far: float, k: int, focal: int, positions: Floats, radii: Floats, walls: Floats
) -> bool:
    """Whether nothing stands nearer than `far` (m) along the unit vector (x, y) but the member k."""
    for other in range(len(positions)):
        if other not in (k, focal) and (
            _disc_distance(x, y, positions[other, 0], positions[other, 1], radii[other]) < far
        ):
            return False
    for w in range(len(walls)):
        along_x, along_y = walls[w, 2] - walls[w, 0], walls[w, 3] - walls[w, 1]
        cross = x * along_y - y * along_x
        if cross == 0.0:
            continue
        distance = (walls[w, 0] * along_y - walls[w, 1] * along_x) / cross
        share = (walls[w, 0] * y - walls[w, 1] * x) / cross
        if 0.0 < distance < far and 0.0 <= share <= 1.0:
            return False
    return True


@compiled
def _disc_distance(x: float, y: float, centre_x: float, centre_y: float, radius: float) -> float:
    """Distance (m) from the origin along the unit vector (x, y) to a disc; inf if it is missed."""
    along, aside = x * centre_x + y * centre_y, x * centre_y - y * centre_x
    inside = radius * radius - aside * aside
    if along <= 0.0 or inside < 0.0:
        return math.inf
    return max(0.0, along - math.sqrt(inside))
