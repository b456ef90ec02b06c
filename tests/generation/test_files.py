"""Environments as files: what is written is read back exactly; what cannot be is refused in one line."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from generation import files, sources
from generation.environment import Environment
from generation.primitives import Arc, Circle, Point, Polygon, Polyline, Segment, segments

NUMBERS = st.floats(-1e3, 1e3, allow_nan=False)
LENGTHS = st.floats(1e-3, 1e3)
ANGLES = st.floats(-math.pi, math.pi)
SEGMENTS = st.builds(Segment, NUMBERS, NUMBERS, st.floats(2e3, 3e3), NUMBERS)
CIRCLES = st.builds(Circle, NUMBERS, NUMBERS, LENGTHS, st.just("both"))
ARCS = st.builds(Arc, NUMBERS, NUMBERS, LENGTHS, ANGLES, st.floats(1e-3, 2 * math.pi))
POLYLINES = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=2, max_size=5, unique_by=lambda p: round(p[0], 3)).map(
    lambda points: Polyline(tuple(points))
)
PRIMITIVES = st.lists(st.one_of(SEGMENTS, CIRCLES, ARCS, POLYLINES), max_size=5)


def text(**given: Any) -> str:
    return json.dumps({"format": 1, "unit": "m", **given})


def wall(**given: Any) -> dict[str, Any]:
    return {"kind": "segment", "x0": 0, "y0": 0, "x1": 1, "y1": 0, **given}


@settings(max_examples=100, deadline=None)
@given(PRIMITIVES, PRIMITIVES, st.builds(Point, NUMBERS, NUMBERS, ANGLES), st.floats(0.01, 1.0))
def test_what_is_written_is_read_back_bit_for_bit(workspace: Any, construct: Any, start: Point, shine: float) -> None:
    drawn = Environment(tuple(workspace), tuple(construct), {"start": start}, shine, {"schema": "dirt", "seed": 3})
    environment = files.from_json(files.to_json(drawn))  # without what stands there twice
    assert files.from_json(files.to_json(environment)) == environment
    assert environment.markers == drawn.markers
    assert environment.reflectance == shine
    for kept in environment.workspace:
        assert kept in drawn.workspace


@pytest.mark.parametrize(
    ("unit", "metres"),
    [
        ("m", 1.0),
        ("mm", 0.001),
        ("cm", 0.01),
        ("dm", 0.1),
        ("km", 1000.0),
        ("in", 0.0254),
        ("ft", 0.3048),
        ("yd", 0.9144),
    ],
)
def test_lengths_are_converted_to_the_nearest_number_and_angles_are_not(unit: str, metres: float) -> None:
    """3 of a unit: 3 × metres, as one rounding of the exact product gives it."""
    arc = {"kind": "arc", "x": 3, "y": 0, "radius": 3, "start_rad": 3, "turn_rad": 1}
    line = {"kind": "polyline", "points": [[0, 0], [3, -3]]}
    made = files.from_json(text(workspace=[arc, line]).replace('"unit": "m"', f'"unit": "{unit}"'))
    assert made.workspace[0] == Arc(
        pytest.approx(3 * metres, rel=1e-16), 0.0, pytest.approx(3 * metres, rel=1e-16), 3, 1
    )
    assert made.workspace[1].points_m[1] == pytest.approx((3 * metres, -3 * metres), rel=1e-16)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("[]", r"a.json is \[\]: expected a JSON object"),
        ("{", "a.json is no JSON: .* line 1"),
        ("[" * 100_000, "nested or long beyond reason"),
        ('{"format": ' + "1" * 10_000 + "}", "nested or long beyond reason"),
        ("{}", "a.json has no format"),
        ('{"format": 2, "unit": "m"}', "format 2: expected 1"),
        ('{"format": true, "unit": "m"}', "format True: expected 1"),
        ('{"format": 1}', "has no unit of length"),
        ('{"format": 1, "unit": "meter"}', "unknown unit of length 'meter'"),
        ('{"format": 1, "format": 1}', "'format' is given twice"),
        (text(workspace={}), "workspace = {}: expected a list"),
        (text(workspace=[[]]), r"workspace 1 is \[\]: expected a JSON object"),
        (text(workspace=[wall(kind="segmnt")]), "workspace 1: unknown kind 'segmnt'; did you mean segment"),
        (
            text(workspace=[{"kind": "segment", "x0": 1}]),
            r"workspace 1 \(segment\) lacks 'y0'; expected x0, y0, x1, y1",
        ),
        (text(workspace=[wall(x0=math.nan)]), "NaN: expected finite numbers"),
        (text(workspace=[wall(x0="1")]), "workspace 1: x0_m = '1': expected a number"),
        (text(workspace=[wall(x0=2e6)]), r"x0_m = 2000000.0: expected a number from -1e\+06"),
        (text(workspace=[{"kind": "point", "x": 0, "y": 0}]), "unknown kind 'point'"),
        (text(workspace=[{"kind": "circle", "x": 0, "y": 0, "radius": -1}]), "radius_m = -1.0"),
        (text(workspace=[{"kind": "circle", "x": 0, "y": 0, "radius": 1, "free": "insid"}]), "did you mean inside"),
        (text(workspace=[{"kind": "polygon", "corners": [[0, 0], [1, 1]]}]), "has 2 places: expected 3 to"),
        (text(workspace=[{"kind": "polygon", "corners": [[0, 0], [1, 1], [2, 2]]}]), "has no inside"),
        (
            text(workspace=[{"kind": "polygon", "corners": [[0, 0], [1, 1], [1, 0], [0, 1]]}]),
            "crosses or touches itself",
        ),
        (
            text(workspace=[{"kind": "polyline", "points": [[0, 0], [1, None]]}]),
            r"has \[1.0, None\]: expected \[x, y\]",
        ),
        (text(workspace=[{"kind": "polyline", "points": "ab"}]), r"points = 'ab': expected a list of \[x, y\]"),
        (text(reflectance=0), "reflectance = 0: expected a number above 0"),
        (text(reflectance=True), "reflectance = True"),
        (text(markers={"start": {"kind": "point", "x": 0}}), "marker 'start' .* lacks 'y'"),
        (text(markers=[]), "markers is .*: expected a JSON object"),
        (text(origin=3), "origin is 3: expected a JSON object"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(given: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        files.from_json(given, "a.json")
    assert "\n" not in str(refused.value)


def test_a_million_walls_are_refused() -> None:
    many = Polyline(tuple((float(k), 0.0) for k in range(50_000)))
    walls = tuple(many._replace(points_m=tuple((x, y) for x, _ in many.points_m)) for y in np.arange(20.0))
    with pytest.raises(InputError, match="999980 straight pieces of wall: expected at most 100000"):
        files.to_json(Environment(walls))


@pytest.mark.parametrize(
    ("walls", "words"),
    [
        ([wall(), wall()], r"workspace 2 \(segment\) is the same wall as workspace 1, and was left out"),
        ([wall(), wall(x0=1, x1=0)], r"workspace 2 \(segment\) is the same wall as workspace 1"),
        ([wall(), wall(x1=0)], "workspace 2 has no length, and was left out"),
        ([wall(), {"kind": "polyline", "points": [[2, 2], [2, 2]]}], "workspace 2 has too few places"),
        ([wall(colour="red")], "workspace 1: 'colour' is nothing that a segment has, and was left out"),
    ],
)
def test_what_is_harmless_is_mended_and_told(walls: list[Any], words: str) -> None:
    environment, told = files.from_json_mended(text(workspace=walls), "a.json")
    assert environment.workspace == (Segment(0.0, 0.0, 1.0, 0.0),)
    with pytest.raises(AssertionError, match=words):
        raise AssertionError("\n".join(told))
    assert all(line.startswith("a.json: ") for line in told)


def test_a_corner_that_is_there_twice_is_left_out() -> None:
    corners = [[0, 0], [1, 0], [1, 0], [1, 1], [0, 0]]
    environment, told = files.from_json_mended(text(workspace=[{"kind": "polygon", "corners": corners}]))
    assert environment.workspace == (Polygon(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))),)
    assert "2 of its places stood on the one before" in told[0]
    assert np.hypot(*np.diff(segments(environment.workspace[0]).reshape(-1, 2, 2), axis=1)[:, 0].T).min() == 1.0


@pytest.mark.parametrize("x", [0.0, 0.9, 4.5, 1.1])
def test_a_marker_inside_of_a_wall_is_refused(x: float) -> None:
    """A pillar of radius 1 in a room that reaches to 4 m: only 1.1 m is free."""
    room = {"kind": "polygon", "corners": [[-4, -4], [4, -4], [4, 4], [-4, 4]], "free": "inside"}
    given = text(
        workspace=[room, {"kind": "circle", "x": 0, "y": 0, "radius": 1}],
        markers={"start": {"kind": "point", "x": x, "y": 0}},
    )
    if x == 1.1:
        assert files.from_json(given).markers["start"] == Point(1.1, 0.0, 0.0)
        return
    with pytest.raises(InputError, match=r"marker 'start' at .* m inside of a wall"):
        files.from_json(given)


def test_a_file_is_written_whole_and_read_with_what_was_mended(tmp_path: Path) -> None:
    environment = Environment((Segment(),), origin={"schema": "itb", "angles": np.array([1.0, 2.0])})
    files.write(environment, tmp_path / "a.json")
    assert files.read(tmp_path / "a.json") == Environment((Segment(),), origin={"schema": "itb", "angles": [1.0, 2.0]})
    assert sources.environment_text(str(tmp_path / "a.json")) == files.to_json(environment)
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    with pytest.raises(InputError, match="x1_m = inf"):
        files.write(Environment((Segment(x1_m=math.inf),)), tmp_path / "b.json")
    assert not (tmp_path / "b.json").exists()
    (tmp_path / "c.json").write_text(text(workspace=[wall(), wall()]))
    with pytest.warns(UserWarning, match="the same wall as workspace 1"):
        files.read(tmp_path / "c.json")
    assert sources.told(str(tmp_path / "c.json")) == [
        f"{tmp_path}/c.json: workspace 2 (segment) is the same wall as workspace 1, and was left out"
    ]


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_bytes(b"\xff\xfe\x00")
    for name, words in (("a.json", "is no text"), ("b.json", "does not exist"), (".", "cannot be read")):
        with pytest.raises(InputError, match=words):
            files.read(tmp_path / name)
    with pytest.raises(InputError, match="expected a name that ends in"):
        sources.environment_text(str(tmp_path / "a.doc"))


def test_the_example_of_the_documentation_is_an_environment() -> None:
    page = (Path(files.__file__).parents[1] / "docs" / "environments.md").read_text(encoding="utf-8")
    environment, told = files.from_json_mended(page.partition("```json")[2].partition("```")[0])
    assert told == []
    assert set(environment.markers) == {"start"}
    assert len(environment.workspace) == 2
