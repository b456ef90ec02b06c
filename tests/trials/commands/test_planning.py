"""`herd plan`: a plan is found, a budget that is spent keeps what was found, and bad input is refused in one line."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from generation.piloting import plan as plans
from trials.commands import cli

SMALL = ["plan", "task-1", "--members", "1", "--starts", "3", "--set", "grid.lengths_m=[1.5, 2.12]"]
"""One member meets each wall once: seconds."""


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["herd", *words])
    return cli.main()


def test_a_plan_is_found_printed_and_kept_and_a_spent_budget_keeps_its_part_to_go_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "plan.json"
    assert run(monkeypatch, *SMALL, "--static", "--out", str(out), "--budget", "180") == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "no plan within 180 simulations" in said.err.splitlines()[-1]
    part = plans.read(out)
    assert part.static
    assert 0 < len(part.walls) < 3
    assert f"{len(part.walls)} walls are kept in {out}: the same command goes on" in said.err
    assert run(monkeypatch, *SMALL, "--static", "--out", str(out)) == 0
    whole, said = plans.read(out), capsys.readouterr()
    assert whole.walls[: len(part.walls)] == part.walls
    assert len(whole.walls) == 3
    assert f'piloting.walls="{plans.words(whole.walls)}"' in said.out
    assert "task-1: 3 standing walls" in said.out
    # a whole plan is not written over
    assert run(monkeypatch, *SMALL, "--static", "--out", str(out)) == 2
    assert "expected a new file, or a partial plan of task-1" in capsys.readouterr().err
    assert plans.read(out) == whole


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["plan", "task1"], ["task1", "task-1"]),
        (["plan", "mine.json"], ["mine.json"]),
        (["plan", "task-1", "--members", "0"], ["--members"]),
        (["plan", "task-1", "--share", "1.5"], ["--share 1.5", "at most 1"]),
        (["plan", "task-1", "--share", "0"], ["--share 0", "above 0"]),
        (["plan", "task-1", "--law", "reynolds"], ["reynolds"]),
        (["plan", "task-1", "--set", "grid.angle=15"], ["grid.angle", "grid.angle_step_deg"]),
        (["plan", "task-1", "--set", "grid.lengths_m=[]"], ["expected a length"]),
        (["plan", "task-1", "--set", "grid.lengths_m=2"], ["lengths in m as in [1.5, 2.12]"]),
        (["plan", "task-1", "--set", "grid.angle_step_deg=0"], ["degrees above 0"]),
        (["plan", "task-1", "--set", "law.separation=1"], ["separation"]),
    ],
)
def test_bad_input_is_refused_in_one_line(refused: Callable[..., str], words: list[str], expected: list[str]) -> None:
    told = refused(*words)
    assert all(part in told for part in expected), told


def test_a_file_that_is_no_plan_is_not_written_over(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert "is no plan" in refused("plan", "task-1", "--out", "mine.txt")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--set", "piloting.walls='27 315'"], ["'27 315'", "its anchor, its angle in degrees"]),
        (["--set", "piloting.walls='27 315 0.75'"], ["1 walls", "3 turns"]),
        (["--set", "pilots.count=5", "--set", "piloting.guides=pilots"], ["5 pilots", "expected a multiple"]),
    ],
)
def test_a_run_whose_guides_do_not_fit_is_refused_in_one_line(
    refused: Callable[..., str], words: list[str], expected: list[str]
) -> None:
    told = refused("run", "piloting", "--set", "task=task-1", *words, "--dry-run")
    assert all(part in told for part in expected), told
