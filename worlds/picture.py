"""A picture of an environment in three dimensions: walls, the construct in another colour, markers on the floor.

It is rendered off-screen by MuJoCo in a process of its own, since a process can be given one OpenGL library alone, and
one that is broken may end it. EGL is tried first, then OSMesa.
"""

from __future__ import annotations

import dataclasses
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.environment import Environment, Mark
from generation.primitives import Point
from worlds.assemble import specification
from worlds.walls import FENCE, walls_of

WIDTH, HEIGHT = 1280, 960
"""Pixels."""
WIDEST_M = 12.0
"""Of what is drawn as large as it is: fences 0.5 m high and 2 cm thick are still seen. A choice."""
DRAWN_M = 8.0
"""Width to which larger environments are scaled. A choice."""
AZIMUTH_DEG, ELEVATION_DEG = 110.0, -50.0
"""Of the camera: from before the environment, a little from its left. A choice."""
FLOOR = 0.1
"""How far the floor reaches beyond what stands on it, in its diagonal. A choice."""
ROOM = 1.05
"""How much farther away the camera is than what is to be seen needs. A choice."""
CONSTRUCT, MARKER, START = (0.84, 0.37, 0.0, 1.0), (0.0, 0.45, 0.70, 1.0), (0.0, 0.62, 0.45, 1.0)
"""Colours, after Okabe and Ito 2008; the workspace keeps that of walls."""
LIBRARIES = ("egl", "osmesa")
NEEDED = {"egl": "libEGL, as of the packages libegl1 and libgl1-mesa-dri", "osmesa": "libOSMesa, as of libosmesa6"}
LONGEST = 200
"""Letters of what a library says against it that are told."""
LIMIT_S = 300.0
"""Wall time for one picture with one library: without a graphics card a second or so."""


def scale_of(environment: Environment) -> float:
    """By how much an environment is scaled to be drawn, so that fences, whose size is that of robots', are seen."""
    low, high = _bounds(environment)
    widest = float((high - low).max())
    return 1.0 if widest <= WIDEST_M else DRAWN_M / widest


def picture(environment: Environment, library: str = "") -> bytes:
    """A PNG of an environment. `library`: which OpenGL library renders it, as `MUJOCO_GL` has it; empty: any.

    Raises `InputError` where nothing can be drawn, or no OpenGL library renders it.
    """
    if len(environment.walls()) == 0:
        raise InputError("an environment without walls has nothing to be drawn in three dimensions; expected some")
    xml = _scene(environment.moved(scale=scale_of(environment)))
    tried = (library,) if library else LIBRARIES
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        model, out = Path(folder, "scene.xml"), Path(folder, "scene.png")
        model.write_text(xml, encoding="utf-8")
        for library in tried:
            fault = _rendered(model, out, library)
            if out.is_file():
                return out.read_bytes()
            faults.append(f"{library} ({fault})")
    expected = " or ".join(NEEDED.get(library, f"MUJOCO_GL={' or '.join(LIBRARIES)}") for library in tried)
    raise InputError(
        f"a picture needs OpenGL to render off-screen, and none did: {', '.join(faults)}; expected {expected}"
    )


def _rendered(model: Path, out: Path, library: str) -> str:
    """Has a scene rendered by a library in a process of its own; the last line of what it says against it."""
    folder = str(Path(__file__).parents[1])
    paths = [folder, *filter(None, [os.environ.get("PYTHONPATH", "")])]
    try:
        done = subprocess.run(
            [sys.executable, "-m", "worlds.picture", str(model), str(out)],
            env={**os.environ, "MUJOCO_GL": library, "PYTHONPATH": os.pathsep.join(paths)},
            capture_output=True, text=True, timeout=LIMIT_S, stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"did not return within {LIMIT_S:g} s"
    lines = [line.strip() for line in (done.stdout or done.stderr).splitlines() if line.strip()]
    return lines[-1][:LONGEST] if lines else f"ended with code {done.returncode}"


def _scene(environment: Environment) -> str:
    """Floor, walls, markers and lights as MJCF, with a camera named `all` that sees them."""
    spec = specification(walls_of(environment), (), (), np.empty((0, 3)), timestep_s=0.01)
    of_construct = _rows(dataclasses.replace(environment, workspace=()))
    walls = walls_of(environment)
    for kind, segments in (("wall", walls.segments), ("fence", walls.fences)):
        for number, segment in enumerate(segments, 1):
            if _row(segment) in of_construct:
                spec.geom(f"{kind}-{number}").rgba = CONSTRUCT
    low, high = _bounds(environment)
    size = float(np.hypot(*(high - low)))
    floor = spec.geom("floor")
    floor.pos, floor.size = [*((low + high) / 2), 0.0], [*((high - low) / 2 + FLOOR * size), 1.0]
    for name, mark in environment.markers.items():
        _add_marker(spec, name, mark, 0.006 * size)
    for light in spec.lights:
        light.active = False
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, pos=[*((low + high) / 2), size], dir=[0.5, 0.3, -0.8],
        diffuse=[0.45, 0.45, 0.45], specular=[0.0, 0.0, 0.0],
    )  # fmt: skip
    spec.visual.global_.offwidth, spec.visual.global_.offheight = WIDTH, HEIGHT
    spec.visual.quality.shadowsize = 8192
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.25, 0.25, 0.25]
    spec.visual.headlight.specular = [0.0, 0.0, 0.0]
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[1.0, 1.0, 1.0], rgb2=[0.85, 0.9, 0.95], width=128, height=128,
    )  # fmt: skip
    spec.compile()
    return str(spec.to_xml())


def _add_marker(spec: mujoco.MjSpec, name: str, mark: Mark, half: float) -> None:
    """A marker as it lies on the floor: a disc for a point, with a line along its heading; strips for others."""
    colour = START if name == "start" else MARKER
    if isinstance(mark, Point):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[2.0 * half, 0.002, 0.0], pos=[mark.x_m, mark.y_m, 0.003],
            rgba=colour, contype=0, conaffinity=0,
        )  # fmt: skip
        if name != "start":
            return
        ahead = 6.0 * half
        lines = np.array([[mark.x_m, mark.y_m, mark.x_m + ahead * math.cos(mark.heading_rad),
                           mark.y_m + ahead * math.sin(mark.heading_rad)]])  # fmt: skip
    else:
        lines = Environment((mark,)).walls()
    for x0, y0, x1, y1 in lines:
        turn = math.atan2(y1 - y0, x1 - x0)
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[max(math.hypot(x1 - x0, y1 - y0) / 2, 1e-3), half / 2, 0.002],
            pos=[(x0 + x1) / 2, (y0 + y1) / 2, 0.002],
            quat=[math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2)],
            rgba=colour, contype=0, conaffinity=0,
        )  # fmt: skip


def _rows(environment: Environment) -> set[tuple[float, ...]]:
    """The pieces of an environment, each in both directions."""
    walls = environment.walls()
    return {_row(each) for each in (*walls, *walls[:, [2, 3, 0, 1]])}


def _row(segment: Floats) -> tuple[float, ...]:
    return tuple(np.round(segment, 6).tolist())


def _bounds(environment: Environment) -> tuple[Floats, Floats]:
    """Both corners (2,) of the box about all walls and points, m."""
    points = [(mark.x_m, mark.y_m) for mark in environment.markers.values() if isinstance(mark, Point)]
    every = np.concatenate([environment.walls().reshape(-1, 2), np.reshape(points, (-1, 2))])
    return every.min(axis=0) - FENCE, every.max(axis=0) + FENCE


def _draw(model: Path, out: Path) -> None:
    """Renders a scene to a PNG. Runs in the process of its own, whose OpenGL library `MUJOCO_GL` names."""
    import cv2

    compiled = mujoco.MjModel.from_xml_path(str(model))
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    camera = _camera(compiled, data)
    compiled.stat.extent = camera.distance  # the near and the far plane are shares of it
    renderer = mujoco.Renderer(compiled, HEIGHT, WIDTH)
    renderer.update_scene(data, camera)
    pixels = renderer.render()
    if pixels.min() == pixels.max():
        raise RuntimeError("rendered nothing")
    done, png = cv2.imencode(".png", pixels[:, :, ::-1])
    if not done:
        raise RuntimeError("no PNG was made")
    part = out.with_suffix(".part")
    part.write_bytes(png.tobytes())
    part.replace(out)


def _camera(model: mujoco.MjModel, data: mujoco.MjData) -> mujoco.MjvCamera:
    """A camera that sees all boxes of a scene, as near as that lets it be."""
    boxes = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_BOX)
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1)
    corners = np.concatenate(
        [data.geom_xpos[k] + (data.geom_xmat[k].reshape(3, 3) @ (model.geom_size[k][:, None] * signs)).T for k in boxes]
    )
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    azimuth, elevation = math.radians(AZIMUTH_DEG), math.radians(ELEVATION_DEG)
    ahead = np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth),
                      math.sin(elevation)])  # fmt: skip
    right = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    up = np.cross(right, ahead)
    high = math.tan(math.radians(float(model.vis.global_.fovy)) / 2)
    to = corners - middle
    needed = np.maximum(np.abs(to @ right) / (high * WIDTH / HEIGHT), np.abs(to @ up) / high) - to @ ahead
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = middle
    camera.azimuth, camera.elevation = AZIMUTH_DEG, ELEVATION_DEG
    camera.distance = ROOM * float(needed.max())
    return camera


if __name__ == "__main__":
    try:
        _draw(Path(sys.argv[1]), Path(sys.argv[2]))
    except BaseException as error:
        print(f"{type(error).__name__}: {' '.join(str(error).split())}", flush=True)
        os._exit(1)
    os._exit(0)  # libraries that fail when they are left have done their work
