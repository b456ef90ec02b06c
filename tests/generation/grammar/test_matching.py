"""Where left sides match: under all similarities, as parts of longer lines, and only as far as is allowed."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from flocking.types import Floats
from generation.grammar.lines import TOLERANCE_M, summed, without
from generation.grammar.matching import Allowed, matches, plan
from generation.grammar.shapes import Shape, Similarity, added, moved, of_row, part_of, same, shape, taken

ALL = Allowed()
RIGID = Allowed(scale=False, reflection=False)
NAN = math.nan


def drawn(*lines: Any, kinds: Any = None, labels: Any = ()) -> Shape:
    """A shape of lines (x0, y0, x1, y1) of kind 0, and labels (label, x, y, heading)."""
    return shape(
        np.array(lines, float).reshape(-1, 4),
        np.array(kinds if kinds is not None else [0] * len(lines), np.int64),
        np.array([label[0] for label in labels], np.int64),
        np.array([label[1:] for label in labels], float).reshape(-1, 3),
    )


SQUARE = drawn((0, 0, 1, 0), (1, 0, 1, 1), (1, 1, 0, 1), (0, 1, 0, 0))
FLAG = drawn((0, 0, 0, 3), (0, 3, 2, 3), labels=[(0, 0, 0, NAN)])
TRIANGLE = drawn((0, 0, 4, 0), (4, 0, 1, 2), (1, 2, 0, 0))
LADDER = drawn((0, 0, 3, 0), (1, 1, 2, 1))
HOOK = drawn((0, 0, 2, 0), (2, 0, 2, 1))
LINE = drawn((0, 0, 2, 0))
POINTS = drawn(labels=[(0, 0, 0, NAN), (1, 2, 0, NAN), (2, 0, 1, NAN)])
ARROW = drawn(labels=[(0, 0, 0, 0.3), (1, 1, 2, NAN)])
DASHED = drawn((0, 0, 2, 0), (0, 1, 2, 1), (0, 2, 3, 2), kinds=[0, 1, 0])
SHAPES = [SQUARE, FLAG, TRIANGLE, LADDER, HOOK, LINE, POINTS, ARROW, DASHED]


def found(left: Shape, host: Shape, allowed: Allowed = ALL) -> list[Similarity]:
    return [of_row(row) for row in rows(left, host, allowed)]


def rows(left: Shape, host: Shape, allowed: Allowed = ALL) -> Floats:
    out: Floats = matches(left, host, plan(left, allowed, "left"), allowed, 1e-9, 1e6)
    return out


similarities = st.builds(
    Similarity,
    st.floats(0.05, 20.0),
    st.floats(-math.pi, math.pi),
    st.booleans(),
    st.floats(-100.0, 100.0),
    st.floats(-100.0, 100.0),
)


@pytest.mark.parametrize("left", SHAPES)
@given(under=similarities, beside=similarities, other=st.sampled_from(SHAPES))
@settings(max_examples=60, deadline=None)
def test_a_shape_under_any_similarity_is_found_beside_another(
    left: Shape, under: Similarity, beside: Similarity, other: Shape
) -> None:
    """The other one is put far away, where it does not prolong any line."""
    image = moved(left, under.row())
    host = added(moved(other, beside._replace(x_m=beside.x_m + 1000.0).row()), image)
    all_found = rows(left, host)
    assert all(part_of(moved(left, row), host) for row in all_found)
    assert any(same(moved(left, row), image) for row in all_found)
    assert any(np.abs(row - under.row()).max() < 1e-4 for row in all_found)  # places agree within micrometres


@given(under=similarities)
@settings(max_examples=100, deadline=None)
def test_only_what_is_allowed_is_found(under: Similarity) -> None:
    assume(under.scale == 1.0 or abs(under.scale - 1.0) > 1e-4)  # what is nearly none of a transformation is none
    assume(under.turn_rad == 0.0 or abs(under.turn_rad) > 1e-4)
    image = moved(FLAG, under.row())
    none = Allowed(False, False, False, False)
    for allowed, passes in (
        (none._replace(translation=True), under.scale == 1.0 and under.turn_rad == 0.0 and not under.mirrored),
        (none._replace(translation=True, rotation=True), under.scale == 1.0 and not under.mirrored),
        (ALL._replace(reflection=False), not under.mirrored),
    ):
        assert bool(found(FLAG, image, allowed)) == passes


@pytest.mark.parametrize(
    ("under", "needed"),
    [
        (Similarity(x_m=3.0, y_m=-2.0), {"translation"}),
        (Similarity(turn_rad=0.7), {"rotation"}),
        (Similarity(scale=2.5), {"scale"}),
        (Similarity(mirrored=True), {"reflection"}),
        (Similarity(mirrored=True, turn_rad=math.pi), {"reflection"}),
        (Similarity(2.0, 1.0, True, 5.0, 6.0), {"translation", "rotation", "scale", "reflection"}),
    ],
)
@pytest.mark.parametrize("left", [FLAG, TRIANGLE, POINTS, HOOK])
def test_each_transformation_is_found_where_it_is_allowed_and_nowhere_else(
    left: Shape, under: Similarity, needed: set[str]
) -> None:
    """Of the hook, a corner alone, other places are found as well; the one that was made is among them."""
    image = moved(left, under.row())
    for bits in range(16):
        names = {name for k, name in enumerate(Allowed._fields) if bits >> k & 1}
        allowed = Allowed(*(name in names for name in Allowed._fields))
        there = any(same(moved(left, row), image) for row in rows(left, image, allowed))
        if needed <= names:
            assert there
        elif left is not HOOK:  # which is its own mirror image, turned
            assert not there


@pytest.mark.parametrize(
    ("left", "count"),
    [(SQUARE, 8), (TRIANGLE, 1), (FLAG, 1), (LINE, 4), (LADDER, 2), (drawn((-1, 0, 1, 0), (0, -1, 0, 1)), 8)],
)
def test_a_shape_matches_itself_once_for_each_of_its_symmetries(left: Shape, count: int) -> None:
    assert len(found(left, left)) == count


def test_a_square_is_a_part_of_a_grid_of_four_longer_lines() -> None:
    """Lines 0, 1, 3 apart: squares with sides 1, 2 and 3."""
    at = (0.0, 1.0, 3.0)
    grid = drawn(*[(-5, a, 9, a) for a in at], *[(a, -5, a, 9) for a in at])
    images = [moved(SQUARE, row) for row in rows(SQUARE, grid)]
    different: list[Shape] = []
    for image in images:
        if not any(same(image, other) for other in different):
            different.append(image)
    sides = sorted(round(float(np.ptp(image.lines[:, 0])), 6) for image in different)
    assert sides == [1.0, 2.0, 3.0]
    assert len(images) == 3 * 8
    assert len(found(SQUARE, grid, RIGID)) == 4


@given(start=st.floats(0.0, 1.0), length=st.floats(0.01, 1.0), under=similarities)
@settings(max_examples=100, deadline=None)
def test_a_part_of_a_line_is_a_sub_shape_and_what_lies_beyond_is_not(
    start: float, length: float, under: Similarity
) -> None:
    line = drawn((0, 0, 1, 0))
    piece = drawn((start, 0, start + length, 0))
    row = under._replace(scale=1.0).row()
    assert part_of(moved(piece, row), moved(line, row)) == (start + length <= 1.0 + TOLERANCE_M)


def test_a_line_that_can_slide_is_found_at_the_ends_of_a_longer_one() -> None:
    places = found(LINE, drawn((0, 0, 5, 0)), RIGID)
    starts = sorted((round(p.x_m, 9), round(math.cos(p.turn_rad))) for p in places)
    assert starts == [(0.0, 1), (2.0, -1), (3.0, 1), (5.0, -1)]
    assert found(LINE, drawn((0, 0, 1.9, 0)), RIGID) == []
    whole = found(LINE, drawn((0, 0, 5, 0)), Allowed(reflection=False))
    assert sorted(round(p.scale, 9) for p in whole) == [2.5, 2.5]


def test_lines_that_end_on_one_another_are_found_as_one() -> None:
    halves = drawn((0, 0, 1, 0), (1, 0, 2, 0))
    assert len(halves.kinds) == 1
    assert len(found(LINE, halves, RIGID)) == 2


def test_another_kind_or_label_or_heading_is_no_match() -> None:
    assert found(LINE, drawn((0, 0, 2, 0), kinds=[1])) == []
    assert found(ARROW, drawn(labels=[(0, 0, 0, 0.3), (2, 1, 2, NAN)])) == []
    assert found(ARROW, drawn(labels=[(0, 0, 0, NAN), (1, 1, 2, NAN)])) == []
    assert found(ARROW, drawn(labels=[(0, 0, 0, 0.4), (1, 1, 2, NAN)])) == []


@pytest.mark.parametrize(
    ("left", "allowed", "open_"),
    [
        (drawn(labels=[(0, 0, 0, 0.0)]), ALL, "size"),
        (drawn(labels=[(0, 0, 0, NAN)]), RIGID, "direction"),
    ],
)
def test_a_left_side_that_leaves_a_match_open_is_refused(left: Shape, allowed: Allowed, open_: str) -> None:
    with pytest.raises(InputError, match=f"leave the {open_} of a match open"):
        plan(left, allowed, "left")


# sums and differences of lines, against sets of points on a fine raster


pieces = st.lists(st.tuples(st.integers(0, 30), st.integers(1, 12)), min_size=1, max_size=8)


@given(one=pieces, other=pieces, under=similarities)
@settings(max_examples=200, deadline=None)
def test_sum_and_difference_of_collinear_lines_are_those_of_their_unit_pieces(
    one: Any, other: Any, under: Similarity
) -> None:
    row = under._replace(scale=1.0).row()

    def lines(of: Any) -> Floats:
        return moved(_plain(of), row).lines

    def units(of: Floats) -> set[int]:
        """The unit pieces that lines cover, told back in the frame in which they were drawn."""
        covered: set[int] = set()
        for x0, y0, x1, y1 in of:
            a, b = ((x - row[3]) * row[0] + (y - row[4]) * row[1] for x, y in ((x0, y0), (x1, y1)))
            low, high = round(min(a, b)), round(max(a, b))
            assert abs(min(a, b) - low) < 1e-9  # rounding at coordinates of some 100
            piece = set(range(low, high))
            assert not piece & covered
            covered |= piece
        return covered

    none = np.empty((0, 4)), np.empty(0, np.int64)
    first = summed(*none, lines(one), np.zeros(len(one), np.int64))
    second = summed(*none, lines(other), np.zeros(len(other), np.int64))
    a = {k for start, length in one for k in range(start, start + length)}
    b = {k for start, length in other for k in range(start, start + length)}
    assert units(first[0]) == a
    assert units(summed(*first, *second)[0]) == a | b
    assert units(without(*first, *second)[0]) == a - b
    both = sorted(a | b)
    runs = 1 + sum(q - p > 1 for p, q in pairwise(both))
    assert len(summed(*first, *second)[0]) == runs  # maximal


def _plain(of: Any) -> Shape:
    lines = np.array([(start, 0.0, start + length, 0.0) for start, length in of])
    return Shape(lines, np.zeros(len(of), np.int64), np.empty(0, np.int64), np.empty((0, 3)))


@given(one=similarities, other=similarities, a=st.sampled_from(SHAPES), b=st.sampled_from(SHAPES))
@settings(max_examples=60, deadline=None)
def test_what_is_added_and_taken_again_leaves_the_rest(one: Similarity, other: Similarity, a: Shape, b: Shape) -> None:
    """Far apart, so that they have nothing in common."""
    first, second = moved(a, one.row()), moved(b, other._replace(x_m=1000.0).row())
    both = added(first, second)
    assert part_of(first, both)
    assert part_of(second, both)
    assert same(taken(both, second), first)
    assert same(taken(both, both), drawn())
