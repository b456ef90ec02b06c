"""`herd sensitivity` in a process of its own: its table, going on, and what it refuses."""

from __future__ import annotations

import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from trials.commands import cli
from trials.sensitivity import study

ASKED = ["lch-field-of-view", "--repeats", "3", "--keys", "herd.law.step_m", "--budget", "66"]


def herd(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "trials.commands.cli", *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=600,
    )


def table(printed: str) -> str:
    return re.sub(r"results .*\n", "", printed)


def test_the_table_is_the_same_whatever_the_number_of_jobs_and_after_a_stop(tmp_path: Path) -> None:
    one = herd("sensitivity", *ASKED, "--jobs", "1", "--out", "one", cwd=tmp_path)
    assert one.returncode == 0, one.stderr
    assert "herd.law.step_m" in one.stdout
    assert "trajectories" in one.stdout
    assert (tmp_path / "one" / "table.txt").read_text() == table(one.stdout)
    words = [sys.executable, "-m", "trials.commands.cli", "sensitivity", *ASKED, "--jobs", "2", "--out", "two"]
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        while process.poll() is None and ended(tmp_path / "two") < 10:
            time.sleep(0.05)
        if process.poll() is None:
            os.kill(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=600)
    if process.returncode:  # else it was too quick to be stopped
        assert process.returncode == 130, told
        assert "go on with" in told
        assert ended(tmp_path / "two") >= 10
    two = herd("sensitivity", *ASKED, "--jobs", "2", "--out", "two", cwd=tmp_path)
    assert two.returncode == 0, two.stderr
    assert table(two.stdout) == table(one.stdout)
    other = herd("sensitivity", *ASKED, "--seed", "2", "--out", "two", cwd=tmp_path)
    assert other.returncode == 2
    assert "was begun with seed 1, not 2" in other.stderr


def test_a_budget_that_one_screening_exceeds_is_refused_before_the_experiments_own_values_are_run(
    tmp_path: Path,
) -> None:
    refused = herd("sensitivity", *ASKED[:-1], "40", "--out", "small", cwd=tmp_path)
    assert refused.returncode == 2
    assert "one screening of 1 choice takes at least" in refused.stderr
    with sqlite3.connect(tmp_path / "small" / "sensitivity.sqlite") as connection:
        stages = {stage for (stage,) in connection.execute("SELECT DISTINCT stage FROM trials")}
    assert stages == {study.PROBE}  # which tells what cells the claims read


def ended(folder: Path) -> int:
    """Trials that are kept."""
    if not (folder / "sensitivity.sqlite").exists():
        return 0
    try:
        with sqlite3.connect(f"file:{folder / 'sensitivity.sqlite'}?mode=ro", uri=True) as connection:
            return int(connection.execute("SELECT count(*) FROM trials").fetchone()[0])
    except sqlite3.OperationalError:  # it is being made
        return 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["link-tension-beyond"], "has no claims; expected one of"),
        (["lch-table-4-1", "--claim", "40"], "has claims 1 to 9; nearest: 9"),
        (["lch-table-4-1", "--budget", "0"], "expected a time above 0 or a number of trials, as in 10m"),
        (["lch-table-4-1", "--budget", "0m"], "expected a time above 0"),
        (["lch-table-4-1", "--budget", "soon"], "expected a time above 0"),
        (["lch-table-4-1", "--budget", "20"], "takes at least"),
        (["lch-table-4-1", "--keys", "herd.law.step"], "did you mean herd.law.step_m"),
        (["lch-table-4"], "did you mean lch-table-4-1"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    words: list[str],
    told: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["herd", "sensitivity", *words])
    assert cli.main() == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())
