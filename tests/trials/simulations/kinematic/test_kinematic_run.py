"""A kinematic experiment by the `herd` command: run, report, resume, its recording, and one line for an error."""

from __future__ import annotations

import json
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from flocking.errors import InputError
from trials.commands import cli
from trials.design import plan

WORDS = ["lch-table-4-1", "--repeats", "2", "--only", "1,9,17,25", "--set", "steps=20"]
"""The trials of the first variation from both starts, two repeats."""


def herd(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "trials.commands.cli", *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=300,
    )


def table(folder: Path) -> list[tuple[object, ...]]:
    with sqlite3.connect(folder / "results.sqlite") as connection:
        return connection.execute("SELECT * FROM trials").fetchall()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    home = tmp_path_factory.mktemp("home")
    done = herd("run", *WORDS, "--jobs", "2", "--out", "run", cwd=home)
    assert done.returncode == 0, done.stderr
    assert "4 trials: 4 done, 0 failed" in done.stdout
    return home / "run"


def test_a_run_keeps_rows_series_report_and_the_first_recording(run: Path) -> None:
    assert [row[:2] for row in table(run)] == [(1, "done"), (9, "done"), (17, "done"), (25, "done")]
    assert len(list((run / "series").iterdir())) == 4
    assert [path.name for path in (run / "recordings").iterdir()] == ["0001.rrd"]
    page = (run / "report.html").read_text()
    assert "median distance from the herd&#x27;s centre" in page
    assert "Ways" in page
    assert "acts_as_snn" not in page


def test_the_report_is_a_list_of_claims(run: Path) -> None:
    told = json.loads(herd("report", "run", "--json", cwd=run.parent).stdout)
    assert len(told) == 9
    decided = {entry["claim"]: entry["n"] for entry in told}
    assert decided["MMD of group-pose from a single-group start, range 3: 0.05"] == 2
    assert sum(n > 0 for n in decided.values()) == 2  # the other cells are not in this run


def test_a_resumed_run_equals_an_unbroken_one(run: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(run, broken)
    with sqlite3.connect(broken / "results.sqlite") as connection:
        connection.execute("DELETE FROM trials WHERE idx IN (1, 17)")
    connection.close()
    for index in ("0001", "0017"):
        (broken / "series" / f"{index}.npz").unlink()
    done = herd("resume", "broken", "--jobs", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2 of them now" in done.stdout
    assert table(broken) == table(run)
    for path in (run / "series").iterdir():
        assert (broken / "series" / path.name).read_bytes() == path.read_bytes()


def test_show_lists_every_parameter_with_unit_and_source(tmp_path: Path) -> None:
    shown = herd("show", "lch-table-4-1", "--set", "herd.law.st_m=1", "--set", "steps=10", cwd=tmp_path)
    lines = {line.split()[0]: line for line in shown.stdout.splitlines() if line.strip()}
    assert "set here in place of 75" in lines["steps"]
    assert "HERD in its file" in lines["timestep_s"]
    assert "published" in lines["herd.count"]


def test_a_setting_reaches_the_cells_that_have_a_place_for_it() -> None:
    made = plan("lch-table-4-1", settings={"formation.gap_m": 8.0, "herd.law.st_m": 1.0})
    for trial in made.trials:
        split, threshold = trial.formation == "split-group", trial.groups[0].law == "lch-group-pose"
        assert trial.formation_parameters == ({"gap_m": 8.0} if split else {})
        assert trial.groups[0].law_parameters == ({"st_m": 1.0} if threshold else {})
    assert made.notes == [
        f"{key} is left out where there is no such parameter" for key in ("formation.gap_m", "herd.law.st_m")
    ]
    with pytest.raises(InputError, match=r"herd\.law\.range_m"):
        plan("lch-table-4-1", settings={"herd.law.range_m": 8.0})


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["world", "lch-table-4-1", "--out", "w.xml"], ["lch-table-4-1", "kinematic", "herd play"]),
        (["run", "vicsek-transition", "--body", "create"], ["--body create", "no bodies"]),
        (["run", "vicsek-transition", "--pipeline", "perfect-members"], ["perfect-members", "member-based"]),
        (["run", "vicsek-transition", "--set", "herd.information=bearings"], ["vicsek", "headings"]),
        (["run", "vicsek-transition", "--set", "world.size_m=0"], ["world.size_m", "from 1e-06"]),
        (["run", "vicsek-transition", "--law", "vicseck"], ["vicseck", "did you mean vicsek"]),
        (["run", "couzin-leaders", "--set", "herd.selection=voronoy"], ["voronoy", "voronoi"]),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    expected: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["herd", *words])
    assert cli.main() == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    for word in expected:
        assert word in said
    assert list(tmp_path.iterdir()) == []


def test_a_worker_needs_neither_mujoco_nor_rerun(tmp_path: Path) -> None:
    code = (
        "import sys; from trials.batch import folders, worker; from trials.design import plan;"
        "worker.import_for(['kinematic']);"
        "trial = plan('lch-table-4-1', settings={'steps': 2}).trials[0];"
        "output = worker.run_and_write(trial.as_dict(), 'some', folders.NO_FILES);"
        "print(output.status, sorted({'mujoco', 'rerun', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout == "done []\n", done.stderr
