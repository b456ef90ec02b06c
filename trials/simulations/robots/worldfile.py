"""A trial's world as MJCF text, for any MuJoCo viewer."""

from __future__ import annotations

from trials.simulations.robots.fields import environment_of, of_trial
from trials.simulations.robots.resolved import Resolved
from trials.simulations.robots.starts import starting_poses
from trials.types import Trial
from worlds.assemble import specification
from worlds.walls import walls_of


def world_xml(trial: Trial) -> str:
    """Floor, walls and robots at their start, as one MJCF document."""
    members = [(group, k) for group in trial.groups for k in range(group.count)]
    spec = specification(
        walls_of(environment_of(trial)),
        [Resolved(group).body for group, _ in members],
        [f"{group.name}-{k + 1}" for group, k in members],
        starting_poses(trial),
        of_trial(trial).timestep_s,
    )
    spec.compile()
    return str(spec.to_xml())
