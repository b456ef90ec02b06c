"""Where the robots of a trial start: in the trial's formation, or, as a group, in one of its own."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.distance import cdist

from flocking.errors import InputError
from flocking.types import Floats
from trials.rows import below
from trials.simulations.robots.fields import FORMATION, TOGETHER, of_group
from trials.streams import Purpose, stream
from trials.types import Trial
from worlds import formations
from worlds.walls import THICKNESS, clearance, inside


def starting_poses(trial: Trial) -> Floats:
    """(N, 3) x, y, heading in the world of all robots, group by group.

    The groups without a formation of their own share the trial's, in their order. A group's own formation is drawn from
    the group's own stream, turned by `start_heading_deg` and put at `start_x_m`, `start_y_m`. Raises `InputError`.
    """
    given = [of_group(group) for group in trial.groups]
    shared = sum(fields.count for fields in given if fields.formation == TOGETHER)
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    together = (
        formations.poses(trial.formation, trial.formation_parameters, shared, rng) if shared else np.empty((0, 3))
    )
    parts, placed = [], 0
    for number, (group, fields) in enumerate(zip(trial.groups, given, strict=True)):
        if fields.formation == TOGETHER:
            parts.append(together[placed : placed + fields.count])
            placed += fields.count
            continue
        rng = stream(trial.seed, trial.repeat, number + 1, 0, Purpose.START)
        numbers = below(group.setup, FORMATION)
        own = formations.poses(fields.formation, numbers, fields.count, rng, f"{group.name}.{FORMATION}")
        turn = math.radians(fields.start_heading_deg)
        c, s = math.cos(turn), math.sin(turn)
        x, y = own[:, 0], own[:, 1]
        parts.append(
            np.stack([fields.start_x_m + c * x - s * y, fields.start_y_m + s * x + c * y, own[:, 2] + turn], axis=1)
        )
    return np.concatenate(parts)


def check_starts(names: list[str], poses_w: Floats, radii: Floats, walls: Floats) -> None:
    """Refuses robots that overlap one another or a wall at the start: `InputError`.

    poses_w (N, 3); radii (N,) m; walls (K, 4) segments with free space on their left.
    """
    apart = cdist(poses_w[:, :2], poses_w[:, :2]) - radii[:, None] - radii[None, :]
    np.fill_diagonal(apart, math.inf)
    first, second = np.unravel_index(apart.argmin(), apart.shape)
    if apart[first, second] < 0.0:
        raise InputError(
            f"{names[first]} and {names[second]} overlap by {-apart[first, second]:.2f} m at the start; "
            "expected formations that stand apart"
        )
    clear = clearance(walls, poses_w[:, :2])
    nearest = int((clear - radii).argmin())
    solid = inside(walls, poses_w[:, :2])
    if clear[nearest] >= radii[nearest] and not solid.any():
        return
    if solid.any():
        nearest = int(solid.argmax())
        where = "inside a wall, whose corners are given clockwise: free space lies on the left of a wall"
    elif clear[nearest] > 0.0:
        where = f"and reaches {radii[nearest] - clear[nearest]:.2f} m into a wall"
    elif clear[nearest] > -THICKNESS:
        where = "inside a wall"
    else:
        where = "behind a wall"
    x, y = poses_w[nearest, :2]
    raise InputError(f"{names[nearest]} starts at ({x:.2f}, {y:.2f}) m, {where}; expected a start within the world")
