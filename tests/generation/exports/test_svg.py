"""An environment drawn as SVG and read back is the same one."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from generation import plans
from generation.checking import checked
from generation.environment import Environment
from generation.exports.svg import to_svg
from generation.primitives import Arc, Circle, Point, Polygon, Polyline, Segment, places

WITHIN_M = 1e-3
"""What is asked for. Coordinates are written to a picometre, so that most of it is for the ends of very short arcs."""

NUMBERS = st.floats(-100.0, 100.0).map(lambda value: round(value, 4))
PLACES = st.tuples(NUMBERS, NUMBERS)
RADII = st.floats(0.01, 20.0)
SIDES = st.sampled_from(["inside", "outside", "both"])
FENCES = st.one_of(
    st.builds(lambda a, b: Segment(*a, *b), PLACES, PLACES),
    st.builds(lambda points: Polyline(tuple(points)), st.lists(PLACES, min_size=2, max_size=6)),
    st.builds(lambda corners: Polygon(tuple(corners), "both"), st.lists(PLACES, min_size=3, max_size=6)),
    st.builds(lambda at, radius, free: Circle(*at, radius, free), PLACES, RADII, SIDES),
    st.builds(
        lambda at, radius, start, turn: Arc(*at, radius, start, turn),
        PLACES, RADII, st.floats(-math.pi, math.pi), st.floats(0.05, 2.0 * math.pi),
    ),
)  # fmt: skip


def read_back(folder: Path, environment: Environment) -> Environment:
    path = folder / "plan.svg"
    path.write_text(to_svg(environment), encoding="utf-8")
    return plans.read(path)[0]


def same(found: object, expected: object) -> None:
    """Of one kind, with the same free side, and everywhere within the tolerance."""
    assert type(found) is type(expected)
    if isinstance(found, Point) and isinstance(expected, Point):
        assert math.hypot(found.x_m - expected.x_m, found.y_m - expected.y_m) < WITHIN_M
        assert math.cos(found.heading_rad - expected.heading_rad) > 1.0 - 1e-9
        return
    assert getattr(found, "free", "") == getattr(expected, "free", "")
    one, other = places(found), places(expected)  # type: ignore[arg-type]
    assert one.shape == other.shape
    assert np.abs(one - other).max() < WITHIN_M


@settings(max_examples=40, deadline=None)
@given(
    st.lists(FENCES, max_size=5),
    st.lists(FENCES, max_size=5),
    st.dictionaries(
        st.text("abc &<>\"'é-1", min_size=1), st.builds(Point, NUMBERS, NUMBERS, st.floats(-3, 3)) | FENCES, max_size=3
    ),
    st.floats(0.05, 1.0),
)
def test_a_round_trip_keeps_kinds_sides_parts_markers_and_places(
    tmp_path_factory: pytest.TempPathFactory,
    workspace: list[Segment],
    construct: list[Segment],
    markers: dict[str, Point],
    reflectance: float,
) -> None:
    try:
        environment, _ = checked(Environment(tuple(workspace), tuple(construct), markers, reflectance))
    except InputError:  # such as a marker without a length, or inside of a wall
        return
    if not (environment.primitives or environment.markers):
        return
    found = read_back(tmp_path_factory.mktemp("svg"), environment)
    assert found.reflectance == environment.reflectance
    for part in ("workspace", "construct"):
        assert len(getattr(found, part)) == len(getattr(environment, part))
        for one, other in zip(getattr(found, part), getattr(environment, part), strict=True):
            same(one, other)
    assert list(found.markers) == list(environment.markers)
    for name, mark in environment.markers.items():
        same(found.markers[name], mark)


def test_a_second_round_trip_changes_nothing(tmp_path: Path) -> None:
    environment = Environment(
        (Polygon(((-4.0, -3.0), (4.0, -3.0), (4.0, 3.0)), "inside"),),
        (Arc(0.5, 0.5, 0.7, 2.0, 4.0),),
        {"start": Point(1, 0, 2)},
    )
    once = read_back(tmp_path, environment)
    twice = read_back(tmp_path, once)
    np.testing.assert_allclose(twice.walls(), once.walls(), rtol=0, atol=1e-9)
    assert twice.markers == once.markers


def test_the_sheet_has_millimetres_and_y_down() -> None:
    text = to_svg(Environment((Segment(1.0, 2.0, 3.0, 2.0),)))
    assert '<line x1="1000" y1="-2000" x2="3000" y2="-2000"/>' in text
    assert 'viewBox="' in text
    assert 'mm" viewBox' in text


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(InputError, match="empty"):
        to_svg(Environment())
    with pytest.raises(InputError, match="name"):
        to_svg(Environment(markers={"a\0b": Point()}))
