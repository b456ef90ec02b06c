"""Many trials on all cores: each is kept in the run's folder as it ends, whether or not others fail.

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
"""How often in a row all workers may die before one trial has ended."""
Events = queue.SimpleQueue[Future[WorkerOutput] | int]
"""What the batch waits for: a trial that ended, or the number of a signal that stops the batch."""
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that stop a batch."""


class Progress(Protocol):
    """What shows the progress of a batch."""

    def say(self, text: str) -> None:
        """Shows what the batch is doing before its first trial."""

    def ended(self, row: Row) -> None:
        """Counts one more trial that was kept."""


@dataclass(frozen=True)
class Work:
    """What workers do with each trial of a batch, and how long that may take."""

    run: Job = worker.run_packed
    scans: str = "some"
    """`some` or `all`: which scans of a trial go into its recording."""
    recorded: frozenset[int] = frozenset()
    """Indices of the trials to record."""
    imports: Callable[[], None] | None = None
    """Called in each worker before its first trial."""
    warm_up: Sequence[Trial] = ()
    """Trials of which the first moment is run beforehand, one after the other, so that workers do not all compile the
    same code, and none does while a trial's time counts."""
    limit_s: Callable[[Trial], float] = worker.limit_s
    """Wall time that a trial may take."""
    law_limit_s: float = watch.STEP_LIMIT_S
    """Wall time within which a law must return."""


@dataclass(frozen=True)
class Summary:
    """What a batch did."""

    rows: list[Row]
    """The trials that it kept, in the order in which they ended."""
    stopped: int = 0
    """The signal that stopped it; 0 = none."""


class _Stopped(Exception):  # noqa: N818 (no error)
    """The batch was stopped by a signal, whose number is the argument."""


def run_batch(
    trials: Sequence[Trial],
    store: Store,
    progress: Progress,
    *,
    jobs: int,
    work: Work,
) -> Summary:
    """Runs the trials in `jobs` worker processes and keeps each in the store as it ends.

    A trial that fails or takes too long, whose law does not return or whose worker dies is kept as failed, with its
    reason. SIGINT, SIGTERM and SIGHUP stop the batch; trials that ended before are kept. Raises `StorageError` if the
    disk does not take a result.
    """
    waiting, rows, breaks = deque(trials), list[Row](), 0
    ended: Events = queue.SimpleQueue()
    jobs = max(1, min(jobs, len(waiting)))

    def submit(pool: ProcessPool, trial: Trial) -> Future[WorkerOutput]:
        args = (work.run, trial.as_dict(), work.scans, trial.index in work.recorded)
        return pool.schedule(worker.attempt, args=args, timeout=work.limit_s(trial))

    with _environment(worker.ONE_THREAD), _signals(ended.put), _folder() as turns:
        while waiting:
            before = len(rows)
            try:
                with _pool(jobs, work, turns) as pool:
                    if work.warm_up and not rows:
                        progress.say("compiling, where this machine has not yet")
                        _warm_up(pool, work, ended)
                    for trial, future in _ended(pool, waiting, ended, submit, AHEAD * jobs):
                        rows.append(_keep(store, trial, _output(future, trial, work.law_limit_s, turns)))
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
    ended: Events,
    submit: Callable[[ProcessPool, Trial], Future[WorkerOutput]],
    ahead: int,
) -> Iterator[tuple[Trial, Future[WorkerOutput]]]:
    """Hands the waiting trials to the pool, at most `ahead` at a time, and yields each as it ends.

    If a signal or a broken pool interrupts it, the trials that have not ended are put back at the front of `waiting`.
    """
    in_pool: dict[Future[WorkerOutput], Trial] = {}
    broken: Exception | None = None
    try:
        while waiting or in_pool:
            while waiting and len(in_pool) < ahead and broken is None:
                try:
                    future = submit(pool, waiting[0])
                except RuntimeError as error:  # the pool broke after the last trial was handed to it
                    broken = error
                    break
                in_pool[future] = waiting.popleft()
                future.add_done_callback(ended.put)
            if broken is not None and ended.empty():
                raise BrokenProcessPool(str(broken))
            event = ended.get()
            if isinstance(event, int):
                raise _Stopped(event)
            if event not in in_pool:  # a trial of an earlier pool, which broke
                continue
            if isinstance(event.exception(), BrokenProcessPool):
                broken = event.exception()  # type: ignore[assignment]
                continue
            yield in_pool.pop(event), event
    finally:
        waiting.extendleft(reversed(in_pool.values()))


def _output(future: Future[WorkerOutput], trial: Trial, law_limit_s: float, turns: Path) -> WorkerOutput:
    """What a worker handed back; if it handed back nothing, a failed trial with the reason."""
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
    """The reason of a trial whose law did not return, with the member and the step where these are known."""
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


def _warm_up(pool: ProcessPool, work: Work, ended: Events) -> None:
    """Runs the first moment of each trial of the warm-up. Errors are left to the trials themselves."""
    for trial in work.warm_up:
        try:
            future = pool.schedule(worker.warm_up, args=(trial.as_dict(), work.run), timeout=WARM_UP_LIMIT_S)
        except RuntimeError:  # the pool broke; handing out the trials fails in the same way
            return
        future.add_done_callback(ended.put)
        event = ended.get()
        if isinstance(event, int):
            raise _Stopped(event)


@contextmanager
def _folder() -> Iterator[Path]:
    """A temporary folder for the files in which workers note the member at work. Raises `StorageError` without one."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="herd-", ignore_cleanup_errors=True)
    except OSError as error:
        raise StorageError(f"cannot write below {tempfile.gettempdir()}: {error.strerror or error}") from error
    with folder as path:
        yield Path(path)


@contextmanager
def _pool(jobs: int, work: Work, turns: Path) -> Iterator[ProcessPool]:
    pool = ProcessPool(
        jobs,
        initializer=worker.prepare,
        initargs=(work.imports, work.law_limit_s, turns),
        context=multiprocessing.get_context("spawn"),
    )
    # Ctrl-C in a terminal sends its signal to all processes, and only this one is to react: workers inherit a mask that
    # blocks it. The resource tracker is started before, since its start unblocks SIGINT.
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
    """Hands the signals that stop a batch to `tell`. Does nothing outside the main thread, which alone gets them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heeded = [
        number for number in STOPPING if signal.getsignal(number) != signal.SIG_IGN
    ]  # SIGHUP is ignored under nohup
    before = {number: signal.signal(number, lambda got, frame: tell(got)) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Sets environment variables for the processes that are started within it."""
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
