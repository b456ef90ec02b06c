"""A livestock race: two wings that narrow into a lane, which bends to the right.

A construct that is in use, as section 8.1.1 of Fine 2015 wants to decompose them, drawn from no plan: all measures are
a choice, for herds of the T-junction's units. The herd starts before the wings and faces the lane, along y.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import START, Environment
from generation.primitives import Point, Polyline, Segment
from generation.workspaces import built

FILTER = ""
BEHAVIOUR = "turn-right"
PIECES = 12
"""Straight pieces of a bend."""
GOAL = "goal"


class Parameters(NamedTuple):
    """Of the race."""

    mouth_m: Annotated[float, Parameter("m", "a choice", low=1.0, high=20.0)] = 5.0
    """Between the wings' far ends."""
    lane_m: Annotated[float, Parameter("m", "a choice", low=0.5, high=5.0)] = 2.0
    """Between the fences of the lane."""
    wings_m: Annotated[float, Parameter("m", "a choice", low=0.0, high=10.0)] = 3.0
    """Of the wings, along the lane."""
    straight_m: Annotated[float, Parameter("m", "a choice", low=0.0, high=10.0)] = 1.5
    """Of the lane before its bend."""
    bend_deg: Annotated[float, Parameter("deg", "a choice", low=0.0, high=180.0)] = 90.0
    radius_m: Annotated[float, Parameter("m", "a choice", low=0.5, high=20.0)] = 2.5
    """Of the bend, in the middle of the lane."""


def workspace() -> Environment:
    """The open plane, with the place where the herd starts."""
    return Environment(markers={START: Point(0.0, 0.0, math.pi / 2)})


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with both fences, from the wings to the end of the bend, and the goal line there; nothing is drawn.

    Raises `InputError` for a lane that is wider than the mouth or than its bend lets it be.
    """
    p, half = parameters, parameters.lane_m / 2
    if p.lane_m > p.mouth_m or half >= p.radius_m:
        raise InputError(
            f"lane_m = {p.lane_m:g}: expected at most mouth_m = {p.mouth_m:g} and below twice radius_m = {p.radius_m:g}"
        )
    begins = 1.5  # m before the wings
    fences = [_fence(p, side, begins) for side in (-1.0, 1.0)]
    (x0, y0), (x1, y1) = fences[0][-1], fences[1][-1]
    made = built(workspace, *(Polyline(tuple((x, y) for x, y in fence.tolist())) for fence in fences))
    return Environment(
        made.workspace, made.construct, {**made.markers, GOAL: Segment(x0, y0, x1, y1)}, made.reflectance
    )


def _fence(p: Parameters, side: float, begins_m: float) -> Floats:
    """Places along a fence: side −1 is the left one, on the outside of the bend."""
    x = side * p.lane_m / 2
    ends_m = begins_m + p.wings_m + p.straight_m
    angles = np.radians(p.bend_deg) * np.linspace(0.0, 1.0, PIECES + 1)
    radius = p.radius_m - x
    bend = np.column_stack([p.radius_m - radius * np.cos(angles), ends_m + radius * np.sin(angles)])
    straight = [(side * p.mouth_m / 2, begins_m), (x, begins_m + p.wings_m), (x, ends_m)]
    along = np.vstack([straight, bend[1:] if p.bend_deg > 0.0 else np.empty((0, 2))])
    kept = np.append(True, np.hypot(*np.diff(along, axis=0).T) > 1e-9)
    return np.asarray(along[kept])
