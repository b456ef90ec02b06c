"""Folders of runs on the disk: made, locked and named, and files that are there whole or not at all."""

from __future__ import annotations

import fcntl
import os
import re
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from flocking.errors import InputError, StorageError

RUN, RESULTS, SERIES, RECORDINGS, CODE = "run.json", "results.sqlite", "series", "recordings", "code"


class Files(NamedTuple):
    """Where a worker writes what a trial leaves; None: nowhere."""

    series: Path | None
    recording: Path | None


NO_FILES = Files(None, None)


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
    with writing(parent):
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
    with reading(folder):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    at_work = f"another process is running the trials of {folder}"
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InputError(at_work) from error
        except OSError:  # a file system without locks
            pass
        if not _is_open_as(handle, folder):  # removed since it was opened, and perhaps made again
            raise InputError(at_work)
        _clear(folder)
        yield
        _clear(folder)
    finally:
        os.close(handle)


def _is_open_as(handle: int, folder: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), folder.stat())
    except OSError:
        return False


def check_name(folder: Path | None) -> None:
    """Raises `InputError` for a name that no page and no terminal can show."""
    try:
        str(folder).encode()
    except UnicodeEncodeError:
        raise InputError(f"folder {str(folder)!a}: expected a name in UTF-8") from None


@contextmanager
def new_folder(out: Path | None, experiment: str) -> Iterator[Path]:
    """The folder for a new run, locked: `out`, made where it is not yet, or the next numbered one of the experiment.

    A folder that was made here and in which nothing is left is removed at the end, while it is still locked: an empty
    folder may be that of another process, which has yet to write. Raises `InputError` if `out` is a file, or another
    process is at work there.
    """
    folder, made = (out, made_new(out)) if out is not None else (next_folder(experiment), True)
    with alone(folder):
        try:
            yield folder
        finally:
            if made:
                with suppress(OSError):
                    folder.rmdir()


def made_new(folder: Path) -> bool:
    """Makes a folder; whether it was not there before."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file: expected a folder for the run")
    with writing(folder):
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            return False
    return True


def _clear(folder: Path) -> None:
    """Removes the temporary files of processes that are gone: only the one that holds the lock writes."""
    for part in (SERIES, RECORDINGS):
        for path in (folder / part).glob(".*"):
            if is_temporary(path.name):
                with writing(path):
                    path.unlink(missing_ok=True)


_TEMPORARY = re.compile(r"\.(\d{4,}\.npz|\d{4,}\.rrd|run\.json|results\.sqlite)\.\d+(-journal)?")


def is_temporary(name: str) -> bool:
    """Whether `whole` makes files of such a name for the parts of a run."""
    return _TEMPORARY.fullmatch(name) is not None


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A temporary path to write a file at, which then takes the place of `path`: it is there whole or not at all.

    Raises `StorageError` if the disk does not take it.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    with writing(path):
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


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """What goes wrong with reading `path` is told in one line as `InputError`."""
    try:
        yield
    except InputError:
        raise
    except sqlite3.OperationalError as error:
        if "locked" not in str(error):
            raise InputError(f"{path} cannot be read: it is damaged or is no results file ({error})") from error
        raise InputError(f"{path} cannot be read: another process has locked it; try once more") from error
    except (sqlite3.Error, ValueError, OverflowError, RecursionError, TypeError, AttributeError) as error:
        raise InputError(f"{path} cannot be read: it is damaged or is no results file ({error})") from error
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """What goes wrong with writing `path` is told in one line as `StorageError`."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise StorageError(f"cannot write {path}: {why}") from error
