"""Filters: closed forms, an independent oracle (a flooded grid), invariances, and users' files."""

import itertools
import math

import numpy as np
import pytest
import shapely
from scipy import ndimage

from flocking.errors import InputError
from generation import filters
from generation.environment import Environment
from generation.free_paths import reached
from generation.primitives import Arc, Circle, Point, Polygon, Polyline, Segment
from generation.workspaces import t_junction

CELL = 0.04


def accepts(name, environment, **given):
    found = filters.load(name)
    return found.accepts(environment, found.filled(given))


def enclosure(gap, sides=8, radius=10.0, turn=0.0):
    """A regular polygon around the origin whose last side lacks a gap of that width in its middle."""
    angles = turn + 2.0 * math.pi * np.arange(sides + 1) / sides
    corners = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    walls = [Segment(*start, *end) for start, end in itertools.pairwise(corners[:-1])]
    start, end = corners[-2:]
    along = (end - start) / np.hypot(*(end - start))
    middle = (start + end) / 2
    if gap == 0.0:
        walls.append(Segment(*start, *end))
    else:
        walls += [Segment(*start, *(middle - gap / 2 * along)), Segment(*(middle + gap / 2 * along), *end)]
    return Environment(construct=tuple(walls), markers={"origin": Point()})


def flooded(walls, place, radius, low=-1.5, high=7.5):
    """Cells that cells farther than `radius` from every wall join to the cell of a place."""
    at = np.arange(low, high, CELL)
    x, y = np.meshgrid(at, at, indexing="ij")
    free = np.ones(x.shape, dtype=bool)
    for x0, y0, x1, y1 in walls:
        dx, dy = x1 - x0, y1 - y0
        share = np.clip(((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
        free &= np.hypot(x - x0 - share * dx, y - y0 - share * dy) > radius
    labels, _ = ndimage.label(free)
    cell = labels[tuple(np.rint((np.array(place) - low) / CELL).astype(int))]
    return (labels == cell) & (cell > 0)


def is_out(region, walls):
    """Whether a region goes round all walls: their box is cut off a metre beyond them."""
    return region.bounds[0] < walls[:, ::2].min() - 0.9


def out_by_flood(walls, place, radius):
    """Whether flooding leaves the box of the walls: it reaches the grid's rim."""
    reach = flooded(walls, place, radius)
    return bool(reach[0].any() or reach[-1].any() or reach[:, 0].any() or reach[:, -1].any())


@pytest.mark.parametrize("name", filters.names())
def test_each_filter_keeps_the_contract(name):
    found = filters.load(name)
    environment = Environment(construct=(Segment(1.0, 1.0, 2.0, 2.0),), markers={"origin": Point(), "start": Point()})
    assert isinstance(found.accepts(environment), bool)
    assert found.about
    assert found.name == name


def test_terminals_are_counted_by_primitive():
    three = (Segment(), Polyline(((0.0, 0.0), (1.0, 0.0), (2.0, 1.0))), Circle())
    assert accepts("terminals", Environment(construct=three))
    assert not accepts("terminals", Environment(workspace=three, construct=three[:2]))
    assert accepts("terminals", Environment(construct=three[:2]), least=2)


def test_fence_length_is_that_of_the_construct():
    half = Arc(0.0, 0.0, 1.0, 0.0, math.pi)
    environment = Environment(workspace=(Segment(0.0, 0.0, 900.0, 0.0),), construct=(Segment(0.0, 0.0, 3.0, 4.0), half))
    assert not accepts("fence-length", environment, most_m=8.0)
    assert accepts("fence-length", environment, most_m=5.0 + math.pi)  # pieces of an arc are shorter than it
    assert accepts("fence-length", Environment(construct=(Segment(0.0, 0.0, 60.0, 80.0),)))
    assert not accepts("fence-length", Environment(construct=(Segment(0.0, 0.0, 60.0, 80.001),)))


@pytest.mark.parametrize("sides", [3, 4, 8, 30])
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_an_enclosure_passes_only_with_a_gap(sides, turn):
    assert not accepts("enclosing", enclosure(0.0, sides, turn=turn))
    assert accepts("enclosing", enclosure(0.01, sides, turn=turn))


@pytest.mark.parametrize("width", [0.5, 3.0])
def test_the_width_of_a_gap_decides(width):
    assert accepts("enclosing", enclosure(width * 1.001), width_m=width)
    assert not accepts("enclosing", enclosure(width * 0.997), width_m=width)  # rounded corners: 0.12 % wider


def test_a_marker_outside_of_the_hull_or_on_a_wall_does_not_pass():
    walls = enclosure(1.0).construct
    for place, expected in (((0.0, 0.0), True), ((20.0, 0.0), False), ((10.0, 0.0), False)):
        environment = Environment(construct=walls, markers={"origin": Point(*place)})
        assert accepts("enclosing", environment) == expected


@pytest.mark.parametrize("walls", [(), (Segment(-1.0, 0.0, 1.0, 0.0),), (Segment(-1.0, 1.0, 1.0, 1.0),)])
def test_less_than_three_corners_enclose_nothing(walls):
    assert not accepts("enclosing", Environment(construct=walls, markers={"origin": Point()}))


def test_a_workspace_around_the_hull_lets_out_of_it_but_one_within_does_not():
    construct = enclosure(2.0).construct
    for side, expected in ((30.0, True), (2.0, False)):
        room = Polygon(((-side, -side), (side, -side), (side, side), (-side, side)), "inside")
        environment = Environment((room,), construct, {"origin": Point()})
        assert accepts("enclosing", environment) == expected


def test_a_hole_in_a_face_belongs_to_no_way_out():
    """A closed ring around a marker, with a smaller closed ring beside it."""
    rings = (Circle(0.0, 0.0, 10.0, "both"), Circle(5.0, 0.0, 2.0, "both"))
    for place in ((0.0, 0.0), (5.0, 0.0)):
        assert not accepts("enclosing", Environment(construct=rings, markers={"origin": Point(*place)}))


def test_free_paths_of_a_point_are_those_of_a_flooded_grid():
    """Corners on a lattice of side 6: walls touch or are at least 1/sqrt(72) = 0.118 apart, three cells."""
    rng, seen = np.random.default_rng(1), []
    while len(seen) < 60:
        walls = rng.integers(0, 7, (rng.integers(10, 22), 4)).astype(float)
        walls = walls[np.any(walls[:, :2] != walls[:, 2:], axis=1)]
        place = rng.integers(1, 6, 2) + np.array([0.31, 0.27])
        if shapely.MultiLineString(list(walls.reshape(-1, 2, 2))).distance(shapely.Point(place)) < 3 * CELL:
            continue
        region = reached(walls, tuple(place))
        expected = out_by_flood(walls, place, 0.71 * CELL)  # the diagonal of half a cell: no wall is leapt over
        assert is_out(region, walls) == expected
        seen.append(expected)
    assert 10 < sum(seen) < 50


def test_free_paths_of_a_width_are_those_of_a_flooded_grid():
    rng, seen = np.random.default_rng(2), []
    while len(seen) < 60:
        walls = rng.uniform(0.0, 6.0, (6, 4))
        place, width = rng.uniform(1.5, 4.5, 2), rng.uniform(0.3, 1.2)
        sure = {out_by_flood(walls, place, width / 2 + margin) for margin in (-1.5 * CELL, 1.5 * CELL)}
        if len(sure) == 2:
            continue  # the grid is too coarse to tell
        region = reached(walls, tuple(place), width)
        found = region is not None and is_out(region, walls)
        assert found == sure.pop()
        seen.append(found)
    assert 10 < sum(seen) < 50


@pytest.mark.parametrize("width", [0.0, 1.0])
def test_enclosing_is_the_same_in_every_frame(width):
    rng, found = np.random.default_rng(3), filters.load("enclosing")
    parameters, values = found.filled({"width_m": width}), []
    for _ in range(60):
        walls = tuple(Segment(*row) for row in rng.uniform(-6.0, 6.0, (8, 4)))
        environment = Environment(construct=walls, markers={"origin": Point()})
        value = found.accepts(environment, parameters)
        assert found.accepts(environment.moved(1.0, 2.1, 40.0, -7.0), parameters) == value
        values.append(value)
    assert 5 < sum(values) < 55


def test_passage_wants_room_at_the_start():
    junction = t_junction()
    assert accepts("passage", junction)
    assert accepts("passage", junction, start_m=1.0)
    assert not accepts("passage", junction, start_m=1.01)


@pytest.mark.parametrize(("end", "expected"), [(1.5, True), (1.61, False)])
def test_passage_wants_a_way_to_the_goal_of_its_width(end, expected):
    """A wall across the right arm that leaves 2 m less its length; the arm is 2 m wide and the way 0.4 m."""
    junction = t_junction()
    environment = Environment(junction.workspace, (Segment(2.0, 0.0, 2.0, end),), junction.markers)
    assert accepts("passage", environment) == expected
    assert accepts("passage", environment, width_m=0.0)


def test_passage_without_a_goal_leads_out():
    markers = {"start": Point()}
    assert accepts("passage", Environment(markers=markers))
    assert accepts("passage", Environment(construct=enclosure(1.0).construct, markers=markers))
    assert not accepts("passage", Environment(construct=enclosure(0.3).construct, markers=markers))


@pytest.mark.parametrize("name", ["enclosing", "passage"])
def test_a_missing_marker_is_told(name):
    with pytest.raises(InputError, match="is missing; expected a point"):
        accepts(name, Environment(construct=(Segment(),)))


OWN = """'''Mine.'''
from typing import NamedTuple
class Parameters(NamedTuple):
    pass
def passes(environment, parameters):
    return {value}
"""


@pytest.mark.parametrize(("value", "told"), [("3", "returned 3"), ("None", "None"), ("1 / 0", "line 6")])
def test_a_users_filter_that_breaks_its_promise_is_told_in_one_line(tmp_path, value, told):
    path = tmp_path / "mine.py"
    path.write_text(OWN.format(value=value))
    with pytest.raises(InputError) as raised:
        filters.load(str(path)).accepts(Environment())
    assert str(path) in str(raised.value)
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_users_filter_is_asked_like_any_other(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(OWN.format(value="len(environment.construct) == 1"))
    assert filters.load(str(path)).accepts(Environment(construct=(Segment(),)))
    assert not filters.load(str(path)).accepts(Environment())
    path.write_text("'''Mine.'''")
    with pytest.raises(InputError, match="lacks Parameters, passes"):
        filters.load(str(path))


def test_an_unknown_name_gets_the_nearest_ones():
    with pytest.raises(InputError, match="did you mean terminals"):
        filters.load("terminal")
