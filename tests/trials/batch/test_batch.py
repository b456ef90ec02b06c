"""Batches: a trial that fails leaves the others as they are, and the number of workers changes no result."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from flocking.errors import InputError, StorageError
from trials.batch import runfile, store
from trials.batch.batch import Summary, Work, ordered, run_batch
from trials.batch.crew import Task, following
from trials.batch.store import Row, Store
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials  # by a name that worker processes can import too


class Silent:
    """Progress that only counts."""

    def __init__(self) -> None:
        self.rows: list[Row] = []

    def say(self, text: str) -> None: ...

    def ended(self, row: Row) -> None:
        self.rows.append(row)


def new_store(folder: Path, trials: Sequence[Trial]) -> Store:
    run = {"format": runfile.FORMAT, "experiment": "fake", "trials": [trial.as_dict() for trial in trials]}
    return store.create(folder, run, {})


def batch(folder: Path, trials: Sequence[Trial], jobs: int = 2, **how: Any) -> tuple[Summary, list[Row]]:
    kept = new_store(folder, trials)
    summary = run_batch(trials, kept, Silent(), jobs=jobs, work=Work(run=fake_trials.run, **how))
    rows = kept.rows()
    kept.close()
    return summary, rows


def table(folder: Path) -> list[tuple[object, ...]]:
    with sqlite3.connect(folder / "results.sqlite") as connection:
        return connection.execute("SELECT * FROM trials").fetchall()


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "series").iterdir())}


def test_all_trials_are_kept_and_equal_for_any_number_of_workers(tmp_path: Path) -> None:
    # Later trials end sooner, so that with four workers they end out of order.
    trials = [fake_trials.trial(k, seconds=0.02 * (9 - k)) for k in range(1, 9)]
    one, _ = batch(tmp_path / "one", trials, jobs=1)
    four, _ = batch(tmp_path / "four", trials, jobs=4)
    assert len(one.rows) == len(four.rows) == 8
    assert [row.index for row in one.rows] == list(range(1, 9))
    assert table(tmp_path / "one") == table(tmp_path / "four")
    assert files(tmp_path / "one") == files(tmp_path / "four")


def task(key: int, limit_s: float = 1.0, shares: str | None = None) -> Task:
    return Task(key, print, (), limit_s, shares)


@pytest.mark.parametrize(
    ("limits", "jobs", "order"),
    [
        ([1, 1, 1, 1, 1], 2, [1, 2, 3, 4, 5]),
        ([1, 1, 1, 3, 7], 2, [5, 1, 2, 3, 4]),  # a quarter of the sum, 3.25, is more than 3
        ([1, 1, 1, 4, 7], 2, [5, 4, 1, 2, 3]),
        ([2, 3, 2], 2, [2, 1, 3]),
        ([], 2, []),
    ],
)
def test_a_trial_that_would_run_alone_at_the_end_begins_first(limits: list[float], jobs: int, order: list[int]) -> None:
    tasks = [task(k, limit) for k, limit in enumerate(limits, start=1)]
    assert [each.key for each in ordered(tasks, jobs)] == order


@pytest.mark.parametrize(
    ("shares", "last", "others", "key"),
    [
        (["a", "b", "a"], "b", {"a"}, 2),  # what it has done before
        (["a", "b", "c"], "d", {"a"}, 2),  # nobody else is at it
        (["a", "a"], "b", {"a"}, 1),  # better than to wait
        ([None, None], None, {None}, 1),  # nothing is shared: in their order
        (["a", "b"], None, set(), 1),
    ],
)
def test_tasks_that_share_something_stay_with_one_worker(
    shares: list[str | None], last: str | None, others: set[str | None], key: int
) -> None:
    assert following([task(k, shares=each) for k, each in enumerate(shares, start=1)], last, others).key == key


def test_what_goes_wrong_in_one_trial_is_its_own_affair(tmp_path: Path) -> None:
    acts = ["succeed", "raise", "exit", "kill", "hang", "nan", "sys.exit", "succeed", "work", "half an answer"]
    trials = [fake_trials.trial(k, act) for k, act in enumerate(acts, start=1)]
    summary, rows = batch(tmp_path / "run", trials, limit_s=lambda trial: 1.5, still_s=1.0)
    reasons = {row.index: row.reason for row in rows}
    assert [row.index for row in rows] == list(range(1, 11))
    assert [row.status for row in rows] == ["done", *["failed"] * 6, "done", "failed", "failed"]
    assert reasons[2].startswith("ValueError: no such luck in two lines (fake_trials.py, line ")
    assert reasons[3] == "its worker process died (exit code 3)"
    assert reasons[4] == "its worker process died (SIGKILL)"
    assert reasons[5] == "waited for something that did not come within 1 s"
    assert reasons[6] == "the law returned nan"
    assert reasons[7].startswith("SystemExit: the law wants out")
    assert reasons[9] == "did not end within 1.5 s of processor time"
    assert reasons[10] == "its worker process died (SIGKILL)"
    assert all(row.seed == 1 for row in rows)
    assert not summary.stopped


def test_a_law_that_never_returns_is_named_and_one_that_is_slow_is_let_be(tmp_path: Path) -> None:
    trials = [fake_trials.trial(k, act) for k, act in enumerate(["spin watched", "breathe"], start=1)]
    _, rows = batch(tmp_path / "run", trials, law_limit_s=0.5)
    reasons = {row.index: (row.status, row.reason) for row in rows}
    assert reasons[1] == ("failed", "law 'extended-hamilton' did not return within 0.5 s of processor time")
    assert reasons[2] == ("done", "")


def test_only_what_is_asked_for_is_recorded(tmp_path: Path) -> None:
    trials = [fake_trials.trial(k) for k in (1, 2, 3)]
    batch(tmp_path / "run", trials, recorded=frozenset({2}), scans="all")
    found = list((tmp_path / "run" / "recordings").iterdir())
    assert [path.name for path in found] == ["0002.rrd"]
    assert found[0].read_bytes() == b"all 2"


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_full_disk_stops_the_batch_and_fails_no_trial(tmp_path: Path, jobs: int) -> None:
    """Of two workers a busy machine may start that of the first trial after the other has met the full disk."""
    trials = [fake_trials.trial(1), fake_trials.trial(2, "disk", seconds=0.3), fake_trials.trial(3, seconds=5)]
    with pytest.raises(StorageError, match="No space left"):
        batch(tmp_path / "run", trials, jobs=jobs)
    assert [row[:2] for row in table(tmp_path / "run")] in ([[(1, "done")]] if jobs == 1 else [[], [(1, "done")]])


def test_workers_that_all_die_at_once_end_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="worker processes die before they run a trial"):
        batch(tmp_path / "run", [fake_trials.trial(1), fake_trials.trial(2)], imports=fake_trials.die)


def test_imports_that_fail_are_left_to_the_trial_to_tell(tmp_path: Path) -> None:
    summary, _ = batch(tmp_path / "run", [fake_trials.trial(1)], imports=fake_trials.refuse)
    assert summary.rows[0].status == "done"


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_warm_up_that_dies_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jobs: int) -> None:
    """The trials after it are warmed up all the same."""
    marker = tmp_path / "warm"
    monkeypatch.setenv("FAKE_MARKED", str(marker))
    trials = [fake_trials.trial(1), fake_trials.trial(2)]
    warm_up = [fake_trials.trial(9, "exit"), fake_trials.trial(8, "mark")]
    summary, _ = batch(tmp_path / "run", trials, warm_up=warm_up, jobs=jobs)
    assert [row.status for row in summary.rows] == ["done", "done"]
    assert marker.exists()


BATCH = """
import sys
from pathlib import Path
sys.path[:0] = {folders!r}
if __name__ == "__main__":
    import fake_trials, test_batch
    trials = [fake_trials.trial(k, act) for k, act in enumerate({acts!r}, start=1)]
    summary, rows = test_batch.batch(Path({folder!r}), trials)
    print(summary.stopped, len(rows))
"""


def start_batch(tmp_path: Path, acts: list[str]) -> subprocess.Popen[str]:
    """A batch in a process group of its own, once its first two trials are kept and one that hangs has begun."""
    script = tmp_path / "go.py"
    folders = [str(folder) for folder in Path(__file__).parents[:2]]
    script.write_text(BATCH.format(folders=folders, acts=acts, folder=str(tmp_path / "run")))
    marker = tmp_path / "spinning"
    process = subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "FAKE_SPINNING": str(marker)},
    )
    deadline = time.monotonic() + 60
    while not (marker.exists() and {1, 2} <= {row[0] for row in table(tmp_path / "run")}):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return process


def assert_nothing_left(group: int) -> None:
    """Waits until no process of the group is left (the resource tracker takes a moment to end)."""
    deadline = time.monotonic() + 10
    while True:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_ctrl_c_stops_compiled_loops_and_keeps_what_has_ended(tmp_path: Path) -> None:
    process = start_batch(tmp_path, ["succeed", "succeed", "spin", "succeed", "spin", "succeed"])
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes of the group
    out, err = process.communicate(timeout=30)
    assert err == ""
    stopped, kept = map(int, out.split())
    assert stopped == signal.SIGINT
    assert {1, 2} <= {row[0] for row in table(tmp_path / "run")}
    assert kept == len(table(tmp_path / "run"))
    assert_nothing_left(process.pid)


def test_a_killed_parent_leaves_no_process_and_no_broken_file(tmp_path: Path) -> None:
    process = start_batch(tmp_path, ["succeed", "succeed", "spin", "spin"])
    process.kill()
    process.communicate(timeout=30)
    assert_nothing_left(process.pid)
    opened = store.opened(tmp_path / "run")
    assert [row.index for row in opened.rows()] == [1, 2]
    assert [path.name for path in sorted((tmp_path / "run" / "series").iterdir())] == ["0001.npz", "0002.npz"]


SCRIPT = """
from trials import batch
{guard}folder = batch.run("lch-table-4-1", repeats=1, settings={{"steps": 2}}, jobs=1, record="none")
{guard}print(folder)
"""


@pytest.mark.parametrize("guarded", [True, False])
def test_a_batch_of_a_script_of_ones_own(tmp_path: Path, guarded: bool) -> None:
    """Without a main guard it ends at once, in one line, and leaves no run."""
    path = tmp_path / "mine.py"
    path.write_text(SCRIPT.format(guard="if __name__ == '__main__': " if guarded else ""))
    done = subprocess.run([sys.executable, str(path)], cwd=tmp_path, capture_output=True, text=True)
    folders_made = [folder.name for folder in (tmp_path / "runs" / "lch-table-4-1").iterdir()]
    assert folders_made == (["001"] if guarded else [])
    if guarded:
        assert done.returncode == 0, done.stderr
        assert done.stdout.endswith("runs/lch-table-4-1/001\n")
    else:
        assert done.returncode == 1
        assert done.stderr.rstrip().splitlines()[-1].endswith("expected its calls under if __name__ == '__main__':")
        assert done.stderr.count("Traceback") == 1
