"""Trials that need no physics, for tests of batches: what each does stands in its conditions, under `act`."""

from __future__ import annotations

import dataclasses
import math
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from trials.batch.store import StorageError
from trials.batch.worker import WorkerOutput
from trials.simulations import watch
from trials.simulations.robots import fields
from trials.types import Trial


def trial(index: int, act: str = "succeed", seconds: float = 0.0, seed: int = 1) -> Trial:
    """A trial that does as told."""
    base = fields.trial("fake", 1 + index % 3, [fields.group(count=1)], duration_s=1.0)
    return dataclasses.replace(
        base,
        index=index,
        seed=seed,
        conditions={"act": act, "seconds": seconds},
    )


def run(trial: dict[str, Any], scans: str, record: bool) -> WorkerOutput:
    """Does what the trial's conditions say."""
    act, seconds = trial["conditions"]["act"], trial["conditions"]["seconds"]
    time.sleep(seconds)
    if act == "raise":
        raise ValueError("no such luck\nin two lines")
    if act == "exit":
        os._exit(3)
    if act == "sys.exit":
        sys.exit("the law wants out")
    if act == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if act == "hang":
        time.sleep(3600)
    if act == "mark":
        Path(os.environ["FAKE_MARKED"]).touch()
    if act == "spin":
        _spin()
    if act == "spin watched":
        with watch.watched():
            _spin()
    if act == "breathe":
        with watch.watched():
            for _ in range(8):
                time.sleep(0.1)
                watch.breathe()
        time.sleep(0.5)
    if act == "disk":
        raise StorageError("cannot write a recording below /tmp: No space left on device")
    if act == "nan":
        return WorkerOutput("failed", "the law returned nan", {"straightness": math.nan, "mmd": math.inf})
    rng = np.random.default_rng([trial["seed"], trial["repeat"], trial["index"]])
    recording = f"{scans} {trial['index']}".encode() if record else None
    return WorkerOutput(
        "done",
        measures={"mmd": float(rng.normal()), "groups": 1.0},
        series=rng.bytes(1000),
        recording=recording,
        timing={"seconds": seconds, "loop_s": 0.0},
    )


def refuse() -> None:
    """Imports that fail."""
    raise ImportError("no such module")


def die() -> None:
    """Imports that kill the worker."""
    os._exit(7)


def _spin() -> None:
    """A compiled loop that never ends and lets no Python run, so that no handler of a signal runs either."""
    import ctypes

    pause = ctypes.PyDLL(None).pause  # holds the interpreter's lock, as a long compiled call does
    Path(os.environ["FAKE_SPINNING"]).touch()
    while True:
        pause()
