"""Parameters, errors, selections, angles, and the freshness of compiled code."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from flocking import found, lawentry, selection
from flocking.angles import LAST, wrap, wrapped
from flocking.errors import InputError
from flocking.parameters import Parameter, filled, relation
from flocking.types import members_at

ROOT = Path(lawentry.__file__).parents[1]


class Parameters(NamedTuple):
    """Of a test."""

    distance_m: Annotated[float, Parameter("m", "test", low=0.0, high=2.0)] = 1.0
    count: Annotated[int, Parameter("", "test", low=1)] = 3
    mode: Annotated[str, Parameter("", "test", choices=("one", "two"))] = "one"
    on: Annotated[bool, Parameter("", "test")] = False


class TestParameters:
    def test_defaults_stand_where_nothing_is_given(self) -> None:
        assert filled(Parameters, {}) == Parameters()
        assert filled(Parameters, {"distance_m": 2}).distance_m == 2.0

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"distance_m": math.nan}, "from 0 to 2 in m"),
            ({"distance_m": 2.0 + 1e-9}, "from 0 to 2 in m"),
            ({"distance_m": "far"}, "a number in m"),
            ({"distance_m": True}, "a number in m"),
            ({"count": 0}, "at least 1"),
            ({"count": 2.5}, "whole number"),
            ({"mode": "twoo"}, "did you mean two"),
            ({"on": 1}, "true or false"),
            ({"distanse_m": 1.0}, "distance_m"),
        ],
    )
    def test_errors_name_the_value_and_the_bounds(self, given: dict[str, object], words: str) -> None:
        with pytest.raises(InputError, match=words):
            filled(Parameters, given)


class TestRelations:
    @pytest.mark.parametrize(
        ("words", "names", "holding"),
        [
            ("distance_m below count", ["distance_m", "count"], [True, False, False]),
            ("distance_m at most count", ["distance_m", "count"], [True, True, False]),
            ("distance_m above 1", ["distance_m"], [False, False, True]),
            ("distance_m at least 1", ["distance_m"], [False, True, True]),
        ],
    )
    def test_the_words_are_what_is_compared(self, words: str, names: list[str], holding: list[bool]) -> None:
        found = relation(words, Parameters)
        assert found.names == names
        assert [found.holds(Parameters(distance_m=value, count=1)) for value in (0.5, 1.0, 1.5)] == holding

    @pytest.mark.parametrize("words", ["distance_m < count", "distanse_m below 1", "distance_m below cuont", "", 3])
    def test_other_words_are_refused(self, words: str) -> None:
        with pytest.raises(InputError, match=r"expected NAME below .* with NAME of distance_m, count"):
            relation(words, Parameters)


class TestAngles:
    @pytest.mark.parametrize("turns", [-2, -1, 0, 1, 3])
    def test_whole_turns_vanish(self, turns: int) -> None:
        # one turn of 2π in float64 is off by 2.4e-16, times three turns
        assert wrap(0.5 + turns * 2 * math.pi) == pytest.approx(0.5, abs=1e-14)

    def test_the_interval_is_half_open(self) -> None:
        assert wrap(math.pi) == -math.pi
        assert wrap(-math.pi) == -math.pi

    @pytest.mark.parametrize("angle", [np.nextafter(-math.pi, -10.0), -3.0 * math.pi, -1e-16 - math.pi, 1e9, -1e9])
    def test_no_rounding_leads_out_of_the_interval(self, angle: float) -> None:
        for turned in (wrap(angle), wrap.py_func(angle), float(wrapped(np.array([angle]))[0])):
            assert -math.pi <= turned <= LAST < math.pi

    def test_half_a_turn_less_a_rounding_is_just_below_half_a_turn(self) -> None:
        assert wrap(float(np.nextafter(-math.pi, -10.0))) == LAST

    def test_of_an_array_it_is_that_of_each(self) -> None:
        angles = np.array([-7.0, -math.pi, -0.1, 0.0, 3.0, math.pi, 4.0, 100.0])
        assert wrapped(angles).tolist() == pytest.approx([wrap(angle) for angle in angles.tolist()], abs=1e-14)


class TestSelection:
    members = members_at(np.array([[1.0, 0.0], [0.0, 3.0], [-2.0, 0.0]]))

    @pytest.mark.parametrize(
        ("text", "kept"),
        [
            ("all", [0, 1, 2]),
            ("nearest", [0]),
            ("k-nearest(2)", [0, 2]),
            ("distance-based(1, 3)", [0, 2]),
            ("distance-based(1.5, 9) & nearest", [2]),
        ],
    )
    def test_keeps_whom_it_says(self, text: str, kept: list[int]) -> None:
        mask = selection.select(selection.parse(text), self.members)
        assert np.flatnonzero(mask).tolist() == kept

    @pytest.mark.parametrize("text", ["nearst", "k-nearest", "k-nearest(x)", "all(1)", "", "distance-based(1, nan)"])
    def test_refuses_what_is_no_selection(self, text: str) -> None:
        with pytest.raises(InputError):
            selection.parse(text)

    def test_nobody_is_legal(self) -> None:
        assert selection.select(selection.parse("nearest"), members_at(np.empty((0, 2)))).shape == (0,)


class TestFound:
    def test_names_are_files_and_hyphens_equal_underscores(self) -> None:
        assert "extended-hamilton" in found.modules("flocking.laws")
        assert found.load("flocking.laws", "extended_hamilton", "law") is found.load(
            "flocking.laws", "extended-hamilton", "law"
        )

    def test_a_wrong_name_offers_the_nearest(self) -> None:
        with pytest.raises(InputError, match="did you mean extended-hamilton"):
            found.load("flocking.laws", "extended-hamiltn", "law")


LAW = """
import math
from typing import Annotated, NamedTuple
from flocking.parameters import Parameter
from flocking.types import Kind, Motion
from flocking.helper_of_a_test import gain

class Parameters(NamedTuple):
    pass

def law(own, members, sets, obstacles, parameters, memory, u):
    return Motion(Kind.WAY_POINT, gain(), 0.0, 0)
"""
HELPER = "from flocking.compilation import compiled\n\n@compiled\ndef gain():\n    return {}\n"
CALL = """
import math, numpy as np
from flocking import lawentry
from flocking.types import NO_MEMBERS, NO_OBSTACLES, Own
own = Own(np.zeros(2), 0.0, math.nan, np.zeros(2), np.zeros(2, dtype=bool), 0.1, 0, 0)
law = lawentry.load("law_of_a_test")
empty = np.ones((1, 0), dtype=bool)
print(law.decide(own, NO_MEMBERS, empty, NO_OBSTACLES, law.parameters({}), np.zeros(0), np.zeros(0)).x)
"""


def test_compiled_code_is_never_stale_after_an_edit_of_a_helper(tmp_path: Path) -> None:
    """A copy of the packages, so that the edit does not touch the real ones; the cache is shared between the runs."""
    import shutil

    for package in ("flocking", "robots", "sensing"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "flocking/laws/law_of_a_test.py").write_text(LAW)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "CREATE_HERD_CACHE": str(tmp_path / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)

    def run() -> float:
        done = subprocess.run(
            [sys.executable, "-c", CALL],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return float(done.stdout)

    for value in (1.0, 2.0):
        (tmp_path / "flocking/helper_of_a_test.py").write_text(HELPER.format(value))
        assert run() == value


def test_only_the_hashed_packages_hold_compiled_code() -> None:
    for package in ("worlds", "trials", "scripts"):
        for path in (ROOT / package).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            assert "@compiled" not in text, path
            assert "njit" not in text, path
