"""What eyes look for, where it truly was: the robots' cones in the world."""

from __future__ import annotations

import math
from functools import cache

import mujoco
import numpy as np

from flocking.types import Floats
from robots import body as bodies
from sensing.camera.rendering import CONE
from trials.simulations.robots.fields import of_group
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


def cones_w(result: TrialResult, times: Floats) -> Floats:
    """(U, N, 2) where the cones of all robots were at these times (U,), world frame, m."""
    poses = result.poses_w
    at = np.empty((len(times), *poses.shape[1:]))
    for k in range(poses.shape[1]):
        for column in range(3):
            at[:, k, column] = np.interp(times, result.times, poses[:, k, column])
    c, s, own = np.cos(at[..., 2]), np.sin(at[..., 2]), offsets(result)
    return np.stack([at[..., 0] + c * own[:, 0] - s * own[:, 1], at[..., 1] + s * own[:, 0] + c * own[:, 1]], axis=-1)
