"""Compiled code kept between runs: damage is a miss, a full disk is told as such, a folder of another's is not used."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.core.caching import IndexDataCacheFile

from flocking import compilation, lawsource
from flocking.compiled_cache import kept_between_runs
from flocking.errors import InputError, StorageError

DAMAGES: tuple[Callable[[bytes], bytes], ...] = (
    lambda data: b"",
    lambda data: data[:1],
    lambda data: data[: len(data) // 2],
    lambda data: data[:-1],
    lambda data: bytes(len(data)),
    lambda data: b"\xff" * len(data),
)


def doubled(x: float) -> float:
    return 2.0 * x


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    return tmp_path


def called() -> Any:
    """The function compiled, or taken from the cache, as in a new process."""
    made = kept_between_runs(numba.njit(doubled))
    assert made(3.0) == 6.0
    return made


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_is_a_miss_and_is_put_right(folder: Path, suffix: str, damage: Callable[[bytes], bytes]) -> None:
    called()
    (path,) = folder.rglob(f"*{suffix}")
    path.write_bytes(damage(path.read_bytes()))
    assert sum(called().stats.cache_misses.values()) == 1
    assert sum(called().stats.cache_hits.values()) == 1


def test_a_full_disk_is_told_as_such(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: object, path: str) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(IndexDataCacheFile, "_open_for_write", full)
    with pytest.raises(StorageError, match=f"cannot keep compiled code in {folder}.*: No space left on device"):
        called()


def test_a_full_disk_below_a_law_is_told_as_such(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lawsource, "cache_folder", lambda: tmp_path)

    def full(source: object, target: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(StorageError, match="No space left on device"):
        lawsource.written("entry", "law = 1\n")
    assert list((tmp_path / "laws").iterdir()) == []


def test_a_generated_file_cut_short_is_written_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lawsource, "cache_folder", lambda: tmp_path)
    path = lawsource.written("entry", "law = 1\n")
    written = path.stat().st_mtime_ns
    assert lawsource.written("entry", "law = 1\n").stat().st_mtime_ns == written
    path.write_text("la")
    assert lawsource.written("entry", "law = 1\n").read_text() == "law = 1\n"


@pytest.fixture
def homeless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user whose cache folder cannot be made; the folder for temporary files."""
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.delenv(compilation.CACHE_VARIABLE, raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_the_folder_for_temporary_files_is_the_users_alone(homeless: Path) -> None:
    folder = compilation.cache_folder.__wrapped__()
    assert folder.parent == homeless / f"create-herd-{os.geteuid()}"
    assert folder.parent.stat().st_mode & 0o777 == folder.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("planted", ["open to all", "a link", "a file"])
def test_a_folder_that_others_may_write_is_not_used(
    homeless: Path, planted: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(compilation.CACHE_VARIABLE, "")  # is put back after the test
    trap = homeless / f"create-herd-{os.geteuid()}"
    elsewhere = homeless / "elsewhere"
    elsewhere.mkdir()
    if planted == "open to all":
        trap.mkdir()
        trap.chmod(0o777)
    elif planted == "a link":
        trap.symlink_to(elsewhere)
    else:
        trap.write_text("mine")
    folder = compilation.cache_folder.__wrapped__()
    assert not folder.is_relative_to(trap)
    assert not folder.resolve().is_relative_to(elsewhere)
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    assert compilation.cache_folder.__wrapped__() == folder  # as those do that this process starts


def test_a_named_folder_that_others_may_write_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(compilation.CACHE_VARIABLE, str(tmp_path))
    folder = compilation.cache_folder.__wrapped__()
    assert folder.parent == tmp_path
    folder.chmod(0o777)
    with pytest.raises(InputError, match="is not this user's alone"):
        compilation.cache_folder.__wrapped__()
