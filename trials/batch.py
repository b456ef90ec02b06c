"""Many trials on all cores: each is kept as it ends, whatever becomes of the others.

Results depend on the trials alone, not on the number of workers nor on the order in which they end.
"""

from __future__ import annotations

import multiprocessing
import os
import queue
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import Protocol

from pebble import ProcessExpired, ProcessPool

from flocking.errors import InputError
from trials import watch, worker
from trials.store import DIED, Row, StorageError, Store
from trials.types import Trial
from trials.worker import Job, WorkerOutput

AHEAD = 2
"""Trials handed out per worker: one at work, one waiting, so that results do not pile up in memory."""
WARM_UP_LIMIT_S = 300.0
"""Wall time for filling the compiled cache."""
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
    imports: Callable[[], None] | None = worker.imports,
    warm_up: Sequence[Trial] = (),
    limit_s: Callable[[Trial], float] = worker.limit_s,
) -> Summary:
    """Runs the trials in `jobs` worker processes and keeps each in the store as it ends.

    `recorded` holds the indices of the trials to record, with `scans` some or all; `warm_up` the trials of which
    one worker first runs a moment, so that not all of them compile the same code. A trial that fails, lasts
    longer than `limit_s` or whose worker dies is kept as failed with its reason. SIGINT, SIGTERM and SIGHUP stop
    the batch: what has ended is kept. Raises `StorageError` if the disk does not take a result.
    """
    waiting, rows, breaks = deque(trials), list[Row](), 0
    ended: queue.SimpleQueue[Future[WorkerOutput] | int] = queue.SimpleQueue()
    jobs = max(1, min(jobs, len(waiting)))

    def submit(pool: ProcessPool, trial: Trial) -> Future[WorkerOutput]:
        args = (run, trial.as_dict(), scans, trial.index in recorded)
        return pool.schedule(worker.attempt, args=args, timeout=limit_s(trial))

    with _environment(worker.ONE_THREAD), _signals(ended.put):
        while waiting:
            before = len(rows)
            try:
                with _pool(jobs, imports) as pool:
                    if warm_up and jobs > 1 and not rows:
                        progress.say("compiling, where this machine has not yet")
                        _warm_up(pool, warm_up, run, ended)
                    for trial, output in _outputs(pool, waiting, ended, submit, AHEAD * jobs):
                        rows.append(_keep(store, trial, output))
                        progress.ended(rows[-1])
            except _Stopped as stop:
                return Summary(rows, stop.args[0])
            except BrokenProcessPool as error:
                breaks = 1 if len(rows) > before else breaks + 1
                if breaks == BREAKS:
                    raise InputError(f"worker processes die before they run a trial: {error}") from error
    return Summary(rows)


def _outputs(
    pool: ProcessPool,
    waiting: deque[Trial],
    ended: queue.SimpleQueue[Future[WorkerOutput] | int],
    submit: Callable[[ProcessPool, Trial], Future[WorkerOutput]],
    ahead: int,
) -> Iterator[tuple[Trial, WorkerOutput]]:
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
            trial = flying.pop(event)
            yield trial, _output(event, trial)
    finally:
        waiting.extendleft(reversed(flying.values()))


def _output(future: Future[WorkerOutput], trial: Trial) -> WorkerOutput:
    """What a worker handed back, or a failed trial that says what became of it."""
    error = future.exception()
    if error is None:
        return future.result()
    if isinstance(error, StorageError):
        raise error
    if isinstance(error, TimeoutError):
        return WorkerOutput("failed", f"did not end within {error.args[1]:g} s of wall time; {_laws(trial)} is slow")
    if isinstance(error, ProcessExpired):
        code = error.exitcode
        if code == -signal.SIGALRM:
            return WorkerOutput("failed", f"{_laws(trial)} did not return within {watch.STEP_LIMIT_S:g} s of wall time")
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return WorkerOutput("failed", f"{DIED} ({how})")
    return WorkerOutput("failed", worker.told(error))


def _laws(trial: Trial) -> str:
    return "law " + " or ".join(dict.fromkeys(repr(group.law) for group in trial.groups))


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
    args = ([trial.as_dict() for trial in trials], run)
    future = pool.schedule(worker.warm_up, args=args, timeout=WARM_UP_LIMIT_S)
    future.add_done_callback(ended.put)
    event = ended.get()
    if isinstance(event, int):
        raise _Stopped(event)


@contextmanager
def _pool(jobs: int, imports: Callable[[], None] | None) -> Iterator[ProcessPool]:
    pool = ProcessPool(
        jobs,
        initializer=worker.prepare,
        initargs=(imports,),
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
