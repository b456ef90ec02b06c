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
from collections.abc import Sequence
from pathlib import Path

import pytest

from flocking.errors import InputError, StorageError
from trials.batch import folders, runfile, series, store
from trials.batch.store import DIED, Row, Store
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials
from synthetic import synthetic_result

TRIALS = [fake_trials.trial(k) for k in (1, 2, 3)]


def new(folder: Path) -> Store:
    run = {"format": runfile.FORMAT, "experiment": "fake", "seed": 1, "trials": [trial.as_dict() for trial in TRIALS]}
    return store.create(folder, run, {"mine.py": "law = 1\n"})


def row(index: int, **measures: float) -> Row:
    trial = TRIALS[index - 1]
    return Row(index, "done", "", trial.seed, trial.repeat, dict(trial.conditions), measures)


def series_of(index: int) -> bytes:
    return fake_trials.packed(TRIALS[index - 1].as_dict())


def refused(folder: Path, words: str) -> None:
    """Opening fails in one line and changes no byte of what is there."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=words) as caught:
        store.opened(folder)
    assert "\n" not in str(caught.value)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


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
    path.write_text(told.replace(f'"format": {runfile.FORMAT}', f'"format": {runfile.FORMAT + 1}'))
    refused(tmp_path / "run", f"has format {runfile.FORMAT + 1} and this version reads {runfile.FORMAT}")
    path.write_text(told)
    with sqlite3.connect(tmp_path / "run" / "results.sqlite") as connection:
        connection.execute(f"PRAGMA user_version = {runfile.FORMAT + 1}")
    connection.close()
    refused(tmp_path / "run", f"has format {runfile.FORMAT + 1}, of a newer version")


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


class TestWhatDoesNotBelongToTheRun:
    """Parts of a run's folder that were put there from elsewhere, or edited: named, left out, and run again."""

    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        """Two finished trials, with series, of three."""
        kept = new(tmp_path / "run")
        self._finish(kept, TRIALS[:2])
        kept.close()
        return tmp_path / "run"

    @staticmethod
    def _finish(kept: Store, trials: Sequence[Trial]) -> None:
        for trial in trials:
            result = dataclasses.replace(synthetic_result(seed=trial.index, seconds=1.0, scans="none"), trial=trial)
            told = Row(trial.index, "done", "", trial.seed, trial.repeat, dict(trial.conditions), {})
            fake_trials.keep(kept, told, series.pack(result))

    def _misfits(self, folder: Path) -> dict[int, str]:
        kept = store.opened(folder)
        found = dict(kept.misfits)
        assert [row.index for row in kept.rows()] == [index for index in (1, 2) if index not in found]
        self._finish(kept, [trial for trial in TRIALS if trial.index in found])
        assert kept.misfits == {}
        assert [row.index for row in kept.rows()] == [1, 2]
        kept.close()
        return found

    def test_what_belongs_to_it_is_no_misfit(self, folder: Path) -> None:
        assert self._misfits(folder) == {}

    def test_the_series_of_another_trial(self, folder: Path) -> None:
        (folder / "series" / "0002.npz").write_bytes((folder / "series" / "0001.npz").read_bytes())
        found = self._misfits(folder)
        assert list(found) == [2]
        assert found[2].startswith("its series is that of trial 1, seed 1")

    def test_a_series_cut_short(self, folder: Path) -> None:
        path = folder / "series" / "0001.npz"
        path.write_bytes(path.read_bytes()[:-100])
        found = self._misfits(folder)
        assert list(found) == [1]
        assert found[1].startswith("its series: damaged series")

    def test_an_edited_seed(self, folder: Path) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute("UPDATE trials SET digest = 'other', seed = 7 WHERE idx = 2")
        connection.close()
        assert self._misfits(folder) == {2: "its row is that of another trial (seed 7 in place of 1)"}

    @pytest.mark.parametrize(
        "change",
        ["seed = 7", "seed = 'abc'", "repeat = 9", 'conditions = \'{"act": "other"}\'', "conditions = '['"],
    )
    def test_an_edited_row_whose_digest_still_stands(self, folder: Path, change: str) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute(f"UPDATE trials SET {change} WHERE idx = 2")
        connection.close()
        assert list(self._misfits(folder)) == [2]

    @pytest.mark.parametrize("change", ["status = 'finished'", "reason = x'ff00'"])
    def test_a_row_that_no_trial_has(self, folder: Path, change: str) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute(f"UPDATE trials SET {change} WHERE idx = 2")
        connection.close()
        assert list(self._misfits(folder)) == [2]

    @pytest.mark.parametrize("measures", ["[" * 100_000, "[1]", '{"a": %s}' % ("9" * 400), '{"a": "b"}'])
    def test_measures_that_are_none_are_told_in_one_line(self, folder: Path, measures: str) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute("UPDATE trials SET measures = ? WHERE idx = 2", (measures,))
        connection.close()
        kept = store.opened(folder)
        with pytest.raises(InputError, match="is damaged") as caught:
            kept.rows()
        assert len(str(caught.value)) < 1000

    def test_what_would_act_on_a_terminal_is_not_handed_out(self, folder: Path) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute("UPDATE trials SET status = 'failed', reason = char(27) || '[31mred' WHERE idx = 2")
        connection.close()
        assert store.opened(folder).rows()[1].reason.endswith("[31mred")
        assert "\x1b" not in store.opened(folder).rows()[1].reason

    def test_a_view_is_no_table(self, folder: Path) -> None:
        with sqlite3.connect(folder / "results.sqlite") as connection:
            connection.execute("ALTER TABLE trials RENAME TO others")
            connection.execute("CREATE VIEW trials AS SELECT * FROM others")
        connection.close()
        refused(folder, "not the results of a run")

    def test_results_of_another_run(self, folder: Path, tmp_path: Path) -> None:
        """The same seeds and conditions with another duration."""
        run = json.loads((folder / "run.json").read_text())
        for trial in run["trials"]:
            trial["setup"]["duration_s"] = 2.0
        (folder / "run.json").write_text(json.dumps(run))
        kept = store.opened(folder)
        assert list(kept.misfits) == [1, 2]
        assert set(kept.misfits.values()) == {"its row is that of another trial (another run or other settings)"}
        assert kept.rows() == []

    def test_a_row_of_no_trial(self, folder: Path) -> None:
        run = json.loads((folder / "run.json").read_text())
        run["trials"] = run["trials"][:1]
        (folder / "run.json").write_text(json.dumps(run))
        kept = store.opened(folder)
        assert kept.misfits == {2: "the run has no such trial"}
        assert [row.index for row in kept.rows()] == [1]


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
