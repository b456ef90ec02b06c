"""A run's folder: what was asked for, and for each trial a row, its series and its recording.

    run.json            what was asked for and with what it ran: all that is needed to run it again
    results.sqlite      table `trials`: one row a trial as it ends; table `timing` apart
    series/0001.npz     the trial's time series, as trials.batch.series packs them
    recordings/0001.rrd for the Rerun viewer, as the trial's simulation writes it
    code/               users' files that took part

One process writes the tables. A trial's worker writes its series, then its recording (each to a temporary file that
is synced and renamed); the row comes last and in a transaction: what has a row is complete, whenever the run was
killed.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import shlex
import shutil
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from flocking.errors import InputError, StorageError
from trials.types import Trial, TrialResult

FORMAT = 2
"""Of run.json and of the tables (`PRAGMA user_version`)."""
RUN, RESULTS, SERIES, RECORDINGS, CODE = "run.json", "results.sqlite", "series", "recordings", "code"
_TABLES = """
CREATE TABLE trials (
    idx INTEGER PRIMARY KEY,     -- of the trial, from 1
    status TEXT NOT NULL,        -- done or failed
    reason TEXT NOT NULL,        -- why it failed, one line
    seed INTEGER NOT NULL,
    repeat INTEGER NOT NULL,
    conditions TEXT NOT NULL,    -- JSON object
    measures TEXT NOT NULL       -- JSON object; null is nan
);
CREATE TABLE timing (
    idx INTEGER PRIMARY KEY,
    seconds REAL NOT NULL,       -- wall time of the trial, with its series and recording
    parts TEXT NOT NULL          -- JSON object, s
);
"""


DIED = "its worker process died"
"""How the reason of a trial whose worker died begins. Resuming runs such a trial again and replaces its row."""


class Files(NamedTuple):
    """Where a worker writes what a trial leaves; None: nowhere."""

    series: Path | None
    recording: Path | None


NO_FILES = Files(None, None)


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

    @property
    def trials(self) -> list[Trial]:
        """All trials of the run, finished or not."""
        return [Trial.from_dict(trial) for trial in self.run["trials"]]

    def rows(self) -> list[Row]:
        """The finished trials, by index."""
        from trials.batch.series import numbers

        with _reading(self.folder / RESULTS):
            rows = self.connection.execute(
                "SELECT idx, status, reason, seed, repeat, conditions, measures FROM trials ORDER BY idx"
            ).fetchall()
            try:
                return [
                    Row(
                        index, status, reason, seed, repeat, dict(json.loads(conditions)), numbers(json.loads(measures))
                    )
                    for index, status, reason, seed, repeat, conditions, measures in rows
                ]
            except (TypeError, AttributeError) as error:
                raise ValueError(error) from error

    def timing(self) -> dict[int, dict[str, float]]:
        """Wall time (s) of each finished trial in all (`seconds`) and by part."""
        with _reading(self.folder / RESULTS):
            rows = self.connection.execute("SELECT idx, seconds, parts FROM timing ORDER BY idx").fetchall()
            return {index: {"seconds": seconds, **json.loads(parts)} for index, seconds, parts in rows}

    def series(self, index: int) -> TrialResult:
        """The time series of a trial. Raises `InputError` if it has none."""
        from trials.batch.series import unpack

        path = self.folder / SERIES / f"{index:04d}.npz"
        if not path.is_file():
            raise InputError(f"trial {index} left no series in {self.folder}")
        with _reading(path):
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
        """Keeps a finished trial, whose files are there. Raises `StorageError` if the disk does not take it."""
        from trials.batch.series import plain

        parts = dict(timing)
        seconds = parts.pop("seconds", 0.0)
        with _writing(self.folder / RESULTS), self.connection:
            self.connection.execute("DELETE FROM trials WHERE idx = ? AND reason LIKE ?", (row.index, f"{DIED}%"))
            self.connection.execute(
                "INSERT INTO trials VALUES (?, ?, ?, ?, ?, ?, ?)",
                (
                    row.index,
                    row.status,
                    row.reason,
                    row.seed,
                    row.repeat,
                    json.dumps(row.conditions),
                    json.dumps(plain(row.measures)),
                ),
            )
            self.connection.execute(
                "INSERT OR REPLACE INTO timing VALUES (?, ?, ?)", (row.index, seconds, json.dumps(parts))
            )

    def close(self) -> None:
        """Closes the tables."""
        self.connection.close()


def create(folder: Path, run: Mapping[str, Any], code: Mapping[str, str]) -> Store:
    """Starts a run in a new or empty folder, which the caller holds `alone`; `code` holds the users' files by name.

    What a killed process left there before its run.json stood is taken over. Raises `InputError` if the folder holds
    another run or anything else; nothing is ever overwritten.
    """
    _made(folder)
    if (folder / RUN).exists():
        raise InputError(
            f"{folder} holds a run: name another folder, or finish it with herd resume {shlex.quote(str(folder))}"
        )
    found = sorted(path.name for path in folder.iterdir())
    others = [name for name in found if name not in (RESULTS, SERIES, RECORDINGS, CODE) and not _is_temporary(name)]
    if others:
        raise InputError(f"{folder} is not empty ({others[0]}): expected a new or empty folder for the run")
    if found and not _is_half_made(folder):
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
    with _writing(folder):
        for part in (SERIES, RECORDINGS):
            (folder / part).mkdir()
    with _writing(folder / RESULTS), whole(folder / RESULTS) as path:
        made = sqlite3.connect(path)
        made.executescript(f"{_TABLES} PRAGMA user_version = {FORMAT};")
        made.close()
    if code:
        with _writing(folder / CODE):
            (folder / CODE).mkdir()
        for name, text in code.items():
            write_whole(folder / CODE / name, text.encode())
    write_whole(folder / RUN, _run_text(run).encode())
    with _writing(folder / RESULTS):
        return Store(folder, run, sqlite3.connect(folder / RESULTS))


def _is_half_made(folder: Path) -> bool:
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
                connection.execute("PRAGMA user_version").fetchone()[0] == FORMAT
                and connection.execute("SELECT count(*) FROM trials").fetchone()[0] == 0
            )
    except sqlite3.Error:
        return False


def _remove(path: Path) -> None:
    with suppress(OSError):
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink(missing_ok=True)


def opened(folder: Path) -> Store:
    """Opens the folder of a run. Raises `InputError` if it is none, is damaged or is of another version."""
    run = _read_run(folder)
    path = folder / RESULTS
    if not path.is_file():
        raise InputError(f"{folder} lacks its {RESULTS}: the run cannot be read")
    with _reading(path):
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=rw", uri=True)
        try:
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > FORMAT:
                raise InputError(f"{path} has format {version}, of a newer version: this version reads {FORMAT}")
            if version < FORMAT:
                raise InputError(f"{path} is not the results of a run")
            found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
            if found != "ok":
                raise InputError(f"{path} is damaged ({' '.join(found.split())}); nothing was changed")
            connection.execute("SELECT idx, status, reason, seed, repeat, conditions, measures FROM trials LIMIT 1")
        except BaseException:
            connection.close()
            raise
    return Store(folder, run, connection)


def newest(experiment: str | None = None, base: Path = Path("runs")) -> Path:
    """The folder of the newest run below `base`, of one experiment or of any.

    Raises `InputError` if there is none.
    """
    found = sorted((path.stat().st_mtime_ns, path) for path in base.glob(f"{experiment or '*'}/*/{RUN}"))
    if not found:
        of = f" of {experiment}" if experiment else ""
        raise InputError(f"no run{of} below {base}/: start one with herd run, or name the run's folder")
    return found[-1][1].parent


def next_folder(experiment: str, base: Path = Path("runs")) -> Path:
    """Makes and returns the next numbered folder for an experiment: runs/EXPERIMENT/001 and so on."""
    parent = base / experiment
    with _writing(parent):
        parent.mkdir(parents=True, exist_ok=True)
        number = (
            max(
                (int(path.name) for path in parent.iterdir() if path.name.isascii() and path.name.isdecimal()),
                default=0,
            )
            + 1
        )
        while True:
            folder = parent / f"{number:03d}"
            try:
                folder.mkdir()
                return folder
            except FileExistsError:
                number += 1


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Locks a run's folder for this process, and removes the temporary files of processes that were killed.

    Raises `InputError` if another process is starting a run there, or running its trials.
    """
    with _reading(folder):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InputError(f"another process is running the trials of {folder}") from error
        except OSError:  # a file system without locks
            pass
        _clear(folder)
        yield
        _clear(folder)
    finally:
        os.close(handle)


@contextmanager
def new_folder(out: Path | None, experiment: str) -> Iterator[Path]:
    """The folder for a new run, locked: `out`, made where it is not yet, or the next numbered one of the experiment.

    A folder that was made here and in which nothing is left is removed at the end. Raises `InputError` if `out` is a
    file, or another process is at work there.
    """
    folder, made = (out, _made(out)) if out is not None else (next_folder(experiment), True)
    try:
        with alone(folder):
            yield folder
    finally:
        if made:
            with suppress(OSError):
                folder.rmdir()


def _made(folder: Path) -> bool:
    """Makes a folder; whether it was not there before."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file: expected a folder for the run")
    with _writing(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        try:
            folder.mkdir()
        except FileExistsError:
            return False
    return True


def _clear(folder: Path) -> None:
    """Removes the temporary files of processes that are gone: only the one that holds the lock writes."""
    for part in (SERIES, RECORDINGS):
        for path in (folder / part).glob(".*"):
            if _is_temporary(path.name):
                with _writing(path):
                    path.unlink(missing_ok=True)


_TEMPORARY = re.compile(r"\.(\d{4,}\.npz|\d{4,}\.rrd|run\.json|results\.sqlite)\.\d+(-journal)?")


def _is_temporary(name: str) -> bool:
    """Whether `whole` makes files of such a name for the parts of a run."""
    return _TEMPORARY.fullmatch(name) is not None


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A temporary path to write a file at, which then takes the place of `path`: it is there whole or not at all.

    Raises `StorageError` if the disk does not take it.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    with _writing(path):
        try:
            yield temporary
            with open(temporary, "rb") as handle:
                os.fsync(handle.fileno())
            os.replace(temporary, path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file so that it is there whole or not at all. Raises `StorageError` if the disk does not take it."""
    with whole(path) as temporary:
        temporary.write_bytes(data)


def _read_run(folder: Path) -> dict[str, Any]:
    path = folder / RUN
    if not path.is_file():
        raise InputError(f"{folder} is not the folder of a run: it has no {RUN}")
    with _reading(path):
        data = path.read_bytes()
    try:
        run = json.loads(data)
        version = run["format"]
        if version != FORMAT:
            raise InputError(_of_another_version(path, run, version))
        for trial in run["trials"]:
            Trial.from_dict(trial)
        return {**run, "experiment": str(run["experiment"])}
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise InputError(f"{path} is damaged ({type(error).__name__}: {error}); nothing was changed") from error


def _of_another_version(path: Path, run: Mapping[str, Any], version: object) -> str:
    versions = run.get("versions")
    made = str(versions.get("create-herd", "")) if isinstance(versions, Mapping) else ""
    commit = str(run.get("commit", ""))[:12].rstrip("+")
    who = f"create-herd {made}" if made else "another version"
    return (
        f"{path} has format {version!r} and this version reads {FORMAT}: report and resume it with {who}"
        f"{f', commit {commit}' if commit else ''}"
    )


def _run_text(run: Mapping[str, Any]) -> str:
    """The text of run.json: indented, with each trial on one line."""
    head = json.dumps({name: value for name, value in run.items() if name != "trials"}, indent=2, ensure_ascii=False)
    trials = ",\n".join(f"    {json.dumps(trial, ensure_ascii=False)}" for trial in run["trials"])
    return f'{head[:-2]},\n  "trials": [\n{trials}\n  ]\n}}\n'


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    try:
        yield
    except InputError:
        raise
    except (sqlite3.Error, ValueError) as error:
        raise InputError(f"{path} cannot be read: it is damaged or is no results file ({error})") from error
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise StorageError(f"cannot write {path}: {why}") from error
