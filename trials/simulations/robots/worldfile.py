"""A trial's world as MJCF text, to be opened in any MuJoCo viewer."""

from __future__ import annotations

from flocking import found
from flocking.parameters import filled
from robots import body
from trials.streams import Purpose, stream
from trials.types import Trial
from worlds import formations
from worlds.assemble import specification


def world_xml(trial: Trial) -> str:
    """Floor, walls and robots at their start, as one MJCF document."""
    members = [(group, k) for group in trial.groups for k in range(group.count)]
    module = found.load("worlds", trial.world, "world")
    walls = module.walls(filled(module.Parameters, trial.world_parameters, prefix="world."))
    poses_w = formations.poses(trial.formation, len(members), stream(trial.seed, trial.repeat, 0, 0, Purpose.START))
    spec = specification(
        walls,
        [body.load(group.body) for group, _ in members],
        [f"{group.name}-{k + 1}" for group, k in members],
        poses_w,
        trial.timestep_s,
    )
    spec.compile()
    return str(spec.to_xml())
