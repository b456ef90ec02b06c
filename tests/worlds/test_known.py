"""Worlds by name, by a user's Python file, and by an environment's file."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from flocking.errors import InputError
from generation.environment import Environment
from generation.files import to_json, write
from generation.primitives import Point, Segment
from worlds import corridor, known
from worlds.walls import closed, walls_of

TEXT = to_json(Environment((Segment(0, 0, 1, 2),), markers={"start": Point(1, 0, 0.5)}, reflectance=0.4))


def test_the_corridor_has_the_walls_that_it_always_had() -> None:
    a, b = 40.0, 7 * 0.33 / 2
    walls = walls_of(corridor.environment(corridor.Parameters()))
    np.testing.assert_array_equal(walls.segments, closed([(-a, -b), (a, -b), (a, b), (-a, b)]))
    assert len(walls.fences) == 0


def test_worlds_are_found_by_what_their_files_define() -> None:
    assert known.names() == ["corridor", "octagon", "open-floor", "post", "t-junction"]
    assert known.load("open_floor").free_length((), 0.1) == math.inf
    for name in ("coridor", "assemble", "walls"):
        with pytest.raises(InputError, match="unknown world"):
            known.load(name)


def test_an_environment_has_a_scale_and_a_reflectance() -> None:
    as_it_is = known.environment_of("a.json", TEXT, {})
    assert (as_it_is.reflectance, as_it_is.markers["start"]) == (0.4, Point(1.0, 0.0, 0.5))
    larger = known.environment_of("a.json", TEXT, {"scale": 3.0, "reflectance": 0.9})
    assert larger.workspace == (Segment(0.0, 0.0, 3.0, 6.0),)
    assert (larger.reflectance, larger.markers["start"]) == (0.9, Point(3.0, 0.0, 0.5))
    assert known.load("a.json", TEXT).values({"scale": 2.0}) == {
        "scale": 2.0,
        "reflectance": 0.4,
        "construct": True,
    }
    with pytest.raises(InputError, match=r"world\.scale = 0: expected a number from 0\.001"):
        known.environment_of("a.json", TEXT, {"scale": 0})


def test_an_environment_can_stand_without_its_construct() -> None:
    text = to_json(Environment((Segment(0, 0, 1, 2),), (Segment(5, 5, 6, 6),), {"origin": Point(1.0, 1.0)}))
    empty = known.environment_of("a.json", text, {"construct": False})
    assert empty.construct == ()
    assert (empty.workspace, set(empty.markers)) == ((Segment(0.0, 0.0, 1.0, 2.0),), {"origin"})
    assert known.environment_of("a.json", text, {}).construct == (Segment(5.0, 5.0, 6.0, 6.0),)


def test_its_text_is_read_once_from_its_file(tmp_path: Path) -> None:
    write(known.environment_of("a.json", TEXT, {}), tmp_path / "a.json")
    assert known.text_of(str(tmp_path / "a.json")) == TEXT
    assert known.told(str(tmp_path / "a.json")) == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("def walls(p): pass", "lacks Parameters|has walls"),
        (
            "class Parameters: pass\ndef walls(p): pass",
            r"has walls\(parameters\), .* expected environment\(parameters\)",
        ),
        ("def environment(p): pass", "lacks Parameters"),
        ("class Parameters: pass", "lacks environment"),
    ],
)
def test_a_python_file_that_is_no_world_is_told_what_to_write(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        known.load("own.py", text)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return 3", r"environment\(...\) returned int; expected generation.environment.Environment"),
        ("return Environment((Segment(x1_m=float('nan')),))", "workspace 1: x1_m = nan"),
        ("return 1 / 0", "line 7: ZeroDivisionError"),
    ],
)
def test_what_a_users_world_makes_is_checked(body: str, words: str) -> None:
    text = f"""from typing import NamedTuple
from generation.environment import Environment
from generation.primitives import Segment
class Parameters(NamedTuple):
    pass
def environment(parameters):
    {body}
"""
    with pytest.raises(InputError, match=words):
        known.environment_of("own.py", text, {})
