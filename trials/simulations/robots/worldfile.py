"""A trial's world as MJCF text, for any MuJoCo viewer."""

from __future__ import annotations

from flocking.parameters import filled
from trials.simulations.robots.fields import of_trial, world_of
from trials.simulations.robots.resolved import Resolved
from trials.simulations.robots.starts import starting_poses
from trials.types import Trial
from worlds.assemble import specification


def world_xml(trial: Trial) -> str:
    """Floor, walls and robots at their start, as one MJCF document."""
    members = [(group, k) for group in trial.groups for k in range(group.count)]
    module = world_of(trial)
    walls = module.walls(filled(module.Parameters, trial.world_parameters, prefix="world."))
    spec = specification(
        walls,
        [Resolved(group).body for group, _ in members],
        [f"{group.name}-{k + 1}" for group, k in members],
        starting_poses(trial),
        of_trial(trial).timestep_s,
    )
    spec.compile()
    return str(spec.to_xml())
