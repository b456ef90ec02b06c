"""DXF plans, drawn by ezdxf and read back in metres."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from flocking.errors import InputError
from generation import plans
from generation.plans import units
from generation.primitives import BOTH, SAGITTA_M, Arc, Circle, Polygon, Polyline, Segment, places

Drawn = Callable[[Any, Any], object]


def saved(folder: Path, draw: Drawn, insunits: int = 6) -> Path:
    """A DXF file in which `draw` has put something into document and model space."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = insunits
    draw(document, document.modelspace())
    path = folder / "plan.dxf"
    document.saveas(path)
    return path


@pytest.mark.parametrize(("code", "metres"), [(1, 0.0254), (2, 0.3048), (4, 0.001), (5, 0.01), (6, 1.0), (14, 0.1)])
def test_units_are_those_of_the_header(tmp_path: Path, code: int, metres: float) -> None:
    environment, _ = plans.read(saved(tmp_path, lambda _, m: m.add_line((1, 2), (4, 6)), code))
    assert environment.workspace == (Segment(metres, 2 * metres, 4 * metres, 6 * metres),)


def test_a_header_without_units_is_refused_unless_one_is_given(tmp_path: Path) -> None:
    path = saved(tmp_path, lambda _, m: m.add_line((0, 0), (1, 0)), 0)
    with pytest.raises(InputError, match=r"without units.*INSUNITS.*--unit"):
        plans.read(path)
    assert plans.read(path, units.named("cm"))[0].workspace == (Segment(0.0, 0.0, 0.01, 0.0),)


def test_a_file_without_a_header_has_no_units(tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n")
    with pytest.raises(InputError, match="without units"):
        plans.read(path)


def test_each_kind_of_entity_becomes_its_primitive(tmp_path: Path) -> None:
    def draw(_: Any, m: Any) -> None:
        m.add_lwpolyline([(0, 0), (1, 0), (1, 1)])
        m.add_lwpolyline([(0, 0), (2, 0), (2, 2)], close=True)
        m.add_polyline2d([(0, 0), (3, 0), (3, 3)])
        m.add_circle((1, 2), 0.5)
        m.add_arc((1, 2), 0.5, 350, 20)
        m.add_arc((1, 2), 0.7, 0, 360)

    found = plans.read(saved(tmp_path, draw))[0].workspace
    assert found[:4] == (
        Polyline(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))),
        Polygon(((0.0, 0.0), (2.0, 0.0), (2.0, 2.0)), BOTH),
        Polyline(((0.0, 0.0), (3.0, 0.0), (3.0, 3.0))),
        Circle(1.0, 2.0, 0.5, BOTH),
    )
    arc = found[4]
    assert isinstance(arc, Arc)
    np.testing.assert_allclose(arc, (1.0, 2.0, 0.5, math.radians(350), math.radians(30)), rtol=1e-12)
    assert found[5] == Circle(1.0, 2.0, 0.7, BOTH)


@pytest.mark.parametrize("bulge", [1.0, -1.0, 0.2, -2.5])
def test_a_bulge_is_an_arc_to_the_right_for_positive_ones(tmp_path: Path, bulge: float) -> None:
    """The bulge is the tangent of a quarter of the turn; its sagitta is that times half the chord (DXF reference)."""
    path = saved(tmp_path, lambda _, m: m.add_lwpolyline([(0, 0, bulge), (2, 0, 0), (2, 5, 0)], format="xyb"))
    found = places(plans.read(path)[0].workspace[0])
    np.testing.assert_allclose(found[[0, -2, -1]], [[0, 0], [2, 0], [2, 5]], atol=1e-9)
    radius = (1 + bulge**2) / (2 * abs(bulge))
    centre_y = (1 - bulge**2) / (2 * bulge)
    np.testing.assert_allclose(np.hypot(found[:-1, 0] - 1, found[:-1, 1] - centre_y), radius, rtol=1e-9)
    deepest = found[:-1, 1].min() if bulge > 0 else found[:-1, 1].max()
    assert abs(deepest - -bulge) <= SAGITTA_M


def test_a_closed_polyline_keeps_the_bulge_of_its_last_side(tmp_path: Path) -> None:
    path = saved(tmp_path, lambda _, m: m.add_lwpolyline([(0, 0, 1), (2, 0, 1)], format="xyb", close=True))
    polygon = plans.read(path)[0].workspace[0]
    assert isinstance(polygon, Polygon)
    corners = np.array(polygon.corners_m)
    np.testing.assert_allclose(np.hypot(corners[:, 0] - 1, corners[:, 1]), 1.0, rtol=1e-9)
    assert {math.copysign(1, y) for _, y in corners if abs(y) > 0.1} == {1, -1}


def test_ellipses_and_splines_are_cut_to_within_the_sagitta(tmp_path: Path) -> None:
    path = saved(tmp_path, lambda _, m: m.add_ellipse((0, 0), (3, 0), 0.5))
    x, y = places(plans.read(path)[0].workspace[0]).T
    np.testing.assert_allclose((x / 3) ** 2 + (y / 1.5) ** 2, 1.0, rtol=1e-9)
    middles = np.column_stack([x[:-1] + x[1:], y[:-1] + y[1:]]) / 2
    # in a stretched plane an ellipse is a circle; the smaller half axis bounds what the stretch can hide
    inside = 1.0 - np.hypot(middles[:, 0] / 3, middles[:, 1] / 1.5)
    assert np.max(inside) * 1.5 <= SAGITTA_M * 2.0
    spline = saved(tmp_path, lambda _, m: m.add_open_spline([(0, 0), (1, 2), (3, -2), (4, 0)]))
    cut = places(plans.read(spline)[0].workspace[0])
    t = np.linspace(0, 1, 400)[:, None]  # four control points of degree three: a Bézier curve
    exact = 3 * (1 - t) ** 2 * t * [1, 2] + 3 * (1 - t) * t**2 * [3, -2] + t**3 * [4, 0]
    import shapely

    line = shapely.LineString(cut)
    assert max(line.distance(shapely.Point(place)) for place in exact) <= SAGITTA_M


def test_blocks_are_put_where_they_are_inserted(tmp_path: Path) -> None:
    def draw(document: Any, m: Any) -> None:
        inner = document.blocks.new("INNER")
        inner.add_line((0, 0), (1, 0))
        outer = document.blocks.new("OUTER")
        outer.add_blockref("INNER", (1, 0), dxfattribs={"rotation": 90})
        m.add_blockref("OUTER", (10, 0), dxfattribs={"xscale": -2, "yscale": 2})
        m.add_blockref("INNER", (0, 0), dxfattribs={"row_count": 2, "row_spacing": 3, "column_count": 1})

    found = plans.read(saved(tmp_path, draw))[0].workspace
    np.testing.assert_allclose(found, [(8, 0, 8, 2), (0, 0, 1, 0), (0, 3, 1, 3)], atol=1e-12)


def test_mirrored_entities_are_seen_from_above(tmp_path: Path) -> None:
    """An extrusion downwards mirrors x: the object's coordinate system of the DXF reference."""
    down = {"extrusion": (0, 0, -1)}

    def draw(_: Any, m: Any) -> None:
        m.add_arc((1, 0), 1, 0, 90, dxfattribs=down)
        m.add_lwpolyline([(1, 0), (2, 0)], dxfattribs=down)

    arc, line = plans.read(saved(tmp_path, draw))[0].workspace
    ends = places(arc)[[0, -1]]
    np.testing.assert_allclose(sorted(ends.tolist()), [[-2, 0], [-1, 1]], atol=1e-9)
    np.testing.assert_allclose(places(line), [[-1, 0], [-2, 0]], atol=1e-12)


def test_hidden_layers_texts_and_paper_are_left_out(tmp_path: Path) -> None:
    def draw(document: Any, m: Any) -> None:
        document.layers.add("OFF").off()
        m.add_line((0, 0), (9, 9), dxfattribs={"layer": "off"})
        m.add_text("kitchen")
        document.paperspace().add_line((0, 0), (8, 8))
        m.add_line((0, 0, 3), (1, 0, 3))

    environment, told = plans.read(saved(tmp_path, draw))
    assert environment.workspace == (Segment(0.0, 0.0, 1.0, 0.0),)
    assert "left out: 1 TEXT, 1 hidden" in told


def nothing(_: Any, m: Any) -> None:
    m.add_text("nothing")


def itself(document: Any, m: Any) -> None:
    block = document.blocks.new("B")
    block.add_blockref("B", (1, 1))
    m.add_blockref("B", (0, 0))


def without_end(document: Any, m: Any) -> None:
    document.blocks.new("B").add_line((0, 0), (1, 0))
    m.add_blockref(
        "B", (0, 0), dxfattribs={"row_count": 30_000, "row_spacing": 1, "column_count": 30_000, "column_spacing": 1}
    )


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (nothing, "nothing is drawn"),
        (itself, "holds itself"),
        (without_end, "expected fewer"),
        (lambda _, m: m.add_line((0, 0), (1e300, 0)), "expected a number"),
        (lambda _, m: m.add_line((0, 0, 0), (0, 0, 3)), "nothing is drawn"),
    ],
)
def test_what_is_no_plan_is_refused_in_one_line(tmp_path: Path, draw: Drawn, expected: str) -> None:
    with pytest.raises(InputError, match=expected) as refusal:
        plans.read(saved(tmp_path, draw))
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("text", ["", "hello", "0\nSECTION\n", "\0\1\2" * 100])
def test_what_is_no_dxf_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "plan.dxf").write_text(text)
    with pytest.raises(InputError):
        plans.read(tmp_path / "plan.dxf")
    path = saved(tmp_path, lambda _, m: m.add_line((0, 0), (1.25, 0)))
    path.write_text(path.read_text().replace("1.25", "nan"))
    with pytest.raises(InputError, match="nan"):
        plans.read(path)
