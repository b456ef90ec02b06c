"""A run's folder: a trial with a row is whole, nothing is overwritten, damage is reported in one line."""

from __future__ import annotations

import dataclasses
import errno
import json
import math
import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from flocking.errors import InputError
from trials.batch import store
from trials.batch.store import DIED, Row, StorageError, Store

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials

TRIALS = [fake_trials.trial(k) for k in (1, 2, 3)]


def new(folder: Path) -> Store:
    run = {"format": store.FORMAT, "experiment": "fake", "seed": 1, "trials": [trial.as_dict() for trial in TRIALS]}
    return store.create(folder, run, {"mine.py": "law = 1\n"})


def row(index: int, **measures: float) -> Row:
    return Row(index, "done", "", 1, 1, {"herd.law.exclusion_m": 0.5}, measures)


def refused(folder: Path, words: str) -> None:
    """Opening fails in one line and changes no byte of what is there."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=words) as caught:
        store.opened(folder)
    assert "\n" not in str(caught.value)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_what_is_kept_comes_back_in_order_of_index(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(3, mmd=0.1), b"series 3", timing={"seconds": 2.0, "loop_s": 1.5})
    fake_trials.keep(kept, row(1, mmd=math.nan), b"series 1", b"recording 1", {"seconds": 1.0})
    kept.close()
    again = store.opened(tmp_path / "run")
    assert [r.index for r in again.rows()] == [1, 3]
    assert math.isnan(again.rows()[0].measures["mmd"])
    assert again.rows()[1] == row(3, mmd=0.1)
    assert again.timing() == {1: {"seconds": 1.0}, 3: {"seconds": 2.0, "loop_s": 1.5}}
    assert again.trials == TRIALS
    assert again.recording(1) is not None
    assert again.recording(3) is None
    assert (tmp_path / "run" / "series" / "0003.npz").read_bytes() == b"series 3"
    assert (tmp_path / "run" / "code" / "mine.py").read_text() == "law = 1\n"


def test_the_tables_do_not_depend_on_the_order_of_insertion(tmp_path: Path) -> None:
    tables = []
    for name, order in (("a", (1, 2, 3)), ("b", (3, 1, 2))):
        kept = new(tmp_path / name)
        for index in order:
            fake_trials.keep(kept, row(index, mmd=index / 3), b"x")
        tables.append(kept.connection.execute("SELECT * FROM trials").fetchall())
        kept.close()
    assert tables[0] == tables[1]


def test_files_come_before_the_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = new(tmp_path / "run")

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match=r"cannot write .*0001.npz: No space left on device"):
        fake_trials.run(fake_trials.trial(1).as_dict(), "some", kept.files(1, record=True))
    assert kept.rows() == []
    assert list((tmp_path / "run" / "series").iterdir()) == []
    monkeypatch.undo()
    fake_trials.run(fake_trials.trial(1).as_dict(), "some", kept.files(1, record=True))
    assert [path.name for path in (tmp_path / "run" / "series").iterdir()] == ["0001.npz"]
    assert kept.recording(1) is not None
    assert kept.rows() == []


def test_a_full_disk_under_the_tables_loses_no_earlier_row(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(1))
    pages = kept.connection.execute("PRAGMA page_count").fetchone()[0]
    kept.connection.execute(f"PRAGMA max_page_count = {pages}")
    big = Row(2, "failed", "x" * 100_000, 1, 1, {}, {})
    with pytest.raises(StorageError, match="full"):
        fake_trials.keep(kept, big)
    kept.close()
    assert [r.index for r in store.opened(tmp_path / "run").rows()] == [1]


def test_a_trial_cannot_be_kept_twice(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(1, mmd=1.0))
    with pytest.raises(StorageError, match="UNIQUE"):
        fake_trials.keep(kept, row(1, mmd=2.0))
    assert kept.rows() == [row(1, mmd=1.0)]


def test_a_trial_that_lost_its_worker_gives_way_to_its_repetition(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(
        kept, dataclasses.replace(row(1), status="failed", reason=f"{DIED} (SIGKILL)"), timing={"seconds": 1.0}
    )
    fake_trials.keep(kept, row(1, mmd=2.0), timing={"seconds": 2.0})
    assert kept.rows() == [row(1, mmd=2.0)]
    assert kept.timing()[1]["seconds"] == 2.0


def test_a_folder_with_a_run_is_not_used_again(tmp_path: Path) -> None:
    new(tmp_path / "run").close()
    before = (tmp_path / "run" / "run.json").read_bytes()
    with pytest.raises(InputError, match="holds a run"):
        new(tmp_path / "run")
    assert (tmp_path / "run" / "run.json").read_bytes() == before


def test_a_folder_with_other_files_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text("mine")
    with pytest.raises(InputError, match="not empty"):
        new(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert (tmp_path / "report.html").read_text() == "mine"


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run").write_text("mine")
    with pytest.raises(InputError, match="is a file"):
        new(tmp_path / "run")
    with pytest.raises(InputError, match="cannot write"):
        new(tmp_path / "run" / "below")
    assert (tmp_path / "run").read_text() == "mine"


def test_a_start_that_fails_leaves_nothing_half_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match="No space left"):
        new(tmp_path / "run")
    monkeypatch.undo()
    new(tmp_path / "run").close()


MADE = ("series", "recordings", "results.sqlite", "code", "code/mine.py", "run.json")
"""The parts of a run's folder, in the order in which they are made."""


@pytest.mark.parametrize("there", range(len(MADE)))
def test_what_a_killed_start_left_is_taken_over(tmp_path: Path, there: int) -> None:
    """The folder as it is after each part was made, with the beginning of the next as a temporary file."""
    new(tmp_path / "run").close()
    for name in reversed(MADE[there:]):
        path = tmp_path / "run" / name
        path.rmdir() if path.is_dir() else path.unlink()
    (tmp_path / "run" / ".results.sqlite.123").write_bytes(b"SQLite")
    (tmp_path / "run" / ".run.json.123").write_text("{")
    new(tmp_path / "run").close()
    assert store.opened(tmp_path / "run").rows() == []
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == [
        "code",
        "recordings",
        "results.sqlite",
        "run.json",
        "series",
    ]


@pytest.mark.parametrize("lost", ["run.json", "results.sqlite"])
def test_a_folder_with_results_is_never_taken_over(tmp_path: Path, lost: str) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(1), b"series")
    kept.close()
    for name in {"run.json", lost}:
        (tmp_path / "run" / name).unlink()
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=r"holds parts of a run without its run\.json"):
        new(tmp_path / "run")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


START = """
import sys
from pathlib import Path
from flocking.errors import InputError
from trials.batch import store
folder, barrier = Path(sys.argv[1]), Path(sys.argv[2])
while not barrier.exists():
    pass
try:
    with store.new_folder(folder, "fake") as new:
        store.create(new, {"format": store.FORMAT, "experiment": "fake", "trials": []}, {"mine.py": "law = 1"}).close()
    print("won")
except InputError as error:
    print(error)
"""


def test_of_many_starts_in_one_folder_one_wins_and_loses_nothing(tmp_path: Path) -> None:
    """All are released by one file; whoever comes too late finds a run or a lock, and removes nothing."""
    barrier = tmp_path / "barrier"
    starts = [
        subprocess.Popen(
            [sys.executable, "-c", START, str(tmp_path / "run"), str(barrier)], stdout=subprocess.PIPE, text=True
        )
        for _ in range(4)
    ]
    barrier.touch()
    said = [process.communicate()[0].strip() for process in starts]
    assert said.count("won") == 1
    assert all("holds a run" in words or "another process" in words for words in said if words != "won")
    for name in MADE:
        assert (tmp_path / "run" / name).exists()
    assert store.opened(tmp_path / "run").rows() == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="Permission denied"):
        new(tmp_path / "run")


def test_damage_is_told_and_nothing_is_changed(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    for index in (1, 2, 3):
        fake_trials.keep(kept, row(index))
    kept.close()
    results, run = tmp_path / "run" / "results.sqlite", tmp_path / "run" / "run.json"
    whole, told = results.read_bytes(), run.read_bytes()

    results.write_bytes(b"not a database, though long enough to be taken for one" * 100)
    refused(tmp_path / "run", "damaged or is no results file")
    results.write_bytes(whole[: len(whole) // 2])
    refused(tmp_path / "run", "damaged")
    results.write_bytes(whole[:100] + b"\xa5" * (len(whole) - 100))
    refused(tmp_path / "run", "damaged")
    results.write_bytes(b"")
    refused(tmp_path / "run", "not the results of a run")
    results.unlink()
    refused(tmp_path / "run", "lacks its results.sqlite")
    results.write_bytes(whole)

    run.write_bytes(told[:-20])
    refused(tmp_path / "run", "run.json is damaged")
    run.write_text("[]")
    refused(tmp_path / "run", "run.json is damaged")
    run.write_bytes(b"\xff\xfe")
    refused(tmp_path / "run", "run.json is damaged")
    run.write_text(json.dumps(json.loads(told) | {"trials": [{"index": 1}]}))
    refused(tmp_path / "run", "run.json is damaged")
    run.unlink()
    refused(tmp_path / "run", "it has no run.json")
    run.write_bytes(told)
    assert len(store.opened(tmp_path / "run").rows()) == 3


def test_a_newer_version_is_told(tmp_path: Path) -> None:
    new(tmp_path / "run").close()
    path = tmp_path / "run" / "run.json"
    told = path.read_text()
    path.write_text(told.replace(f'"format": {store.FORMAT}', f'"format": {store.FORMAT + 1}'))
    refused(tmp_path / "run", f"has format {store.FORMAT + 1} and this version reads {store.FORMAT}")
    path.write_text(told)
    with sqlite3.connect(tmp_path / "run" / "results.sqlite") as connection:
        connection.execute(f"PRAGMA user_version = {store.FORMAT + 1}")
    connection.close()
    refused(tmp_path / "run", f"has format {store.FORMAT + 1}, of a newer version")


def test_an_older_format_is_refused_with_the_version_that_reads_it(tmp_path: Path) -> None:
    new(tmp_path / "run").close()
    path = tmp_path / "run" / "run.json"
    old = {
        "format": 1,
        "experiment": "fake",
        "versions": {"create-herd": "0.1.0"},
        "commit": "282baf4f00+",
        "trials": [],
    }
    path.write_text(json.dumps(old))
    refused(tmp_path / "run", "report and resume it with create-herd 0.1.0, commit 282baf4f00$")


def test_a_missing_or_damaged_series_is_told(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(1), b"nonsense")
    with pytest.raises(InputError, match=r"0001.npz: damaged series"):
        kept.series(1)
    with pytest.raises(InputError, match="trial 2 left no series"):
        kept.series(2)


def test_folders_are_numbered_and_the_newest_is_found(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no run below"):
        store.newest(base=tmp_path)
    first, second = store.next_folder("fake", tmp_path), store.next_folder("fake", tmp_path)
    assert [first.name, second.name] == ["001", "002"]
    (tmp_path / "fake" / "²").mkdir()  # a digit to Python, and no number
    other = store.next_folder("other", tmp_path)
    for number, folder in enumerate((second, first, other)):
        new(folder).close()
        os.utime(folder / "run.json", (number, number))
    assert store.newest(base=tmp_path) == other
    assert store.newest("fake", tmp_path) == first
    with pytest.raises(InputError, match="no run of nobody"):
        store.newest("nobody", tmp_path)
    assert store.next_folder("fake", tmp_path).name == "003"


def test_only_one_process_may_run_the_trials_of_a_folder(tmp_path: Path) -> None:
    new(tmp_path / "run").close()
    with (
        store.alone(tmp_path / "run"),
        pytest.raises(InputError, match="another process"),
        store.alone(tmp_path / "run"),
    ):
        pass
    half = tmp_path / "run" / "series" / ".0001.npz.123"
    half.write_bytes(b"of a killed process")
    users = tmp_path / "run" / "series" / ".notes"
    users.write_text("of the user's own")
    with store.alone(tmp_path / "run"):
        assert not half.exists()
    assert users.exists()
