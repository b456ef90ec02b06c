"""Pioneers among boxes and poles, and what their sonars hear there."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from robots import body as bodies
from robots.physics import apply_options
from sensing.sonar import Sonars


class Room:
    """Pioneers at (x, y, heading) among boxes (x, y, half sizes) and poles (x, y, radius)."""

    def __init__(
        self,
        *poses: tuple[float, float, float],
        boxes: tuple[tuple[float, float, float, float], ...] = (),
        poles: tuple[tuple[float, float, float], ...] = (),
        top: float = 0.5,
    ) -> None:
        spec = mujoco.MjSpec()
        apply_options(spec)
        for x, y, a, b in boxes:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX, size=(a, b, top / 2), pos=(x, y, top / 2), userdata=(0.8, 0.0)
            )
        for x, y, radius in poles:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(radius, top / 2, 0), pos=(x, y, top / 2), userdata=(0.8, 0.0)
            )
        for k, (x, y, heading) in enumerate(poses or ((0.0, 0.0, 0.0),)):
            quat = (math.cos(heading / 2), 0, 0, math.sin(heading / 2))
            spec.attach(
                bodies.load("pioneer").spec(), prefix=f"{k}/", frame=spec.worldbody.add_frame(pos=(x, y, 0), quat=quat)
            )
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        count = max(1, len(poses))
        roots = [self.model.body(f"{k}/base").id for k in range(count)]
        self.sonars = Sonars(self.model, [f"{k}/sonar" for k in range(count)], roots)

    def read(self, k: int = 0) -> np.ndarray:
        return self.sonars.read(self.data, k)
