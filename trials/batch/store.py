"""A run's folder: what was asked for, and for each trial a row, its series and its recording.

    run.json            what was asked for and with what it ran: all that is needed to run it again
    results.sqlite      table `trials`: one row a trial as it ends, with the digest of that trial; table `timing` apart
    series/0001.npz     the trial's time series, as trials.batch.series packs them
    recordings/0001.rrd for the Rerun viewer, as the trial's simulation writes it
    code/               users' files that took part

One process writes the tables. A trial's worker writes its series, then its recording (each to a temporary file that
is synced and renamed); the row comes last and in a transaction: what has a row is complete, whenever the run was
killed.
"""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from flocking.errors import InputError, printable
from trials.batch import runfile
from trials.batch.folders import (
    CODE,
    RECORDINGS,
    RESULTS,
    RUN,
    SERIES,
    Files,
    is_temporary,
    made_new,
    reading,
    whole,
    write_whole,
    writing,
)
from trials.invoked import command
from trials.types import Trial, TrialResult

_COLUMNS = "idx, status, reason, seed, repeat, conditions, measures, digest"
_TABLES = """
CREATE TABLE trials (
    idx INTEGER PRIMARY KEY,     -- of the trial, from 1
    status TEXT NOT NULL,        -- done or failed
    reason TEXT NOT NULL,        -- why it failed, one line
    seed INTEGER NOT NULL,
    repeat INTEGER NOT NULL,
    conditions TEXT NOT NULL,    -- JSON object
    measures TEXT NOT NULL,      -- JSON object; null is nan
    digest TEXT NOT NULL         -- of the trial as it was run
);
CREATE TABLE timing (
    idx INTEGER PRIMARY KEY,
    seconds REAL NOT NULL,       -- wall time of the trial, with its series and recording
    parts TEXT NOT NULL          -- JSON object, s
);
"""


STATUSES = ("done", "failed")
DIED = "its worker process died"
"""How the reason of a trial whose worker died begins. Resuming runs such a trial again and replaces its row."""


@dataclass(frozen=True)
class Row:
    """One finished trial, without its series."""

    index: int
    status: str
    """`done` or `failed`."""
    reason: str
    seed: int
    repeat: int
    conditions: dict[str, Any]
    measures: dict[str, float]


@dataclass(frozen=True)
class Store:
    """An open run's folder."""

    folder: Path
    run: Mapping[str, Any]
    """The content of run.json."""
    connection: sqlite3.Connection

    @cached_property
    def trials(self) -> list[Trial]:
        """All trials of the run, finished or not."""
        return [Trial.from_dict(trial) for trial in self.run["trials"]]

    @cached_property
    def misfits(self) -> dict[int, str]:
        """Why what is kept of a trial does not belong to this run, in words, by index of its row."""
        planned = {trial.index: trial for trial in self.trials}
        with reading(self.folder / RESULTS):
            kept = self.connection.execute(f"SELECT {_COLUMNS} FROM trials ORDER BY idx").fetchall()
        found = {}
        for row in kept:
            index = row[0]
            why = self._misfit(planned.get(index), row)
            if why:
                found[index] = why
        return found

    def _misfit(self, trial: Trial | None, row: tuple[Any, ...]) -> str:
        from trials.batch.series import trial_of

        _, status, reason, seed, repeat, conditions, _, of = row
        if trial is None:
            return "the run has no such trial"
        own = runfile.digest(trial)
        if of != own:
            other = f"seed {seed} in place of {trial.seed}" if seed != trial.seed else "another run or other settings"
            return f"its row is that of another trial ({other})"
        if status not in STATUSES or not isinstance(reason, str):
            return "its row is no trial's: neither done nor failed, or without words for why"
        try:
            told = seed, repeat, _object(conditions)
        except ValueError:
            told = seed, repeat, {}
        if told != (trial.seed, trial.repeat, dict(trial.conditions)):
            return "its row was changed: its seed, repeat or conditions are not the trial's"
        path = self.folder / SERIES / f"{trial.index:04d}.npz"
        if not path.is_file():
            return ""
        try:
            held = trial_of(path)
        except InputError as error:
            return f"its series: {error}"
        if runfile.digest(held) != own:
            return f"its series is that of trial {held.index}, seed {held.seed}, of another run or other settings"
        return ""

    def of(self, trials: Sequence[Trial]) -> Store:
        """The same folder as that of a run of some of its trials alone."""
        return Store(self.folder, {**self.run, "trials": [trial.as_dict() for trial in trials]}, self.connection)

    def rows(self) -> list[Row]:
        """The finished trials, by index, without those that do not fit the run."""
        from trials.batch.series import numbers

        misfits = self.misfits
        with reading(self.folder / RESULTS):
            rows = self.connection.execute(f"SELECT {_COLUMNS} FROM trials ORDER BY idx").fetchall()
            return [
                Row(
                    index,
                    status,
                    printable(reason),
                    seed,
                    repeat,
                    _object(conditions),
                    numbers(_object(measures)),
                )
                for index, status, reason, seed, repeat, conditions, measures, _ in rows
                if index not in misfits
            ]

    def timing(self) -> dict[int, dict[str, float]]:
        """Wall time (s) of each finished trial in all (`seconds`) and by part."""
        with reading(self.folder / RESULTS):
            rows = self.connection.execute("SELECT idx, seconds, parts FROM timing ORDER BY idx").fetchall()
            return {index: {"seconds": seconds, **json.loads(parts)} for index, seconds, parts in rows}

    def series(self, index: int) -> TrialResult:
        """The time series of a trial. Raises `InputError` if it has none."""
        from trials.batch.series import unpack

        path = self.folder / SERIES / f"{index:04d}.npz"
        if not path.is_file():
            raise InputError(f"trial {index} left no series in {self.folder}")
        with reading(path):
            data = path.read_bytes()
        try:
            return unpack(data)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error

    def has_series(self, index: int) -> bool:
        """Whether a trial's time series is there."""
        return (self.folder / SERIES / f"{index:04d}.npz").is_file()

    def recording(self, index: int) -> Path | None:
        """The recording of a trial, if it was recorded."""
        path = self.folder / RECORDINGS / f"{index:04d}.rrd"
        return path if path.is_file() else None

    def files(self, index: int, record: bool) -> Files:
        """Where the files of a trial go."""
        recording = self.folder / RECORDINGS / f"{index:04d}.rrd" if record else None
        return Files(self.folder / SERIES / f"{index:04d}.npz", recording)

    def add(self, row: Row, timing: Mapping[str, float]) -> None:
        """Keeps a finished trial, whose files are there; in place of a row whose worker died, or that did not fit.

        Raises `StorageError` if the disk does not take it.
        """
        from trials.batch.series import plain

        parts = dict(timing)
        seconds = parts.pop("seconds", 0.0)
        with writing(self.folder / RESULTS), self.connection:
            if row.index in self.misfits:
                self.connection.execute("DELETE FROM trials WHERE idx = ?", (row.index,))
            self.connection.execute("DELETE FROM trials WHERE idx = ? AND reason LIKE ?", (row.index, f"{DIED}%"))
            self.connection.execute(
                "INSERT INTO trials VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    row.index,
                    row.status,
                    row.reason,
                    row.seed,
                    row.repeat,
                    json.dumps(row.conditions),
                    json.dumps(plain(row.measures)),
                    self._digests[row.index],
                ),
            )
            self.connection.execute(
                "INSERT OR REPLACE INTO timing VALUES (?, ?, ?)", (row.index, seconds, json.dumps(parts))
            )
        self.misfits.pop(row.index, None)

    @cached_property
    def _digests(self) -> dict[int, str]:
        return {trial.index: runfile.digest(trial) for trial in self.trials}

    def close(self) -> None:
        """Closes the tables."""
        self.connection.close()


def create(folder: Path, run: Mapping[str, Any], code: Mapping[str, str]) -> Store:
    """Starts a run in a new or empty folder, which the caller holds `alone`; `code` holds the users' files by name.

    What a killed process left there before its run.json stood is taken over. Raises `InputError` if the folder holds
    another run or anything else; nothing is ever overwritten.
    """
    made_new(folder)
    if (folder / RUN).exists():
        raise InputError(
            f"{folder} holds a run: name another folder, or finish it with {command('resume', str(folder))}"
        )
    found = sorted(path.name for path in folder.iterdir())
    others = [name for name in found if name not in (RESULTS, SERIES, RECORDINGS, CODE) and not is_temporary(name)]
    if others:
        raise InputError(f"{folder} is not empty ({others[0]}): expected a new or empty folder for the run")
    if found and not _is_halfmade_new(folder):
        raise InputError(
            f"{folder} holds parts of a run without its {RUN} ({found[0]}): expected a new or empty folder for the run"
        )
    for name in found:
        _remove(folder / name)
    try:
        return _create(folder, run, code)
    except BaseException:  # the folder was empty
        for name in (RUN, RESULTS, SERIES, RECORDINGS, CODE):
            _remove(folder / name)
        raise


def _create(folder: Path, run: Mapping[str, Any], code: Mapping[str, str]) -> Store:
    with writing(folder):
        for part in (SERIES, RECORDINGS):
            (folder / part).mkdir()
    with writing(folder / RESULTS), whole(folder / RESULTS) as path:
        made = sqlite3.connect(path)
        made.executescript(f"{_TABLES} PRAGMA user_version = {runfile.FORMAT};")
        made.close()
    if code:
        with writing(folder / CODE):
            (folder / CODE).mkdir()
        for name, text in code.items():
            write_whole(folder / CODE / name, text.encode())
    write_whole(folder / RUN, runfile.text_of(run).encode())
    with writing(folder / RESULTS):
        return Store(folder, run, sqlite3.connect(folder / RESULTS))


def removed(kept: Store) -> None:
    """Takes away all that `create` made of a run in which nothing was run, and its folder."""
    kept.close()
    for name in (RUN, RESULTS, SERIES, RECORDINGS, CODE):
        _remove(kept.folder / name)


def check_code(kept: Store, code: Mapping[str, str]) -> None:
    """Raises `InputError` where a user's file in the run's folder is not the one that its trials hold and would run."""
    for name, text in code.items():
        path = kept.folder / CODE / name
        with reading(path):
            same = path.read_text(encoding="utf-8") == text
        if not same:
            raise InputError(f"{path} is not the file that the trials of this run hold: nothing was run; put it back")


def _object(text: Any) -> dict[str, Any]:
    """A JSON object. Raises `ValueError` for anything else."""
    try:
        found = json.loads(text)
    except (TypeError, RecursionError) as error:
        raise ValueError(f"not JSON: {type(error).__name__}") from error
    if not isinstance(found, dict):
        raise ValueError("not a JSON object")
    return found


def _is_halfmade_new(folder: Path) -> bool:
    """Whether a folder without run.json holds what a killed `create` left, and nothing else.

    Its parts come in the order of `_create`: users' files come after tables without rows.
    """
    for part in (SERIES, RECORDINGS):
        if (folder / part).exists() and not ((folder / part).is_dir() and not any((folder / part).iterdir())):
            return False
    if not (folder / RESULTS).exists():
        return not (folder / CODE).exists()
    try:
        with closing(sqlite3.connect(f"{(folder / RESULTS).absolute().as_uri()}?mode=ro", uri=True)) as connection:
            return bool(
                connection.execute("PRAGMA user_version").fetchone()[0] == runfile.FORMAT
                and connection.execute("SELECT count(*) FROM trials").fetchone()[0] == 0
            )
    except sqlite3.Error:
        return False


def _remove(path: Path) -> None:
    with suppress(OSError):
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink(missing_ok=True)


def opened(folder: Path) -> Store:
    """Opens the folder of a run. Raises `InputError` if it is none, is damaged or is of another version."""
    run = runfile.read(folder)
    path = folder / RESULTS
    if not path.is_file():
        raise InputError(f"{folder} lacks its {RESULTS}: the run cannot be read")
    with reading(path):
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=rw", uri=True)
        try:
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > runfile.FORMAT:
                raise InputError(
                    f"{path} has format {version}, of a newer version: this version reads {runfile.FORMAT}"
                )
            if version < runfile.FORMAT:
                raise InputError(f"{path} is not the results of a run")
            found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
            if found != "ok":
                raise InputError(f"{path} is damaged ({' '.join(found.split())}); nothing was changed")
            kinds = connection.execute("SELECT type FROM sqlite_master WHERE name IN ('trials', 'timing')").fetchall()
            if kinds != [("table",), ("table",)]:
                raise InputError(f"{path} is not the results of a run")
            connection.execute(f"SELECT {_COLUMNS} FROM trials LIMIT 1")
        except BaseException:
            connection.close()
            raise
    return Store(folder, run, connection)
