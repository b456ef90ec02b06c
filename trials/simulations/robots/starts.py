"""Where the robots of a trial start: in the trial's formation, or, as a group, in one of its own."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.distance import cdist

from flocking.errors import InputError
from flocking.types import Floats
from generation.environment import Environment
from trials.rows import below
from trials.simulations.robots import guided
from trials.simulations.robots.fields import FORMATION, TOGETHER, environment_of, of_group
from trials.streams import Purpose, stream
from trials.types import Trial
from worlds import formations, start_poses, starts
from worlds.walls import FENCE


def starting_poses(trial: Trial) -> Floats:
    """(N, 3) x, y, heading in the world of all robots, group by group.

    The groups without a formation of their own share the trial's, in their order, put at the world's start; poses of a
    file stand where it says. A group's own formation is drawn from the group's own stream, turned by
    `start_heading_deg` and put at `start_x_m`, `start_y_m`. Pilots stand along the walls that they hold first,
    sheepdogs behind the herd. Raises `InputError`.
    """
    given = [of_group(group) for group in trial.groups]
    by_task = [guided.starts_by_task(trial, group) for group in trial.groups]
    shared = sum(
        fields.count for fields, put in zip(given, by_task, strict=True) if fields.formation == TOGETHER and not put
    )
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    together = np.empty((0, 3))
    if start_poses.is_file(trial.formation):
        together = start_poses.poses(trial.formation, trial.formation_source, shared)
    elif shared:
        drawn = formations.poses(trial.formation, trial.formation_parameters, shared, rng)
        together = starts.put_at_start(environment_of(trial), drawn)
    parts, placed = [], 0
    for number, (group, fields) in enumerate(zip(trial.groups, given, strict=True)):
        if by_task[number]:
            parts.append(guided.pilot_starts(trial))
            continue
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


def check_starts(herd: starts.Starting, environment: Environment) -> None:
    """Refuses robots that overlap one another or a wall at the start, or that walls keep apart: `InputError`."""
    names, radii, places = herd.names, herd.radii, herd.poses_w[:, :2]
    apart = cdist(places, places) - radii[:, None] - radii[None, :]
    np.fill_diagonal(apart, math.inf)
    first, second = np.unravel_index(apart.argmin(), apart.shape)
    if apart[first, second] < 0.0:
        raise InputError(
            f"{names[first]} and {names[second]} overlap by {-apart[first, second]:.2f} m at the start; "
            "expected formations that stand apart"
        )
    starts.check(herd, environment, FENCE / 2)
