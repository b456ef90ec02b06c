"""Sends tasks to a Dask cluster, as `crew.py` hands them to processes, and yields each as it ends.

Short trials go in chunks, so that a cluster's share in each (some milliseconds) is small beside its own; how many
follows from how long the last ones took. So many chunks are under way that every thread has one at hand, and that an
adaptive cluster sees what there is to do.
"""

from __future__ import annotations

import itertools
import math
import os
import pickle
import queue
import select
import socket
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from distributed import KilledWorker
from distributed.client import ClosedClientError

from flocking.errors import InputError, StorageError
from trials.batch import remote
from trials.batch.cluster import Cluster, told
from trials.batch.crew import Ended, Stopped, Task
from trials.batch.folders import Files, write_whole

CHUNK_S = 1.0
"""Wall time that a chunk is to take."""
CHUNK_BYTES = 32_000_000
"""Of the files that come back with a chunk."""
MOST = 500
"""Trials in a chunk."""
UNDER_WAY = 32
"""Chunks under way, or `A_THREAD` for each thread where these are more."""
A_THREAD = 3
LOOK_S = 2.0
"""Wall time between two counts of the cluster's threads."""
RETURN_S = 60.0
"""Wall time for which a scheduler that is gone is waited for."""
KNOCK_S = 1.0
"""Wall time between two attempts at it."""


@dataclass
class _Link:
    """What is under way on one connection."""

    sent: dict[int, tuple[list[Task], Any]] = field(default_factory=dict)
    """Tasks of each chunk by its number, and its future."""
    back: queue.SimpleQueue[tuple[int, Any]] = field(default_factory=queue.SimpleQueue)
    """Numbers of chunks, each with its answer or the error that came in its place."""


class Hands:
    """The cluster's workers, for tasks whose last argument is the `Files` of a trial."""

    def __init__(
        self,
        cluster: Cluster,
        imports: Callable[[], None] | None,
        law_limit_s: float,
        still_s: float,
        warm_up: Mapping[int, tuple[str, Task]],
        again: str,
        say: Callable[[str], None],
    ) -> None:
        """`warm_up`: what compiles the code of a task, by its key; `again`: the command that finishes the batch."""
        self.cluster, self.warm_up, self.again, self.say = cluster, warm_up, again, say
        self.chunk = remote.Chunk(cluster.client.id, cluster.own, law_limit_s, still_s, (), imports)
        self.numbers = itertools.count()
        self.link = _Link()
        self.alone: set[int] = set()
        """Keys of tasks that were in a chunk whose workers were lost: they are sent one by one."""
        self.threads = 0
        self.each_s = self.each_bytes = 0.0
        """Wall time and size of the last trials. The time falls slowly: a chunk of trials that are longer than those
        before them would keep one thread for long."""
        self.bell, self.rung = socket.socketpair()
        """A byte comes in at `bell` for each answer."""

    def run(self, tasks: Sequence[Task], wake: int) -> Iterator[Ended]:
        """Yields each task as it ends, in any order. `wake`: descriptor on which the number of a signal comes.

        Raises `Stopped` when one comes, and `InputError` for a cluster that cannot go on; what it had sent back until
        then was yielded.
        """
        waiting, looked = deque(tasks), 0.0
        heard: list[Any] = [wake, self.bell]
        while waiting or self.link.sent:
            if monotonic() - looked >= LOOK_S:
                looked = monotonic()
                self.cluster.schedule(self._count())
            lost = not self._send(waiting)
            ready = [] if lost else select.select(heard, [], [], LOOK_S)[0]
            if wake in ready:
                raise Stopped(os.read(wake, 1)[0])
            if self.bell in ready:
                self.bell.recv(4096)
            failure: InputError | None = None
            while not self.link.back.empty():
                number, answer = self.link.back.get()
                chunk, _ = self.link.sent.pop(number)
                if isinstance(answer, OSError) or getattr(answer, "reason", "") == "scheduler-connection-lost":
                    waiting.extendleft(reversed(chunk))
                    lost = True
                else:
                    try:
                        yield from self._taken(chunk, answer, waiting)
                    except InputError as error:  # once all that has come is kept
                        failure = failure or error
            if failure is not None:
                raise failure
            if lost:
                self._return(waiting, wake)

    def stop(self) -> None:
        """Cancels what is under way: processes that are at it end within a second."""
        self._drop()
        self.rung.close()
        self.bell.close()

    def _drop(self) -> list[Task]:
        """Cancels what is under way, and returns its tasks."""
        link, self.link = self.link, _Link()
        futures = [future for _, future in link.sent.values()]
        if self.cluster.client.status == "running":
            with suppress(Exception):  # a scheduler that is gone has cancelled them
                self.cluster.client.cancel([future for future in futures if future is not None], force=True)
        return [task for tasks, _ in link.sent.values() for task in tasks]

    def _send(self, waiting: deque[Task]) -> bool:
        """Sends chunks until enough are under way; whether the connection took them."""
        while waiting and len(self.link.sent) < max(UNDER_WAY, A_THREAD * self.threads):
            tasks = [waiting.popleft()]
            size = self._size(len(waiting) + 1)
            while len(tasks) < size and waiting and not {tasks[0].key, waiting[0].key} & self.alone:
                tasks.append(waiting.popleft())
            number = next(self.numbers)
            self.link.sent[number] = tasks, None
            chunk = self.chunk._replace(trials=tuple(self._sent(task) for task in tasks))
            try:
                future = self.cluster.submit(chunk, (f"herd-trials-{self.chunk.client}", number))
            except (OSError, ClosedClientError):
                return False
            self.link.sent[number] = tasks, future
            self.cluster.schedule(self._fetch(number, future, self.link))
        return bool(self.cluster.client.status == "running" or not self.link.back.empty())

    def _size(self, left: int) -> int:
        """Trials of the next chunk: fewer towards the end, so that all threads end at about the same time."""
        if not self.each_s:
            return 1
        share = math.ceil(left / (2 * max(1, self.threads)))
        return max(1, min(MOST, share, int(CHUNK_S / self.each_s), int(CHUNK_BYTES / max(1.0, self.each_bytes))))

    def _sent(self, task: Task) -> remote.Sent:
        files: Files = task.args[-1]
        bare = task._replace(args=task.args[:-1])
        return remote.Sent(bare, self.warm_up.get(task.key), files.series is not None, files.recording is not None)

    async def _fetch(self, number: int, future: Any, link: _Link) -> None:
        """Puts the answer of a chunk into the queue, and rings."""
        try:
            answer = await future._result()
        except BaseException as error:
            answer = error
        link.back.put((number, answer))
        with suppress(OSError):  # nobody listens any more
            self.rung.send(b"\0")

    async def _count(self) -> None:
        """Counts the cluster's threads."""
        try:
            threads = sum((await self.cluster.client.scheduler.ncores()).values())
        except (OSError, AttributeError):  # the connection is gone: this is seen elsewhere
            return
        if not threads and self.threads:
            self.say("the cluster has no workers now")
        self.threads = threads

    def _taken(self, tasks: list[Task], answer: Any, waiting: deque[Task]) -> Iterator[Ended]:
        """The tasks of a chunk that has come back. What has not ended is put back."""
        if isinstance(answer, KilledWorker):
            if len(tasks) > 1:
                self.alone |= {task.key for task in tasks}
                waiting.extendleft(reversed(tasks))
                return
            lost, last = answer.allowed_failures + 1, answer.last_worker.address
            yield Ended(tasks[0], died=f"{lost} workers of the cluster were lost with it, the last of them {last}")
            return
        if isinstance(answer, StorageError):
            raise answer
        if isinstance(answer, BaseException):
            why = f"a worker cannot run trials ({told(answer)})"
            raise InputError(f"--cluster {self.cluster.address}: {why}; {self._finish}")
        if not answer:  # not wanted any more by a worker that then left
            waiting.extendleft(reversed(tasks))
            return
        came: remote.Answer = pickle.loads(answer)
        try:
            self.cluster.accept({came.worker: came.made_with})
        except InputError as error:
            raise InputError(f"{error}; {self._finish}") from None
        by_key = {task.key: task for task in tasks}
        each_s = came.seconds / len(tasks)
        self.each_s = max(each_s, 0.8 * self.each_s + 0.2 * each_s)
        self.each_bytes = sum(len(each.series or b"") + len(each.recording or b"") for each in came.trials) / len(tasks)
        for each in came.trials:
            task = by_key[each.key]
            for path, data in zip(task.args[-1], (each.series, each.recording), strict=True):
                if path is not None and data is not None:
                    write_whole(path, data)
            yield Ended(task, each.answer, each.died, each.turn)

    def _return(self, waiting: deque[Task], wake: int) -> None:
        """Waits for a scheduler that is gone, and has everything that was under way sent again."""
        waiting.extendleft(reversed(self._drop()))
        self.say(f"the scheduler at {self.cluster.address} is gone; waiting {RETURN_S:g} s for another one there")
        end = monotonic() + RETURN_S
        while True:
            try:
                self.cluster.reopen()
                break
            except InputError as error:
                if monotonic() > end:
                    raise InputError(f"{error}; {self._finish}") from None
            if select.select([wake], [], [], KNOCK_S)[0]:
                raise Stopped(os.read(wake, 1)[0])
        self.threads = 0

    @property
    def _finish(self) -> str:
        return f"what came back is kept; finish it with: {self.again}"
