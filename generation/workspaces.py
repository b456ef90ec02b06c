"""Workspaces (W of Fine 2015, definition 2) that schemas build in, and their anchors. Metres."""

from __future__ import annotations

import dataclasses
import math

from flocking.errors import InputError
from generation.environment import START, Environment
from generation.primitives import Point, Polygon, Primitive, Segment

ANCHOR = "anchor-"
"""What the markers begin with to which a construct can be fixed."""


def t_junction(width_m: float = 2.0, stem_m: float = 8.0, arm_m: float = 8.0) -> Environment:
    """Three corridors of that width that meet, closed at their ends; the herd starts in the stem and faces the bar.

    Source: Fine 2015, figure 7.9. Anchors are the corners of the square where the corridors meet: 1 and 2 left and
    right on the stem's side, 3 and 4 on the far wall. The goal line crosses the right arm. All lengths are a choice:
    those of the corridors let a member that has turned left come back too late. The stem's axis is x = 0, the bar from
    y = 0 on.
    """
    half = width_m / 2
    outline = (
        (-half, -stem_m), (half, -stem_m), (half, 0.0), (half + arm_m, 0.0), (half + arm_m, width_m),
        (-half - arm_m, width_m), (-half - arm_m, 0.0), (-half, 0.0),
    )  # fmt: skip
    corners = ((-half, 0.0), (half, 0.0), (-half, width_m), (half, width_m))
    goal_m = half + arm_m / 4
    return Environment(
        workspace=(Polygon(outline, "inside"),),
        markers={
            START: Point(0.0, -stem_m / 2, math.pi / 2),
            "goal": Segment(goal_m, 0.0, goal_m, width_m),
            **anchors(corners),
        },
    )


def corridor(width_m: float = 12.0, length_m: float = 40.0) -> Environment:
    """A corridor along y, closed at its ends, with an anchor in the middle of each long wall: 1 left, 2 right.

    The herd starts a quarter of the length before the middle and faces it; the goal line is as far behind it. All
    lengths are a choice: members all over this width have a standard deviation of 3.5 m, and figure 7.14 of Fine 2015
    has deviations from 1.5 to 4.0.
    """
    half, end = width_m / 2, length_m / 2
    return Environment(
        workspace=(Polygon(((-half, -end), (half, -end), (half, end), (-half, end)), "inside"),),
        markers={
            START: Point(0.0, -length_m / 4, math.pi / 2),
            "goal": Segment(-half, length_m / 4, half, length_m / 4),
            **anchors(((-half, 0.0), (half, 0.0))),
        },
    )


def field(side_m: float = 6.0, anchors_a_side: int = 3) -> Environment:
    """An open square, with anchors on a grid, row by row from the near left; the goal is an area at the far right.

    The herd starts in the near left corner and faces the far side. A choice: the workspaces of figure 8.4 of Fine 2015
    are given as pictures alone.
    """
    half = side_m / 2
    places = [(k / (anchors_a_side - 1) - 0.5) * side_m / 1.5 for k in range(anchors_a_side)]
    goal = ((half / 3, half / 3), (half, half / 3), (half, half), (half / 3, half))
    return Environment(
        markers={
            START: Point(-0.75 * half, -0.75 * half, math.pi / 2),
            "goal": Polygon(goal, "both"),
            **anchors(tuple((x, y) for y in places for x in places)),
        }
    )


def anchors(places: tuple[tuple[float, float], ...]) -> dict[str, Point]:
    """The markers of anchors at these places, numbered from 1."""
    return {f"{ANCHOR}{number}": Point(x, y) for number, (x, y) in enumerate(places, 1)}


def anchor(workspace: Environment, number: int) -> tuple[float, float]:
    """The place of an anchor. Raises `InputError` with the anchors that a workspace has."""
    found = workspace.markers.get(f"{ANCHOR}{number}")
    if not isinstance(found, Point):
        has = ", ".join(sorted(name for name in workspace.markers if name.startswith(ANCHOR))) or "none"
        raise InputError(f"anchor {number}: the workspace has no point {ANCHOR}{number} (anchors: {has})")
    return found.x_m, found.y_m


def wall(place: tuple[float, float], angle_deg: float, length_m: float) -> Segment:
    """A straight wall from a place at an angle, counter-clockwise from the x axis (Fine 2015, algorithms 6 and 8)."""
    x, y = place
    angle = math.radians(angle_deg)
    return Segment(x, y, x + length_m * math.cos(angle), y + length_m * math.sin(angle))


def built(workspace: Environment, *construct: Primitive) -> Environment:
    """The workspace with these in it, beside what was built there before."""
    return dataclasses.replace(workspace, construct=(*workspace.construct, *construct))
