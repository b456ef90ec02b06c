"""SVG drawings, by svgelements.

Lines, polylines, polygons, rectangles, circles, ellipses and paths with arcs and Bézier curves, wherever transforms,
groups and uses put them. A drawing's origin stays where it is, and its y axis, which points down, is turned up. Stroke
widths are not read: a wall is the line itself. Closed shapes are fences with free space on both sides, unless
`data-free` says otherwise; groups with the ids `workspace`, `construct` and `markers` are what these say, as
`generation.exports.svg` writes them.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import svgelements
from lxml import etree

from flocking.errors import InputError
from generation.environment import REFLECTANCE, START, Environment, Mark
from generation.plans import svg_text
from generation.plans.drawing import CURVES_TOLD, Count, contents, fence, pieces_of_arc, pieces_of_bezier
from generation.plans.units import Unit, chosen
from generation.primitives import BOTH, SAGITTA_M, Arc, Circle, Point, Polygon, Polyline, Primitive, Segment

PARTS = ("workspace", "construct", "markers")
DOT_M = 0.25
"""Largest radius of a circle that, as a marker, is the place in its middle; `data-free` or a larger one makes it an
area. A choice."""
POINT = "point"
_HOW = (
    "a line from the place in its direction, with data-kind='point', or a circle about it, of at most "
    f"{DOT_M:g} m or with data-kind='point'"
)
_SAME = 1e-6
"""Relative difference within which radii and centres of arcs are the same. A choice: drawings have eight digits."""

_NO_LENGTH = 1e-9
"""Relative length of what only rounding has drawn, as the end of a circle of arcs. A choice."""


def read(path: Path, given: Unit | None) -> tuple[Environment, list[str]]:
    """The environment that an SVG file draws, and lines that tell how it was read. Raises `InputError`."""
    text = svg_text.checked(contents(path, "an SVG file"), path)
    unit, told = chosen(text.unit, given, str(path), "its width and height have no physical unit, such as mm")
    try:
        drawing = svgelements.SVG.parse(io.BytesIO(etree.tostring(text.root)), reify=False, ppi=96.0)
    except Exception as error:  # the library raises whatever its parsing meets
        raise InputError(f"{path} is no SVG that can be read: {type(error).__name__}, {error}") from None
    count = Count(str(path))
    parts: dict[str, list[Primitive]] = {"workspace": [], "construct": []}
    markers: dict[str, Mark] = {}
    for part, element in _shapes(drawing, "workspace", count):
        made = list(_primitives(element, unit.metres, count))
        if part != "markers":
            parts[part] += made
            continue
        name = element.values.get("data-name") or element.id
        if not name or len(made) != 1:
            count.left_out["marker without a name, or of several pieces"] += 1
            continue
        if name in markers:
            raise InputError(f"{path}: marker {name!r} is there twice: expected one")
        markers[name] = _mark(made[0], element, f"{path}: marker {name!r}")
        if name == START and not isinstance(markers[name], Point):
            kind = type(made[0]).__name__.lower()
            raise InputError(f"{path}: marker {name!r} is a {kind}: expected a point, drawn as {_HOW}")
    if not (parts["workspace"] or parts["construct"] or markers):
        nothing = ", ".join(count.told())
        raise InputError(
            f"{path}: nothing is drawn in it{f' ({nothing})' if nothing else ''}: expected lines or shapes"
        )
    return Environment(
        tuple(parts["workspace"]),
        tuple(parts["construct"]),
        markers,
        _reflectance(text.root, path),
        {"file": path.name, "format": "svg", "metres_per_unit": unit.metres},
    ), [told, CURVES_TOLD, *count.told()]


def _shapes(element: Any, part: str, count: Count) -> Iterator[tuple[str, Any]]:
    """All shapes that are seen, each with the part of the environment that its group names."""
    if isinstance(element, svgelements.SVG | svgelements.Group | svgelements.Use):
        inner = element.id if isinstance(element, svgelements.Group) and element.id in PARTS else part
        for child in element:
            yield from _shapes(child, inner, count)
    elif isinstance(element, svgelements.Shape):
        values = element.values
        if values.get("visibility") in ("hidden", "collapse"):
            count.left_out["hidden"] += 1
        elif values.get("fill") == "none" and values.get("stroke") in (None, "none"):
            count.left_out["without stroke and fill"] += 1
        else:
            yield part, element
    elif isinstance(element, svgelements.Text | svgelements.Image):
        count.left_out[type(element).__name__.lower()] += 1


def _primitives(element: Any, scale: float, count: Count) -> Iterator[Primitive]:
    """The primitives of one shape, metres."""
    free = element.values.get("data-free", BOTH)
    for subpath in abs(svgelements.Path(element)).as_subpaths():
        curves = [piece for piece in subpath if not isinstance(piece, svgelements.Move)]
        closed = any(isinstance(piece, svgelements.Close) for piece in curves)
        curves = [piece for piece in curves if not _is_no_length(piece)]
        made: Primitive | None = None
        if curves and all(_is_round(piece) for piece in curves):
            made = _round(curves, closed, scale)
        if made is None:
            places = [_place(curves[0].start, scale)] if curves else []
            for piece in curves:
                places += [_place(place, scale) for place in _along(piece, SAGITTA_M / scale)]
            made = fence(places, closed, isinstance(element, svgelements.Polyline))
        if made is None:
            count.left_out["without a length"] += 1
            continue
        count.add(len(made[0]) if isinstance(made, Polyline | Polygon) else 1)
        yield made._replace(free=free) if isinstance(made, Polygon | Circle) else made


def _is_no_length(piece: Any) -> bool:
    if not isinstance(piece, svgelements.Line | svgelements.Close):
        return False
    if piece.start is None or piece.end is None:
        return True
    start, end = complex(piece.start), complex(piece.end)
    return abs(end - start) <= _NO_LENGTH * max(abs(start), 1.0)


def _is_round(piece: Any) -> bool:
    return isinstance(piece, svgelements.Arc) and abs(piece.rx - piece.ry) <= _SAME * abs(piece.rx)


def _along(piece: Any, sagitta: float) -> Iterator[Any]:
    """The places at which a piece of a path is cut, its end included, in the drawing's units."""
    if isinstance(piece, svgelements.Arc):
        number = pieces_of_arc(max(abs(piece.rx), abs(piece.ry)), piece.sweep, sagitta)
    elif isinstance(piece, svgelements.CubicBezier):
        number = pieces_of_bezier(
            [complex(p) for p in (piece.start, piece.control1, piece.control2, piece.end)], sagitta
        )
    elif isinstance(piece, svgelements.QuadraticBezier):
        number = pieces_of_bezier([complex(p) for p in (piece.start, piece.control, piece.end)], sagitta)
    else:
        number = 1
    for k in range(1, number):
        yield piece.point(k / number)
    yield piece.end


def _place(place: Any, scale: float) -> tuple[float, float]:
    return scale * float(place.x), 0.0 - scale * float(place.y)


def _round(arcs: list[Any], closed: bool, scale: float) -> Circle | Arc | None:
    """The circle, or open part of one, that all arcs of a path lie on; None if they do not."""
    first = arcs[0]
    for arc in arcs[1:]:
        if abs(arc.center - first.center) > _SAME * abs(first.rx) or abs(arc.rx - first.rx) > _SAME * abs(first.rx):
            return None
        if (arc.sweep > 0.0) != (first.sweep > 0.0):
            return None
    # the drawing's y axis points down, so that what turns from x to y there turns clockwise here
    turn = -sum(arc.sweep for arc in arcs)
    (x, y), radius = _place(first.center, scale), scale * abs(first.rx)
    if closed:
        return Circle(x, y, radius) if abs(turn) >= 2.0 * math.pi * (1.0 - _SAME) else None
    begin_x, begin_y = _place(first.start if turn > 0.0 else arcs[-1].end, scale)
    return Arc(x, y, radius, math.atan2(begin_y - y, begin_x - x), min(abs(turn), 2.0 * math.pi))


def _mark(made: Primitive, element: Any, where: str) -> Mark:
    """A marker: what was drawn, or, where its `data-kind` is point, the place and direction of a line.

    A circle is the place in its middle, along x, where its `data-kind` says so, and where it is small and nothing says
    where it is free.
    """
    is_point = element.values.get("data-kind") == POINT
    if is_point and isinstance(made, Segment):
        return Point(made.x0_m, made.y0_m, math.atan2(made.y1_m - made.y0_m, made.x1_m - made.x0_m))
    is_dot = isinstance(made, Circle) and made.radius_m <= DOT_M and "data-free" not in element.values
    if isinstance(made, Circle) and (is_point or is_dot):
        return Point(made.x_m, made.y_m)
    if is_point:
        raise InputError(f"{where} is a {type(made).__name__.lower()} with data-kind='point': expected {_HOW}")
    return made


def _reflectance(root: Any, path: Path) -> float:
    given = root.get("data-reflectance")
    try:
        return REFLECTANCE if given is None else float(given)
    except ValueError:
        raise InputError(f"{path}: data-reflectance = {given[:40]!r}: expected a number") from None
