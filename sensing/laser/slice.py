"""What stands at the laser's height: the world cut by one level plane, taken from the compiled model.

Every geom that the plane cuts must be an upright prism there, so that the cut keeps its outline while bodies move
on the floor: boxes give rectangles, cylinders, spheres and capsules give discs. Anything else is an error that
names the other method, the rays of MuJoCo in `sensing.laser.reference`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats, Ints
from sensing.types import NOBODY

FIXED = -1
"""Frame of what does not move."""
UPRIGHT_RAD = 1e-3
"""How far the axis of a prism, a body or a laser may lean in the model's reference pose."""
CLEARANCE_M = 0.002
"""A geom that begins or ends within this distance of the plane is ambiguous, hence an error."""
POLYGON_SIDES = 24
"""Chords that stand for a fixed disc among the walls."""

_BOX, _CYLINDER, _SPHERE, _CAPSULE = (
    int(mujoco.mjtGeom.mjGEOM_BOX),
    int(mujoco.mjtGeom.mjGEOM_CYLINDER),
    int(mujoco.mjtGeom.mjGEOM_SPHERE),
    int(mujoco.mjtGeom.mjGEOM_CAPSULE),
)


@dataclass(frozen=True)
class Slice:
    """P shapes at one height, in F moving frames. The first `rectangles` shapes are rectangles, the rest discs."""

    height_m: float
    rectangles: int
    shapes: Floats
    """(P, 6) in the shape's frame, m: a rectangle is centre x, y, cosine and sine of its x axis, half sizes along
    its own x and y; a disc is centre x, y, 1, 0, radius, radius."""
    frames: Ints
    """(P,) row of the frame that carries the shape; −1 = fixed in the world."""
    owners: Ints
    """(P,) which of the roots the shape belongs to; −1 = none."""
    materials: Floats
    """(P, 2) diffuse albedo and retroreflective gain."""
    geoms: Ints
    """(P,) id of the geom."""
    bodies: Ints
    """(F,) id of the body whose frame it is."""
    addresses: Ints
    """(F,) where the body's free joint stands in qpos; −1 = moved by other joints, or by mocap."""
    levels_m: Floats
    """(F,) height of the plane above the frame's origin in the model's reference pose."""

    def walls_w(self) -> Floats:
        """(W, 4) segments x0, y0, x1, y1 of all that is fixed and belongs to no root, m; discs as chords."""
        segments = []
        for p in np.flatnonzero((self.frames == FIXED) & (self.owners == NOBODY)):
            x, y, cosine, sine, a, b = self.shapes[p]
            if p < self.rectangles:
                outline = np.array([[a, b], [-a, b], [-a, -b], [a, -b]])
                corners = outline @ np.array([[cosine, sine], [-sine, cosine]])
            else:
                turn = 2.0 * np.pi * np.arange(POLYGON_SIDES) / POLYGON_SIDES
                corners = a * np.stack([np.cos(turn), np.sin(turn)], axis=1)
            corners = corners + np.array([x, y])
            segments.append(np.hstack([corners, np.roll(corners, -1, axis=0)]))
        return np.concatenate(segments) if segments else np.empty((0, 4))

    def silhouette_radii(self, roots: Sequence[int], model: mujoco.MjModel) -> Floats:
        """(N,) greatest distance of each root's shapes from the root's vertical axis, m; 0 = none at this height."""
        data = reference_pose(model)
        radii = np.zeros(len(roots))
        for p, owner in enumerate(self.owners):
            if owner == NOBODY:
                continue
            x, y, cosine, sine, a, b = self.shapes[p]
            turn = _frame_matrix(data, self._body(p))
            centre = _frame_position(data, self._body(p))[:2] + turn[:2, :2] @ (x, y)
            offset = centre - data.xpos[roots[owner]][:2]
            if p < self.rectangles:
                axis = turn[:2, :2] @ (cosine, sine)
                across = np.array([-axis[1], axis[0]])
                reach = max(
                    float(np.hypot(*(offset + i * a * axis + j * b * across))) for i in (-1, 1) for j in (-1, 1)
                )
            else:
                reach = float(np.hypot(*offset)) + a
            radii[owner] = max(radii[owner], reach)
        return radii

    def _body(self, shape: int) -> int:
        return int(self.bodies[self.frames[shape]]) if self.frames[shape] != FIXED else 0


def slice_at(
    model: mujoco.MjModel, height_m: float, roots: Sequence[int] = (), also_moving: Sequence[int] = ()
) -> Slice:
    """Cut `model` at `height_m` above z = 0, bodies in their reference pose (qpos0).

    `roots` are the ids of the bodies (robots) that own everything beneath them. Bodies of `also_moving` get a frame
    even where the plane cuts nothing of them.
    Raises InputError where a geom at that height is no upright prism, or has no reflectance.
    """
    data = reference_pose(model)
    bodies: list[int] = []
    for body in also_moving:
        _frame_of(model, data, moving_body(model, body), bodies)
    found: list[tuple[bool, Floats, int, int, Floats, int]] = []
    for geom in range(model.ngeom):
        cut = _cut(model, data, geom, height_m)
        if cut is None:
            continue
        is_rectangle, shape_w = cut
        body = moving_body(model, int(model.geom_bodyid[geom]))
        frame = _frame_of(model, data, body, bodies)
        shape = shape_w if frame == FIXED else _in_frame(shape_w, data, body)
        owner = owner_of(model, int(model.geom_bodyid[geom]), roots)
        found.append((is_rectangle, shape, frame, owner, _reflectance(model, geom), geom))
    found.sort(key=lambda entry: not entry[0])
    return Slice(
        height_m=height_m,
        rectangles=sum(entry[0] for entry in found),
        shapes=np.array([entry[1] for entry in found], dtype=np.float64).reshape(-1, 6),
        frames=np.array([entry[2] for entry in found], dtype=np.int64),
        owners=np.array([entry[3] for entry in found], dtype=np.int64),
        materials=np.array([entry[4] for entry in found], dtype=np.float64).reshape(-1, 2),
        geoms=np.array([entry[5] for entry in found], dtype=np.int64),
        bodies=np.array(bodies, dtype=np.int64),
        addresses=np.array([_free_address(model, body) for body in bodies], dtype=np.int64),
        levels_m=np.array([height_m - data.xpos[body][2] for body in bodies], dtype=np.float64),
    )


def reference_pose(model: mujoco.MjModel) -> mujoco.MjData:
    """Data of `model` with every body where qpos0 puts it."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data


def moving_body(model: mujoco.MjModel, body: int) -> int:
    """The nearest body at or above `body` that has a joint or is a mocap body; 0 = fixed in the world."""
    while body > 0 and model.body_jntnum[body] == 0 and model.body_mocapid[body] < 0:
        body = int(model.body_parentid[body])
    return body


def owner_of(model: mujoco.MjModel, body: int, roots: Sequence[int]) -> int:
    """Index in `roots` of the root at or above `body`, −1 if there is none."""
    rows = {int(root): row for row, root in enumerate(roots)}
    while body > 0:
        if body in rows:
            return rows[body]
        body = int(model.body_parentid[body])
    return NOBODY


def body_name(model: mujoco.MjModel, body: int) -> str:
    """How messages call a body."""
    return f"body {model.body(body).name!r}" if model.body(body).name else f"body {body}"


def geom_name(model: mujoco.MjModel, geom: int) -> str:
    """How messages call a geom."""
    name = model.geom(geom).name
    return f"geom {name!r}" if name else f"geom {geom} of {body_name(model, int(model.geom_bodyid[geom]))}"


def is_visible(model: mujoco.MjModel, geom: int) -> bool:
    """False for what is wholly transparent: MuJoCo's rays pass through it, and so do ours."""
    material = int(model.geom_matid[geom])
    return bool((model.geom_rgba[geom, 3] if material < 0 else model.mat_rgba[material, 3]) > 0.0)


def _frame_of(model: mujoco.MjModel, data: mujoco.MjData, body: int, bodies: list[int]) -> int:
    if body == 0:
        return FIXED
    if body not in bodies:
        if data.xmat[body].reshape(3, 3)[2, 2] < np.cos(UPRIGHT_RAD):
            raise InputError(
                f"{body_name(model, body)} leans in the reference pose: expected its z axis upright, "
                "or use the rays of sensing.laser.reference"
            )
        bodies.append(body)
    return bodies.index(body)


def _free_address(model: mujoco.MjModel, body: int) -> int:
    first = int(model.body_jntadr[body])
    if first >= 0 and model.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE:
        return int(model.jnt_qposadr[first])
    return -1


def _frame_matrix(data: mujoco.MjData, body: int) -> Floats:
    return np.asarray(data.xmat[body]).reshape(3, 3)


def _frame_position(data: mujoco.MjData, body: int) -> Floats:
    return np.asarray(data.xpos[body])


def _in_frame(shape_w: Floats, data: mujoco.MjData, body: int) -> Floats:
    """A shape of the world as the (level) body sees it."""
    turn = _frame_matrix(data, body)[:2, :2]
    centre = (shape_w[:2] - _frame_position(data, body)[:2]) @ turn
    axis = shape_w[2:4] @ turn
    return np.array([*centre, *(axis / np.hypot(*axis)), *shape_w[4:]])


def _cut(model: mujoco.MjModel, data: mujoco.MjData, geom: int, height_m: float) -> tuple[bool, Floats] | None:
    """The geom's section in world axes: (is it a rectangle, shape), or None where the plane misses it."""
    if not is_visible(model, geom):
        return None
    kind = int(model.geom_type[geom])
    position = np.asarray(data.geom_xpos[geom])
    turn = np.asarray(data.geom_xmat[geom]).reshape(3, 3)
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        if abs(turn[2, 2]) < np.cos(UPRIGHT_RAD):
            raise _no_prism(model, geom, height_m)
        return None
    half = _half_height(model, geom, kind, turn)
    middle = position[2] + (turn @ model.geom_aabb[geom, :3])[2]
    off = abs(height_m - middle)
    if off > half + CLEARANCE_M:
        return None
    upright = abs(turn[2]) > np.cos(UPRIGHT_RAD)
    size = model.geom_size[geom]
    is_box = kind == _BOX and bool(upright.any())
    if not (is_box or kind == _SPHERE or (kind in (_CYLINDER, _CAPSULE) and bool(upright[2]))):
        raise _no_prism(model, geom, height_m)
    if off > half - CLEARANCE_M:
        raise InputError(
            f"{geom_name(model, geom)} ends {1000 * (half - off):.1f} mm above or below the laser's height "
            f"{height_m:g} m: expected it to end farther than {1000 * CLEARANCE_M:g} mm from there"
        )
    if is_box:
        vertical = int(np.argmax(abs(turn[2])))
        first, second = (axis for axis in range(3) if axis != vertical)
        axis = turn[:2, first] / np.hypot(*turn[:2, first])
        return True, np.array([*position[:2], *axis, size[first], size[second]])
    radius = float(size[0])
    cap = off if kind == _SPHERE else max(0.0, off - float(size[1])) if kind == _CAPSULE else 0.0
    section = np.sqrt(radius**2 - cap**2)
    return False, np.array([*position[:2], 1.0, 0.0, section, section])


def _half_height(model: mujoco.MjModel, geom: int, kind: int, turn: Floats) -> float:
    """Half the extent along z, m; for meshes, height fields and the like that of the geom's bounding box."""
    size = model.geom_size[geom]
    if kind == _SPHERE:
        return float(size[0])
    if kind == _CYLINDER:
        return float(size[1] * abs(turn[2, 2]) + size[0] * np.hypot(turn[2, 0], turn[2, 1]))
    if kind == _CAPSULE:
        return float(size[1] * abs(turn[2, 2]) + size[0])
    return float(abs(turn[2]) @ model.geom_aabb[geom, 3:])


def _no_prism(model: mujoco.MjModel, geom: int, height_m: float) -> InputError:
    kind = mujoco.mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_").lower()
    return InputError(
        f"{geom_name(model, geom)} ({kind}) is no upright prism at the laser's height {height_m:g} m: expected an "
        "upright box, cylinder or capsule or a sphere, or use the rays of sensing.laser.reference"
    )


def _reflectance(model: mujoco.MjModel, geom: int) -> Floats:
    """[diffuse albedo, retroreflective gain] from the geom's user data."""
    values = np.asarray(model.geom_user[geom][:2], dtype=np.float64) if model.nuser_geom >= 2 else np.zeros(2)
    if not np.all(np.isfinite(values)) or np.any(values < 0.0) or not np.any(values > 0.0) or values[0] > 1.0:
        raise InputError(
            f"{geom_name(model, geom)} stands at the laser's height with reflectance {values.tolist()}: expected "
            'user="DIFFUSE RETRO" with an albedo of 0 to 1 and a gain of at least 0, not both 0'
        )
    return values
