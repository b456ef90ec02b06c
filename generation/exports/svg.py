"""An environment as an SVG drawing, from which `generation.plans.svg` reads the same environment.

Millimetres, full size; the y axis is turned down as SVG has it, so that what is drawn looks as the world does, seen
from above. Workspace, construct and markers are groups of these ids. `data-free` says on which side of a closed shape
free space lies; a marker has its name in `data-name`; a place with a direction is a short line from it, whose
`data-kind` is point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from lxml import etree

from flocking.errors import InputError
from flocking.types import Floats
from generation.environment import Environment, Mark
from generation.plans.svg_text import NAMESPACE
from generation.primitives import SAGITTA_M, Arc, Circle, Point, Polygon, Polyline, Segment, places

POINT_M = 0.2
"""Length of the line that shows a place and its direction, m. A choice."""
MARGIN_M = 0.2
"""Around what is drawn, m. A choice."""
STROKES = {"workspace": "#444", "construct": "#c30", "markers": "#06c"}
"""Colours. A choice."""
_MM = 1000.0


def to_svg(environment: Environment) -> str:
    """The text of an SVG drawing of an environment. Raises `InputError` where there is nothing to draw."""
    x0, y0, x1, y1 = _bounds(environment)
    size_mm = _MM * (x1 - x0), _MM * (y1 - y0)
    root = etree.Element(
        "svg",
        nsmap={None: NAMESPACE},
        width=f"{_text(size_mm[0])}mm",
        height=f"{_text(size_mm[1])}mm",
        viewBox=" ".join(map(_text, (_MM * x0, -_MM * y1, *size_mm))),
    )
    root.set("data-reflectance", repr(float(environment.reflectance)))
    width = _text(max(max(size_mm) / 500.0, 1.0))
    parts = {"workspace": environment.workspace, "construct": environment.construct}
    for part, primitives in parts.items():
        group = _group(root, part, width)
        for primitive in primitives:
            _draw(group, primitive)
    group = _group(root, "markers", width)
    for name, mark in environment.markers.items():
        try:
            _draw(group, mark).set("data-name", name)
        except ValueError:
            raise InputError(f"marker {name!r} has a name that XML has no way to hold: expected plain text") from None
    etree.indent(root)
    return str(etree.tostring(root, encoding="unicode")) + "\n"


def _group(root: Any, part: str, width: str) -> Any:
    look = {"fill": "none", "stroke": STROKES[part], "stroke-width": width}
    return etree.SubElement(root, "g", id=part, **look)


def _draw(group: Any, mark: Mark) -> Any:
    """The element of a primitive or point, added to a group."""
    match mark:
        case Point(x, y, heading):
            ahead = x + POINT_M * math.cos(heading), y + POINT_M * math.sin(heading)
            element = _line(group, x, y, *ahead)
            element.set("data-kind", "point")
            return element
        case Segment(x0, y0, x1, y1):
            return _line(group, x0, y0, x1, y1)
        case Polyline(points):
            return etree.SubElement(group, "polyline", points=_points(points))
        case Polygon(corners, free):
            element = etree.SubElement(group, "polygon", points=_points(corners))
        case Circle(x, y, radius, free):
            element = etree.SubElement(group, "circle", cx=_x(x), cy=_y(y), r=_x(radius))
        case Arc():
            return etree.SubElement(group, "path", d=_arc(mark))
    element.set("data-free", free)
    return element


def _line(group: Any, x0: float, y0: float, x1: float, y1: float) -> Any:
    return etree.SubElement(group, "line", x1=_x(x0), y1=_y(y0), x2=_x(x1), y2=_y(y1))


def _arc(arc: Arc) -> str:
    """A path of three thirds, none of which is half a circle or more: SVG gives the ends of an arc and no centre.

    Counter-clockwise is against SVG's sweep.
    """
    found = []
    for third in range(4):
        angle = arc.start_rad + third / 3.0 * arc.turn_rad
        found.append(f"{_x(arc.x_m + arc.radius_m * math.cos(angle))},{_y(arc.y_m + arc.radius_m * math.sin(angle))}")
    flags = f"{_x(arc.radius_m)} {_x(arc.radius_m)} 0 0 0"
    return f"M {found[0]}" + "".join(f" A {flags} {place}" for place in found[1:])


def _points(given: Iterable[tuple[float, float]]) -> str:
    return " ".join(f"{_x(x)},{_y(y)}" for x, y in given)


def _x(metres: float) -> str:
    return _text(_MM * metres)


def _y(metres: float) -> str:
    return _text(-_MM * metres)


def _text(millimetres: float) -> str:
    """To a picometre, so that arcs keep their centres."""
    found = f"{millimetres:.9f}".rstrip("0").rstrip(".")
    return "0" if found == "-0" else found


def _bounds(environment: Environment) -> tuple[float, float, float, float]:
    """x0, y0, x1, y1 of all that is drawn and a margin, m."""
    drawn: list[Floats] = [places(primitive) for primitive in environment.primitives]
    for mark in environment.markers.values():
        drawn.append(np.array([[mark.x_m, mark.y_m]]) if isinstance(mark, Point) else places(mark))
    if not drawn:
        raise InputError("the environment is empty: expected walls or markers to draw")
    every = np.vstack(drawn)
    margin = MARGIN_M + POINT_M + SAGITTA_M
    (x0, y0), (x1, y1) = every.min(axis=0) - margin, every.max(axis=0) + margin
    return float(x0), float(y0), float(x1), float(y1)
