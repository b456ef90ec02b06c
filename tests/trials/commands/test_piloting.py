"""`herd pilot`: a person at a terminal, here a pipe, says when a wall has been cleared."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest

from trials.commands import cli
from trials.commands.piloting import Watching

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


def test_after_the_last_wall_the_pace_is_kept_and_enter_ends_the_trial(capsys, monkeypatch) -> None:
    words = ["--times", "1", "--set", "duration_s=30", "--set", "piloting.at_once=2"]
    assert run(monkeypatch, b"\n" * 4, False, "piloting", "--trial", "1", *words) == 0
    told = capsys.readouterr().out
    assert "all walls are cleared: press Enter to end the trial" in told
    assert "wall 1" in told
    assert " 2 s" not in told  # of thirty
    watching, passed = Watching(10.0, "trial"), []
    monkeypatch.setattr(sys, "stdin", os.fdopen(os.pipe()[0]))
    for tick in (0.0, 1.0, 2.0):
        assert not watching(tick, 3, 0, 1, 4)
        passed.append(time.monotonic())
    assert passed[-1] - passed[0] >= 0.19
    assert "2 s  the goal: 1 in it, 4 on their course" in capsys.readouterr().out


def test_ctrl_c_ends_a_trial_and_what_was_recorded_until_then_is_kept(tmp_path, capsys, monkeypatch) -> None:
    def interrupting(self: Watching, moment: float) -> bool:
        if moment >= 1.0 and not self.is_interrupted:
            os.kill(os.getpid(), signal.SIGINT)
        return False

    monkeypatch.setattr(Watching, "_is_pressed", interrupting)
    out = tmp_path / "part.rrd"
    assert run(monkeypatch, b"", False, "piloting", "--trial", "1", *SHORT, "--out", str(out)) == 130
    assert out.stat().st_size > 1000
    assert f"recording   {out}" in capsys.readouterr().out


def test_nobody_is_told_to_press_enter_before_a_trial_is_refused(capsys, monkeypatch) -> None:
    assert run(monkeypatch, b"", True, "detection-case-study", "--trial", "1") == 2
    assert "press Enter" not in capsys.readouterr().out


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
