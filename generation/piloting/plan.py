"""A plan: the walls that guide a herd through a task, and when each of them stands."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.piloting.task import Task
from generation.workspaces import wall

FORMAT = 1
FOLDER = Path(__file__).parent / "plans"
ROBOTS_A_WALL = 3
"""Fine 2015, section 8.2."""
AT_ONCE = 2
"""Walls that stand at a time where they change: six pilots hold two walls of three (Fine 2015, section 8.2)."""


class Wall(NamedTuple):
    """A wall of algorithm 8 (ITB)."""

    anchor: int
    """Number of the anchor that it is fixed to."""
    angle_deg: float
    length_m: float

    def segment(self, task: Task) -> Floats:
        """(4,) x0, y0, x1, y1, m. Raises `InputError` for an anchor that the task lacks."""
        places = task.anchors
        if self.anchor not in places:
            raise InputError(f"wall at anchor {self.anchor}: task {task.name} has anchors 1 to {max(places)}")
        x, y = places[self.anchor]
        return np.array(wall((float(x), float(y)), self.angle_deg, self.length_m), dtype=np.float64)


class Judged(NamedTuple):
    """How well a whole plan guides herds that were not used to find it."""

    herds: int
    share: float
    """Of their members, how many it guides to the goal."""
    low: float
    """The 95 % interval of that share, from here (Wilson 1927), as if each herd arrived whole or not at all: members of
    one herd share their fate, so that the interval is rather too wide."""
    high: float


def judged(shares: Sequence[float]) -> Judged:
    """The judgement from the share of each herd that arrived."""
    n, share, z = len(shares), float(np.mean(shares)), 1.959964
    middle = (share + z * z / (2.0 * n)) / (1.0 + z * z / n)
    reach = z / (1.0 + z * z / n) * math.sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n))
    return Judged(n, share, max(0.0, middle - reach), min(1.0, middle + reach))


@dataclass(frozen=True)
class Plan:
    """Walls in the order of the turns that they make; a partial one has fewer than the task has turns."""

    task: str
    static: bool
    """Whether all walls stand all the time; else each stands from when the last but one has been passed, until it has
    been passed itself."""
    walls: tuple[Wall, ...]
    shares: tuple[float, ...] = ()
    """Of each wall, the share of members that made its turn when it was found."""
    judged: Judged | None = None
    """Of a whole plan, how well it guides new herds."""

    def standing(self, passed: int, at_once: int | None = None) -> tuple[int, ...]:
        """Numbers of the walls (from 0) that stand when so many of them have been passed.

        `at_once`: so many stand at a time at the most; by default as many as the plan says.
        """
        if at_once is None:
            if self.static:
                return tuple(range(len(self.walls)))
            at_once = AT_ONCE
        return tuple(range(passed, min(passed + at_once, len(self.walls))))

    def segments(self, task: Task, passed: int = 0) -> Floats:
        """(K, 4) the walls that stand when so many have been passed, m."""
        found = [self.walls[k].segment(task) for k in self.standing(passed)]
        return np.array(found, dtype=np.float64).reshape(-1, 4)


def to_json(plan: Plan, told: dict[str, Any] | None = None) -> str:
    """The plan as text, with what is `told` of how it was found."""
    walls = [{**wall._asdict(), "share": share} for wall, share in _paired(plan)]
    data = {"format": FORMAT, "task": plan.task, "static": plan.static, "walls": walls}
    if plan.judged is not None:
        data["judged"] = plan.judged._asdict()
    data["found"] = told or {}
    return json.dumps(data, indent=1) + "\n"


def shipped(task: str) -> Plan:
    """The plan that comes with a task of that name. Raises `InputError` where none does."""
    known = sorted(path.stem for path in FOLDER.glob("*.json"))
    if task not in known:
        raise InputError(f"task {task} comes without a plan (those with one: {', '.join(known)}): herd plan makes one")
    return read(FOLDER / f"{task}.json")


def words(walls: Sequence[Wall]) -> str:
    """Walls as one line of text: the anchor, the angle in degrees and the length in metres of each, by commas."""
    return ", ".join(f"{wall.anchor} {wall.angle_deg:g} {wall.length_m:g}" for wall in walls)


def of_words(text: str) -> tuple[Wall, ...]:
    """The inverse of `words`. Raises `InputError`."""
    found = []
    for part in text.split(",") if text.strip() else []:
        numbers = part.split()
        try:
            anchor, angle, length = int(numbers[0]), float(numbers[1]), float(numbers[2])
        except (ValueError, IndexError):
            numbers = []
        if len(numbers) != 3 or not (math.isfinite(angle) and 0.0 < length < math.inf):
            raise InputError(
                f"wall {part.strip()!r}: expected its anchor, its angle in degrees and its length in metres, as in "
                "'27 315 0.75', and commas between walls"
            )
        found.append(Wall(anchor, angle, length))
    return tuple(found)


def read(path: str | Path) -> Plan:
    """The plan of a file. Raises `InputError`."""
    return from_json(_text(path), str(path))


def found_with(path: str | Path) -> dict[str, Any]:
    """What the file of a plan, which was read before, tells of how it was found; empty where it tells nothing."""
    told = json.loads(_text(path)).get("found")
    return told if isinstance(told, dict) else {}


def _text(path: str | Path) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"plan {str(path)!r} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"plan {str(path)!r} is no text; expected JSON in UTF-8") from None


def from_json(text: str, where: str) -> Plan:
    """The plan that text describes. Raises `InputError`."""
    try:
        data = json.loads(text)
        if data["format"] != FORMAT:
            raise ValueError(f"format {data['format']!r}")
        task, static, rows = data["task"], data["static"], data["walls"]
        if not isinstance(task, str) or not isinstance(static, bool):
            raise ValueError("a task or static of another type")
        walls = tuple(Wall(_whole(row["anchor"]), _number(row["angle_deg"]), _number(row["length_m"])) for row in rows)
        shares = tuple(_number(row["share"]) for row in rows)
        told = data.get("judged")
        fields = {name: _number(told[name]) for name in Judged._fields} if told is not None else {}
        judgement = Judged(**{**fields, "herds": _whole(told["herds"])}) if told is not None else None  # type: ignore[arg-type]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError(f"{where} is no plan: {error}; expected what `herd plan` wrote") from None
    return Plan(task, static, walls, shares, judgement)


def _paired(plan: Plan) -> Sequence[tuple[Wall, float]]:
    return list(zip(plan.walls, plan.shares or (math.nan,) * len(plan.walls), strict=True))


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{value!r} is no whole number")
    return value


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{value!r} is no number")
    return float(value)
