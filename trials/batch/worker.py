"""What a worker process does: it runs a trial, writes its files, and hands back its row."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import signal
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from flocking.errors import StorageError, printable
from flocking.types import Ints
from trials import simulations
from trials.batch.folders import NO_FILES, Files, whole
from trials.simulations import watch
from trials.types import Trial

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "RAYON_NUM_THREADS": "1",
}
"""Environment in which each worker computes with one thread: the workers share the cores among themselves."""

_PR_SET_PDEATHSIG = 1
"""From linux/prctl.h."""


@dataclass(frozen=True)
class WorkerOutput:
    """One finished trial."""

    status: str
    """`done` or `failed`."""
    reason: str = ""
    measures: Mapping[str, float] = field(default_factory=dict)
    timing: Mapping[str, float] = field(default_factory=dict)
    """Wall time by part, s; `seconds` is that of the whole trial."""


Job = Callable[[dict[str, Any], str, Files], WorkerOutput]
"""(trial as a dict, scans, its files) → output; a module's function, so that workers can import it."""


def prepare(imports: Callable[[], None] | None, memory: Ints) -> None:
    """Prepares a worker before its first trial: shares its watch in `memory` and imports what trials need.

    From then on it ends at once at SIGTERM, and when its parent ends.
    """
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    watch.share(memory)
    end_with_parent()
    if imports is not None:
        try:
            imports()
        except Exception:  # the trial meets the same error, and reports it
            return


def end_with_parent() -> None:
    """Has this process ended at once when its parent ends, however that ends."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def imports_of(trials: Sequence[Trial]) -> Callable[[], None]:
    """The imports of a worker that is to run these trials."""
    return partial(import_for, sorted({trial.simulation for trial in trials}))


def import_for(names: Sequence[str]) -> None:
    """Imports all that trials of the simulations of these names need."""
    import trials.batch.series  # noqa: F401

    for name in names:
        simulations.named(name).prepare()


def attempt(run: Job, trial: dict[str, Any], scans: str, files: Files) -> WorkerOutput:
    """The output of `run`; an exception makes the trial a failed one. Raises only `StorageError`."""
    started = perf_counter()
    try:
        output = run(trial, scans, files)
    except StorageError:
        raise
    except BaseException as error:
        output = WorkerOutput("failed", told(error))
    return dataclasses.replace(output, timing={"seconds": perf_counter() - started, **output.timing})


def run_and_write(trial: dict[str, Any], scans: str, files: Files) -> WorkerOutput:
    """Runs a trial and writes its files.

    Raises what the trial raises, and `StorageError` if the disk does not take a file.
    """
    from trials.batch import series

    folder = files.recording.parent if files.recording is not None else None
    result = simulations.run_trial(Trial.from_dict(trial), scans=scans if folder else "none", folder=folder)
    ran = perf_counter()
    if files.series is not None:
        with whole(files.series) as path:
            series.write(result, path)
    kept = perf_counter()
    if files.recording is not None and len(result.times):
        with whole(files.recording) as path:
            simulations.record(result, path)
    timing = {**result.timing, "series_s": kept - ran, "recording_s": perf_counter() - kept}
    return WorkerOutput(result.outcome, one_line(result.reason), dict(result.measures), timing)


def warm_up(trial: dict[str, Any], run: Job) -> None:
    """Runs the first moment of a trial, so that its code is compiled. Errors are left to the trial itself."""
    complete = Trial.from_dict(trial)
    attempt(run, simulations.of(complete).moment(complete).as_dict(), "none", NO_FILES)


def told(error: BaseException) -> str:
    """An exception in one line: its type, its message, and where it arose."""
    last = traceback.extract_tb(error.__traceback__)[-1:]
    where = f" ({Path(last[0].filename).name}, line {last[0].lineno})" if last else ""
    words = one_line(str(error))
    return f"{type(error).__name__}{': ' if words else ''}{words}{where}"


def one_line(text: str) -> str:
    """`text` with every run of white space as one space, without what would act on a terminal, cut to a readable
    length."""
    text = printable(" ".join(text.split()))
    return text if len(text) <= 500 else f"{text[:497]}..."


def limit_s(trial: Trial) -> float:
    """Processor time (s) after which a trial counts as hung."""
    return simulations.of(trial).limit_s(trial)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
