"""Starting poses from a CSV file, and what walls do to a start."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.errors import InputError
from generation.environment import Environment
from generation.primitives import Circle, Point, Polygon, Segment
from worlds import start_poses, starts

ROWS = "1,2,90\n-3, 4.5,-180\n"
ROOM = Polygon(((0, 0), (6, 0), (6, 4), (0, 4)), "inside")


@pytest.mark.parametrize("text", [ROWS, f"x_m,y_m,heading_deg\n{ROWS}", f"\ufeffx_m, y_m, heading_deg\r\n\r\n{ROWS}"])
def test_rows_are_metres_and_degrees(text: str) -> None:
    poses = start_poses.poses("a.csv", text, 2)
    assert_allclose(poses, [[1.0, 2.0, math.pi / 2], [-3.0, 4.5, -math.pi]], atol=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has 0 poses: expected 1 to"),
        ("1,2,3\n", "has 1 poses for 2 members"),
        ("1,2,3\n1,2,9\n", r"two members start at \(1, 2\) m"),
        ("1,2,3\nnan,2,9\n", r"a.csv, line 2: 'nan,2,9': expected x_m, y_m, heading_deg, three finite numbers"),
        ("1,2,3\n1,2e9,9\n", "line 2"),
        ("1,2\n", "a.csv, line 1: '1,2'"),
        ("x,y,heading\n1,2,3\n", "line 1: 'x,y,heading'"),
        ('"1,2,3\n', "is no CSV"),
    ],
)
def test_what_are_no_poses_is_refused_in_one_line(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        start_poses.poses("a.csv", text or "\n", 2)
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"formation file '.*a\.csv' does not exist; expected a CSV file"):
        start_poses.text_of(str(tmp_path / "a.csv"))


def test_a_formation_is_put_at_the_marker_and_turned_with_it() -> None:
    formation = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.5]])
    there = starts.put_at_start(Environment(markers={"start": Point(3.0, 4.0, math.pi / 2)}), formation)
    assert_allclose(there, [[3.0, 5.0, math.pi / 2], [1.0, 4.0, math.pi / 2 + 0.5]], atol=1e-12)
    assert starts.put_at_start(Environment(), formation) is formation


def herd(*places: tuple[float, float], radius: float = 0.165) -> starts.Starting:
    poses = np.array([(*place, 0.0) for place in places])
    names = [f"herd-{k + 1}" for k in range(len(poses))]
    return starts.Starting(names, poses, np.full(len(poses), radius), np.ones(len(poses), np.bool_))


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ((1.0, 1.0), ""),
        ((0.1, 1.0), r"herd-1 starts at \(0.10, 1.00\) m, and reaches 0.0[67] m into a wall"),
        ((-0.05, 1.0), "inside a wall"),
        ((-3.0, 1.0), "behind a wall"),
        ((5.0, 2.0), "inside a wall"),
        ((2.9, 1.0), r"and reaches 0.0[67] m into a fence"),
        ((3.0, 1.0), "in a fence"),
        ((4.0, 1.0), r"walls keep it apart from the herd's start at \(1.00, 2.00\) m"),
    ],
)
def test_a_start_in_a_wall_or_cut_off_from_the_marker_is_refused(place: tuple[float, float], words: str) -> None:
    solid, fence = Circle(5.0, 2.0, 0.5), Segment(3.0, 0.0, 3.0, 4.0)
    environment = Environment((ROOM, solid, fence), markers={"start": Point(1.0, 2.0)})
    if not words:
        starts.check(herd(place), environment)
        return
    with pytest.raises(InputError, match=words):
        starts.check(herd(place), environment)
    # by itself, not in the formation about the start, a member may stand behind the fence
    if "apart" in words:
        starts.check(herd(place)._replace(together=np.array([False])), environment)


def test_the_brackets_of_a_touch() -> None:
    """A millionth of a millimetre nearer than its radius is refused, and farther is not."""
    environment = Environment((ROOM,))
    starts.check(herd((0.165 + 1e-9, 1.0)), environment)
    with pytest.raises(InputError, match="into a wall"):
        starts.check(herd((0.165 - 1e-9, 1.0)), environment)


def test_without_a_marker_members_must_have_no_wall_between_them_and_a_marker_is_advised() -> None:
    environment = Environment((ROOM, Segment(3.0, 0.0, 3.0, 4.0)), origin={"file": "plan.svg"})
    starts.check(herd((1.0, 1.0), (2.0, 3.0)), environment)
    with pytest.raises(InputError, match="or a marker 'start' to put it at"):
        starts.check(herd((1.0, 1.0), (4.0, 3.0)), environment)


def test_members_that_overlap_are_named() -> None:
    starts.check_apart(herd((0.0, 0.0), (0.34, 0.0)))
    with pytest.raises(InputError, match=r"herd-1 and herd-3 overlap by 0.03 m"):
        starts.check_apart(herd((0.0, 0.0), (5.0, 0.0), (0.3, 0.0)))
