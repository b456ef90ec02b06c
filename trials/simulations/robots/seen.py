"""What eyes look for, where it truly was: the robots' cones in the world, and as an exact input would have them."""

from __future__ import annotations

import math
from functools import cache

import mujoco
import numpy as np

from flocking.types import Floats, Ints
from robots import body as bodies
from robots.eyes import CONE_RADIUS
from sensing.camera.looking import CAMERA, MIDDLE, camera_mounts
from sensing.camera.rendering import CONE
from trials.simulations.robots.fields import of_group
from trials.simulations.robots.resolved import Resolved
from trials.types import TrialResult


@cache
def cone_of(body: str) -> tuple[float, float]:
    """Where the axis of a body's cone stands in its frame, m; nan where it carries none."""
    model = bodies.load(body).spec().compile()
    geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, CONE)
    if geom < 0:
        return math.nan, math.nan
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    x, y = data.geom_xpos[geom, :2].tolist()
    return x, y


def offsets(result: TrialResult) -> Floats:
    """(N, 2) where the cone of each robot stands in its frame, m; nan where it carries none."""
    return np.array([cone_of(of_group(group).body) for group in result.trial.groups for _ in range(group.count)])


def _poses_at(result: TrialResult, times: Floats) -> Floats:
    """(U, N, 3) the poses of all robots at these times (U,), world frame, between two of those that were kept."""
    poses = result.poses_w
    at = np.empty((len(times), *poses.shape[1:]))
    for k in range(poses.shape[1]):
        for column in range(3):
            at[:, k, column] = np.interp(times, result.times, poses[:, k, column])
    return at


def cones_w(result: TrialResult, times: Floats) -> Floats:
    """(U, N, 2) where the cones of all robots were at these times (U,), world frame, m."""
    at, own = _poses_at(result, times), offsets(result)
    c, s = np.cos(at[..., 2]), np.sin(at[..., 2])
    return np.stack([at[..., 0] + c * own[:, 0] - s * own[:, 1], at[..., 1] + s * own[:, 0] + c * own[:, 1]], axis=-1)


@cache
def lenses_of(body: str) -> Floats:
    """(2, 2) x, y of the left and the right lens in the frame of a body with cameras, m."""
    return np.array(camera_mounts(bodies.load(body).spec().compile()))[:, :2]


def exact_inputs(result: TrialResult, times: Floats, robots: Ints, poses_w: Floats) -> Floats:
    """(U, N, 2) what an exact detection would make of each robot at updates of these robots (U,), their body frame, m.

    `times` (U,), `poses_w` (U, 3) of who updates. Of images it is the near side of the cone, seen from the nearer lens,
    whose image shows it wider and so is the one that it is read from: told from the robot's centre, or from where the
    pipeline's `offset` has it told from. Of other detections it is the robot's centre. nan where a body has no cone.
    """
    groups = [Resolved(group) for group in result.trial.groups]
    first = np.cumsum([0, *(each.group.count for each in groups)])
    made = np.full((len(times), first[-1], 2), math.nan)
    for its, start, end in zip(groups, first[:-1], first[1:], strict=True):
        who = (start <= robots) & (robots < end)
        images = "images" in its.pipeline_reads
        at = cones_w(result, times[who]) if images else _poses_at(result, times[who])[..., :2]
        x, y = np.moveaxis(at - poses_w[who, None, :2], -1, 0)
        c, s = np.cos(poses_w[who, 2])[:, None], np.sin(poses_w[who, 2])[:, None]
        body = np.stack([c * x + s * y, c * y - s * x], axis=-1)
        made[who] = _near_sides(body, its) if images else body
    return made


def _near_sides(cones: Floats, its: Resolved) -> Floats:
    """The near sides of cones whose axes (…, 2) are in the body frame, as `exact_inputs` has them."""
    lenses = lenses_of(its.given.body)
    away = cones[..., None, :] - lenses
    nearer = np.hypot(away[..., 0], away[..., 1]).argmin(axis=-1)
    way = np.take_along_axis(away, nearer[..., None, None], axis=-2)[..., 0, :]
    distance = np.hypot(way[..., 0], way[..., 1])[..., None]
    near = way * np.maximum(1.0 - CONE_RADIUS / np.maximum(distance, 1e-9), 1e-9)
    offset = its.pipeline_parameters.offset
    if offset == CAMERA:
        return lenses[nearer] + near
    return lenses[nearer] - lenses.mean(axis=0) + near if offset == MIDDLE else near
