"""Two classes of cattle that are corralled, lined up and sorted, one after the other.

Source: Fine 2015, section 6.1.3, which names the three behaviours alone; all geometry is a choice, in dirt's scale.
The herd comes from -y: out of a field between two wings (dsdr) into a pen, through a narrower pair (dsdr) into the
stem of a T-junction, and past a wall (dirt). Walls sort classes only by what their members do differently.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.combined import combined
from generation.environment import START, Environment
from generation.primitives import Point, Polygon
from generation.schema import Part

CHOICE = "a choice: Fine 2015, section 6.1.3, has no numbers"
FILTER = "passage"
BEHAVIOUR = "sorting"
PEN, STEM = (-16.0, -8.0), (-8.0, 0.0)
"""From where to where along y, m."""
FIELD_M, HALF_M = -36.0, 6.0
"""Where the field begins along y, and half its width, m."""


class Parameters(NamedTuple):
    """The walls of the three stages: both wings of a pair are each other's mirror image."""

    corral_deg: Annotated[float, Parameter("deg", CHOICE, low=-90.0, high=90.0)] = 45.0
    corral_m: Annotated[float, Parameter("m", CHOICE, low=0.0, high=8.0)] = 4.0
    line_deg: Annotated[float, Parameter("deg", CHOICE, low=-90.0, high=90.0)] = 45.0
    line_m: Annotated[float, Parameter("m", CHOICE, low=0.0, high=8.0)] = 6.0
    sort_deg: Annotated[float, Parameter("deg", CHOICE, low=0.0, high=360.0)] = 225.0
    sort_m: Annotated[float, Parameter("m", CHOICE, low=0.0, high=4.0)] = 1.0
    sort_anchor: Annotated[int, Parameter("", CHOICE, low=1, high=4)] = 4


def parts(parameters: Parameters) -> tuple[Part, ...]:
    """The three stages."""
    corral: dict[str, Any] = {"radius_m": 4.0, "threshold_m": 3.0, "consecutive": 20}
    return (
        Part("dsdr", _pair(parameters.corral_deg, parameters.corral_m), y_m=PEN[0], walls=False,
             behaviour="corralling", judging=corral),
        Part("dsdr", _pair(parameters.line_deg, parameters.line_m), y_m=PEN[1] - 5.0, walls=False),
        Part("dirt", {"angle_deg": parameters.sort_deg, "length_m": parameters.sort_m,
                      "anchor": parameters.sort_anchor}, walls=False, behaviour="sorting"),
    )  # fmt: skip


def workspace() -> Environment:
    """A field, a pen behind it, and a T-junction behind that, all in one; the stages' areas as markers."""
    outline = (
        (-HALF_M, FIELD_M), (HALF_M, FIELD_M), (HALF_M, PEN[1]), (1.0, PEN[1]), (1.0, 0.0), (9.0, 0.0), (9.0, 2.0),
        (-9.0, 2.0), (-9.0, 0.0), (-1.0, 0.0), (-1.0, PEN[1]), (-HALF_M, PEN[1]),
    )  # fmt: skip
    return Environment(
        workspace=(Polygon(outline, "inside"),),
        markers={
            START: Point(0.0, (FIELD_M + PEN[0]) / 2, math.pi / 2),
            "stage-1-origin": Point(0.0, sum(PEN) / 2),
            "stage-1-area": _area(HALF_M, *PEN),
            "stage-2-area": _area(1.0, *STEM),
        },
    )


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with the walls of all stages; nothing is drawn. The goal is that of the last stage."""
    made = combined(parts(parameters), rng)
    markers = {name: mark for name, mark in made.markers.items() if name != START}
    return dataclasses.replace(
        workspace,
        construct=(*workspace.construct, *made.construct),
        markers={**markers, "goal": made.markers["stage-3-goal"], **workspace.markers},
    )


def _pair(angle_deg: float, length_m: float) -> dict[str, float]:
    """Parameters of dsdr for a pair of wings."""
    return {"left_deg": angle_deg, "left_m": length_m, "right_deg": 180.0 - angle_deg, "right_m": length_m}


def _area(half_m: float, low_m: float, high_m: float) -> Polygon:
    return Polygon(((-half_m, low_m), (half_m, low_m), (half_m, high_m), (-half_m, high_m)), "both")
