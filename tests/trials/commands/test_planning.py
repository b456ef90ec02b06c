"""`herd plan`: plans, partial plans that are gone on with, and what is refused in one line."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

from generation.piloting import plan as plans
from generation.piloting import planner
from trials.commands import cli

SMALL = ["--starts", "2", "--set", "grid.angle_step_deg=30", "--set", "grid.lengths_m=[1.5, 2.12]"]


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["herd", "plan", *words])
    return cli.main()


def test_a_plan_is_written_and_told(tmp_path: Path, capsys, monkeypatch) -> None:
    out = tmp_path / "plan.json"
    assert run(monkeypatch, "task-4", *SMALL, "--out", str(out)) == 0
    told = capsys.readouterr().out
    found = plans.read(out)
    assert len(found.walls) == 3
    assert plans.words(found.walls) in told
    assert "of 50 new herds" in told
    written = json.loads(out.read_text())
    judged, by = written["judged"], written["found"]
    assert judged["herds"] == 50
    assert 0.0 <= judged["low"] < judged["share"] <= judged["high"] <= 1.0
    assert found.judged == tuple(judged.values())
    assert by["grid"] == {**planner.Grid()._asdict(), "angle_step_deg": 30.0, "lengths_m": [1.5, 2.12]}
    assert (by["starts"], by["seed"], by["search"]["whole"], by["search"]["herds"]) == (2, 1, 0.9, 50)
    assert by["settings"] == {"law.separation_m": 0.6}
    assert run(monkeypatch, "task-4", *SMALL, "--out", str(out)) == 2  # it is whole
    assert "expected a new file" in capsys.readouterr().err


def test_a_partial_plan_is_kept_and_gone_on_with(tmp_path: Path, capsys, monkeypatch) -> None:
    out = tmp_path / "plan.json"
    assert run(monkeypatch, "task-4", *SMALL, "--budget", "120", "--out", str(out)) == 2
    told = capsys.readouterr().err
    assert "no plan within 120 simulations" in told
    assert "with a larger --budget goes on" in told
    partial = plans.read(out)
    assert 0 < len(partial.walls) < 3
    assert run(monkeypatch, "task-4", *SMALL, "--out", str(out)) == 0
    assert plans.read(out).walls[: len(partial.walls)] == partial.walls


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--starts", "3"], "its walls were found with starts 2, not 3; expected the same, or a new file"),
        (["--starts", "2", "--seed", "4"], "its walls were found with seed 1, not 4"),
        (["--starts", "2", "--set", "law.separation_m=0.5"], "its walls were found with settings"),
    ],
)
def test_a_partial_plan_that_was_found_otherwise_is_refused(
    words: list[str], told: str, tmp_path: Path, capsys, monkeypatch
) -> None:
    out = tmp_path / "plan.json"
    found = {"law": "reynolds-boids", "starts": 2, "seed": 1, "settings": {"law.separation_m": 0.6}}
    part = plans.Plan("task-4", False, (plans.Wall(19, 60.0, 2.12),), (1.0,))
    out.write_text(plans.to_json(part, found))
    assert run(monkeypatch, "task-4", *words, "--out", str(out)) == 2
    assert told in capsys.readouterr().err
    assert plans.read(out) == part


def test_a_place_that_cannot_take_a_plan_is_refused_before_the_search(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.setattr(planner, "search", lambda *given: pytest.fail("it searched"))
    for out in (tmp_path / "missing" / "plan.json", tmp_path):
        assert run(monkeypatch, "task-4", "--out", str(out)) == 2
        error = capsys.readouterr().err
        assert "expected the name of a file, in a folder that exists and can be written" in error
        assert error.count("\n") == 1


def test_ctrl_c_keeps_the_walls_that_were_found(tmp_path: Path, capsys, monkeypatch) -> None:
    def interrupted(*given: object) -> None:
        progress = next(each for each in given if isinstance(each, planner.Progress))
        progress.best = plans.Plan("task-4", False, (plans.Wall(19, 60.0, 2.12),), (1.0,))
        raise KeyboardInterrupt

    monkeypatch.setattr(planner, "search", interrupted)
    out = tmp_path / "plan.json"
    assert run(monkeypatch, "task-4", "--out", str(out)) == 130
    assert f"1 walls are kept in {out}: the same command goes on from them" in capsys.readouterr().err
    assert len(plans.read(out).walls) == 1


def test_ctrl_c_before_a_wall_was_found_says_so(tmp_path: Path, capsys, monkeypatch) -> None:
    def interrupted(*given: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(planner, "search", interrupted)
    out = tmp_path / "plan.json"
    assert run(monkeypatch, "task-4", "--out", str(out)) == 130
    assert "no wall was found yet" in capsys.readouterr().err
    assert not out.exists()


def test_no_set_of_standing_walls_of_a_grid_solves_the_third_task(capsys, monkeypatch) -> None:
    words = ["task-3", "--exhaust", "--starts", "3", "--set", "grid.angle_step_deg=90", "--set", "grid.lengths_m=[1.5]"]
    assert run(monkeypatch, *words) == 0
    found = re.search(r"the best set guides (\S+) of the members", capsys.readouterr().out)
    assert found is not None
    assert float(found[1]) < 0.9  # which a whole plan has to guide; one of three herds passes a crossing by chance


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["task-9"], "did you mean task-"),
        (["task-1", "--share", "2"], "expected a share above 0 and at most 1"),
        (["task-1", "--set", "grid.angle=3"], "did you mean grid.angle_step_deg"),
        (["task-1", "--set", "grid.lengths_m=[]"], "expected lengths above 0"),
        (["task-1", "--law", "boids"], "boids"),
        (["task-1", "--body", "creat"], "create"),
        (["task-1", "--exhaust", "--body", "create"], "--body create with --exhaust"),
        (["task-3", "--exhaust", "--budget", "10"], "take more than 10 simulations"),
        (["task-1", "--set", "grid.angle_step_deg=0.0001"], "an angle of at least 0.5"),
        (["missing.json"], "missing.json"),
    ],
)
def test_bad_input_is_one_line(words: list[str], told: str, capsys, monkeypatch) -> None:
    assert run(monkeypatch, *words) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
