"""Schemas combined for behaviours in sequence: parts that are placed, and the stages that a herd passes.

Source: Fine 2015, section 6.1.3. A part is any schema, shape grammars and hierarchical ones included. Its markers are
kept by the number of its stage: `origin` of the second is `stage-2-origin`. `stage-2-area`, a polygon, is where that
stage is.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import filled
from flocking.types import Floats
from generation import behaviours, found
from generation.environment import START, Environment
from generation.free_paths import inside
from generation.markers import marker
from generation.primitives import Polygon
from generation.schema import Part

AREA = "area"
MOST_PARTS = 100
"""Of one environment. A choice."""
DEEPEST = 10
"""Hierarchical parts in hierarchical parts. A choice."""
_depth: ContextVar[int] = ContextVar("depth", default=0)


def combined(parts: Sequence[Part], rng: np.random.Generator) -> Environment:
    """All parts in one environment, each scaled and turned about its own origin, then shifted; drawn one by one.

    The herd starts where it does in the first part. Raises `InputError` for a schema or a parameter that there is not,
    and for parts that hold one another without end.
    """
    depth = _depth.get()
    if depth >= DEEPEST:
        raise InputError(f"parts hold parts more than {DEEPEST} deep; expected parts that do not hold themselves")
    token = _depth.set(depth + 1)
    try:
        return _combined(parts, rng)
    finally:
        _depth.reset(token)


def _combined(parts: Sequence[Part], rng: np.random.Generator) -> Environment:
    made = Environment()
    for number, part in enumerate(parts, 1):
        schema = found.load(part.schema)
        own = schema.workspace()
        workspace = own if part.walls else dataclasses.replace(own, workspace=())
        parameters = filled(schema.parameters, part.settings, f"part {number}: ")
        built = schema.generate(parameters, workspace, rng)
        built = built.moved(part.scale, math.radians(part.turn_deg), part.x_m, part.y_m)
        markers = {f"stage-{number}-{name}": mark for name, mark in built.markers.items()}
        if number == 1 and START in built.markers:
            markers[START] = built.markers[START]
        made = Environment(
            (*made.workspace, *built.workspace), (*made.construct, *built.construct), {**made.markers, **markers}
        )
    return made


def stage(environment: Environment, number: int) -> Environment:
    """The environment as a behaviour of that stage sees it: with the stage's markers under their own names."""
    start = f"stage-{number}-"
    own = {name.removeprefix(start): mark for name, mark in environment.markers.items() if name.startswith(start)}
    if not own:
        raise InputError(f"the environment has no stage {number}; expected a marker that begins with {start}")
    return dataclasses.replace(environment, markers={**environment.markers, **own})


def fitness_of(parts: Sequence[Part], positions: Floats, environment: Environment) -> list[float]:
    """The fitness of members at positions (T, N, 2) in each stage, 0 to 1.

    A stage with an area is judged from the start until the herd's centroid is in that area for the last time; a herd
    that never comes there has 0. A stage without one is judged as a whole. Raises `InputError` as a behaviour does.
    """
    return [
        _fitness(part.behaviour or found.load(part.schema).behaviour, part.judging, positions, stage(environment, k))
        for k, part in enumerate(parts, 1)
    ]


def _fitness(name: str, judging: Mapping[str, Any], positions: Floats, environment: Environment) -> float:
    behaviour = behaviours.load(name)
    if AREA in environment.markers:
        area = marker(environment, AREA, "stage", Polygon)
        there = np.flatnonzero(inside(np.array(area.corners_m), positions.mean(axis=1)))
        if len(there) == 0:
            return 0.0
        positions = positions[: there[-1] + 1]
    return behaviour.judged(positions, environment, behaviour.filled(judging))


def read(path: str) -> list[Part]:
    """The parts of a TOML file: a `[[part]]` each, with the fields of `Part`, `schema` at the least.

    Raises `InputError`.
    """
    try:
        data = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"parts file {path!r} does not exist; expected a TOML file") from None
    except (OSError, ValueError) as error:
        raise InputError(f"parts file {path!r} cannot be read: {' '.join(str(error).split())}") from None
    listed = data.get("part")
    if not isinstance(listed, list) or not 0 < len(listed) <= MOST_PARTS:
        raise InputError(f"parts file {path!r}: expected 1 to {MOST_PARTS} tables [[part]]")
    return [_part(given, f"{path}: part {number}") for number, given in enumerate(listed, 1)]


def _part(given: Any, what: str) -> Part:
    if not isinstance(given, dict) or not isinstance(given.get("schema"), str):
        raise InputError(f'{what}: expected a table with schema = "NAME"')
    for name, value in given.items():
        if name not in Part._fields:
            raise unknown_name(f"{what}: key", name, Part._fields)
        default = Part._field_defaults.get(name, "")
        sound = (
            isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
            if isinstance(default, float)
            else isinstance(value, type(default))
        )
        if not sound or (name == "scale" and value <= 0.0):
            kind = {float: "a finite number", bool: "true or false", str: "text", dict: "a table"}[type(default)]
            raise InputError(f"{what}: {name} = {value!r}: expected {kind}{' above 0' * (name == 'scale')}")
    return Part(**given)
