"""The contract for a body: what the rest of the program knows of a kind of robot.

A body is a folder of `robots` whose package holds one `BODY`; it is found by its folder and named by it (`-` and `_`
are equal). Beside `__init__.py` the folder has its XML: the robot alone on a floor, for any MuJoCo viewer
(`python -m robots.body` writes all of them).
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, Protocol, runtime_checkable

import mujoco

from flocking import users_files
from flocking.errors import InputError, unknown_name
from flocking.found import is_path, run
from flocking.types import Bools, Floats, Ints, Kind
from robots.physics import FLOOR_MASK, TIMESTEP, apply_options, take_servos_implicitly

HOME = Path(__file__).resolve().parent


class Mount(NamedTuple):
    """Where a sensor is fastened to a robot."""

    site: str
    """Name of the site in `Body.spec`, which looks along its x axis; z is up."""
    height_m: float
    """Of the site above the floor, at rest."""


class Fleet(Protocol):
    """The robots of one kind, or of several, in one compiled world; k is a robot's number in it, from 0.

    Around each step: `before_step(data)`, `mj_step`, `after_step(data)`. A fleet belongs to one run from time 0.
    """

    root_bodies: Ints
    """(N,) id of each robot's root body."""

    def command(self, k: int, speed: float, turn_rate: float) -> None:
        """Tell robot k to drive at `speed` (m/s) and `turn_rate` (rad/s), as far as its machine can say that.

        A body that goes in any direction takes the two for its velocity forward and to the left, m/s: what its `follow`
        gives, or (speed, 0) for straight ahead.
        """

    def before_step(self, data: mujoco.MjData) -> None:
        """Bring the actuators' controls up to date."""

    def after_step(self, data: mujoco.MjData) -> bool:
        """Read encoders and bumpers. Whether any hull is pressed: whether there may be a touch to be noted."""

    def poses(self, data: mujoco.MjData) -> Floats:
        """(N, 3) true x, y (m) and heading (rad, in (−π, π]) at `data.time`."""

    def velocities(self, data: mujoco.MjData) -> Floats:
        """(N, 2) true velocities over ground in the world frame, m/s."""

    @property
    def odometry(self) -> Floats:
        """(N, 3) x, y (m), heading (rad, unwrapped) by each robot's odometry, in the frame of its start."""

    @property
    def bumpers(self) -> Bools:
        """(N, 2) left and right bumper pressed now."""

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        """Fills `motion` (3,), robot k's velocity over ground in its own axes (m/s) and its turn rate (rad/s) by
        odometry since this was last asked, and `contacts` (2,), left and right bumper pressed since then."""

    def meant(self, k: int, motion: Floats) -> None:
        """Fills `motion` (3,) as `own` does, by what robot k told its actuators instead of its encoders."""

    def meant_pose(self, k: int) -> Floats:
        """(3,) x, y, heading by what robot k told its actuators when `meant` was last asked, from its start."""

    def counted_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its odometry, from its start."""


@runtime_checkable
class CanFall(Protocol):
    """What a fleet has besides whose robots can fall."""

    @property
    def fallen_at(self) -> Floats:
        """(N,) s, when each robot fell; nan = it is upright."""


@dataclass(frozen=True)
class Body:
    """One kind of robot. Lengths in m, speeds in m/s; body frame x forward, y left, origin on the floor."""

    name: str
    radius: float
    """Of the outline with which it meets walls and other robots."""
    silhouette_radius: float
    """Of what a level laser sees of it."""
    top_speed: float
    """Straight ahead on the floor."""
    mounts: Mapping[str, Mount]
    """Sensor → where it is fastened; a body that carries no such sensor leaves it out."""
    follows: frozenset[Kind]
    """The kinds of `Motion` that `follow` turns into commands."""
    spec: Callable[[], mujoco.MjSpec]
    """One robot at the origin, facing +x, with all that can be seen of it: no floor, no light, no options."""
    fleet: Callable[[mujoco.MjModel, Sequence[str]], Fleet]
    """All robots of this kind in a model, in the order of the prefixes of their names."""
    follow: Callable[[int, float, float, float, float, float, float], tuple[float, float]]
    """(kind, x, y, cruise, speed_now, turn_rate_now, dt) → speed (m/s) and turn rate (rad/s) to command, or the two
    numbers that its fleet's `command` takes in their place: `kind`, `x` and `y` of a `Motion`; `cruise`, speed towards
    a way-point; the command in force; `dt`, s to the next update."""
    constants: tuple[str, ...]
    """Modules whose constants are this body's numbers, to be shown with their sources."""
    marked: bool = True
    """Whether others can tell it as a member; one that is not marked looks like a part of a wall."""
    longest_timestep: float = math.inf
    """s, of physics: with a longer step its control does not hold."""

    def mount(self, sensor: str) -> Mount:
        """Where `sensor` is fastened. Raises `InputError` where this body carries none."""
        if sensor not in self.mounts:
            carried = ", ".join(sorted(self.mounts)) or "no sensor"
            raise InputError(f"body {self.name!r} carries no {sensor}; expected one that does (it carries {carried})")
        return self.mounts[sensor]


def carrying(sensor: str) -> tuple[str, ...]:
    """The names of the bodies that carry such a sensor."""
    return tuple(name for name in names() if sensor in load(name).mounts)


@cache
def names() -> tuple[str, ...]:
    """Of all bodies, with hyphens: the folders of `robots` whose package holds a `BODY`."""
    folders = sorted(path.parent.name for path in HOME.glob("*/__init__.py"))
    return tuple(folder.replace("_", "-") for folder in folders if hasattr(package(folder), "BODY"))


def load(name: str) -> Body:
    """The body of that name, or that of the user's own folder at that path.

    Raises `InputError` with the nearest names if there is none, and for a folder that holds none.
    """
    if is_path(name):
        users_files.check_executed("body", name)
        return _of_folder(str(Path(name).resolve()), digest(name))
    if name.replace("_", "-") not in names():
        raise unknown_name("body", name, names())
    found: Body = package(name).BODY
    return found


def digest(path: str) -> str:
    """A hash of the files of a user's own body, of their names and contents. Raises `InputError` if there are none."""
    folder, digest = Path(path), hashlib.sha256()
    if not (folder / "__init__.py").is_file():
        raise InputError(f"body folder {path!r} has no __init__.py; expected a folder with one that holds a BODY")
    try:
        for file in sorted(folder.rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(file.relative_to(folder).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    except OSError as error:
        raise InputError(f"body folder {path!r} cannot be read: {error.filename}: {error.strerror}") from None
    return digest.hexdigest()[:16]


@cache
def _of_folder(path: str, digest: str) -> Body:
    """The body of a folder whose files have that hash, called by the folder's path.

    The folder is imported as a package of its own, so that its files import one another by `from .model import …`; a
    module among the body's constants that begins with a dot is one of them.
    """
    package = f"own_body_{Path(path).name}_{digest}"
    spec = importlib.util.spec_from_file_location(
        package, Path(path) / "__init__.py", submodule_search_locations=[path]
    )
    assert spec is not None
    assert spec.loader is not None
    module, loader = importlib.util.module_from_spec(spec), spec.loader
    sys.modules[package] = module
    run(str(module.__file__), lambda: loader.exec_module(module))
    found = getattr(module, "BODY", None)
    if not isinstance(found, Body):
        raise InputError(f"body folder {path!r}: its __init__.py has no BODY; expected a robots.body.Body")
    constants = tuple(f"{package}{name}" if name.startswith(".") else name for name in found.constants)
    return replace(found, name=path, constants=constants)


def scene(body: Body) -> mujoco.MjSpec:
    """One robot on a floor with a light: what its XML holds."""
    world = body.spec()
    apply_options(world, min(TIMESTEP, body.longest_timestep))
    floor = world.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1))
    floor.contype, floor.conaffinity = FLOOR_MASK, 0
    floor.rgba = (0.55, 0.57, 0.6, 1)
    world.worldbody.add_light(pos=(0, 0, 3), dir=(0, 0, -1))
    take_servos_implicitly(world)
    return world


def xml(body: Body) -> str:
    """The text of the XML in its folder."""
    world = scene(body)
    world.compile()
    return str(world.to_xml())


def xml_path(name: str) -> Path:
    """Where the XML of a body stands."""
    folder = name.replace("-", "_")
    return HOME / folder / f"{folder}.xml"


def package(name: str) -> Any:
    """The package of a body's folder; its docstring says what the body is."""
    return importlib.import_module(f"robots.{name.replace('-', '_')}")


if __name__ == "__main__":
    for each in names():
        xml_path(each).write_text(xml(load(each)), encoding="utf-8")
