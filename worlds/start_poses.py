"""Starting poses from a CSV file: one member a row, x_m, y_m and heading_deg in the world, with or without a header."""

from __future__ import annotations

import csv
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from flocking import found
from flocking.errors import InputError
from flocking.types import Floats
from generation.primitives import MOST_M

SUFFIX = ".csv"
COLUMNS = ("x_m", "y_m", "heading_deg")
MOST = 1_000_000
"""Most rows. A choice: as many as there can be members."""


class Parameters(NamedTuple):
    """Poses of your own, as FILE.csv: x_m, y_m, heading_deg, one member a row."""


def is_file(formation: str) -> bool:
    """Whether a formation's name is the path of a file of poses."""
    return formation.lower().endswith(SUFFIX)


def text_of(path: str) -> str:
    """The text of a file of poses, which travels with a trial, checked. Raises `InputError`."""
    text = found.read(path, "formation", "a CSV file")
    _parsed(text, path)
    return text


def poses(path: str, text: str, count: int) -> Floats:
    """(count, 3) x, y (m) and heading (rad) of a file's rows. Raises `InputError` for another number of them."""
    rows = _parsed(text or text_of(path), path)
    if len(rows) != count:
        raise InputError(f"{path} has {len(rows)} poses for {count} members; expected one a member")
    return rows.copy()


@lru_cache(maxsize=16)
def _parsed(text: str, path: str) -> Floats:
    try:
        rows = [(number, row) for number, row in enumerate(csv.reader(text.splitlines(), strict=True), 1) if any(row)]
    except csv.Error as error:
        raise InputError(f"{path} is no CSV: {error}; expected {', '.join(COLUMNS)} in each row") from None
    if rows and [cell.strip().lstrip("\ufeff") for cell in rows[0][1]] == list(COLUMNS):
        rows = rows[1:]
    if not 0 < len(rows) <= MOST:
        raise InputError(f"{path} has {len(rows)} poses: expected 1 to {MOST} rows of {', '.join(COLUMNS)}")
    made = np.array([_row(row, f"{path}, line {number}") for number, row in rows])
    _, first, times = np.unique(made[:, :2], axis=0, return_index=True, return_counts=True)
    if (times > 1).any():
        x, y = made[first[times > 1][0], :2]
        raise InputError(f"{path}: two members start at ({x:g}, {y:g}) m; expected places that are apart")
    made[:, 2] = np.radians(made[:, 2])
    return made


def _row(row: list[str], where: str) -> list[float]:
    try:
        numbers = [float(cell) for cell in row]
    except ValueError:
        numbers = []
    if len(numbers) != len(COLUMNS) or not all(math.isfinite(n) and abs(n) <= MOST_M for n in numbers):
        told = ",".join(row)
        told = told if len(told) <= 60 else f"{told[:57]}..."
        raise InputError(f"{where}: {told!r}: expected {', '.join(COLUMNS)}, three finite numbers")
    return numbers
