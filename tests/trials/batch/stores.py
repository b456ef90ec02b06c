"""A run's folder of three made-up trials. For the tests of the store."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from flocking.errors import InputError
from trials.batch import runfile, store
from trials.batch.store import Row, Store

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials

TRIALS = [fake_trials.trial(k) for k in (1, 2, 3)]


def new(folder: Path) -> Store:
    run = {"format": runfile.FORMAT, "experiment": "fake", "seed": 1, "trials": [trial.as_dict() for trial in TRIALS]}
    return store.create(folder, run, {"mine.py": "law = 1\n"})


def row(index: int, **measures: float) -> Row:
    trial = TRIALS[index - 1]
    return Row(index, "done", "", trial.seed, trial.repeat, dict(trial.conditions), measures)


def series_of(index: int) -> bytes:
    return fake_trials.packed(TRIALS[index - 1].as_dict())


def refused(folder: Path, words: str) -> None:
    """Opening fails in one line and changes no byte of what is there."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=words) as caught:
        store.opened(folder)
    assert "\n" not in str(caught.value)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
