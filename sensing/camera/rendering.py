"""What cameras see, rendered off-screen by MuJoCo, and whose cone each pixel shows.

A pair of cameras is two MJCF cameras of a robot, `camera_left` and `camera_right`. A wide pinhole image is rendered
and, for an equal-angle lens, remapped. The light is even: most of it ambient, some from straight above, no shadows, so
that a cone's colour hardly changes about it. An image is rendered when it is asked for, never else.

Whose cone a pixel shows is read from a second rendering, in which each solid has a colour of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from sensing.camera import opengl
from sensing.camera.lens import Lens, remap, remap_labels, remap_tables
from sensing.types import NOBODY, Images, ScanTruth

LEFT, RIGHT = "camera_left", "camera_right"
CONE = "cone"
"""Name of the geom that trackers look for."""
AMBIENT, OVERHEAD = 0.65, 0.30
"""Shares of the nominal light: a choice, by which an orange cone keeps its hue and value all around it."""
NEAREST_M, FARTHEST_M = 0.01, 60.0
"""Of what is drawn. Choices: nearer is inside the robot's own outline, farther a cone is below one pixel."""
FLOOR_M = 500.0
"""Half the side of the floor as it is drawn, in one piece: an endless one is cut into 40,000 pieces, and drawing them
takes three quarters of the time."""

Image = NDArray[np.uint8]
Owners = NDArray[np.int16]
_SEGMENT, _IDS = int(mujoco.mjtRndFlag.mjRND_SEGMENT), int(mujoco.mjtRndFlag.mjRND_IDCOLOR)
_PLAIN = (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION)


class Shown(NamedTuple):
    """Whose cone each pixel of a pair of images shows."""

    left: Owners
    """(H, W) index of the robot; −1 = no cone."""
    right: Owners
    left_robots: Owners
    """(H, W) the same of robots as a whole, their cones included."""
    right_robots: Owners


class Standing(NamedTuple):
    """Where things stand as an image is taken, in the world frame; N robots."""

    lens_w: Floats
    """(3,) x and y of the lens, m, and where its axis points, rad."""
    cones_w: Floats
    """(N, 2) the axes of the robots' cones, m; nan of a robot without one."""
    robots_w: Floats
    """(N, 2) the robots' own centres, m."""


class Cameras:
    """The camera pairs of all robots of one compiled model.

    The data that they look at may be of another model, if its bodies and joints are the same.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        prefixes: Sequence[str],
        lenses: Sequence[Lens | None],
        light: float = 1.0,
        colours: Sequence[tuple[float, float, float]] | None = None,
    ) -> None:
        """`prefixes` of the names of each robot's parts; its lens, None where it has no cameras.

        `light`: of the nominal light. `colours` of the robots' cones, red, green and blue from 0 to 1; by default their
        own. The model is changed, and belongs to the cameras. Raises `InputError` where nothing renders.
        """
        self.model, self.lenses = model, tuple(lenses)
        self._data = mujoco.MjData(model)
        self._time = -1.0
        self._coded: Owners | None = None
        self._owner = np.full(model.ngeom, NOBODY, np.int16)
        self._robot = np.full(model.ngeom, NOBODY, np.int16)
        roots = [model.body(int(root)).name for root in model.body_rootid[model.geom_bodyid]]
        self._cameras: list[tuple[int, int]] = []
        self._cones, self._roots = list[int](), list[int]()
        for k, prefix in enumerate(prefixes):
            cone = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, f"{prefix}{CONE}")
            own = np.array([root.startswith(prefix) for root in roots])
            self._robot[own] = k
            self._cones.append(cone)
            self._roots.append(int(model.body_rootid[model.geom_bodyid[own.argmax()]]))
            if cone >= 0:
                self._owner[cone] = k
                if colours is not None:
                    model.geom_rgba[cone, :3] = colours[k]
            pair = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, f"{prefix}{each}") for each in (LEFT, RIGHT)]
            self._cameras.append((pair[0], pair[1]))
        tables = {lens: remap_tables(lens) for lens in lenses if lens is not None}
        for lens, cameras in zip(lenses, self._cameras, strict=True):
            if lens is not None:
                model.cam_fovy[list(cameras)] = np.degrees(tables[lens].fovy_rad)
        self._tables = tables
        _illuminate(model, light)
        self._eye = _Eye(model, [(table.rendered_width, table.rendered_height) for table in tables.values()])

    def size(self, k: int) -> tuple[int, int]:
        """Rows and columns of robot k's images."""
        lens = self._lens(k)
        return lens.height_px, lens.width_px

    def look(self, data: mujoco.MjData, k: int, time: float, lag_s: float = 0.0) -> Images:
        """The images of robot k at `data`'s places; the right one `lag_s` later, as the robots move then."""
        left, right = self._pair(data, k, lag_s, ids=False)
        return Images(time, left, right)

    def shown(self, data: mujoco.MjData, k: int, lag_s: float = 0.0) -> Shown:
        """Whose cones the pixels of the same `look` show."""
        table, found = self._tables[self._lens(k)], []
        for pixels in self._pair(data, k, lag_s, ids=True):
            coded = pixels[:, :, 0].astype(np.int32) | pixels[:, :, 1].astype(np.int32) << 8
            found.append([
                np.ascontiguousarray(remap_labels(of_code[coded][::-1], table))
                for of_code in (self._owner_of_code(), self._of_codes(self._robot))
            ])  # fmt: skip
        (left, left_robots), (right, right_robots) = found
        return Shown(left, right, left_robots, right_robots)

    def truth(self, data: mujoco.MjData, k: int, lag_s: float = 0.0) -> ScanTruth:
        """Whose cone each column of the same `look` shows, of the left and then of the right image: that of most of its
        pixels."""
        table, columns = self._tables[self._lens(k)], []
        for pixels in self._pair(data, k, lag_s, ids=True):
            owners = _of_columns(pixels, self._owner_of_code(), len(self.lenses))
            columns.append(owners[table.columns])
        of_both = np.concatenate(columns)
        seen = of_both[of_both >= 0]
        return ScanTruth(of_both, np.empty(0), np.bincount(seen, minlength=len(self.lenses)).astype(np.int64))

    def standing(self, data: mujoco.MjData, k: int, right: bool, lag_s: float = 0.0) -> Standing:
        """Where robot k's left or right lens, and all cones and robots are as the same `look` takes that image."""
        self._place(data, lag_s if right else 0.0)
        camera, cones, its = self._cameras[k][right], np.array(self._cones), self._data
        ahead = -its.cam_xmat[camera].reshape(3, 3)[:, 2]
        lens = np.array([*its.cam_xpos[camera, :2], math.atan2(ahead[1], ahead[0])])
        return Standing(
            lens, np.where(cones[:, None] >= 0, its.geom_xpos[cones, :2], np.nan), its.xpos[self._roots, :2].copy()
        )

    def _pair(self, data: mujoco.MjData, k: int, lag_s: float, ids: bool) -> Iterator[Image]:
        """The left image of robot k at `data`'s places and then the right one, `lag_s` later."""
        for side in range(2):
            self._place(data, lag_s if side else 0.0)
            yield self._pixels(k, side, self._lens(k), ids)

    def _lens(self, k: int) -> Lens:
        lens = self.lenses[k]
        assert lens is not None
        return lens

    def _place(self, data: mujoco.MjData, lag_s: float = 0.0) -> None:
        """Brings all that can be seen to where it is."""
        if data.time == self._time and not lag_s:
            return
        self._time = data.time if not lag_s else -1.0
        self._data.qpos[:] = data.qpos
        if lag_s:
            mujoco.mj_integratePos(self.model, self._data.qpos, data.qvel, lag_s)
        self._data.mocap_pos[:], self._data.mocap_quat[:] = data.mocap_pos, data.mocap_quat
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_camlight(self.model, self._data)

    def _pixels(self, k: int, side: int, lens: Lens, ids: bool) -> Image:
        table = self._tables[lens]
        pixels = self._eye.render(self._data, self._cameras[k][side], table.rendered_width, table.rendered_height, ids)
        if ids:
            return pixels
        return self._remapped(pixels, lens)

    def _remapped(self, pixels: Image, lens: Lens) -> Image:
        """An image as rendered, from the lowest row up, as the lens shows it, from the highest row down."""
        table = self._tables[lens]
        if table.map1 is None:
            return np.asarray(cv2.flip(pixels, 0), np.uint8)
        return remap(pixels[::-1], table)

    def _owner_of_code(self) -> Owners:
        """The owner of the cone that each number in the colours of a rendering stands for: always the same, since all
        that can be seen is in every scene."""
        if self._coded is None:
            self._coded = self._of_codes(self._owner)
        return self._coded

    def _of_codes(self, of_geom: Owners) -> Owners:
        """What `of_geom` (ngeom,) says of the solid for which each number in the colours of a rendering stands."""
        scene = self._eye.scene
        owner = np.full(scene.ngeom + 2, NOBODY, np.int16)
        for geom in scene.geoms[: scene.ngeom]:
            if geom.segid >= 0 and geom.objtype == mujoco.mjtObj.mjOBJ_GEOM:
                owner[geom.segid + 1] = of_geom[geom.objid]
        return owner


class _Eye:
    """MuJoCo's renderer with one context for images of several sizes."""

    def __init__(self, model: mujoco.MjModel, sizes: Sequence[tuple[int, int]]) -> None:
        width, height = max(size[0] for size in sizes), max(size[1] for size in sizes)
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self.model = model
        self._gl = opengl.context()
        self._gl.make_current()
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        self.scene = mujoco.MjvScene(model, model.ngeom + 100)
        self._options, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._options.sitegroup[:] = 0
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        for flag in _PLAIN:
            self.scene.flags[flag] = 0
        self._buffers = {size: np.empty((size[1], size[0], 3), np.uint8) for size in sizes}

    def __del__(self) -> None:
        """Frees what it draws with in the context that it was made in."""
        if hasattr(self, "_drawing"):
            self._gl.make_current()
            self._drawing.free()

    def render(self, data: mujoco.MjData, camera: int, width: int, height: int, ids: bool) -> Image:
        """(height, width, 3) from the lowest row up, in an array that the next call writes over."""
        self._gl.make_current()
        self._camera.fixedcamid = camera
        mujoco.mjv_updateScene(
            self.model, data, self._options, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL.value, self.scene
        )
        self.scene.flags[_SEGMENT] = self.scene.flags[_IDS] = ids
        rect, pixels = mujoco.MjrRect(0, 0, width, height), self._buffers[width, height]
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        mujoco.mjr_render(rect, self.scene, self._drawing)
        mujoco.mjr_readPixels(pixels, None, rect, self._drawing)
        return pixels


def _illuminate(model: mujoco.MjModel, light: float) -> None:
    """Even light, and what makes drawing fast."""
    look, quality = model.vis, model.vis.quality
    look.headlight.active = 1
    look.headlight.ambient[:], look.headlight.diffuse[:], look.headlight.specular[:] = AMBIENT * light, 0.0, 0.0
    model.light_active[:] = 0
    if model.nlight:
        model.light_active[0], model.light_castshadow[0] = 1, 0
        model.light_type[0] = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        model.light_ambient[0], model.light_diffuse[0], model.light_specular[0] = 0.0, OVERHEAD * light, 0.0
        model.light_pos0[0], model.light_dir0[0] = (0.0, 0.0, 6.0), (0.0, 0.0, -1.0)
        model.light_pos[0], model.light_dir[0] = (0.0, 0.0, 6.0), (0.0, 0.0, -1.0)
    quality.offsamples, quality.shadowsize = 0, 0
    look.map.znear, look.map.zfar = NEAREST_M / model.stat.extent, FARTHEST_M / model.stat.extent
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    model.geom_size[planes] = FLOOR_M, FLOOR_M, 2.0 * FLOOR_M


def _of_columns(pixels: Image, owner: Owners, robots: int) -> Ints:
    """(W,) the owner of most pixels of each column that show a cone; −1 = none. `pixels` (H, W, 3) hold numbers."""
    counts = np.zeros((pixels.shape[1], robots), np.int64)
    _count(pixels, owner, counts)
    return np.where(counts.any(axis=1), counts.argmax(axis=1), NOBODY).astype(np.int64)


@compiled
def _count(pixels: Image, owner: Owners, counts: Ints) -> None:
    """Adds up the pixels of each column that show the cone of each robot."""
    for row in range(pixels.shape[0]):
        for column in range(pixels.shape[1]):
            code = pixels[row, column, 0] + 256 * pixels[row, column, 1]
            if owner[code] >= 0:
                counts[column, owner[code]] += 1
