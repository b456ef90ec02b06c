"""A run's folder that is damaged, of another version, or holds what is not its own: told in one line, left as it is."""

from __future__ import annotations

import dataclasses
import json
import sqlite3
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from flocking.errors import InputError
from trials.batch import runfile, series, store
from trials.batch.store import Row, Store
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials
from synthetic import synthetic_result

from tests.trials.batch.stores import TRIALS, new, refused, row


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
