"""Rows in a file read back as the array that they would be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flocking.errors import StorageError
from trials.spool import Column, Rows


def test_rows_are_read_as_from_an_array(tmp_path: Path) -> None:
    table = np.random.default_rng(1).normal(size=(50, 7)).astype(np.float32)
    table[3, 2] = np.nan
    rows = Rows(7, tmp_path)
    for row in table[:20]:
        rows.append(row.astype(np.float64))
    np.testing.assert_array_equal(rows[:], table[:20])
    for row in table[20:]:  # what is read in between moves nothing
        rows.append(row)
    assert len(rows) == 50
    assert rows.shape == (50, 7)
    mask = np.arange(50) % 3 == 0
    for which in (mask, np.array([4, 4, 1]), slice(3, 9), slice(None, None, -7), np.array([], dtype=int)):
        np.testing.assert_array_equal(rows[which], table[which])
    np.testing.assert_array_equal(rows[-1], table[-1])
    np.testing.assert_array_equal(np.asarray(rows), table)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_takes_no_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="cannot keep scans below"):
        Rows(7, tmp_path / "nowhere")


def test_a_full_disk_is_told() -> None:
    rows = Rows(1000)
    with open("/dev/full", "r+b", buffering=0) as full:
        rows._file = full
        with pytest.raises(StorageError, match="No space left on device"):
            rows.append(np.zeros(1000))


def test_a_column_is_the_same_in_memory_and_in_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = [np.random.default_rng(seed).normal(size=(seed, 3)) for seed in (5, 1, 0, 7)]
    for limit in (10**9, 100, 0):
        monkeypatch.setattr("trials.spool.IN_MEMORY_BYTES", limit)
        column = Column(np.float32, (3,), tmp_path)
        for block in blocks:
            column.append(block)
        whole = column.whole()
        del column
        assert type(whole) is np.ndarray
        assert whole.dtype == np.float32
        np.testing.assert_array_equal(whole, np.concatenate(blocks).astype(np.float32))
        whole[0] = 1.0  # an array like any other: it can be written to
        assert list(tmp_path.iterdir()) == []


def test_an_empty_column_has_its_shape() -> None:
    assert Column(np.int8, (4, 2)).whole().shape == (0, 4, 2)


def test_a_column_says_that_the_disk_is_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trials.spool.IN_MEMORY_BYTES", 0)
    with pytest.raises(StorageError, match="cannot keep a trial's rows below"):
        Column(np.float64, (), tmp_path / "nowhere").append([1.0])
