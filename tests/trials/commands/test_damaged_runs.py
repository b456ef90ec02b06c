"""Folders of runs that are damaged, newer, locked or another's: one line that says so, exit code 2, nothing changed."""

from __future__ import annotations

import json
import sqlite3
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from trials.batch import folders, runfile, store

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials

RUN = ["run", "detection-case-study"]


def make_run(folder: Path) -> None:
    trials = [fake_trials.trial(k) for k in (1, 2)]
    run = {
        "format": runfile.FORMAT,
        "experiment": "detection-case-study",
        "record": "none",
        "scans": "some",
        "trials": [trial.as_dict() for trial in trials],
    }
    kept = store.create(folder, run, {})
    kept.add(store.Row(1, "done", "", 1, 1, {}, {}), {})
    kept.close()


def test_a_folder_that_holds_another_run_stays_as_it_is(refused: Callable[..., str], tmp_path: Path) -> None:
    make_run(tmp_path / "out")
    line = refused(*RUN, "--repeats", "1", "--out", "out")
    assert "out holds a run" in line
    assert "herd resume out" in line


def test_a_locked_results_file_is_not_called_damaged(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_run(tmp_path / "run")
    connect = sqlite3.connect
    monkeypatch.setattr(sqlite3, "connect", lambda *given, **how: connect(*given, **{**how, "timeout": 0.0}))
    lock = connect(tmp_path / "run" / "results.sqlite", isolation_level=None)
    lock.execute("BEGIN EXCLUSIVE")
    line = refused("report", "run")
    lock.close()
    assert "another process has locked it" in line
    assert "damaged" not in line


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"seed": "1"}, "seed = '1'"),
        ({"groups": 3}, "not iterable"),
        ({"conditions": [1]}, "conditions = "),
        ({"setup": {"duration_s": [1.0]}}, "duration_s = "),
        ({"world": "\x1b[31mred"}, "control characters"),
    ],
)
def test_a_run_file_with_other_types_is_damaged(
    refused: Callable[..., str], tmp_path: Path, change: dict[str, Any], words: str
) -> None:
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    run = json.loads(path.read_text())
    run["trials"][0] |= change
    path.write_text(json.dumps(run))
    for command in ("report", "resume"):
        line = refused(command, "run")
        assert "run.json is damaged" in line
        assert words in line
        assert "\x1b" not in line


@pytest.mark.parametrize("change", [{"notes": 1}, {"notes": [1]}, {"conditions": [1]}, {"only": 5}, {"body": {}}])
def test_a_head_of_a_run_file_with_other_types_is_damaged(
    refused: Callable[..., str], tmp_path: Path, change: dict[str, Any]
) -> None:
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    for command in ("report", "resume"):
        assert "run.json is damaged" in refused(command, "run")


def test_a_users_file_that_is_not_what_the_trials_hold_is_not_run(refused: Callable[..., str], tmp_path: Path) -> None:
    """What resume says that it runs is what it runs."""
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    run = json.loads(path.read_text())
    run["trials"][0] |= {"world": "my_world.py", "world_source": "evil = 1"}
    path.write_text(json.dumps(run))
    (tmp_path / "run" / "code").mkdir()
    (tmp_path / "run" / "code" / "my_world.py").write_text("harmless = 1")
    assert "my_world.py is not the file" in refused("resume", "run")


def test_a_folder_that_cannot_be_made(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    assert "is a file" in refused(*RUN, "--out", "file")
    assert "file/out: Not a directory" in refused(*RUN, "--out", "file/out")
    (tmp_path / "runs").write_text("mine")
    assert "cannot write runs" in refused(*RUN)


def test_damaged_and_newer_results(refused: Callable[..., str], tmp_path: Path) -> None:
    for name in ("damaged", "newer", "empty", "json"):
        make_run(tmp_path / name)
    (tmp_path / "damaged" / "results.sqlite").write_bytes(b"nonsense" * 1000)
    (tmp_path / "empty" / "results.sqlite").write_bytes(b"")
    (tmp_path / "json" / "run.json").write_text("{")
    with sqlite3.connect(tmp_path / "newer" / "results.sqlite") as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    for command in ("resume", "report"):
        assert "run.json is damaged" in refused(command, "json")
        assert "damaged" in refused(command, "damaged")
        assert "not the results of a run" in refused(command, "empty")
        assert "format 99" in refused(command, "newer")


def test_a_trial_that_was_not_recorded_cannot_be_played(refused: Callable[..., str], tmp_path: Path) -> None:
    make_run(tmp_path / "run")
    assert "no trial of run was recorded" in refused("play", "run")
    assert "no trial of run was recorded" in refused("play", "run", "--trial", "1")
    (tmp_path / "run" / "recordings" / "0002.rrd").write_bytes(b"")
    (tmp_path / "run" / "recordings" / "².rrd").write_bytes(b"")  # a digit to Python, and no trial's
    assert "trial 9" in refused("play", "run", "--trial", "9")


def test_a_run_that_another_process_is_at_is_left_alone(refused: Callable[..., str], tmp_path: Path) -> None:
    make_run(tmp_path / "run")
    with folders.alone(tmp_path / "run"):
        assert "another process" in refused("resume", "run")
