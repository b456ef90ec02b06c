"""The folder of a sensitivity analysis: sensitivity.sqlite, which one process writes, a transaction a result.

    study    what was asked for, and what was settled once and for all (JSON values by name)
    trials   one row a trial as it ends, by stage and point
    points   one row a point as its last trial ends: where it lies, and for each claim its slack and its verdict

What is there is complete, whenever the analysis was stopped, and is not computed again.
"""

from __future__ import annotations

import json
import math
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from trials.batch.folders import reading, writing
from trials.batch.series import numbers, plain
from trials.batch.store import DIED, Row
from trials.sensitivity.quantity import Output
from trials.types import Trial

FILE = "sensitivity.sqlite"
FORMAT = 1
_TABLES = """
CREATE TABLE study (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE trials (
    stage TEXT NOT NULL, point INTEGER NOT NULL,
    idx INTEGER NOT NULL,        -- of the trial among those of its point
    status TEXT NOT NULL, reason TEXT NOT NULL,
    measures TEXT NOT NULL,      -- JSON object; null is nan
    seconds REAL NOT NULL,       -- wall time
    PRIMARY KEY (stage, point, idx)
);
CREATE TABLE points (
    stage TEXT NOT NULL, point INTEGER NOT NULL,
    place TEXT NOT NULL,         -- JSON list: of each choice, in its range scaled to [0, 1]
    outputs TEXT NOT NULL,       -- JSON list: of each claim its slack, null is nan, and its verdict
    PRIMARY KEY (stage, point)
);
"""


@dataclass(frozen=True)
class Ledger:
    """An open sensitivity.sqlite."""

    folder: Path
    connection: sqlite3.Connection

    def settled(self, name: str) -> Any:
        """A value that was settled; None if it was not."""
        with reading(self.folder / FILE):
            found = self.connection.execute("SELECT value FROM study WHERE name = ?", (name,)).fetchone()
            return None if found is None else json.loads(found[0])

    def settled_below(self, prefix: str) -> list[Any]:
        """All values that were settled under names with a prefix, in the order of their names."""
        with reading(self.folder / FILE):
            found = self.connection.execute(
                "SELECT value FROM study WHERE substr(name, 1, ?) = ? ORDER BY name", (len(prefix), prefix)
            ).fetchall()
            return [json.loads(value) for (value,) in found]

    def settle(self, name: str, value: Any) -> Any:
        """Keeps a value once and for all, and returns the one that is kept: the first."""
        with writing(self.folder / FILE), self.connection:
            self.connection.execute("INSERT OR IGNORE INTO study VALUES (?, ?)", (name, json.dumps(value)))
        return self.settled(name)

    def add_trial(self, stage: str, point: int, row: Row, seconds: float) -> None:
        """Keeps a finished trial; `row.index`: among those of its point."""
        values = (stage, point, row.index, row.status, row.reason, json.dumps(plain(row.measures)), seconds)
        with writing(self.folder / FILE), self.connection:
            self.connection.execute("INSERT OR REPLACE INTO trials VALUES (?, ?, ?, ?, ?, ?, ?)", values)

    def rows(self, stage: str, point: int, trials: Iterable[Trial]) -> dict[int, Row]:
        """By index, those of the trials of a point that have ended; not those whose worker died."""
        planned = {trial.index: trial for trial in trials}
        with reading(self.folder / FILE):
            found = self.connection.execute(
                "SELECT idx, status, reason, measures FROM trials WHERE stage = ? AND point = ? ORDER BY idx",
                (stage, point),
            ).fetchall()
        return {
            index: Row(
                index,
                status,
                reason,
                planned[index].seed,
                planned[index].repeat,
                dict(planned[index].conditions),
                numbers(json.loads(measures)),
            )
            for index, status, reason, measures in found
            if index in planned and not reason.startswith(DIED)
        }

    def seconds(self, stage: str) -> Floats:
        """(n,) wall time of the trials of a stage, s."""
        with reading(self.folder / FILE):
            found = self.connection.execute("SELECT seconds FROM trials WHERE stage = ?", (stage,)).fetchall()
        return np.array([each[0] for each in found])

    def add_points(self, stage: str, points: Mapping[int, tuple[Floats, Sequence[Output]]]) -> None:
        """Keeps points: where each lies (k,), and its outputs, in one transaction."""
        values = [
            (
                stage,
                number,
                json.dumps([float(x) for x in place]),
                json.dumps([[o.slack if math.isfinite(o.slack) else None, o.agrees] for o in outputs]),
            )
            for number, (place, outputs) in points.items()
        ]
        with writing(self.folder / FILE), self.connection:
            self.connection.executemany("INSERT OR REPLACE INTO points VALUES (?, ?, ?, ?)", values)

    def points(self, stage: str) -> dict[int, tuple[Floats, list[Output]]]:
        """By number, the points of a stage that have ended: where each lies (k,), and its outputs."""
        with reading(self.folder / FILE):
            found = self.connection.execute(
                "SELECT point, place, outputs FROM points WHERE stage = ? ORDER BY point", (stage,)
            ).fetchall()
        return {
            number: (
                np.array(json.loads(place), dtype=np.float64),
                [Output(math.nan if slack is None else slack, agrees) for slack, agrees in json.loads(outputs)],
            )
            for number, place, outputs in found
        }

    def close(self) -> None:
        """Closes the tables."""
        self.connection.close()


def opened(folder: Path, asked: Mapping[str, Any]) -> Ledger:
    """The ledger of a folder, begun there if there is none.

    Raises `InputError` where it was begun for something else than `asked`, names the first difference.
    """
    path = folder / FILE
    if not path.exists():
        others = sorted(each.name for each in folder.iterdir())
        if others:
            raise InputError(f"{folder} is not empty ({others[0]}): expected a new or empty folder, or one to go on in")
        with writing(path):
            connection = sqlite3.connect(path)
            connection.executescript(f"BEGIN; {_TABLES} PRAGMA user_version = {FORMAT}; COMMIT;")
    else:
        with reading(path):
            connection = sqlite3.connect(path)
            version = connection.execute("PRAGMA user_version").fetchone()[0]
        if version != FORMAT:
            raise InputError(f"{path} has format {version}: this version reads {FORMAT}")
    ledger = Ledger(folder, connection)
    begun = ledger.settle("asked", dict(asked))
    given = json.loads(json.dumps(dict(asked)))
    for name, value in given.items():
        if begun.get(name) != value:
            ledger.close()
            raise InputError(
                f"{folder} was begun with {name} {_short(begun.get(name))}, not {_short(value)}; "
                "expected the same command, or another folder"
            )
    return ledger


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
