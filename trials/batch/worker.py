"""What a worker process does: it runs a trial and hands back its row, and its files as bytes. It writes no files."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from trials import simulations
from trials.batch.store import StorageError
from trials.simulations import watch
from trials.types import Trial, TrialResult

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
    series: bytes | None = None
    recording: bytes | None = None
    timing: Mapping[str, float] = field(default_factory=dict)
    """Wall time by part, s; `seconds` is that of the whole trial."""


Job = Callable[[dict[str, Any], str, bool], WorkerOutput]
"""(trial as a dict, scans, whether to record) → output; a module's function, so that workers can import it."""


def prepare(imports: Callable[[], None] | None, law_limit_s: float, turns: Path) -> None:
    """Prepares a worker before its first trial: arms its watch and imports what trials need.

    From then on it ends at once at SIGTERM, when its parent ends, and when a law does not return within `law_limit_s`.
    In a file of the folder `turns` it notes the member at work.
    """
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    watch.arm(law_limit_s, turns)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if imports is not None:
        try:
            imports()
        except Exception:  # the trial meets the same error, and reports it
            return


def imports_of(trials: Sequence[Trial]) -> Callable[[], None]:
    """The imports of a worker that is to run these trials."""
    return partial(import_for, sorted({trial.simulation for trial in trials}))


def import_for(names: Sequence[str]) -> None:
    """Imports all that trials of the simulations of these names need."""
    import trials.batch.series  # noqa: F401

    for name in names:
        simulations.named(name).prepare()


def attempt(run: Job, trial: dict[str, Any], scans: str, record: bool) -> WorkerOutput:
    """The output of `run`; an exception makes the trial a failed one. Raises only `StorageError`."""
    started = perf_counter()
    try:
        output = run(trial, scans, record)
    except StorageError:
        raise
    except BaseException as error:
        output = WorkerOutput("failed", told(error))
    return dataclasses.replace(output, timing={"seconds": perf_counter() - started, **output.timing})


def run_packed(trial: dict[str, Any], scans: str, record: bool) -> WorkerOutput:
    """Runs a trial and packs its result.

    Raises what the trial raises, and `StorageError` if the temporary folder does not take its recording.
    """
    from trials.batch import series

    result = simulations.run_trial(Trial.from_dict(trial), scans=scans if record else "none")
    ran = perf_counter()
    packed = series.pack(result)
    kept = perf_counter()
    recording = _recorded(result) if record and len(result.times) else None
    timing = {**result.timing, "series_s": kept - ran, "recording_s": perf_counter() - kept}
    return WorkerOutput(result.outcome, one_line(result.reason), dict(result.measures), packed, recording, timing)


def warm_up(trial: dict[str, Any], run: Job) -> None:
    """Runs the first moment of a trial, so that its code is compiled. Errors are left to the trial itself."""
    whole = Trial.from_dict(trial)
    attempt(run, simulations.of(whole).moment(whole).as_dict(), "none", False)


def told(error: BaseException) -> str:
    """An exception in one line: its type, its message, and where it arose."""
    last = traceback.extract_tb(error.__traceback__)[-1:]
    where = f" ({Path(last[0].filename).name}, line {last[0].lineno})" if last else ""
    words = one_line(str(error))
    return f"{type(error).__name__}{': ' if words else ''}{words}{where}"


def one_line(text: str) -> str:
    """`text` with every run of white space as one space, cut to a readable length."""
    text = " ".join(text.split())
    return text if len(text) <= 500 else f"{text[:497]}..."


def _recorded(result: TrialResult) -> bytes:
    from trials.simulations import record

    try:
        with tempfile.TemporaryDirectory(prefix="herd-") as folder:
            path = Path(folder) / "trial.rrd"
            record(result, path)
            return path.read_bytes()
    except OSError as error:
        raise StorageError(
            f"cannot write a recording below {tempfile.gettempdir()}: {error.strerror or error}"
        ) from error


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    return simulations.of(trial).limit_s(trial)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
