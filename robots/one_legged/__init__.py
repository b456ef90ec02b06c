"""The one-legged hopping robot of Hodgins and Brogan 1994: three-part control after Raibert, and its fleet.

A herd on open ground, from Python::

    from robots.one_legged.ground import build

    ground = build(poses_w, heights)              # poses (N, 3): x, y, heading; heights (N,): of the soles, m
    fleet, data = ground.fleet, ground.data
    fleet.desire_all(velocities_w)                # (N, 2) m/s in the world, limited to controller.MAX_SPEED;
    fleet.desire(k, x_w, y_w)                     # or of one robot
    ground.step()                                 # before_step, mj_step, after_step: 5 ms; ground.run(seconds)
    fleet.poses(data)                             # (N, 3) x, y, heading
    fleet.velocities(data)                        # (N, 2) those last seen in flight, held through stance
    fleet.actual_velocities(data), fleet.desired  # (N, 2) those of now; those commanded
    fleet.flying, fleet.upright                   # (N,) bool
    fleet.fallen_at, fleet.causes                 # (N,) s, nan = upright; why: `stepping.CAUSES`

A commanded velocity stays in force until the next. All velocities are in m/s along the world's axes. Robots do not
meet one another; whoever counts collisions takes two as touching whose places are nearer than 2 `model.RADIUS`.

As a body of a trial (`--body one-legged`) a robot is commanded in its own axes: `controller.follow`.
"""

from __future__ import annotations

from robots.body import Body
from robots.one_legged import controller, model
from robots.one_legged.fleet import Fleet

BODY: Body = Body(
    name="one-legged",
    radius=model.RADIUS,
    silhouette_radius=model.RADIUS,
    top_speed=controller.MAX_SPEED,
    mounts={},
    follows=controller.FOLLOWS,
    spec=model.spec,
    fleet=Fleet,
    follow=controller.follow,
    longest_timestep=model.TIMESTEP,
    constants=("robots.one_legged.model", "robots.one_legged.controller", "robots.one_legged.stepping"),
)
