"""Trials that need no physics, for tests of batches: what each does stands in its conditions, under `act`."""

from __future__ import annotations

import dataclasses
import io
import json
import math
import os
import signal
import sys
import time
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import StorageError
from trials.batch import series
from trials.batch.folders import Files, write_whole
from trials.batch.store import Row, Store
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


def packed(trial: Mapping[str, Any], data: bytes = b"") -> bytes:
    """What stands for the series of a trial: its head alone is real."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        head = {"format": series.FORMAT, "trial": trial}
        archive.writestr(zipfile.ZipInfo(series.HEAD), json.dumps(head))
        archive.writestr(zipfile.ZipInfo("data"), data)
    return out.getvalue()


def keep(
    kept: Store,
    row: Row,
    data: bytes | None = None,
    recording: bytes | None = None,
    timing: Mapping[str, float] | None = None,
) -> None:
    """Keeps a trial as a worker and its parent do: its files come first."""
    for path, content in zip(kept.files(row.index, True), (data, recording), strict=True):
        if content is not None:
            write_whole(path, content)
    kept.add(row, timing or {})


def run(trial: dict[str, Any], scans: str, files: Files) -> WorkerOutput:
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
    if act == "kill the parent":
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(3600)
    if act == "hang":
        time.sleep(3600)
    if act == "mark":
        Path(os.environ["FAKE_MARKED"]).touch()
    if act == "spin":
        _spin()
    if act == "spin watched":
        with watch.watched():
            while True:
                pass
    if act == "breathe":
        with watch.watched():
            for _ in range(8):
                _work(0.2)
                watch.breathe()
        _work(0.6)
    if act == "work":
        _work(600.0)
    if act == "half an answer":
        _half_an_answer()
    if act == "disk":
        raise StorageError("cannot write a recording below /tmp: No space left on device")
    if act == "nan":
        return WorkerOutput("failed", "the law returned nan", {"straightness": math.nan, "mmd": math.inf})
    rng = np.random.default_rng([trial["seed"], trial["repeat"], trial["index"]])
    if files.series is not None:
        write_whole(files.series, packed(trial, rng.bytes(1000)))
    if files.recording is not None:
        write_whole(files.recording, f"{scans} {trial['index']}".encode())
    return WorkerOutput(
        "done",
        measures={"mmd": float(rng.normal()), "groups": 1.0},
        timing={"seconds": seconds, "loop_s": 0.0},
    )


def refuse() -> None:
    """Imports that fail."""
    raise ImportError("no such module")


def die() -> None:
    """Imports that kill the worker."""
    os._exit(7)


def _work(seconds: float) -> None:
    """Uses processor time."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def _half_an_answer() -> None:
    """Begins to hand something back, and dies."""
    import gc
    from multiprocessing.connection import Connection

    (pipe,) = [each for each in gc.get_objects() if isinstance(each, Connection)]
    os.write(pipe.fileno(), (1000).to_bytes(4, "big") + b"not all of it")
    os.kill(os.getpid(), signal.SIGKILL)


def _spin() -> None:
    """A compiled loop that never ends and lets no Python run, so that no handler of a signal runs either."""
    import ctypes

    pause = ctypes.PyDLL(None).pause  # holds the interpreter's lock, as a long compiled call does
    Path(os.environ["FAKE_SPINNING"]).touch()
    while True:
        pause()
