"""Many trials on all cores: each is kept in the run's folder as it ends, whether or not others fail.

Results depend on the trials alone, not on the number of workers nor on the order in which they end.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from flocking.errors import StorageError
from trials import simulations
from trials.batch import worker
from trials.batch.crew import LAW, SLOW, WAITS, Crew, Ended, Stopped, Task, crew
from trials.batch.kinds import kind_of
from trials.batch.patience import STILL_S
from trials.batch.runfile import digest
from trials.batch.store import DIED, Row, Store
from trials.batch.worker import Job, WorkerOutput
from trials.invoked import command
from trials.simulations import watch
from trials.types import Group, Trial

if TYPE_CHECKING:
    from trials.batch.cluster import Cluster
    from trials.batch.hands import Hands

WARM_UP_LIMIT_S = 300.0
"""Processor time for filling the compiled cache, for each set of code."""
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that stop a batch."""


class Progress(Protocol):
    """What shows the progress of a batch."""

    def say(self, text: str) -> None:
        """Shows what the batch is doing before its first trial."""

    def ended(self, row: Row) -> None:
        """Counts one more trial that was kept."""

    def goes_on(self, text: str, count: int) -> None:
        """Shows a line on what came out so far, and that there are to be `count` trials in all."""


@dataclass(frozen=True)
class Work:
    """What workers do with each trial of a batch, and how long that may take."""

    run: Job = worker.run_and_write
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
    """Processor time that a trial may take."""
    law_limit_s: float = watch.STEP_LIMIT_S
    """Processor time within which a law must return."""
    more: Callable[[], Sequence[Trial]] | None = None
    """Called when all trials have ended: those to run then, until there are none."""
    still_s: float = STILL_S
    """Wall time that a trial may wait without using any processor time."""


@dataclass(frozen=True)
class Summary:
    """What a batch did."""

    rows: list[Row]
    """The trials that it kept, in the order in which they ended."""
    stopped: int = 0
    """The signal that stopped it; 0 = none."""


def run_batch(
    trials: Sequence[Trial],
    store: Store,
    progress: Progress,
    *,
    jobs: int,
    work: Work,
    cluster: Cluster | None = None,
) -> Summary:
    """Runs the trials in `jobs` worker processes, or on a cluster, and keeps each in the store as it ends.

    A trial that fails or takes too long, whose law does not return or whose worker dies is kept as failed, with its
    reason; the others are not affected. SIGINT, SIGTERM and SIGHUP stop the batch; trials that ended before are kept.
    Raises `StorageError` if the disk does not take a result, and `InputError` if no worker can be started or the
    cluster cannot go on.
    """
    rows = list[Row]()
    with (
        _environment(worker.ONE_THREAD),
        _signals() as wake,
        _engine(trials, store, progress, jobs, work, cluster) as workers,
    ):
        try:
            if isinstance(workers, Crew) and work.warm_up:
                progress.say("compiling, where this machine has not yet")
                _warm_up(workers, work, wake)
            while trials:
                by_index = {trial.index: trial for trial in trials}
                for ended in workers.run(ordered([_task(trial, store, work) for trial in trials], jobs), wake):
                    trial = by_index[ended.task.key]
                    rows.append(_keep(store, trial, _output(ended, trial, work)))
                    progress.ended(rows[-1])
                trials = work.more() if work.more is not None else []
        except Stopped as stop:
            return Summary(rows, stop.args[0])
    return Summary(rows)


@contextmanager
def _engine(
    trials: Sequence[Trial], store: Store, progress: Progress, jobs: int, work: Work, cluster: Cluster | None
) -> Iterator[Crew | Hands]:
    """Who runs the tasks: processes of this machine, or the workers of a cluster, which compile their code first."""
    limits = {"law_limit_s": work.law_limit_s, "still_s": work.still_s}
    if cluster is None:
        with crew(max(1, min(jobs, len(trials))), worker.prepare, (work.imports,), **limits) as workers:
            yield workers
        return
    from trials.batch.hands import Hands

    first = {kind_of(trial): (digest(trial), _compiling(trial, work)) for trial in work.warm_up}
    warm_up = {trial.index: first[kind_of(trial)] for trial in trials if kind_of(trial) in first}
    again = command("resume", str(store.folder), "--cluster", cluster.address)
    hands = Hands(cluster, work.imports, warm_up=warm_up, again=again, say=progress.say, **limits)
    try:
        yield hands
    finally:
        hands.stop()


def _task(trial: Trial, store: Store, work: Work) -> Task:
    files = store.files(trial.index, trial.index in work.recorded)
    shares = simulations.of(trial).shares(trial)
    return Task(
        trial.index, worker.attempt, (work.run, trial.as_dict(), work.scans, files), work.limit_s(trial), shares
    )


def ordered(tasks: Sequence[Task], jobs: int) -> list[Task]:
    """The tasks in their order, but those first that may take more than half of a worker's share of them all: begun
    last, they would be left to run alone."""
    long = sum(task.limit_s for task in tasks) / (2 * jobs)
    first = sorted((task for task in tasks if task.limit_s > long), key=lambda task: -task.limit_s)
    return [*first, *(task for task in tasks if task.limit_s <= long)]


def _warm_up(workers: Crew, work: Work, wake: int) -> None:
    """Runs the first moment of each trial of the warm-up. Errors are left to the trials themselves."""
    for trial in work.warm_up:
        for _ in workers.run([_compiling(trial, work)], wake):
            pass


def _compiling(trial: Trial, work: Work) -> Task:
    return Task(trial.index, worker.warm_up, (trial.as_dict(), work.run), WARM_UP_LIMIT_S)


def _output(ended: Ended, trial: Trial, work: Work) -> WorkerOutput:
    """What a worker handed back; if it handed back nothing, a failed trial with the reason."""
    if isinstance(ended.answer, WorkerOutput):
        return ended.answer
    if isinstance(ended.answer, StorageError):
        raise ended.answer
    if isinstance(ended.answer, Exception):
        return WorkerOutput("failed", worker.told(ended.answer))
    if ended.died == LAW:
        return WorkerOutput("failed", _hung(trial, work.law_limit_s, ended.turn))
    if ended.died == SLOW:
        return WorkerOutput("failed", f"did not end within {ended.task.limit_s:g} s of processor time{_perhaps(trial)}")
    if ended.died == WAITS:
        return WorkerOutput(
            "failed", f"waited for something that did not come within {work.still_s:g} s{_perhaps(trial)}"
        )
    return WorkerOutput("failed", f"{DIED} ({ended.died})")


def _hung(trial: Trial, law_limit_s: float, turn: watch.Turn | None) -> str:
    """The reason of a trial whose law did not return, with the member and the step where these are known."""
    late = f"did not return within {law_limit_s:g} s of processor time"
    if turn is None:
        return f"{_laws(trial.groups)} {late}"
    members = [(group, k + 1) for group in trial.groups for k in range(group.count)]
    group, number = members[turn.member]
    return f"{_laws([group])} {late} for {group.name}-{number} {simulations.of(trial).at_step(trial, turn.step)}"


def _perhaps(trial: Trial) -> str:
    """Names the users' laws that take part: a law of the project is not what a trial takes long for."""
    users = [group for group in trial.groups if group.law_source]
    return f"; perhaps {_laws(users)}" if users else ""


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
    store.add(row, output.timing)
    return row


@contextmanager
def _signals() -> Iterator[int]:
    """A descriptor on which the numbers of signals that stop a batch come, a byte each.

    Outside the main thread, which alone gets signals, none comes.
    """
    wake, told = os.pipe()
    before: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        # SIGHUP is ignored under nohup
        heeded = [number for number in STOPPING if signal.getsignal(number) != signal.SIG_IGN]
        before = {number: signal.signal(number, lambda got, frame: _tell(told, got)) for number in heeded}
    try:
        yield wake
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(wake)
        os.close(told)


def _tell(told: int, number: int) -> None:
    os.write(told, bytes([number]))


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
