"""Numbers that are many: they are kept in files without a name until they are needed."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.errors import StorageError

IN_MEMORY_BYTES = 1_000_000
"""A column above this size goes to a file, so that a trial's memory does not grow with its length."""


class Column:
    """An array that grows block by block along its first axis."""

    def __init__(self, dtype: Any, shape: tuple[int, ...] = (), folder: Path | None = None) -> None:
        """`shape`: of one row. `folder`: where a file is; by default, where the system keeps temporary files."""
        self._dtype, self._shape, self._folder = np.dtype(dtype), shape, folder
        self._blocks: list[NDArray[Any]] = []
        self._waiting = self._rows = 0
        self._file: Any = None

    def append(self, block: Any) -> None:
        """Adds rows (K, …). Raises `StorageError` if the disk does not take them."""
        rows = np.asarray(block).astype(self._dtype).reshape(-1, *self._shape)
        self._blocks.append(rows)
        self._rows += len(rows)
        self._waiting += rows.nbytes
        if self._waiting > IN_MEMORY_BYTES:
            self._to_file()

    def whole(self) -> NDArray[Any]:
        """All rows; of a column in a file, that file mapped into memory: what is read can be dropped again."""
        if self._file is None:
            return np.concatenate([np.empty((0, *self._shape), self._dtype), *self._blocks])
        self._to_file()
        return np.memmap(self._file, self._dtype, mode="r+", shape=(self._rows, *self._shape)).view(np.ndarray)

    def _to_file(self) -> None:
        try:
            if self._file is None:
                self._file = tempfile.TemporaryFile(dir=self._folder)  # noqa: SIM115 (it is closed with this object)
            for rows in self._blocks:
                self._file.write(rows.tobytes())
            self._file.flush()
        except OSError as error:
            raise refused("a trial's rows", self._folder, error) from error
        self._blocks.clear()
        self._waiting = 0


class Rows:
    """(S, B) float32 numbers, added row by row, in a file without a name that goes with this object.

    Indexed by a row's number, a slice, row numbers or a mask, it reads these rows alone.
    """

    def __init__(self, width: int, folder: Path | None = None) -> None:
        """`width`: B. `folder`: where the file is; by default, where the system keeps temporary files."""
        self.width, self.count = width, 0
        self._folder = folder
        try:
            self._file = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115 (it is closed with this object)
        except OSError as error:
            raise refused("scans", self._folder, error) from error

    def append(self, row: NDArray[Any]) -> None:
        """Adds a row (B,). Raises `StorageError` if the disk does not take it."""
        try:
            self._file.write(row.astype(np.float32).tobytes())
        except OSError as error:
            raise refused("scans", self._folder, error) from error
        self.count += 1

    def __len__(self) -> int:
        return self.count

    @property
    def shape(self) -> tuple[int, int]:
        """(S, B)."""
        return self.count, self.width

    def __getitem__(self, which: Any) -> NDArray[np.float32]:
        rows = np.arange(self.count)[which]
        found = np.empty((rows.size, self.width), np.float32)
        try:
            self._file.flush()
            for at, row in enumerate(np.atleast_1d(rows)):
                self._file.seek(int(row) * 4 * self.width)
                self._file.readinto(memoryview(found[at]).cast("B"))
            self._file.seek(0, 2)
        except OSError as error:
            raise refused("scans", self._folder, error) from error
        return found.reshape((*rows.shape, self.width))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self[:].astype(dtype or np.float32)


def refused(what: str, folder: Path | None, error: OSError) -> StorageError:
    """The error for `what` that the disk of `folder` does not take."""
    return StorageError(f"cannot keep {what} below {folder or tempfile.gettempdir()}: {error.strerror or error}")
