"""A running herd whose user's creature is steered while it runs, before a viewer's eyes."""

from __future__ import annotations

import dataclasses

import mujoco

from flocking.errors import InputError
from flocking.herding.loop import no_touching
from flocking.kinematic.herd import LawFailedError
from flocking.types import Floats
from robots.physics import DivergedError
from trials.simulations.contract import Rider
from trials.simulations.running import fields, herd, loop
from trials.simulations.running.creatures import Creatures, Legged
from trials.simulations.running.measures import measure
from trials.simulations.running.script import Leg
from trials.types import Trial, TrialResult, with_setup

BALL_M, HERD, USER = 0.25, (0.34, 0.71, 0.91, 1.0), (0.84, 0.15, 0.16, 1.0)
"""Radius and colours of point masses in the viewer. Choices."""


def run_steered(trial: Trial, rider: Rider) -> TrialResult:
    """Runs a trial by what `rider` says until it raises `StoppedError` or the trial's time is over.

    The result's trial has the ride as its `script` and its `duration_s`, so that it can be run again. The test begins
    at once: `settle_s` is 0. Raises `InputError` for a herd without a user's creature.
    """
    trial = with_setup(trial, {"settle_s": 0.0})
    herd.check(trial)
    given, group = fields.of_trial(trial), fields.group_of(trial)
    if fields.of_group(group).users == 0:
        raise InputError(f"{group.name}.users = 0: nobody to steer; expected 1")
    creatures = loop.built(trial)
    shown = Scene(creatures)
    rider.begin(shown.model, shown.data)
    ridden: list[Leg] = []

    def told(time: float) -> Leg:
        shown.place()
        leg = Leg(time, *rider.velocity(time))
        if not ridden or leg[1:] != ridden[-1][1:]:
            ridden.append(leg)
        return leg

    touching = no_touching(group.count, given.collision_m, loop.MOST_TOUCHES)
    try:
        ran = loop.run(trial, creatures, touching, told=told)
    except (LawFailedError, DivergedError) as error:
        raise InputError(f"the herd ended: {' '.join(str(error).split())}") from None
    ride = "; ".join(f"{leg.from_s:g}: {leg.x_m_s:g}, {leg.y_m_s:g}" for leg in ridden) or given.script
    as_ridden = with_setup(trial, {"script": ride, "duration_s": max(float(ran.times[-1]), given.timestep_s)})
    result = loop.result_of(as_ridden, creatures, touching, ran, "done", "")
    return dataclasses.replace(result, measures=measure(result, int(touching.found[0]), float(touching.closest[0])))


class Scene:
    """What a viewer shows: the world of bodies with legs, or balls where point masses are."""

    def __init__(self, creatures: Creatures) -> None:
        self._creatures = creatures
        if isinstance(creatures, Legged):
            self.model, self.data = creatures.model, creatures.data
            self._balls = False
            return
        spec = mujoco.MjSpec()
        spec.worldbody.add_light(
            pos=[0.0, 0.0, 20.0], dir=[0.0, 0.0, -1.0], type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        )
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], rgba=[0.9, 0.9, 0.88, 1.0])
        for k in range(len(creatures.mind.there)):
            body = spec.worldbody.add_body(name=f"{k}", mocap=True)
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[BALL_M, 0.0, 0.0], rgba=HERD if k else USER,
                contype=0, conaffinity=0,
            )  # fmt: skip
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._balls = True
        self.place()

    def place(self) -> None:
        """Puts what is shown where the creatures are."""
        if self._balls:
            places: Floats = self._creatures.poses()
            self.data.mocap_pos[:, :2], self.data.mocap_pos[:, 2] = places[:, :2], BALL_M
            mujoco.mj_forward(self.model, self.data)
