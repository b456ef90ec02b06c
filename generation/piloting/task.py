"""A task: a workspace, a start, a goal, and the trajectory along which a herd is to be guided (Fine 2015, figure 8.4).

A task is a JSON file: the environment that is its workspace (docs/environments.md), without a construct, and what the
herd is to do in it. Its markers are `start` (a point with a direction), `goal` (a polygon), `trajectory` (a polyline
from the start into the goal) and `anchor-1` and so on, the points to which walls can be fixed.

    {"format": 1, "about": "…", "corridor_m": 1.0, "environment": {"format": 1, "unit": "m", …}}
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.found import is_path, read
from flocking.types import Floats
from generation.environment import START, Environment
from generation.files import from_json, text_of
from generation.free_paths import inside
from generation.free_space import crossed, in_solid
from generation.markers import marker
from generation.primitives import Point, Polygon, Polyline
from generation.workspaces import ANCHOR

FORMAT = 1
FOLDER = Path(__file__).parent / "tasks"
_KEYS = {"format", "about", "corridor_m", "environment"}
_NUMBERED = re.compile(rf"{ANCHOR}\d{{1,6}}")
STRAIGHT_RAD = math.radians(1.0)
"""Change of direction below which a corner of a trajectory is no turn."""


@dataclass(frozen=True)
class Task:
    """What a herd is to do in a workspace."""

    name: str
    about: str
    corridor_m: float
    """Farthest from the trajectory that a member may be, m."""
    environment: Environment
    """The workspace and the markers."""

    @property
    def start(self) -> Point:
        """Where the herd starts, and its direction."""
        found: Point = marker(self.environment, START, f"task {self.name}", Point)
        return found

    @property
    def goal(self) -> Floats:
        """(C, 2) corners of the area in which the trajectory ends, m."""
        found: Polygon = marker(self.environment, "goal", f"task {self.name}", Polygon)
        return np.array(found.corners_m, dtype=np.float64)

    @cached_property
    def trajectory(self) -> Floats:
        """(V, 2) its corners from the start to the goal, m."""
        found: Polyline = marker(self.environment, "trajectory", f"task {self.name}", Polyline)
        return np.array(found.points_m, dtype=np.float64)

    @cached_property
    def turns(self) -> tuple[int, ...]:
        """Numbers of the trajectory's corners at which it changes its direction: each needs a wall."""
        ways = np.diff(self.trajectory, axis=0)
        angles = np.arctan2(ways[:, 1], ways[:, 0])
        change = np.abs(np.angle(np.exp(1j * np.diff(angles))))
        return tuple(int(k) + 1 for k in np.flatnonzero(change > STRAIGHT_RAD))

    @property
    def anchors(self) -> dict[int, Floats]:
        """The places (2,) to which walls can be fixed, by their numbers, m."""
        marks = self.environment.markers
        return {
            int(name.removeprefix(ANCHOR)): np.array([mark.x_m, mark.y_m])
            for name, mark in marks.items()
            if isinstance(mark, Point) and _NUMBERED.fullmatch(name)
        }


def names() -> list[str]:
    """Names of the tasks that come with the project."""
    return sorted(path.stem for path in FOLDER.glob("*.json"))


def is_file(name: str) -> bool:
    """Whether a task's name is the path of a file of the user's own."""
    return is_path(name)


def load(name: str, text: str = "") -> Task:
    """The task of that name, or that of the file at that path. Raises `InputError`.

    `text`: of the file, which is then not read.
    """
    if is_file(name):
        return from_text(text or own_text(name), Path(name).stem)
    if name not in names():
        raise unknown_name("task", name, names())
    return from_text(text_of(FOLDER / f"{name}.json"), name)


def own_text(path: str) -> str:
    """The text of a task's file, which travels with a trial. Raises `InputError`."""
    return read(path, "task", "a JSON file")


def from_text(text: str, name: str) -> Task:
    """The task that JSON text describes, checked. Raises `InputError`."""
    try:
        data = json.loads(text)
    except ValueError as error:
        raise InputError(f"task {name} is no JSON: {error}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f'task {name}: expected an object with "format": {FORMAT}')
    for key in data.keys() - _KEYS:
        raise unknown_name(f"key of task {name}", key, sorted(_KEYS))
    missing = sorted(_KEYS - data.keys())
    if missing:
        raise InputError(f"task {name} lacks {', '.join(missing)}")
    corridor = data["corridor_m"]
    if isinstance(corridor, bool) or not isinstance(corridor, int | float) or not 0.0 < corridor < math.inf:
        raise InputError(f"task {name}: corridor_m = {corridor!r}; expected a number above 0")
    environment = from_json(json.dumps(data["environment"]), f"environment of task {name}")
    return checked(Task(name, str(data["about"]), float(corridor), environment))


def checked(task: Task) -> Task:
    """The task, if its trajectory leads through free space from its start into its goal. Raises `InputError`."""
    if task.environment.construct:
        raise InputError(f"task {task.name} has a construct; expected a workspace alone: walls are found")
    line, goal, start = task.trajectory, task.goal, np.array([task.start.x_m, task.start.y_m])
    if np.hypot(*(line[0] - start)) > task.corridor_m:
        raise InputError(f"task {task.name}: the trajectory begins at {_told(line[0])}, the start is {_told(start)}")
    if not inside(goal, line[-1:])[0]:
        raise InputError(f"task {task.name}: the trajectory ends at {_told(line[-1])}, which is not in the goal")
    if not task.turns:
        raise InputError(f"task {task.name}: the trajectory has no turn, so that no wall is needed")
    if not task.anchors:
        raise InputError(f"task {task.name} has no {ANCHOR}1: expected points to which walls can be fixed")
    walls = task.environment.walls()
    for name in task.environment.markers:
        if name.startswith(ANCHOR) and not _NUMBERED.fullmatch(name):
            raise InputError(f"task {task.name}: marker {name!r}; expected {ANCHOR} and a number, as in {ANCHOR}1")
    for k in range(len(line) - 1):
        if crossed(walls, line[k], line[k + 1 : k + 2])[0]:
            raise InputError(
                f"task {task.name}: the trajectory leaves the workspace between {_told(line[k])} and "
                f"{_told(line[k + 1])}"
            )
    if in_solid(task.environment, line).any():
        raise InputError(f"task {task.name}: a corner of the trajectory lies in a solid")
    return task


def _told(place: Any) -> str:
    return f"({place[0]:g}, {place[1]:g})"
