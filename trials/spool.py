"""Rows of numbers that are many: they are kept in a file until they are needed."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.errors import StorageError


class Rows:
    """(S, B) float32 numbers, added row by row, in a file without a name that goes with this object.

    Indexed by a row's number, a slice, row numbers or a mask, it reads these rows alone.
    """

    def __init__(self, width: int, folder: Path | None = None) -> None:
        """`width`: B. `folder`: where the file is; by default, where the system keeps temporary files."""
        self.width, self.count = width, 0
        self._where = str(folder or tempfile.gettempdir())
        try:
            self._file = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115 (it is closed with this object)
        except OSError as error:
            raise self._refused(error) from error

    def append(self, row: NDArray[Any]) -> None:
        """Adds a row (B,). Raises `StorageError` if the disk does not take it."""
        try:
            self._file.write(row.astype(np.float32).tobytes())
        except OSError as error:
            raise self._refused(error) from error
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
            raise self._refused(error) from error
        return found.reshape((*rows.shape, self.width))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self[:].astype(dtype or np.float32)

    def _refused(self, error: OSError) -> StorageError:
        return StorageError(f"cannot keep scans below {self._where}: {error.strerror or error}")
