"""The `herd` command, in a process of its own where that matters: what it runs, keeps and prints; its exit codes."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import pytest

from tests.trials.commands.own_laws import LAW_HEAD
from trials.batch import runfile
from trials.commands import cli, options
from trials.invoked import command, spelled

SHORT = ["detection-case-study", "--repeats", "1", "--only", "1,4,7", "--set", "duration_s=1"]
"""Options: one trial of each detection, a second each."""

COMMAND = f"{sys.executable} -m trials.commands.cli"
"""As it was called, and so as it is printed."""
LAW = LAW_HEAD + "    return Motion(Kind.VELOCITY, math.nan if own.id == 2 else 0.1, 0.0, 0)\n"
"""Straight on; the third member returns nan."""


def herd(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "trials.commands.cli", *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=300,
    )


def keep_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the command sets for the processes that it starts is undone after the test.

    `os.environ` itself stays: Rich keeps the one that it meets when it is imported.
    """
    for name in ("PYTHONSAFEPATH", "PYTHONPATH"):
        monkeypatch.setenv(name, os.environ.get(name, ""))


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """The command in the tests' own process: its exit code, what it prints, and its errors."""

    def called(*words: str, cwd: Path) -> tuple[int, str, str]:
        monkeypatch.chdir(cwd)
        keep_environment(monkeypatch)
        monkeypatch.setattr(sys, "argv", ["herd", *words])
        code = cli.main()
        return code, *capsys.readouterr()

    return called


def table(folder: Path) -> list[tuple[object, ...]]:
    with sqlite3.connect(folder / "results.sqlite") as connection:
        return connection.execute("SELECT * FROM trials").fetchall()


def series(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "series").iterdir()}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a finished run with two workers, the first trial recorded."""
    home = tmp_path_factory.mktemp("home")
    done = herd("run", *SHORT, "--jobs", "2", "--record", "first", cwd=home)
    assert done.returncode == 0, done.stderr
    folder = Path("runs/detection-case-study/001")
    assert "3 trials: 3 done, 0 failed" in done.stdout
    assert f"{COMMAND} play {folder} --trial 1" in done.stdout
    assert f"{folder}/report.html" in done.stdout
    assert "3 of 3 trials" in done.stderr
    return home / folder


def test_a_run_leaves_all_that_is_needed_to_run_it_again(run: Path) -> None:
    kept = json.loads((run / "run.json").read_text())
    assert kept["command"] == "herd run detection-case-study --repeats 1 --set duration_s=1"
    assert [trial["index"] for trial in kept["trials"]] == [1, 4, 7]
    assert kept["versions"]["mujoco"]
    assert kept["cpu"]
    assert kept["seed"] == 1
    assert [row[0] for row in table(run)] == [1, 4, 7]
    assert sorted(series(run)) == ["0001.npz", "0004.npz", "0007.npz"]
    assert [path.name for path in (run / "recordings").iterdir()] == ["0001.rrd"]
    assert (run / "report.html").is_file()
    with sqlite3.connect(run / "results.sqlite") as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (runfile.FORMAT,)
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("delete",)
        assert connection.execute("SELECT count(*) FROM timing").fetchone() == (3,)


def test_a_resumed_run_equals_an_unbroken_one_with_another_number_of_workers(run: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(run, broken)
    with sqlite3.connect(broken / "results.sqlite") as connection:  # as after a process killed at the second trial
        connection.execute("DELETE FROM trials WHERE idx IN (1, 7)")
        connection.execute("DELETE FROM timing WHERE idx IN (1, 7)")
    connection.close()
    (broken / "series" / "0001.npz").unlink()
    (broken / "series" / "0007.npz").write_bytes(b"of a trial that had no row yet")
    (broken / "recordings" / "0001.rrd").unlink()
    done = herd("resume", "broken", "--jobs", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2 of them now" in done.stdout
    assert table(broken) == table(run)
    assert series(broken) == series(run)
    assert [path.name for path in (broken / "recordings").iterdir()] == ["0001.rrd"]


def test_resume_of_a_finished_run_changes_nothing(run: Path, here: Callable[..., tuple[int, str, str]]) -> None:
    before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file() and "report" not in path.name}
    code, _, err = here("resume", cwd=run.parents[2])  # the newest
    assert code == 0, err
    after = {path: path.read_bytes() for path in before}
    assert after == before


def test_a_law_that_fails_in_the_herd_fails_its_trial_and_the_batch_goes_on(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(LAW)
    words = ["detection-case-study", "--repeats", "1", "--law", "mine.py", "--set", "duration_s=1"]
    done = herd("run", *words, "--out", "out", "--record", "none", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    rows = table(tmp_path / "out")
    assert len(rows) == 3  # the law has no exclusion distance: one cell a detection
    assert {row[1] for row in rows} == {"failed"}
    assert all("herd-3" in str(row[2]) and "nan" in str(row[2]) for row in rows)
    assert all(row[3] == 1 for row in rows)
    assert "trial 1 failed (seed 1, repeat 1)" in done.stdout
    assert "--only 1 --debug" in done.stdout
    assert (tmp_path / "out" / "code" / "mine.py").read_text() == LAW
    again = herd("run", *words, "--only", "1", "--debug", cwd=tmp_path)
    assert again.returncode == 1
    assert "Traceback (most recent call last)" in again.stderr
    assert "LawError" in again.stderr
    assert "Traceback" not in done.stderr


def test_only_workers_execute_a_users_law(tmp_path: Path, here: Callable[..., tuple[int, str, str]]) -> None:
    """The law notes who executes it: the check and workers, never the command nor its report; resume names it."""
    noted = tmp_path / "noted"
    (tmp_path / "mine.py").write_text(
        "import multiprocessing\nimport sys\n"
        "who = 'worker' if multiprocessing.parent_process() else sys.argv[0]\n"
        f"with open({str(noted)!r}, 'a') as file:\n    print(who, file=file)\n"
        + LAW.replace("math.nan if own.id == 2 else 0.1", "0.1")
    )
    done = herd("run", *SHORT, "--law", "mine.py", "--record", "none", "--only", "1", "--jobs", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "runs/detection-case-study/001"
    executed = set(noted.read_text().split("\n")[:-1])
    assert "worker" in executed
    assert all(who.endswith("lawcheck.py") for who in executed - {"worker"})
    noted.unlink()
    assert here("report", str(folder), cwd=tmp_path)[0] == 0
    assert not noted.exists()
    with sqlite3.connect(folder / "results.sqlite") as connection:
        connection.execute("DELETE FROM trials")
    connection.close()
    code, _, err = here("resume", str(folder), cwd=tmp_path)
    assert code == 0, err
    assert f"note: runs the user's {folder / 'code' / 'mine.py'}" in err
    assert set(noted.read_text().split("\n")[:-1]) == {"worker"}


def test_ctrl_c_keeps_what_has_ended_and_says_how_to_go_on(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "trials.commands.cli",
            "run",
            "detection-case-study",
            "--out",
            "my run",
            "--record",
            "none",
        ],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120
    while not list(tmp_path.glob("my run/series/*.npz")):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in err
    kept = len(table(tmp_path / "my run"))
    assert 0 < kept < 63
    assert err.endswith(
        f"herd: stopped; {kept} of 63 trials are kept in my run; finish it with: {COMMAND} resume 'my run'\n"
    )


def test_a_dry_run_shows_what_would_run_and_writes_nothing(
    tmp_path: Path, here: Callable[..., tuple[int, str, str]]
) -> None:
    code, out, err = here("run", *SHORT, "--sweep", "herd.speed_m_s=0.1,0.2", "--dry-run", cwd=tmp_path)
    assert code == 0, err
    for told in ("3 of 18 trials", "herd.law.repulsion_m", "chosen", "published"):
        assert told in out
    assert list(tmp_path.iterdir()) == []


def test_the_world_is_written_for_any_viewer(tmp_path: Path, here: Callable[..., tuple[int, str, str]]) -> None:
    import mujoco

    code, _, err = here("world", "detection-case-study", "--out", "world.xml", cwd=tmp_path)
    assert code == 0, err
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "world.xml"))
    assert [model.body(f"herd-{k}/base").id > 0 for k in range(1, 7)] == [True] * 6


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    heavy = {"numpy", "numba", "mujoco", "rerun", "scipy", "matplotlib", "psutil", "rich", "multiprocessing"}
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; sys.argv = ['herd', '--help']; from trials.commands.cli import main; code = main();"
            f"print(sorted({heavy!r} & set(sys.modules)), code)",
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.stdout.splitlines()[-1] == "[] 0"


def test_what_plans_and_runs_does_not_wait_for_what_judges(tmp_path: Path) -> None:
    code = "import sys, trials.batch.running, trials.commands.lawcheck; print('scipy.stats' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout == "False\n"


def test_the_version_is_told(tmp_path: Path) -> None:
    done = herd("--version", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stdout.startswith(f"herd {metadata.version('create-herd')} (Python 3.")


def test_ctrl_c_during_a_report_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr("trials.reports.report.report", interrupted)
    keep_environment(monkeypatch)
    monkeypatch.setattr(sys, "argv", ["herd", "report", str(tmp_path / "my run")])
    assert cli.main() == 130
    again = command("report", str(tmp_path / "my run"))
    told = f"herd: stopped; the report of {tmp_path / 'my run'} is not complete; make it with: {again}\n"
    assert capsys.readouterr().err.endswith(told)


def test_a_printed_command_is_found_where_it_is_typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By its name where the shell finds this very program, else by its path, or as a module of this Python."""
    program = tmp_path / "my tools" / "herd"
    program.parent.mkdir()
    program.touch(mode=0o755)
    monkeypatch.setattr(sys, "argv", [str(program)])
    monkeypatch.setenv("PATH", str(program.parent))
    assert command("play", "my run") == "herd play 'my run'"
    monkeypatch.setenv("PATH", str(tmp_path))
    assert command("play") == f"'{program}' play"
    other = tmp_path / "herd"
    other.touch(mode=0o755)  # another program of that name comes first
    assert command("play") == f"'{program}' play"
    monkeypatch.setattr(sys, "argv", ["/anywhere/trials/commands/cli.py"])
    assert command("play") == f"{sys.executable} -m trials.commands.cli play"


@pytest.mark.parametrize("value", [True, 3, 0.25, "snn", "nearest & all", "distance-based(0, 3)", "true", 'a "b" c'])
def test_a_printed_value_is_read_as_it_was(value: object) -> None:
    assert options.settings([f"herd.x={spelled(value)}"]) == {"herd.x": value}
    assert options.sweeps([f"herd.x={spelled(value)},{spelled('vicsek')}"]) == {"herd.x": [value, "vicsek"]}


def test_a_sweep_over_selections_needs_no_quotes() -> None:
    swept = options.sweeps(["herd.selection=distance-based(0, 3),all,field-of-view(240) & nearest"])
    assert swept == {"herd.selection": ["distance-based(0, 3)", "all", "field-of-view(240) & nearest"]}


def test_a_reader_that_has_had_enough_is_no_error(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "trials.commands.cli", "show", "detection-case-study"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=tmp_path,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    process.wait(timeout=60)
