"""`herd pilot`: a person at a terminal, here a pipe, says when a wall has been cleared."""

from __future__ import annotations

import os
import sys

import pytest

from trials.commands import cli

SHORT = ["--times", "1e6", "--set", "duration_s=3", "--set", "piloting.at_once=2"]


def run(monkeypatch: pytest.MonkeyPatch, typed: bytes, ended: bool, *words: str) -> int:
    read, write = os.pipe()
    os.write(write, typed)
    if ended:
        os.close(write)
    monkeypatch.setattr(sys, "argv", ["herd", "pilot", *words])
    with os.fdopen(read) as keys:
        monkeypatch.setattr(sys, "stdin", keys)
        code = cli.main()
    if not ended:
        os.close(write)
    return code


def test_enter_clears_a_wall(capsys, monkeypatch) -> None:
    assert run(monkeypatch, b"\n", False, "piloting", "--trial", "1", *SHORT) == 0
    told = capsys.readouterr().out
    assert "press Enter once the herd has cleared a wall" in told
    assert "wall 2: 0 past it, 4 on their course" in told
    assert "0.00 of the robots arrived" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["piloting", "--trial", "1", *SHORT], "standard input has ended"),
        (["piloting", "--trial", "999"], "has trials 1 to 80"),
        (["detection-case-study", "--trial", "1"], "has no task; expected one whose herd is guided, as piloting"),
        (["hamilton-1971", "--trial", "1"], "has no task; expected one whose herd is guided, as piloting"),
        (["piloting", "--times", "0"], "expected a number above 0"),
        (["piloting", "--trial", "1", *SHORT, "--out", "missing/a.rrd"], "in a folder that exists"),
        (["piloting", "--trial", "1", *SHORT, "--out", "a.txt"], "a name that ends in .rrd"),
    ],
)
def test_what_cannot_be_watched_is_refused_in_one_line(words: list[str], told: str, capsys, monkeypatch) -> None:
    assert run(monkeypatch, b"", True, *words) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
