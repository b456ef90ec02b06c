"""Many trials on all cores: each is kept as it ends, whatever becomes of the others.

Results depend on the trials alone, not on the number of workers nor on the order in which they end.
"""

from __future__ import annotations

import multiprocessing
import os
import queue
import signal
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Protocol

from pebble import ProcessExpired, ProcessPool

from flocking.errors import InputError
from trials import simulations
from trials.batch import worker
from trials.batch.store import DIED, Row, StorageError, Store
from trials.batch.worker import Job, WorkerOutput
from trials.simulations import watch
from trials.types import Group, Trial

AHEAD = 2
"""Trials handed out per worker: one at work, one waiting, so that results do not pile up in memory."""
WARM_UP_LIMIT_S = 300.0
"""Wall time for filling the compiled cache, for each set of code."""
BREAKS = 3
"""How often in a row the workers may all die before one trial has ended."""
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Progress(Protocol):
    """Who is told how a batch goes on."""

    def say(self, text: str) -> None:
        """What the batch is at, before its first trial."""

    def ended(self, row: Row) -> None:
        """One more trial is kept."""


@dataclass(frozen=True)
class Summary:
    """What became of a batch."""

    rows: list[Row]
    """The trials that it kept, in the order in which they ended."""
    stopped: int = 0
    """The signal that stopped it; 0 = none."""


class _Stopped(Exception):  # noqa: N818 (no error)
    """A signal asks the batch to stop."""


def run_batch(
    trials: Sequence[Trial],
    store: Store,
    progress: Progress,
    *,
    jobs: int,
    scans: str = "some",
    recorded: frozenset[int] = frozenset(),
    run: Job = worker.run_packed,
    imports: Callable[[], None] | None = None,
    warm_up: Sequence[Trial] = (),
    limit_s: Callable[[Trial], float] = worker.limit_s,
    law_limit_s: float = watch.STEP_LIMIT_S,
) -> Summary:
    """Runs the trials in `jobs` worker processes and keeps each in the store as it ends.

    `recorded` holds the indices of the trials to record, with `scans` some or all; `warm_up` the trials of which
    first a moment is run, one after the other, so that not all workers compile the same code, and none while a
    trial's time counts. A trial that fails, lasts longer than `limit_s`, whose law does not return within
    `law_limit_s` or whose worker dies is kept as failed with its reason. SIGINT, SIGTERM and SIGHUP stop
    the batch: what has ended is kept. Raises `StorageError` if the disk does not take a result.
    """
    waiting, rows, breaks = deque(trials), list[Row](), 0
    ended: queue.SimpleQueue[Future[WorkerOutput] | int] = queue.SimpleQueue()
    jobs = max(1, min(jobs, len(waiting)))

    def submit(pool: ProcessPool, trial: Trial) -> Future[WorkerOutput]:
        args = (run, trial.as_dict(), scans, trial.index in recorded)
        return pool.schedule(worker.attempt, args=args, timeout=limit_s(trial))

    with _environment(worker.ONE_THREAD), _signals(ended.put), _folder() as turns:
        prepared = (imports, law_limit_s, turns)
        while waiting:
            before = len(rows)
            try:
                with _pool(jobs, prepared) as pool:
                    if warm_up and not rows:
                        progress.say("compiling, where this machine has not yet")
                        _warm_up(pool, warm_up, run, ended)
                    for trial, future in _ended(pool, waiting, ended, submit, AHEAD * jobs):
                        rows.append(_keep(store, trial, _output(future, trial, law_limit_s, turns)))
                        progress.ended(rows[-1])
            except _Stopped as stop:
                return Summary(rows, stop.args[0])
            except BrokenProcessPool as error:
                breaks = 1 if len(rows) > before else breaks + 1
                if breaks == BREAKS:
                    raise InputError(f"worker processes die before they run a trial: {error}") from error
    return Summary(rows)


def _ended(
    pool: ProcessPool,
    waiting: deque[Trial],
    ended: queue.SimpleQueue[Future[WorkerOutput] | int],
    submit: Callable[[ProcessPool, Trial], Future[WorkerOutput]],
    ahead: int,
) -> Iterator[tuple[Trial, Future[WorkerOutput]]]:
    """Hands out what waits, at most `ahead` trials at a time, and yields each as it ends.

    Trials that did not end are waiting again when a signal or broken workers put an end to it.
    """
    flying: dict[Future[WorkerOutput], Trial] = {}
    broken: Exception | None = None
    try:
        while waiting or flying:
            while waiting and len(flying) < ahead and broken is None:
                try:
                    future = submit(pool, waiting[0])
                except RuntimeError as error:  # the pool broke since
                    broken = error
                    break
                flying[future] = waiting.popleft()
                future.add_done_callback(ended.put)
            if broken is not None and ended.empty():
                raise BrokenProcessPool(str(broken))
            event = ended.get()
            if isinstance(event, int):
                raise _Stopped(event)
            if event not in flying:  # of a pool that broke
                continue
            if isinstance(event.exception(), BrokenProcessPool):
                broken = event.exception()  # type: ignore[assignment]
                continue
            yield flying.pop(event), event
    finally:
        waiting.extendleft(reversed(flying.values()))


def _output(future: Future[WorkerOutput], trial: Trial, law_limit_s: float, turns: Path) -> WorkerOutput:
    """What a worker handed back, or a failed trial that says what became of it."""
    error = future.exception()
    if error is None:
        return future.result()
    if isinstance(error, StorageError):
        raise error
    if isinstance(error, TimeoutError):
        slow = f"did not end within {error.args[1]:g} s of wall time; {_laws(trial.groups)} is slow"
        return WorkerOutput("failed", slow)
    if isinstance(error, ProcessExpired):
        code = error.exitcode
        if code == -signal.SIGALRM:
            return WorkerOutput("failed", _hung(trial, law_limit_s, watch.whose(turns, error.pid)))
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return WorkerOutput("failed", f"{DIED} ({how})")
    return WorkerOutput("failed", worker.told(error))


def _hung(trial: Trial, law_limit_s: float, turn: tuple[int, int] | None) -> str:
    """That a law did not return, and whose and when if that is known."""
    late = f"did not return within {law_limit_s:g} s of wall time"
    if turn is None:
        return f"{_laws(trial.groups)} {late}"
    step, member = turn
    group, number = [(group, k + 1) for group in trial.groups for k in range(group.count)][member]
    return f"{_laws([group])} {late} for {group.name}-{number} {simulations.of(trial).at_step(trial, step)}"


def _laws(groups: Sequence[Group]) -> str:
    return "law " + " or ".join(dict.fromkeys(repr(group.law) for group in groups))


def _keep(store: Store, trial: Trial, output: WorkerOutput) -> Row:
    row = Row(
        trial.index,
        output.status,
        output.reason,
        trial.seed,
        trial.repeat,
        dict(trial.conditions),
        dict(output.measures),
    )
    store.add(row, output.series, output.recording, output.timing)
    return row


def _warm_up(
    pool: ProcessPool,
    trials: Sequence[Trial],
    run: Job,
    ended: queue.SimpleQueue[Future[WorkerOutput] | int],
) -> None:
    """Runs a moment of each; whatever becomes of it, the trial itself will tell."""
    for trial in trials:
        try:
            future = pool.schedule(worker.warm_up, args=(trial.as_dict(), run), timeout=WARM_UP_LIMIT_S)
        except RuntimeError:  # the pool broke, as handing out the trials will find
            return
        future.add_done_callback(ended.put)
        event = ended.get()
        if isinstance(event, int):
            raise _Stopped(event)


@contextmanager
def _folder() -> Iterator[Path]:
    """A temporary folder in which workers keep whose turn it is. Raises `StorageError` if there can be none."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="herd-", ignore_cleanup_errors=True)
    except OSError as error:
        raise StorageError(f"cannot write below {tempfile.gettempdir()}: {error.strerror or error}") from error
    with folder as path:
        yield Path(path)


@contextmanager
def _pool(jobs: int, prepared: tuple[Callable[[], None] | None, float, Path]) -> Iterator[ProcessPool]:
    pool = ProcessPool(
        jobs,
        initializer=worker.prepare,
        initargs=prepared,
        context=multiprocessing.get_context("spawn"),
    )
    # Ctrl-C in a terminal goes to all processes: only this one shall hear it. A mask is handed on to workers.
    # The tracker first, since its start unblocks SIGINT.
    resource_tracker.ensure_running()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP))
    try:
        assert pool.active  # starts the workers
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    try:
        yield pool
    finally:
        pool.stop()
        pool.join()


@contextmanager
def _signals(tell: Callable[[int], None]) -> Iterator[None]:
    """Hands the signals that stop a batch to `tell`; only the main thread can."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heeded = [number for number in STOPPING if signal.getsignal(number) != signal.SIG_IGN]  # as under nohup
    before = {number: signal.signal(number, lambda got, frame: tell(got)) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Environment variables for the processes that are started meanwhile."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
