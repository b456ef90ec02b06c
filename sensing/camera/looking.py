"""What the pipelines that read images share: their parameters, where the cameras are, and runs as cones in the plane.

A cone's position is in the robot's body frame: the camera's place and, from there along its bearing, the distance |d|
of equation 3.5, so it lies on the cone's near side, as a laser's readings do. A cone in both images is one: the wider
run (the closer cone) stands for it, and a run of the other image that its tangents, as the other camera would see them,
meet is the same cone's.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, NamedTuple

import mujoco
import numpy as np

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import NO_OBSTACLES, Floats, Ints, Members, Obstacles, unknown
from sensing import echoes
from sensing.camera.colours import HSV, KINDS, PUBLISHED, Segmentation
from sensing.camera.cones import NEAREST_M, RADIUS_M, edges_of
from sensing.camera.images import Images, Picture
from sensing.camera.palette import CALIBRATED, MOST_ROBOTS, one_each
from sensing.camera.runs import LARGEST_HOLE_PX
from sensing.camera.segmentation import Labels, segment_into
from sensing.types import NOBODY, Senses

CAMERAS = ("camera_left", "camera_right")
"""Names of the cameras in a robot's model (a prefix is allowed)."""
LEVEL = math.radians(1.0)
"""A camera's axis may lean by this much: in a camera that leans more, a column is no bearing."""

EQUAL_ANGLE, LENS = ASSUMPTIONS = ("equal-angle", "lens")
OFFSETS = CAMERA, MIDDLE, NONE = ("camera", "middle", "none")
"""Where places are told from: the robot's centre, each camera where it is; the middle between both cameras, where it is
in the distance that counts from a lens; or the robot's centre as if both cameras were there."""
RANGES = ("calibrated", "published")

# the fields of the pipelines' parameters, each declared once
SegmentationKind = Annotated[
    str, Parameter("", "Kirchner 2006, section 3.6.4.3: what worked best", published=True, choices=KINDS)
]
Ranges = Annotated[str, Parameter("", "choice: the thesis calibrated on its own images, too", choices=RANGES)]
Colours = Annotated[int, Parameter("colours", "Kirchner 2006, section 3.6.2", published=True, low=1, high=MOST_ROBOTS)]
LargestHole = Annotated[int, Parameter("px", "Kirchner 2006, section 3.6.5", published=True, low=0, high=10000)]
ConeRadius = Annotated[float, Parameter("m", "Kirchner 2006, section 3.6.6", published=True, low=1e-6, high=10.0)]
Assumption = Annotated[
    str,
    Parameter(
        "",
        "Kirchner 2006, section 3.6.6: 5.12 everywhere",
        published=True,
        choices=ASSUMPTIONS,
    ),
]
Offset = Annotated[
    str,
    Parameter("", "choice: the thesis leaves the cameras' places out", choices=OFFSETS, plausible=OFFSETS),
]
MinimumRun = Annotated[int, Parameter("px", "choice: 4 px are a cone at 24 ft, noise is shorter", low=1, high=10000)]


SHARED = (
    "segmentation", "ranges", "colours", "largest_hole_px", "minimum_run_px", "cone_radius_m", "pixels_per_degree",
    "offset",
)  # fmt: skip
"""The parameters that `gaze` takes."""


class Eyes(NamedTuple):
    """The two cameras of a robot, left and right."""

    edges: Floats
    """(2, W + 1) bearing of each column's borders in the camera's frame, as taken to be, rad, left positive."""
    mounts: Floats
    """(2, 3) x, y (m) and yaw (rad) of each in the body frame."""


class Gaze(NamedTuple):
    """What a pipeline needs of its parameters, and memory that every image pair writes over."""

    segmentation: Segmentation
    eyes: Eyes
    largest_hole_px: int
    minimum_run_px: int
    radius_m: float
    origin: Floats
    """(2,) what places are counted from, m, body frame: the robot's centre, or the middle between the cameras; that
    middle also stands for either camera where each counts from itself (`offset` of `none`)."""
    labels: tuple[Labels, Labels]
    """(H, W) each; made anew when images of another size come."""

    @property
    def colours(self) -> int:
        """How many colours there are: more than one tell robots apart."""
        return len(self.segmentation.colours)

    @property
    def columns(self) -> int:
        """W."""
        return self.eyes.edges.shape[1] - 1


@lru_cache(maxsize=16)
def camera_mounts(model: mujoco.MjModel) -> tuple[tuple[float, float, float], ...]:
    """x, y (m) and yaw (rad) of the left and the right camera in the frame of the robot that is alone in `model`.

    MuJoCo's cameras look along their −z axis. Raises InputError where one is missing or does not look level.
    """
    names = [model.cam(k).name for k in range(model.ncam)]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    mounts = []
    for wanted in CAMERAS:
        found = [k for k, name in enumerate(names) if name.rpartition("/")[2] == wanted]
        if len(found) != 1:
            raise InputError(f"model with cameras {names}: expected exactly one named {wanted!r}")
        root = model.body_rootid[model.cam_bodyid[found[0]]]
        to_root = data.xmat[root].reshape(3, 3).T
        x, y, _ = to_root @ (data.cam_xpos[found[0]] - data.xpos[root])
        ahead = -(to_root @ data.cam_xmat[found[0]].reshape(3, 3)[:, 2])
        up = to_root @ data.cam_xmat[found[0]].reshape(3, 3)[:, 1]
        if max(abs(ahead[2]), math.hypot(up[0], up[1])) > math.sin(LEVEL):
            raise InputError(f"camera {names[found[0]]!r} leans: expected it level within {math.degrees(LEVEL):g} deg")
        mounts.append((float(x), float(y), math.atan2(ahead[1], ahead[0])))
    return tuple(mounts)


def gaze(
    segmentation: str = HSV,
    ranges: str = RANGES[0],
    colours: int = 1,
    largest_hole_px: int = LARGEST_HOLE_PX,
    minimum_run_px: int = 1,
    cone_radius_m: float = RADIUS_M,
    pixels_per_degree: str = EQUAL_ANGLE,
    offset: str = CAMERA,
    *,
    member_model: mujoco.MjModel,
    angles: Floats,
) -> Gaze:
    """Of a pipeline's parameters, the robot's model and the true bearing (2, W) of each column in its camera's frame.

    Raises InputError for other angles, for a model without the two cameras, for several colours by published ranges.
    """
    angles = np.asarray(angles, dtype=np.float64)
    if angles.ndim != 2 or angles.shape[0] != 2 or angles.shape[1] < 1 or not np.all(np.diff(angles) < 0.0):
        raise InputError(f"angles of shape {angles.shape}: expected (2, columns), falling from the left to the right")
    if colours > 1 and ranges != RANGES[0]:
        raise InputError(f"ranges = {ranges!r} with {colours} colours: expected {RANGES[0]!r}, or colours = 1")
    looked_for = one_each(segmentation, colours) if colours > 1 else {RANGES[0]: CALIBRATED, RANGES[1]: PUBLISHED}[
        ranges
    ][segmentation]  # fmt: skip
    edges = np.stack([edges_of(row) for row in angles])
    if pixels_per_degree == EQUAL_ANGLE:
        half = (edges[:, :1] - edges[:, -1:]) / 2.0
        edges = half * np.linspace(1.0, -1.0, edges.shape[1])
    mounts, origin = np.array(camera_mounts(member_model)), np.zeros(2)
    if offset != CAMERA:
        origin = mounts[:, :2].mean(axis=0)
        mounts[:, :2] = mounts[:, :2] - origin if offset == MIDDLE else 0.0
    none = np.empty((0, 0), np.uint8)
    eyes, radius_m = Eyes(edges, mounts), float(cone_radius_m)
    return Gaze(looked_for, eyes, int(largest_hole_px), int(minimum_run_px), radius_m, origin, (none, none))


def labelled(images: Images, state: Gaze) -> Gaze:
    """The state with the labels of both images. Raises InputError for images of another width than the lens's."""
    return state._replace(labels=(_labelled(images.left, state, 0), _labelled(images.right, state, 1)))


def _labelled(image: Picture, state: Gaze, side: int) -> Labels:
    labels = state.labels[side]
    if labels.shape != image.shape[:2]:
        if image.ndim != 3 or image.shape[1] != state.columns:
            raise InputError(f"image of shape {image.shape}: expected (H, {state.columns}, 3), as wide as the lens's")
        labels = np.empty(image.shape[:2], np.uint8)
    segment_into(image, state.segmentation, labels)
    return labels


def members_of(positions: Floats, ids: Ints, known: bool) -> Members:
    """Members at positions (M, 2); `known` says whether the ids tell which robot each is."""
    headings, velocities, anonymous = unknown(len(positions))
    bearings = np.arctan2(positions[:, 1], positions[:, 0])
    return Members(positions, bearings, headings, velocities, ids if known else anonymous)


def nothing_seen(state: Gaze) -> tuple[Members, Ints]:
    """No member, and the row (none) of each column."""
    return members_of(np.empty((0, 2)), np.empty(0, np.int64), False), np.full(2 * state.columns, NOBODY)


def obstacles(senses: Senses, places: Floats, state: Gaze) -> Obstacles:
    """The echoes of a robot with sonars that no cone at these places (M, 2) explains (`sensing.echoes`); else none."""
    if senses.echoes is None:
        return NO_OBSTACLES
    return echoes.obstacles(senses.echoes, places + state.origin)


@compiled
def seen_at(start: float, end: float, mount: Floats, radius: float) -> tuple[float, float, float]:
    """Place x, y (m, body frame) of a cone's near side, and |d| (m), from the bearings (rad) of its borders (3.5)."""
    half = (start - end) / 2.0
    distance = radius / math.tan(half) - radius if half < math.pi / 2.0 else 0.0
    distance = max(distance, NEAREST_M)
    bearing = (start + end) / 2.0 + mount[2]
    return mount[0] + distance * math.cos(bearing), mount[1] + distance * math.sin(bearing), distance


class Sighted(NamedTuple):
    """What may be cones, in either image."""

    found: Ints
    """(R, 4) camera (0 left, 1 right), colour, first and last column."""
    borders: Floats
    """(R, 2) bearing of the left and the right border in the camera's frame, rad."""


@compiled
def _gathered(left: Ints, right: Ints, edges: Floats) -> tuple[Ints, Floats]:
    found, borders = np.empty((len(left) + len(right), 4), np.int64), np.empty((len(left) + len(right), 2))
    for r in range(len(found)):
        side = 0 if r < len(left) else 1
        run = left[r] if side == 0 else right[r - len(left)]
        found[r, 0], found[r, 1], found[r, 2], found[r, 3] = side, run[0], run[2], run[3]
        borders[r, 0], borders[r, 1] = edges[side, run[2]], edges[side, run[3] + 1]
    return found, borders


def sighted(left: Ints, right: Ints, eyes: Eyes) -> Sighted:
    """The runs (R, 4) of both images, each of which may be a cone."""
    return Sighted(*_gathered(left, right, eyes.edges))


class Cones(NamedTuple):
    """The cones that both images show, the widest first."""

    positions: Floats
    """(M, 2) of their near sides, m, body frame."""
    colours: Ints
    """(M,)."""
    columns: Ints
    """(2W,) which of them each column shows, −1 = none."""
    distances: Floats
    """(M,) |d| from the camera, m."""


def cones(seen: Sighted, state: Gaze, most: int) -> Cones:
    """At most so many cones; one that both images show is one."""
    return Cones(*_cones(*seen, state.eyes.mounts, state.radius_m, most, state.columns))


@compiled
def _cones(
    found: Ints, borders: Floats, mounts: Floats, radius: float, most: int, width: int
) -> tuple[Floats, Ints, Ints, Floats]:
    count = len(found)
    order = np.argsort(borders[:, 1] - borders[:, 0], kind="mergesort")
    positions, distances = np.empty((count, 2)), np.empty(count)
    colours, columns, free = np.empty(count, np.int64), np.full(2 * width, -1, np.int64), np.ones(count, np.bool_)
    members = 0
    for at in range(count):
        r = order[at]
        if not free[r] or members == most:
            continue
        side, other = found[r, 0], 1 - found[r, 0]
        x, y, distance = seen_at(borders[r, 0], borders[r, 1], mounts[side], radius)
        positions[members, 0], positions[members, 1], distances[members] = x, y, distance
        colours[members] = found[r, 1]
        # its tangents from the other camera
        bearing = (borders[r, 0] + borders[r, 1]) / 2.0 + mounts[side, 2]
        to_x = mounts[side, 0] + (distance + radius) * math.cos(bearing) - mounts[other, 0]
        to_y = mounts[side, 1] + (distance + radius) * math.sin(bearing) - mounts[other, 1]
        half = math.asin(min(radius / max(math.hypot(to_x, to_y), radius), 1.0))
        middle = wrap(math.atan2(to_y, to_x) - mounts[other, 2])
        for later in range(at, count):
            q = order[later]
            same = later == at or (
                free[q]
                and found[q, 0] == other
                and found[q, 1] == found[r, 1]
                and borders[q, 1] <= middle + half
                and borders[q, 0] >= middle - half
            )
            if same:
                free[q] = False
                columns[found[q, 0] * width + found[q, 2] : found[q, 0] * width + found[q, 3] + 1] = members
        members += 1
    return positions[:members].copy(), colours[:members].copy(), columns, distances[:members].copy()


@compiled
def spread(owners: Ints, distances: Floats, colours: Ints, edges: Floats, mounts: Floats) -> tuple[Floats, Ints, Ints]:
    """Positions (M, 2) and colours (M,) of one input a column that has an owner (2W,), and its row (2W,)."""
    width = len(owners) // 2
    count = int(np.sum(owners >= 0))
    positions, ids, columns = np.empty((count, 2)), np.empty(count, np.int64), np.full(len(owners), -1, np.int64)
    row = 0
    for j in range(len(owners)):
        if owners[j] < 0:
            continue
        side, column = j // width, j % width
        bearing = (edges[side, column] + edges[side, column + 1]) / 2.0 + mounts[side, 2]
        positions[row, 0] = mounts[side, 0] + distances[owners[j]] * math.cos(bearing)
        positions[row, 1] = mounts[side, 1] + distances[owners[j]] * math.sin(bearing)
        ids[row], columns[j] = colours[owners[j]], row
        row += 1
    return positions, ids, columns
