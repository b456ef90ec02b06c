"""What a schema is (C_g of Fine 2015, definition 2): rules by which primitives are combined into environments.

A schema is one file of `generation/schemas/`, found by its file and named by it: a Python file, or a grammar (TOML).
A Python file has

- a docstring whose first line says what it generates;
- `Parameters`, a `NamedTuple` of declared parameters (`flocking.parameters`), whose bounds are the parameter space;
- `workspace() -> Environment`: what it builds in by itself, with its anchors and goals as markers;
- `generate(parameters, workspace, rng) -> Environment`: one environment. A deterministic schema draws nothing;
- `FILTER` and `BEHAVIOUR`: the names of the filter and of the behaviour that it is meant for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from generation.environment import Environment


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
