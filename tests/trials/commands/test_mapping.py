"""`herd map`: its table, its numbers and its figures; what it refuses, in one line."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from trials.commands import cli, mapping
from trials.simulations.maps import loop

QUICK = ["--grid", "2", "--refinements", "1", "--members", "2", "--set", "pairs=1", "--set", "iterations=3"]
OWN = '''
"""A wall across the stem."""
from typing import Annotated, NamedTuple
from flocking.parameters import Parameter
from generation.workspaces import built, t_junction, wall

FILTER, BEHAVIOUR = "", "turn-right"


class Parameters(NamedTuple):
    x_m: Annotated[float, Parameter("m", "mine", low=-1.0, high=1.0)] = 0.0


def workspace():
    return t_junction()


def generate(parameters, workspace, rng):
    return built(workspace, wall((parameters.x_m, 0.0), 90.0, 1.0))
'''


def herd(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["herd", *words])
    return cli.main()


def test_a_map_is_a_table_numbers_and_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "map"
    assert herd(monkeypatch, "map", "dirt", *QUICK, "--out", str(out)) == 0
    with (out / "map.csv").open() as file:
        rows = list(csv.DictReader(file))
    measures = json.loads((out / "map.json").read_text())["measures"]
    assert len(rows) == measures["configurations"] == 4  # three steps bring nobody to the goal: nothing is refined
    assert [(float(row["angle_deg"]), float(row["length_m"])) for row in rows[:2]] == [(90.0, 1.0), (90.0, 3.0)]
    assert all(int(row["simulations"]) == 2 and row["successful"] == "0" for row in rows)
    assert {path.name for path in (out / "figures").iterdir()} == {"map.png", "surface.png"}
    assert "configurations" in capsys.readouterr().out


def test_a_schema_of_the_users_own_is_mapped_over_its_one_parameter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.py").write_text(OWN)
    out = tmp_path / "map"
    assert herd(monkeypatch, "map", str(tmp_path / "mine.py"), *QUICK, "--out", str(out)) == 0
    assert len((out / "map.csv").read_text().splitlines()) == 3


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["drit"], "dirt"),
        (["dirt", "--refined", "angel_deg"], "angle_deg"),
        (["dirt", "--grid", "3.5"], "whole numbers"),
        (["dirt", "--method", "random"], "budget"),
        (["splitting"], "no parameter that can be refined"),
        (["dirt", "--set", "world.anchor=9"], "1 to 4"),
        (["dirt", "--behaviour", "turn-left"], "turn-right"),
    ],
)
def test_what_cannot_be_mapped_is_refused_in_one_line(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert herd(monkeypatch, "map", *words, "--out", str(tmp_path / "map")) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not (tmp_path / "map").exists()


def test_a_folder_that_is_there_is_not_written_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert herd(monkeypatch, "map", "dirt", *QUICK, "--out", str(tmp_path)) == 2
    assert "expected a new one" in capsys.readouterr().err


LAW = '''
"""Goes on, but never returns in a step of a second with somebody near: the check of laws has steps of 0.1 s."""
import math
from typing import NamedTuple
from flocking.types import Kind, Motion

NEEDS = frozenset({"positions"})


class Parameters(NamedTuple):
    pass


def law(own, members, sets, obstacles, parameters, memory, u):
    turns = 0.0
    for j in range(len(members.positions)):
        while abs(members.positions[j, 0]) + abs(members.positions[j, 1]) < 0.6 and abs(own.dt - 1.0) < 1e-9:
            turns += 1e-300
    return Motion(Kind.VELOCITY, 0.1, turns, 0)
'''


def test_a_law_that_hangs_ends_the_map_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text(LAW)
    monkeypatch.setattr(mapping, "LAW_LIMIT_S", 2.0)
    words = ["--members", "5", "--set", "pairs=2", "--set", "iterations=100"]
    out = tmp_path / "map"
    assert (
        herd(monkeypatch, "map", "dirt", "--grid", "2", *words, "--law", str(tmp_path / "mine.py"), "--out", str(out))
        == 2
    )
    error = capsys.readouterr().err
    assert "mine.py" in error
    assert "a law did not return within 2 s of processor time" in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_ctrl_c_keeps_the_iterations_that_are_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    judge, calls = loop.judge, list[int]()

    def stopped_in_the_second(*given: Any) -> Any:
        calls.append(1)
        if len(calls) > 1:
            raise KeyboardInterrupt
        judged = judge(*given)
        return judged._replace(successes=judged.trials * (np.arange(len(judged.trials)) % 2))  # edges to refine

    monkeypatch.setattr(loop, "judge", stopped_in_the_second)
    out = tmp_path / "map"
    assert herd(monkeypatch, "map", "dirt", *QUICK, "--out", str(out)) == 130
    assert capsys.readouterr().err.splitlines()[-1].startswith("herd: stopped; the map has 4 configurations")
    assert json.loads((out / "map.json").read_text())["measures"]["configurations"] == 4
    assert (out / "figures" / "map.png").is_file()


def test_ctrl_c_in_the_first_iteration_keeps_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*given: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(loop, "judge", stopped)
    assert herd(monkeypatch, "map", "dirt", *QUICK, "--out", str(tmp_path / "map")) == 130
    assert not (tmp_path / "map").exists()


def test_an_unknown_schema_is_called_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert herd(monkeypatch, "map", "dirtt", "--out", str(tmp_path / "map")) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "unknown schema 'dirtt'" in line
    assert "dirt" in line.partition("dirtt")[2]
