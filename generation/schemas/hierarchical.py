"""Other schemas combined for behaviours in sequence, as a file of parts says.

Source: Fine 2015, section 6.1.3. A part is any schema; `generation.combined` says what a file of parts has:

    [[part]]
    schema = "weiring"

    [[part]]
    schema = "splitting"
    x_m = 400.0
    settings = { most_lines = 10 }
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.combined import combined, read
from generation.environment import Environment
from generation.schema import Part

FILTER = ""
BEHAVIOUR = "simple-split"
PARTS = (Part("weiring"), Part("splitting", x_m=400.0))
"""By default a herd that is corralled, then split. A choice."""


class Parameters(NamedTuple):
    """What is combined."""

    parts: Annotated[str, Parameter("", "a choice: the path of a TOML file; empty: the weir, then the tree")] = ""


def workspace() -> Environment:
    """Nothing stands there but what parts bring."""
    return Environment()


def parts(parameters: Parameters) -> Sequence[Part]:
    """Those of its file, or the default. Raises `InputError` for a file that cannot be read."""
    return read(parameters.parts) if parameters.parts else PARTS


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """All parts beside what stands there. Raises `InputError` for a file that cannot be read, and as its schemas do."""
    made = combined(parts(parameters), rng)
    return dataclasses.replace(
        workspace,
        workspace=(*workspace.workspace, *made.workspace),
        construct=(*workspace.construct, *made.construct),
        markers={**workspace.markers, **made.markers},
    )
