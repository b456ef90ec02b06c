"""Worker processes, each with a pipe of its own: what becomes of one is no affair of the others.

The parent judges by processor time and by progress, never by wall time, so that a busy machine fails no trial: a worker
is ended when its task has used up its limit, when a law uses its own without progress, and when it waits for something
that does not come.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Container, Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import connection, resource_tracker
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Ints
from trials.batch.patience import STILL_S, Patience
from trials.simulations import watch

POLL_S = 0.25
"""Wall time between two looks at the workers."""
BREAKS = 3
"""How many workers in a row may die before one is ready."""
ENDING_S = 5.0
"""Wall time that a worker may take to end once its pipe is closed."""
NO_MAIN_GUARD = 79
"""Exit code of a worker whose import of the user's own script came to start a batch."""
SHORT_S = 0.5
"""Tasks shorter than this (wall time) are handed out one ahead, so that no worker waits while a result is kept."""
SLOW, LAW, WAITS = "slow", "law", "waits"
"""For what a worker is ended: its task used up its limit; a law used up its own without progress; it waits."""
_CONTEXT = multiprocessing.get_context("spawn")


class Task(NamedTuple):
    """A call of a module's function in a worker."""

    key: int
    """By which the caller knows it."""
    function: Callable[..., Any]
    args: tuple[Any, ...]
    limit_s: float
    """Processor time that it may use."""
    shares: Hashable = None
    """Equal for tasks that are shorter in a worker that has just done another of them; None: there is no such."""


class Ended(NamedTuple):
    """How a task ended."""

    task: Task
    answer: Any = None
    """What the function returned, or the exception that it raised."""
    died: str = ""
    """`SLOW`, `LAW` or `WAITS`, or how else the worker died, in words. Empty if there is an answer."""
    turn: watch.Turn | None = None
    """Of the law that was at work when the worker was ended."""


class Stopped(Exception):  # noqa: N818 (no error)
    """A signal came, whose number is the argument."""


@dataclass
class _Worker:
    """A worker process, and what the parent saw of it."""

    process: Any
    pipe: connection.Connection
    memory: Ints
    patience: Patience
    tasks: deque[Task] = field(default_factory=deque)
    """Handed out and not ended, oldest first: the first is at work."""
    shares: Hashable = None
    """Of the last task that was handed out."""
    is_ready: bool = False
    took_s: float = 0.0
    """Wall time of its last task."""
    began: float = field(default_factory=monotonic)
    seen: tuple[int, ...] = ()
    seen_at_s: float = 0.0
    """Processor time of its task at the last progress of its law."""
    why: str = ""
    """For what it was killed."""


class Crew:
    """Workers that call `prepare(*args, memory)` before their first task."""

    def __init__(
        self,
        jobs: int,
        prepare: Callable[..., None],
        args: tuple[Any, ...],
        law_limit_s: float = watch.STEP_LIMIT_S,
        still_s: float = STILL_S,
    ) -> None:
        self.jobs, self.prepare, self.args = jobs, prepare, args
        self.law_limit_s, self.still_s = law_limit_s, still_s
        self.workers: list[_Worker] = []
        self.breaks = 0

    def run(self, tasks: Sequence[Task], wake: int) -> Iterator[Ended]:
        """Yields each task as it ends, in any order. `wake`: descriptor on which the number of a signal comes.

        Raises `Stopped` when one comes, and `InputError` if workers die again and again before they are ready.
        """
        waiting = deque(tasks)
        looked = monotonic()
        while waiting or any(worker.tasks for worker in self.workers):
            busy = sum(bool(worker.tasks) for worker in self.workers)
            while len(self.workers) < min(self.jobs, busy + len(waiting)):
                self.workers.append(_started(self.prepare, self.args))
            self._hand_out(waiting)
            watched = [wake, *(w.pipe for w in self.workers), *(w.process.sentinel for w in self.workers)]
            ready = connection.wait(watched, POLL_S)
            if wake in ready:
                raise Stopped(os.read(wake, 1)[0])
            for worker in [w for w in self.workers if w.pipe in ready or w.process.sentinel in ready]:
                yield from self._heard(worker)
                if worker.process.sentinel in ready:
                    yield from self._buried(worker, waiting)
            if monotonic() - looked >= POLL_S:
                looked = monotonic()
                for worker in self.workers:
                    self._judge(worker)

    def stop(self) -> None:
        """Ends all workers at once."""
        for worker in self.workers:
            worker.process.kill()
        for worker in self.workers:
            worker.process.join()
            worker.process.close()
            worker.pipe.close()
        self.workers.clear()

    def _hand_out(self, waiting: deque[Task]) -> None:
        for ahead in (0, 1):
            for worker in self.workers:
                short = worker.is_ready and 0.0 < worker.took_s < SHORT_S
                if waiting and len(worker.tasks) == ahead and (ahead == 0 or short):
                    others = {other.shares for other in self.workers if other is not worker and other.tasks}
                    task = following(waiting, worker.shares, others)
                    waiting.remove(task)
                    worker.shares = task.shares
                    if not worker.tasks:
                        _begins(worker)
                    worker.tasks.append(task)
                    try:
                        worker.pipe.send((task.function, task.args))
                    except OSError:  # it has just died: its sentinel tells
                        return

    def _heard(self, worker: _Worker) -> Iterator[Ended]:
        """The answers that a worker has sent."""
        try:
            while worker.pipe.poll():
                answer = worker.pipe.recv()
                if not worker.is_ready:
                    worker.is_ready, self.breaks = True, 0
                    _begins(worker)
                    continue
                task = worker.tasks.popleft()
                worker.took_s = monotonic() - worker.began
                _begins(worker)
                yield Ended(task, answer)
        except (EOFError, OSError):  # it died, perhaps in the middle of an answer
            worker.process.join(ENDING_S)
            worker.process.kill()  # it lives on only where something in it has closed the pipe

    def _buried(self, worker: _Worker, waiting: deque[Task]) -> Iterator[Ended]:
        """Puts the tasks of a dead worker back, but for the one that it was at."""
        worker.process.join()
        code = worker.process.exitcode
        self.workers.remove(worker)
        turn = watch.whose(worker.memory)
        task = worker.tasks.popleft() if worker.tasks and worker.is_ready else None
        waiting.extendleft(reversed(worker.tasks))
        worker.process.close()
        worker.pipe.close()
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        if code == NO_MAIN_GUARD:
            raise InputError(
                "workers import the script that started the batch: expected its calls under if __name__ == '__main__':"
            )
        if not worker.is_ready:
            self.breaks += 1
            if self.breaks == BREAKS:
                raise InputError(f"worker processes die before they run a trial ({how})")
        if task is not None:
            yield Ended(task, died=worker.why or how, turn=turn)

    def _judge(self, worker: _Worker) -> None:
        """Kills a worker that has used up a limit."""
        if not worker.tasks or worker.why:
            return
        used, state = worker.patience.used_s(), tuple(worker.memory.tolist())
        if state != worker.seen or not watch.is_on(worker.memory):
            worker.seen, worker.seen_at_s = state, used
        if used - worker.seen_at_s > self.law_limit_s:
            worker.why = LAW
        elif worker.is_ready and used > worker.tasks[0].limit_s:
            worker.why = SLOW
        elif worker.patience.still_s() > self.still_s:
            worker.why = WAITS
        if worker.why:
            worker.process.kill()


def following(waiting: Iterable[Task], last: Hashable, others: Container[Hashable]) -> Task:
    """The task that a worker does next: the first that shares something with its last one, else the first that shares
    nothing with what others are at, else the first."""
    tasks = list(waiting)
    near = (task for task in tasks if task.shares is not None and task.shares == last)
    apart = (task for task in tasks if task.shares is None or task.shares not in others)
    return next(near, None) or next(apart, None) or tasks[0]


def check_main_guard() -> None:
    """Ends a worker that comes here while it imports the script of its parent: it would start a batch of its own."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        os._exit(NO_MAIN_GUARD)


@contextmanager
def crew(*args: Any, **how: Any) -> Iterator[Crew]:
    """A crew, ended at the end of the block."""
    made = Crew(*args, **how)
    try:
        yield made
    finally:
        made.stop()


def _started(prepare: Callable[..., None], args: tuple[Any, ...]) -> _Worker:
    shared = _CONTEXT.RawArray("q", watch.SIZE)
    ours, theirs = _CONTEXT.Pipe()
    process = _CONTEXT.Process(target=_serve, args=(theirs, shared, prepare, args), daemon=True)
    # Ctrl-C in a terminal sends its signal to all processes, and only this one is to react: workers inherit a mask that
    # blocks it. The resource tracker is started before, since its start unblocks SIGINT.
    resource_tracker.ensure_running()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP))
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    theirs.close()
    assert process.pid is not None
    return _Worker(process, ours, np.frombuffer(shared, np.int64), Patience(process.pid))


def _serve(pipe: connection.Connection, shared: Any, prepare: Callable[..., None], args: tuple[Any, ...]) -> None:
    """What a worker does until its parent closes the pipe."""
    prepare(*args, np.frombuffer(shared, np.int64))
    pipe.send(None)
    while True:
        try:
            function, given = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer = function(*given)
        except Exception as error:
            answer = error
        pipe.send(answer)


def _begins(worker: _Worker) -> None:
    """Notes the moment at which the next task of a worker begins."""
    worker.began, worker.seen_at_s = monotonic(), 0.0
    worker.patience.begin()
