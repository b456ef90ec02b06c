"""A run's folder: a trial with a row is whole, and nothing is overwritten."""

from __future__ import annotations

import dataclasses
import errno
import fcntl
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flocking.errors import InputError, StorageError
from trials.batch import folders, runfile, store
from trials.batch.store import DIED, Row
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials

from tests.trials.batch.stores import TRIALS, new, refused, row, series_of


def test_what_is_kept_comes_back_in_order_of_index(tmp_path: Path) -> None:
    kept = new(tmp_path / "run")
    fake_trials.keep(kept, row(3, mmd=0.1), series_of(3), timing={"seconds": 2.0, "loop_s": 1.5})
    fake_trials.keep(kept, row(1, mmd=math.nan), series_of(1), b"recording 1", {"seconds": 1.0})
    kept.close()
    again = store.opened(tmp_path / "run")
    assert [r.index for r in again.rows()] == [1, 3]
    assert math.isnan(again.rows()[0].measures["mmd"])
    assert again.rows()[1] == row(3, mmd=0.1)
    assert again.timing() == {1: {"seconds": 1.0}, 3: {"seconds": 2.0, "loop_s": 1.5}}
    assert again.trials == TRIALS
    assert again.recording(1) is not None
    assert again.recording(3) is None
    assert (tmp_path / "run" / "series" / "0003.npz").read_bytes() == series_of(3)
    assert (tmp_path / "run" / "code" / "mine.py").read_text() == "law = 1\n"


def test_the_tables_do_not_depend_on_the_order_of_insertion(tmp_path: Path) -> None:
    tables = []
    for name, order in (("a", (1, 2, 3)), ("b", (3, 1, 2))):
        kept = new(tmp_path / name)
        for index in order:
            fake_trials.keep(kept, row(index, mmd=index / 3), series_of(index))
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
    fake_trials.keep(kept, row(1), series_of(1))
    kept.close()
    for name in {"run.json", lost}:
        (tmp_path / "run" / name).unlink()
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=r"holds parts of a run without its run\.json"):
        new(tmp_path / "run")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


START = """
import sys
from collections.abc import Sequence
from pathlib import Path
from flocking.errors import InputError
from trials.batch import folders, runfile, store
folder, barrier = Path(sys.argv[1]), Path(sys.argv[2])
print("ready", flush=True)
while not barrier.exists():
    pass
try:
    with folders.new_folder(folder, "fake") as new:
        run = {"format": runfile.FORMAT, "experiment": "fake", "trials": []}
        store.create(new, run, {"mine.py": "law = 1"}).close()
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
    for process in starts:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    barrier.touch()
    said = [process.communicate()[0].strip() for process in starts]
    assert said.count("won") == 1
    assert all("holds a run" in words or "another process" in words for words in said if words != "won")
    for name in MADE:
        assert (tmp_path / "run" / name).exists()
    assert store.opened(tmp_path / "run").rows() == []


def test_who_made_a_folder_and_came_second_leaves_it_to_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between making and locking another process may lock: its folder is empty until it writes."""
    folder = tmp_path / "run"
    folder.mkdir()
    monkeypatch.setattr(folders, "made_new", lambda folder: True)
    with folders.alone(folder):
        with pytest.raises(InputError, match="another process"), folders.new_folder(folder, "fake"):
            pass
        assert folder.exists()
    with folders.new_folder(folder, "fake"):
        pass
    assert not folder.exists()


@pytest.mark.parametrize("again", [True, False])
def test_a_folder_that_went_before_it_was_locked_is_not_worked_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, again: bool
) -> None:
    folder = tmp_path / "run"
    folder.mkdir()

    def lock_too_late(handle: int, operation: int) -> None:
        folder.rename(tmp_path / "gone")
        if again:
            folder.mkdir()

    monkeypatch.setattr(fcntl, "flock", lock_too_late)
    with pytest.raises(InputError, match="another process"), folders.alone(folder):
        pass


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="Permission denied"):
        new(tmp_path / "run")


def test_folders_are_numbered_and_the_newest_is_found(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no run below"):
        folders.newest(base=tmp_path)
    first, second = folders.next_folder("fake", tmp_path), folders.next_folder("fake", tmp_path)
    assert [first.name, second.name] == ["001", "002"]
    (tmp_path / "fake" / "²").mkdir()  # a digit to Python, and no number
    other = folders.next_folder("other", tmp_path)
    for number, folder in enumerate((second, first, other)):
        new(folder).close()
        os.utime(folder / "run.json", (number, number))
    assert folders.newest(base=tmp_path) == other
    assert folders.newest("fake", tmp_path) == first
    with pytest.raises(InputError, match="no run of nobody"):
        folders.newest("nobody", tmp_path)
    assert folders.next_folder("fake", tmp_path).name == "003"


def test_only_one_process_may_run_the_trials_of_a_folder(tmp_path: Path) -> None:
    new(tmp_path / "run").close()
    with (
        folders.alone(tmp_path / "run"),
        pytest.raises(InputError, match="another process"),
        folders.alone(tmp_path / "run"),
    ):
        pass
    half = tmp_path / "run" / "series" / ".0001.npz.123"
    half.write_bytes(b"of a killed process")
    users = tmp_path / "run" / "series" / ".notes"
    users.write_text("of the user's own")
    with folders.alone(tmp_path / "run"):
        assert not half.exists()
    assert users.exists()


def test_each_text_of_a_users_file_is_kept_once_and_trials_stay_themselves(tmp_path: Path) -> None:
    world, law = "a world\n" * 1000, "a law\n" * 500
    trials = [
        dataclasses.replace(
            trial,
            world="plan.json",
            world_source=world if trial.index < 3 else "another",
            groups=tuple(dataclasses.replace(group, law_source=law) for group in trial.groups),
        )
        for trial in TRIALS
    ]
    run = {"format": runfile.FORMAT, "experiment": "fake", "trials": [trial.as_dict() for trial in trials]}
    text = runfile.text_of(run)
    assert text.count(json.dumps(world)[1:-1]) == text.count(json.dumps(law)[1:-1]) == 1
    short = json.loads(text)
    assert set(short["texts"].values()) == {world, law, "another"}
    assert [run["trials"][0]["world_source"], short["trials"][0]["world_source"]] == [
        world,
        {"text": runfile.text_digest(world)},
    ]
    (tmp_path / "run").mkdir()
    path = tmp_path / "run" / "run.json"
    laws = {runfile.text_digest(law): {}}
    for kept in (text, json.dumps(run)):  # as it is written, and as earlier versions wrote it
        path.write_text(json.dumps(json.loads(kept) | {"laws": laws}))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(runfile, "_learn", lambda run: None)
            again = runfile.read(tmp_path / "run")
        assert [Trial.from_dict(trial) for trial in again["trials"]] == trials
        assert [runfile.digest(Trial.from_dict(trial)) for trial in again["trials"]] == [*map(runfile.digest, trials)]
        assert "texts" not in again
    path.write_text(json.dumps({**short, "texts": {}}))
    refused(tmp_path / "run", "run.json is damaged")
