"""A herd's bands and space: as users describe them, and as arrays for the compiled code.

Metres, seconds, radians; world frame.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flocking import avoidance, obstacle_selection, selection
from flocking.errors import InputError
from flocking.kinematic import detection
from flocking.kinematic.arrays import BEARINGS, BELOW, COSINE, LEAST, POSES, Place, Stages
from flocking.lawentry import Law
from flocking.perception import Step, squared_bound
from flocking.selection import Chosen
from flocking.types import Bools, Floats

CLEARANCE = 1e-9
"""Radius of a point as walls know it, in units of their largest coordinate or 1 m: far above rounding, so that nobody
gets through, and far below what matters."""
KINDS = ("unbounded", "bounded", "periodic")
DETECTIONS = {member.name.lower().replace("_", "-"): int(member) for member in detection.Detection}
MOST_M = 1e9
"""Largest radius or assumed distance."""
MOST_LINKED = 5000
"""Most members for which Voronoi cells or a graph are kept: each is an (N, N) array."""
OBSTACLES = ("as-law", "avoid", "virtual-members")
INFORMATION = {"poses": POSES, "bearings": BEARINGS}


@dataclass(frozen=True)
class Space:
    """Where a herd lives. A bounded space is a square of walls, a periodic one has none at its border."""

    kind: str = "unbounded"
    """`unbounded`, `bounded` or `periodic`."""
    size_m: float = math.inf
    """Side of the square [0, size]² of a bounded or periodic space."""
    walls: Floats = field(default_factory=lambda: np.empty((0, 4)))
    """(W, 4) segments x0, y0, x1, y1 in it."""

    @property
    def clearance_m(self) -> float:
        """Radius of a point as walls know it."""
        far = max([0.0, *np.abs(np.asarray(self.walls, dtype=np.float64)).ravel()])
        return CLEARANCE * max(1.0, far, self.size_m if self.kind != "unbounded" else 0.0)

    def place(self, graph: Bools | None = None, count: int = 0) -> Place:
        """As the compiled code takes it, for `count` members. Raises `InputError` for what is no valid space."""
        if self.kind not in KINDS:
            raise InputError(f"space {self.kind!r}: expected {' or '.join(KINDS)}")
        if self.kind != "unbounded" and not 0.0 < self.size_m < math.inf:
            raise InputError(f"{self.kind} space of side {self.size_m:g} m: expected a finite positive side")
        walls = np.array(self.walls, dtype=np.float64)
        if walls.ndim != 2 or walls.shape[1] != 4 or not np.isfinite(walls).all():
            raise InputError(f"walls of shape {walls.shape}: expected (W, 4) finite numbers x0, y0, x1, y1")
        a = self.size_m
        if self.kind == "bounded":
            walls = np.vstack([[[0.0, 0.0, a, 0.0], [a, 0.0, a, a], [a, a, 0.0, a], [0.0, a, 0.0, 0.0]], walls])
        elif self.kind == "periodic":
            walls = _with_images(walls, a)
        if graph is not None and np.shape(graph) != (count, count):
            raise InputError(f"graph of shape {np.shape(graph)} for {count} members; expected ({count}, {count})")
        none = np.empty((0, 0), np.bool_)
        links = none if graph is None else np.ascontiguousarray(graph, np.bool_)
        return Place(a if self.kind == "periodic" else 0.0, walls, self.clearance_m, links, none)


def _with_images(walls: Floats, period: float) -> Floats:
    """The walls, and their images in the neighbouring squares as far as half a period from this one."""
    shifts = period * np.array([(0, 0), *((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y)], dtype=np.float64)
    images = (walls[None] + np.tile(shifts, 2)[:, None]).reshape(-1, 4)
    ends = images.reshape(-1, 2, 2)
    near = (ends.max(axis=1) >= -0.5 * period).all(axis=1) & (ends.min(axis=1) <= 1.5 * period).all(axis=1)
    return np.ascontiguousarray(images[near])


def parsed_sets(law: str, text: str, sets: Mapping[str, str], names: Sequence[str]) -> list[list[Chosen]]:
    """The steps of each of a law's sets as `flocking.selection.parse_sets` gives them, `names` its parameters'.

    Raises `InputError` for what a kinematic herd cannot select by. Compiles nothing.
    """
    found = selection.parse_sets(text, sets, names)
    for steps in found:
        if any(chosen.step is Step.VORONOI for chosen in steps[1:]):
            raise InputError(f"law {law!r}: in a kinematic herd voronoi must come first in a selection")
    return found


def check_linked(count: int) -> None:
    """Raises `InputError` for a herd of too many members for Voronoi cells or a graph."""
    if count > MOST_LINKED:
        raise InputError(f"{count} members: Voronoi cells and graphs are kept for at most {MOST_LINKED}")


@dataclass(frozen=True)
class Band:
    """Members that run one law."""

    law: Law
    count: int
    parameters: Mapping[str, Any] | Sequence[Mapping[str, Any]] = field(default_factory=dict)
    """The law's, by name: for all members, or one mapping a member (heterogeneous groups)."""
    selection: str = "all"
    """What all of the law's sets select from, or other selections for its sets (`flocking.selection.parse_sets`)."""
    cruise_m_s: float = math.inf
    """Speed towards a way-point; inf = it is reached within the step."""
    max_speed_m_s: float = math.inf
    max_turn_rate_rad_s: float = math.inf
    radius_m: float = 0.0
    """0 = points that nothing touches; else discs that cannot enter one another or a wall."""
    goals_w: Floats | None = None
    """(count, 2); nan = none."""
    role: int = 0
    detection: str = "perfect"
    """`perfect`, `member-based`, `member-extrapolated` or `sensor-based`."""
    information: str = "poses"
    """`poses`, or `bearings`: every input then stands at `assumed_distance_m`. The law's range is then that of the
    sensor: whoever is really beyond it is not seen."""
    assumed_distance_m: float = 1.0
    silhouette_m: float = 0.165
    """Radius of the members as the detections other than perfect see them."""
    sight_m: float = math.inf
    """Range of those detections and of obstacles."""
    obstacle_selection: str = "all"
    """Which obstacles count (`flocking.obstacle_selection.parse`)."""
    sight_lines: bool = False
    """Whether a wall hides obstacles: those whose nearest point lies behind another wall."""
    obstacles: str = "as-law"
    """`as-law`; `avoid`: the shared avoidance is added; `virtual-members`: obstacles become members."""
    avoidance: avoidance.Parameters = field(default_factory=avoidance.Parameters)

    def checked(self) -> Band:
        """Itself. Raises `InputError` for numbers that no member can have."""
        if self.count < 1:
            raise InputError(f"{self.count} members of law {self.law.name!r}: expected at least 1")
        for name, low, high in (
            ("cruise_m_s", 0.0, math.inf),
            ("max_speed_m_s", 0.0, math.inf),
            ("max_turn_rate_rad_s", 0.0, math.inf),
            ("radius_m", 0.0, MOST_M),
            ("assumed_distance_m", 0.0, MOST_M),
            ("silhouette_m", 0.0, MOST_M),
            ("sight_m", 0.0, math.inf),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"{name} = {value:g}: expected {low:g} to {high:g}")
        if self.goals_w is not None:
            goals = np.asarray(self.goals_w, dtype=np.float64)
            if goals.shape != (self.count, 2) or np.isinf(goals).any():
                raise InputError(f"goals of shape {goals.shape}: expected ({self.count}, 2) numbers, nan for none")
        return self

    def rows(self) -> Floats:
        """(count, P) parameters, checked."""
        given = self.parameters
        if isinstance(given, Mapping):
            row = np.array(self.law.parameters(given), dtype=np.float64)
            return np.tile(row, (self.count, 1))
        if len(given) != self.count:
            raise InputError(f"{len(given)} sets of parameters for {self.count} members of law {self.law.name!r}")
        return np.array([self.law.parameters(one) for one in given], dtype=np.float64).reshape(self.count, -1)

    def _resolved(self, sets: Sequence[Sequence[Chosen]]) -> list[list[Chosen]]:
        """The sets' steps with the numbers that all members have."""
        values = self.law.parameters(self.parameters)._asdict()  # type: ignore[arg-type]
        return [selection.resolved(steps, values) for steps in sets]

    def stages(self) -> Stages:
        """As the compiled code takes them. Raises `InputError` for what does not fit."""
        names, law = self.law.parameter_names, self.law
        sets = parsed_sets(law.name, self.selection, law.sets, names)
        varied = not isinstance(self.parameters, Mapping)
        program = selection.program(sets if varied else self._resolved(sets), names)
        angles = program.steps == Step.ANGLE
        program.given[angles, COSINE] = np.cos(np.radians(program.given[angles, 0]))
        for s, k in np.argwhere(program.steps == Step.DISTANCE_BASED):
            program.given[s, k, [LEAST, BELOW]] = [squared_bound(bound) for bound in program.given[s, k, :2].tolist()]
        for name, value, valid in (
            ("detection", self.detection, DETECTIONS),
            ("information", self.information, INFORMATION),
            ("obstacles", self.obstacles, OBSTACLES),
        ):
            if value not in valid:
                raise InputError(f"{name} = {value!r}: expected {' or '.join(valid)}")
        given = [self.parameters] if isinstance(self.parameters, Mapping) else self.parameters
        values = [law.parameters(one)._asdict() for one in given]
        reach = max((selection.reach(steps, one) for steps in sets for one in values), default=math.inf)
        perfect = self.detection == "perfect"
        if not perfect:
            reach = min(reach, self.sight_m) + self.silhouette_m
        obstacle_steps, obstacle_given = obstacle_selection.program(obstacle_selection.parse(self.obstacle_selection))
        # the kernel takes ANGLE from positions: a bearing costs an arctangent
        chosen_steps = [chosen for steps in sets for chosen in steps if chosen.step is not Step.ANGLE]
        read = law.needs | selection.needs(chosen_steps)
        return Stages(
            *program,
            varied=varied,
            parameters=len(names),
            memory=law.memory,
            reach=float(reach),
            bearings="bearings" in read,
            headings="headings" in read,
            velocities="velocities" in read,
            detection=DETECTIONS[self.detection],
            information=INFORMATION[self.information],
            assumed_distance=float(self.assumed_distance_m),
            silhouette=float(self.silhouette_m),
            sight=float(self.sight_m),
            role=int(self.role),
            goal="goal" in law.needs,
            contacts="contacts" in law.needs,
            obstacles="obstacles" in law.needs,
            obstacle_steps=obstacle_steps,
            obstacle_given=obstacle_given,
            avoids=self.obstacles == "avoid",
            virtual=self.obstacles == "virtual-members",
            virtual_range=float(self.avoidance.virtual_range_m),
            sight_lines=bool(self.sight_lines),
            look_ahead=float(self.avoidance.look_ahead_m),
            margin=float(self.avoidance.margin_m),
        )
