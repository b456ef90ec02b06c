"""`herd run --until-decided`: what it writes before the first trial, kill and resume, and what it refuses."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from flocking.errors import InputError
from trials.batch import runfile, running
from trials.batch.deciding import Budget, budget
from trials.design import plan
from trials.reports.report import report

HERD = (sys.executable, "-m", "trials.commands.cli")
SHORT = ("lch-table-4-1", "--until-decided", "--repeats", "3", "--budget", "12", "--record", "none")


def herd(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*HERD, *words], cwd=cwd, capture_output=True, text=True)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("until")
    done = herd("run", *SHORT, "--jobs", "2", "--out", "run", cwd=place)
    assert done.returncode == 0, done.stderr
    (place / "told").write_text(done.stdout)
    return place / "run"


def entries(folder: Path) -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads(report(folder, as_json=True))
    return found


def test_the_plan_is_laid_down_and_kept_to(run: Path) -> None:
    plan = json.loads((run / "run.json").read_text())["until_decided"]
    assert plan["looks"] == [3, 6, 9, 12]
    assert plan["levels"]["two-sided"] < 0.025
    assert [claim["by repeats"] for claim in plan["claims"]] == [True] * 9
    assert plan["claims"][0]["outcomes"][0]["margin"] == 0.005
    found = entries(run)
    assert any(entry["agrees"] is not None for entry in found)
    for entry in found:
        assert entry["agrees"] is not None or entry["n"] == 12
        numbers = [look["n"] for look in entry["looks"]]  # type: ignore[attr-defined]
        assert numbers == plan["looks"][: len(numbers)]
        assert entry["n"] == numbers[-1]
    assert len({entry["n"] for entry in found}) > 1  # decided ones did not wait for the others


def test_the_report_tells_of_the_looks(run: Path) -> None:
    told = (run.parent / "told").read_text()
    assert "of 9 claims decided" in " ".join(told.split())
    page = (run / "report.html").read_text()
    assert "at each look at the growing run" in page
    assert "decided at look 1 of 4" in page


def test_a_killed_run_with_other_workers_comes_to_the_same(run: Path) -> None:
    """Killed once its first rows are there, and resumed."""
    process = subprocess.Popen(
        [*HERD, "run", *SHORT, "--jobs", "1", "--out", "killed"],
        cwd=run.parent,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    killed = run.parent / "killed"
    while not list(killed.glob("series/*.npz")) and process.poll() is None:
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    again = herd("resume", "killed", "--jobs", "2", cwd=run.parent)
    assert again.returncode == 0, again.stderr
    assert entries(killed) == entries(run)


def test_a_trial_whose_worker_died_is_run_again_before_any_look_counts_it(run: Path, tmp_path: Path) -> None:
    """Wherever it is in the run: what resume comes to is what the run came to."""
    shutil.copytree(run, tmp_path / "run")
    with sqlite3.connect(tmp_path / "run" / "results.sqlite") as connection:
        last = connection.execute("SELECT max(idx) FROM trials").fetchone()[0]
        connection.execute(
            "UPDATE trials SET status = 'failed', measures = '{}', reason = 'its worker process died (SIGKILL)' "
            "WHERE idx IN (2, 9, ?)",
            (last,),
        )
    connection.close()
    assert entries(tmp_path / "run") != entries(run)
    again = herd("resume", "run", "--jobs", "1", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert entries(tmp_path / "run") == entries(run)


def test_the_command_of_a_failed_trial_plans_the_same_trial(run: Path) -> None:
    told = json.loads((run / "run.json").read_text())
    words = shlex.split(running.again_of(told))
    assert words[-2:] == ["--repeats", "12"]
    assert "--until-decided" not in words
    assert "--budget" not in words
    trials = plan("lch-table-4-1", repeats=12).trials
    assert json.loads(json.dumps([trial.as_dict() for trial in trials])) == told["trials"]


def test_levels_that_are_not_those_of_the_looks_are_told(run: Path, tmp_path: Path) -> None:
    shutil.copytree(run, tmp_path / "run")
    told = json.loads((run / "run.json").read_text())
    told["until_decided"]["looks"] = [6, 12]
    (tmp_path / "run" / "run.json").write_text(json.dumps(told))
    assert "its levels are not those of its looks" in " ".join(report(tmp_path / "run").split())


def test_budgets() -> None:
    assert budget("10m") == Budget(seconds=600.0)
    assert budget("90 s") == Budget(seconds=90.0)
    assert budget("1.5h") == budget("90min") == Budget(seconds=5400.0)
    assert budget("40") == budget("40 repeats") == Budget(repeats=40)
    assert [str(budget(text)) for text in ("40", "10m")] == ["40", "600s"]
    assert budget(str(budget("10m"))) == budget("10m")
    for text in ("-5", "1.5", "3 trials", "10x", ""):
        with pytest.raises(InputError):
            budget(text)


@pytest.mark.parametrize(
    "change",
    [
        {"looks": [3, 3]},
        {"looks": [3, 6]},
        {"looks": []},
        {"looks": "3"},
        {"seconds": "x"},
        {"levels": {}},
        {"claims": [1]},
    ],
)
def test_a_damaged_plan_is_told_in_one_line(run: Path, change: dict[str, object], tmp_path: Path) -> None:
    told = json.loads((run / "run.json").read_text())
    told["until_decided"] |= change
    (tmp_path / "run.json").write_text(json.dumps(told))
    with pytest.raises(InputError, match=r"run\.json is damaged") as caught:
        runfile.read(tmp_path)
    assert "\n" not in str(caught.value)
