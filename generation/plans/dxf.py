"""DXF drawings, by ezdxf.

LINE, LWPOLYLINE and POLYLINE with bulges, CIRCLE, ARC, ELLIPSE, SPLINE, and what INSERT puts of blocks, all of the
model space, on layers that are on. Heights are left out: a plan lies in the plane. Closed shapes are fences with free
space on both sides.
"""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ezdxf import recover

from flocking.errors import InputError
from generation.checking import MOST_PIECES
from generation.environment import Environment
from generation.plans.drawing import CURVES_TOLD, Count, Place, contents, fence
from generation.plans.units import METRES, Unit, chosen
from generation.primitives import BOTH, SAGITTA_M, Arc, Circle, Polygon, Polyline, Primitive

INSUNITS = {
    1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 13: "um", 14: "dm",
}  # fmt: skip
"""Values of the header's $INSUNITS that plans have (DXF reference, HEADER section); 0 is none."""
_CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
_DEEPEST = 16
"""How deep blocks in blocks may go. A choice."""


def read(path: Path, given: Unit | None) -> tuple[Environment, list[str]]:
    """The environment that a DXF file draws, and lines that tell how it was read. Raises `InputError`."""
    data = contents(path, "a DXF file")
    document, repaired = _parsed(path, data)
    own = _own_unit(document, data, path)
    unit, told = chosen(own, given, str(path), "its header has no $INSUNITS")
    count = Count(str(path))
    layers = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
    walls: list[Primitive] = []
    try:
        for entity in _flat(document.modelspace(), layers, count, 0):
            made = _primitive(entity, unit.metres)
            if made is None:
                count.left_out[f"{entity.dxftype()} without a length"] += 1
                continue
            count.add(len(made[0]) if isinstance(made, Polyline | Polygon) else 1)
            walls.append(made)
    except InputError:
        raise
    except Exception as error:  # the library raises whatever its geometry meets, as with numbers that are none
        raise InputError(f"{path} cannot be drawn: {type(error).__name__}, {error}") from None
    if not walls:
        nothing = ", ".join(count.told())
        raise InputError(
            f"{path}: nothing is drawn in it{f' ({nothing})' if nothing else ''}: expected lines or curves"
        )
    return Environment(tuple(walls), origin={"file": path.name, "format": "dxf", "metres_per_unit": unit.metres}), [
        told,
        CURVES_TOLD,
        *repaired,
        *count.told(),
    ]


def _parsed(path: Path, data: bytes) -> tuple[Any, list[str]]:
    """The document, and a line where the library had to repair it."""
    try:
        document, auditor = recover.read(io.BytesIO(data))
    except Exception as error:  # the library raises whatever its parsing meets
        reason = " ".join(str(error).split())
        raise InputError(f"{path} is no DXF file that can be read: {reason or type(error).__name__}") from None
    faults = len(auditor.errors) + len(auditor.fixes)
    return document, [f"{faults} faults of the file were repaired"] if faults else []


def _own_unit(document: Any, data: bytes, path: Path) -> Unit | None:
    """What the file says of its unit; the library fills in metres where it says nothing."""
    code = int(document.header.get("$INSUNITS", 0)) if b"$INSUNITS" in data else 0
    if code == 0:
        return None
    if code not in INSUNITS:
        valid = ", ".join(f"{number} ({name})" for number, name in INSUNITS.items())
        raise InputError(f"{path}: $INSUNITS = {code} is no unit of a plan: expected {valid}")
    name = INSUNITS[code]
    return Unit(METRES[name], name)


def _flat(entities: Iterable[Any], hidden: set[str], count: Count, depth: int) -> Iterator[Any]:
    """All entities that are seen and are walls, those of blocks among them."""
    for entity in entities:
        kind = entity.dxftype()
        if entity.dxf.get("layer", "0").lower() in hidden or entity.dxf.get("invisible", 0):
            count.left_out["hidden"] += 1
        elif kind == "INSERT":
            if depth == _DEEPEST:
                raise InputError(f"{count.where}: block {entity.dxf.name!r} holds itself, or is nested too deep")
            if entity.mcount > MOST_PIECES:
                raise InputError(
                    f"{count.where}: block {entity.dxf.name!r} is put {entity.mcount} times: expected fewer"
                )
            for copy in entity.multi_insert() if entity.mcount > 1 else (entity,):
                count.add(1)
                yield from _flat(copy.virtual_entities(), hidden, count, depth + 1)
        elif kind in ("LINE", "LWPOLYLINE", *_CURVES) or (kind == "POLYLINE" and not _is_mesh(entity)):
            yield entity
        elif kind not in ("ATTRIB", "ATTDEF", "SEQEND", "VERTEX", "VIEWPORT"):
            count.left_out[kind] += 1


def _is_mesh(polyline: Any) -> bool:
    return bool(polyline.is_polygon_mesh or polyline.is_poly_face_mesh)


def _primitive(entity: Any, scale: float) -> Primitive | None:
    """The primitive of one entity, metres; None for one without a length."""
    kind, sagitta = entity.dxftype(), SAGITTA_M / scale
    if kind == "LINE":
        return fence([_place(entity.dxf.start, scale), _place(entity.dxf.end, scale)], closed=False)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        closed = bool(entity.closed if kind == "LWPOLYLINE" else entity.is_closed)
        corners = entity.vertices_in_wcs() if kind == "LWPOLYLINE" else entity.points_in_wcs()
        start = [_place(place, scale) for place in itertools.islice(corners, 1)]
        return fence(_along(start, entity.virtual_entities(), sagitta, scale), closed, is_polyline=True)
    if kind in ("CIRCLE", "ARC") and entity.dxf.extrusion.isclose((0.0, 0.0, 1.0)):
        x, y = _place(entity.dxf.center, scale)
        radius = scale * abs(entity.dxf.radius)
        if not radius > 0.0:
            return None
        if kind == "CIRCLE":
            return Circle(x, y, radius, BOTH)
        begin = math.radians(entity.dxf.start_angle) % (2.0 * math.pi)
        turn = (math.radians(entity.dxf.end_angle) - begin) % (2.0 * math.pi)
        return Arc(x, y, radius, begin, turn) if turn > 0.0 else Circle(x, y, radius, BOTH)
    places = [_place(place, scale) for place in _cut(entity, sagitta)]
    return fence(places, kind == "CIRCLE" or (kind == "SPLINE" and bool(entity.closed)), is_polyline=True)


def _cut(entity: Any, sagitta: float) -> list[Any]:
    """The places at which a curve is cut so that no piece lies farther than `sagitta` from it, in drawing units."""
    if entity.dxftype() in ("CIRCLE", "ARC"):
        return list(entity.flattening(min(sagitta, abs(entity.dxf.radius))))
    return list(entity.flattening(sagitta, segments=8))


def _along(start: list[Place], pieces: Iterable[Any], sagitta: float, scale: float) -> list[Place]:
    """The places from a start along a chain of lines and arcs, of which any may be given backwards."""
    found = start
    for piece in pieces:
        cut = [piece.dxf.start, piece.dxf.end] if piece.dxftype() == "LINE" else _cut(piece, sagitta)
        places = [_place(place, scale) for place in cut]
        if math.dist(found[-1], places[-1]) < math.dist(found[-1], places[0]):
            places.reverse()
        found += places[1:]
    return found


def _place(place: Any, scale: float) -> Place:
    return scale * float(place[0]), scale * float(place[1])
