"""Draws the one-legged robots of a running herd, in the manner of Hodgins and Brogan 1994, figure 1.

    python -m scripts.robot_herd [--out docs/robot_herd.png] [--at 12]

It runs the first trial with robots of `herd-steady` and renders one moment off-screen (`MUJOCO_GL` names the library).
The creature that the user controls is red.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import mujoco
import numpy as np

from flocking.herding.loop import no_touching
from flocking.types import Floats
from robots.one_legged import model as one_legged
from sensing.camera import opengl
from trials.design import plan
from trials.simulations.running import loop
from trials.simulations.running.creatures import Legged
from trials.types import Trial, with_setup

WIDTH, HEIGHT = 1280, 720
USER, FLOOR = (0.84, 0.15, 0.16, 1.0), (0.80, 0.80, 0.76, 1.0)
SKY = (0.93, 0.95, 0.97), (0.62, 0.74, 0.86)
AZIMUTH_DEG, ELEVATION_DEG, ROOM = 150.0, -16.0, 1.75
"""Of the camera: before the herd and a little above it; how many of its radii away. Choices."""


def main() -> None:
    """Runs the trial and writes the picture."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("docs/robot_herd.png"))
    parser.add_argument("--at", type=float, default=12.0, metavar="TIME", help="s")
    given = parser.parse_args()
    creatures = running(given.at)
    picture = rendered(creatures.data.qpos, len(creatures.poses()), creatures.poses()[:, :2].mean(axis=0))
    cv2.imwrite(str(given.out), picture[:, :, ::-1])
    print(f"{given.out}: {int(np.isnan(creatures.fallen_at).sum())} of {len(creatures.poses())} robots upright")


def first_with_robots() -> Trial:
    """The first trial of `herd-steady` that runs robots."""
    return next(each for each in plan("herd-steady", repeats=1).trials if "one-legged" in each.conditions.values())


def running(at_s: float) -> Legged:
    """The robots at that time, s."""
    trial = with_setup(first_with_robots(), {"duration_s": at_s, "settle_s": 0.0})
    creatures = loop.built(trial)
    assert isinstance(creatures, Legged)
    loop.run(trial, creatures, no_touching(len(creatures.poses()), 0.1))
    return creatures


def rendered(qpos: Floats, count: int, centre: Floats) -> np.ndarray:
    """(H, W, 3) the picture of robots whose joints stand at `qpos`, of a model with all that is seen of them."""
    spec = mujoco.MjSpec()
    spec.copy_during_attach = True
    spec.worldbody.add_light(pos=[0.0, 0.0, 30.0], dir=[0.3, 0.2, -1.0], type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL)
    spec.visual.headlight.ambient = (0.45, 0.45, 0.45)
    spec.add_texture(
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, rgb1=SKY[0], rgb2=SKY[1],
        width=64, height=384,
    )  # fmt: skip
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], rgba=FLOOR)
    for k in range(count):
        spec.attach(one_legged.spec(), prefix=f"{k}/", frame=spec.worldbody.add_frame())
    model = spec.compile()
    model.geom_rgba[[model.geom(g).name.startswith("0/") for g in range(model.ngeom)]] = USER
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    opengl.context().make_current()
    drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, drawing)
    scene, camera = mujoco.MjvScene(model, model.ngeom + 100), mujoco.MjvCamera()
    camera.lookat[:] = (*centre, 0.4)
    camera.azimuth, camera.elevation = AZIMUTH_DEG, ELEVATION_DEG
    places = qpos.reshape(count, -1)[:, :2]
    camera.distance = ROOM * float(np.hypot(*(places - centre).T).max())
    every = mujoco.mjtCatBit.mjCAT_ALL.value
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), mujoco.MjvPerturb(), camera, every, scene)
    pixels, view = np.empty((HEIGHT, WIDTH, 3), np.uint8), mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
    mujoco.mjr_render(view, scene, drawing)
    mujoco.mjr_readPixels(pixels, None, view, drawing)
    drawing.free()
    return pixels[::-1]


if __name__ == "__main__":
    main()
