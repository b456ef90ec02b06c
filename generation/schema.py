"""What a schema is (C_g of Fine 2015, definition 2): rules by which primitives are combined into environments.

A schema is one file of `generation/schemas/`, found by its file and named by it: a Python file, or a grammar (TOML).
A Python file has

- a docstring whose first line says what it generates;
- `Parameters`, a `NamedTuple` of declared parameters (`flocking.parameters`), whose bounds are the parameter space;
- `workspace() -> Environment`: what it builds in by itself, with its anchors and goals as markers;
- `generate(parameters, workspace, rng) -> Environment`: one environment. A deterministic schema draws nothing;
- `FILTER` and `BEHAVIOUR`: the names of the filter and of the behaviour that it is meant for;
- where it combines other schemas, `parts(parameters)`: its parts, a `Part` a stage.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from generation.environment import Environment


class Part(NamedTuple):
    """One of the schemas that a schema combines, where it is placed, and what the herd is to do there."""

    schema: str
    settings: Mapping[str, Any] = {}
    """Its parameters, where they are not the defaults."""
    x_m: float = 0.0
    y_m: float = 0.0
    turn_deg: float = 0.0
    scale: float = 1.0
    walls: bool = True
    """Whether its own workspace stands there as well; its anchors and other markers do in any case."""
    behaviour: str = ""
    """Empty: the schema's."""
    judging: Mapping[str, Any] = {}
    """The behaviour's parameters, where they are not the defaults."""


@dataclass(frozen=True)
class Schema:
    """A schema, whatever its file."""

    name: str
    about: str
    """First line of its description."""
    parameters: type
    """Its `Parameters`."""
    workspace: Callable[[], Environment]
    generate: Callable[[Any, Environment, np.random.Generator], Environment]
    filter: str
    """Name of a filter; empty: none."""
    behaviour: str
    """Name of a behaviour."""
    parts: Callable[[Any], Sequence[Part]] | None = None
    """(its parameters) → the parts that it combines, each with the behaviour of its stage; None where it does not."""
