"""SVG plans: what the primitives must be, in metres and with y up, whatever draws and places them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from generation import plans
from generation.environment import Environment
from generation.plans import units
from generation.primitives import BOTH, SAGITTA_M, Arc, Circle, Point, Polygon, Polyline, Segment, segments

SIZE = 'width="10000mm" height="5000mm" viewBox="0 0 10000 5000"'
"""A sheet of ten by five metres, in millimetres."""


def drawn(folder: Path, inside: str, size: str = SIZE, unit: units.Unit | None = None) -> Environment:
    """The environment of an SVG with these elements."""
    path = folder / "plan.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{inside}</svg>')
    return plans.read(path, unit)[0]


def near(found: object, expected: object) -> None:
    """Equal to a nanometre: svgelements keeps some twelve digits."""
    assert type(found) is type(expected)
    for one, other in zip(found, expected, strict=True):  # type: ignore[call-overload]
        if isinstance(other, str):
            assert one == other
        else:
            np.testing.assert_allclose(one, other, atol=1e-9)


def test_each_kind_of_shape_becomes_its_primitive(tmp_path: Path) -> None:
    found = drawn(
        tmp_path,
        """<line x1="1000" y1="2000" x2="3000" y2="2500"/>
        <polyline points="0,0 1000,0 1000,1000"/>
        <polygon points="0,0 1000,0 1000,1000"/>
        <rect x="1000" y="1000" width="2000" height="500"/>
        <circle cx="4000" cy="1000" r="250"/>
        <path d="M 0 0 L 500 0"/>
        <path d="M 1000 0 A 1000 1000 0 0 1 0 1000"/>""",
    ).workspace
    expected = [
        Segment(1.0, -2.0, 3.0, -2.5),
        Polyline(((0.0, 0.0), (1.0, 0.0), (1.0, -1.0))),
        Polygon(((0.0, 0.0), (1.0, 0.0), (1.0, -1.0)), BOTH),
        Polygon(((1.0, -1.0), (3.0, -1.0), (3.0, -1.5), (1.0, -1.5)), BOTH),
        Circle(4.0, -1.0, 0.25, BOTH),
        Segment(0.0, 0.0, 0.5, 0.0),
        Arc(0.0, 0.0, 1.0, -math.pi / 2, math.pi / 2),
    ]
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        near(one, other)


def test_transforms_groups_and_uses_put_shapes_where_they_say(tmp_path: Path) -> None:
    found = drawn(
        tmp_path,
        """<defs><line id="l" x2="1000"/></defs>
        <g transform="translate(1000, 2000) rotate(90)"><g transform="scale(2)"><use href="#l" x="500"/></g></g>
        <path transform="scale(-1, 1)" d="M 1000 0 A 1000 1000 0 0 1 0 1000"/>""",
    ).workspace
    # along x, moved by half a metre, doubled, turned clockwise on the sheet (y down), moved
    near(found[0], Segment(1.0, -3.0, 1.0, -5.0))
    near(found[1], Arc(0.0, 0.0, 1.0, math.pi, math.pi / 2))


@pytest.mark.parametrize(
    ("size", "metres"),
    [
        ('width="10in" height="10in" viewBox="0 0 100 100"', 0.00254),
        ('width="10cm" viewBox="-7 -8 100 100"', 0.001),
        ('width="10cm" height="10cm"', 0.0254 / 96),
        ('width="72pt" height="72pt" viewBox="0 0 1 1"', 0.0254),
    ],
)
def test_units_are_those_of_width_and_view_box(tmp_path: Path, size: str, metres: float) -> None:
    near(
        drawn(tmp_path, '<line x1="0" y1="1" x2="3" y2="0"/>', size).workspace[0],
        Segment(0.0, -metres, 3 * metres, 0.0),
    )


@pytest.mark.parametrize("size", ["", 'width="100" height="100"', 'width="100%"', 'viewBox="0 0 9 9"'])
def test_a_drawing_without_units_is_refused_unless_one_is_given(tmp_path: Path, size: str) -> None:
    with pytest.raises(InputError, match=r"without units.*--unit"):
        drawn(tmp_path, '<line x2="3"/>', size)
    near(drawn(tmp_path, '<line x2="3"/>', size, units.named("ft")).workspace[0], Segment(0.0, 0.0, 0.9144, 0.0))


def test_a_given_unit_goes_before_the_drawings_own_and_that_is_told(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SIZE}><line x2="3"/></svg>')
    environment, told = plans.read(path, units.scaled(0.5))
    near(environment.workspace[0], Segment(0.0, 0.0, 1.5, 0.0))
    assert any("mm, is set aside" in line for line in told)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(-3000, 3000), min_size=8, max_size=8), st.integers(0, 2))
def test_curves_are_straightened_to_within_the_stated_sagitta(
    tmp_path_factory: pytest.TempPathFactory, c: list[int], kind: int
) -> None:
    if c[:2] == c[2:4]:
        return
    curve = (
        f"C {c[4]} {c[5]} {c[6]} {c[7]} {c[2]} {c[3]}",
        f"Q {c[4]} {c[5]} {c[2]} {c[3]}",
        f"A {abs(c[4]) + 50} {abs(c[5]) + 50} {c[6] % 180} {c[6] % 2} {c[7] % 2} {c[2]} {c[3]}",
    )[kind]
    path = tmp_path_factory.mktemp("svg") / "plan.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SIZE}><path d="M {c[0]} {c[1]} {curve}"/></svg>')
    cut = shapely.MultiLineString(segments(plans.read(path)[0].workspace[0]).reshape(-1, 2, 2).tolist())
    for x, y in _on_curve(c, kind):
        # 1 µm: what rounding in the library adds
        assert cut.distance(shapely.Point(x / 1000, -y / 1000)) <= SAGITTA_M + 1e-6


def _on_curve(c: list[int], kind: int) -> list[tuple[float, float]]:
    """Places on a curve by its own definition: Bernstein polynomials; arcs by SVG 1.1, appendix F.6.5."""
    t = np.linspace(0.0, 1.0, 500)[:, None]
    p = np.array(c, dtype=np.float64).reshape(4, 2)
    if kind == 0:
        return list(
            map(tuple, (1 - t) ** 3 * p[0] + 3 * (1 - t) ** 2 * t * p[2] + 3 * (1 - t) * t**2 * p[3] + t**3 * p[1])
        )
    if kind == 1:
        return list(map(tuple, (1 - t) ** 2 * p[0] + 2 * (1 - t) * t * p[2] + t**2 * p[1]))
    radii = np.array([abs(c[4]) + 50.0, abs(c[5]) + 50.0])
    large, sweep, turn = c[6] % 2, c[7] % 2, math.radians(c[6] % 180)
    back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    half = back @ (p[0] - p[1]) / 2
    radii *= max(1.0, math.sqrt(np.sum((half / radii) ** 2)))
    rest = max(0.0, 1.0 / np.sum((half / radii) ** 2) - 1.0)
    centre = (
        (1 if large != sweep else -1)
        * math.sqrt(rest)
        * np.array([half[1] * radii[0] / radii[1], -half[0] * radii[1] / radii[0]])
    )
    begin, end = (math.atan2(*((sign * half - centre) / radii)[::-1]) for sign in (1.0, -1.0))
    turned = (end - begin) % (2 * math.pi) if sweep else -((begin - end) % (2 * math.pi))
    angle = begin + t * turned
    places = centre + radii * np.hstack([np.cos(angle), np.sin(angle)])
    return list(map(tuple, places @ back + (p[0] + p[1]) / 2))


def test_what_cannot_be_seen_or_is_no_wall_is_left_out_and_told(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    inside = """<text x="3" y="3">kitchen</text><line x2="5" visibility="hidden"/>
    <rect width="3" height="3" fill="none"/>
    <rect width="9" height="9" style="display:none"/><clipPath id="c"><rect width="4" height="4"/></clipPath>
    <symbol id="s"><rect width="5" height="5"/></symbol><marker><rect width="6" height="6"/></marker>
    <line id="seen" x2="1000"/>"""
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SIZE}>{inside}</svg>')
    environment, told = plans.read(path)
    assert environment.workspace == (Segment(0.0, 0.0, 1.0, 0.0),)
    assert "left out: 1 hidden, 1 text, 1 without stroke and fill" in told


def test_a_marker_is_a_point_by_a_line_or_by_a_small_circle(tmp_path: Path) -> None:
    found = drawn(
        tmp_path,
        """<g id="markers"><circle id="start" cx="1000" cy="2000" r="100"/>
        <line id="goal" data-kind="point" x1="3000" y1="1000" x2="3000" y2="900"/>
        <circle id="far" data-kind="point" cx="9000" cy="4000" r="400"/>
        <circle id="area" cx="5000" cy="1000" r="300"/>
        <circle id="hole" data-free="outside" cx="5000" cy="4000" r="100"/></g>""",
    ).markers
    near(found["start"], Point(1.0, -2.0, 0.0))
    near(found["goal"], Point(3.0, -1.0, math.pi / 2))
    near(found["far"], Point(9.0, -4.0, 0.0))
    near(found["area"], Circle(5.0, -1.0, 0.3, BOTH))
    near(found["hole"], Circle(5.0, -4.0, 0.1, "outside"))  # as an environment's own export says of each circle


def ten(k: int) -> str:
    """A group that uses the one before it ten times."""
    return f'<g id="u{k + 1}">' + f'<use href="#u{k}"/>' * 10 + "</g>"


REFUSED = {
    "nothing": ("", "nothing is drawn"),
    "only text": ("<text>hi</text>", "nothing is drawn"),
    "no number": ('<line x1="nan" x2="5"/>', "expected a length"),
    "infinite": ('<line x1="1e999" x2="5"/>', "expected a number"),
    "no number in a path": ('<path d="M 0 0 L nan 5"/>', "expected numbers"),
    "no number in a transform": ('<g transform="scale(nan)"><line x2="5"/></g>', "transform"),
    "half a place": ('<polyline points="0,0 4"/>', "odd number"),
    "too far": ('<line x2="1e12"/>', "expected a number"),
    "uses itself": ('<g id="a"><use href="#a"/></g>', "used within itself"),
    "uses nothing": ('<use href="#a"/>', "expected #id"),
    "uses without end": (
        f'<defs><line id="u0" x2="5"/>{"".join(map(ten, range(9)))}</defs><use href="#u9"/>',
        "more than",
    ),
    "a million walls": ('<path d="M0 0' + "l1 1 1 -1" * 500_000 + '"/>', "more than"),
    "too deep": ("<g>" * 5000 + '<line x2="5"/>' + "</g>" * 5000, "broken XML"),
    "a marker twice": ('<g id="markers"><line id="goal" x2="5"/><line id="goal" x2="6"/></g>', "twice"),
    "a start that is no point": (
        '<g id="markers"><circle id="start" r="2000"/></g>',
        "marker 'start' is a circle: expected a point, drawn as a line from the place in its direction, with",
    ),
    "a start without a direction": ('<g id="markers"><line id="start" x2="50"/></g>', "is a segment: expected a point"),
    "a point of corners": (
        '<g id="markers"><rect id="goal" data-kind="point" width="5" height="5"/></g>',
        "marker 'goal' is a polygon with data-kind='point': expected a line from the place in its direction",
    ),
    "broken": ("<line", "broken XML"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_plan_is_refused_in_one_line(tmp_path: Path, what: str) -> None:
    inside, expected = REFUSED[what]
    with pytest.raises(InputError, match=expected) as refusal:
        drawn(tmp_path, inside)
    assert "\n" not in str(refusal.value)


def test_entities_are_refused_before_they_grow(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    path.write_text('<!DOCTYPE svg [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><svg><text>&b;</text></svg>')
    with pytest.raises(InputError, match="entities"):
        plans.read(path)


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "plan.pdf").write_text("%PDF")
    (tmp_path / "plan.svg").write_text("<html/>")
    with pytest.raises(InputError, match="is no plan: expected a name that ends in"):
        plans.read(tmp_path / "plan.pdf")
    with pytest.raises(InputError, match="first element is <html>"):
        plans.read(tmp_path / "plan.svg")
    with pytest.raises(InputError, match="does not exist"):
        plans.read(tmp_path / "none.svg")


def test_a_marker_is_a_point_where_it_says_so(tmp_path: Path) -> None:
    markers = drawn(
        tmp_path,
        '<line x1="0" y1="0" x2="4000" y2="0" stroke="black"/><g id="markers" stroke="blue">'
        '<circle id="start" data-kind="point" cx="1000" cy="3000" r="100"/>'
        '<circle id="area" cx="3000" cy="3000" r="500"/></g>',
    ).markers
    start = markers["start"]
    assert isinstance(start, Point)
    assert (start.x_m, start.heading_rad) == pytest.approx((1.0, 0.0))
    assert isinstance(markers["area"], Circle)
