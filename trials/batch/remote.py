"""What a worker of a Dask cluster does with the trials that are sent to it.

Each thread of a Dask worker has a process of its own for them, a crew of one (`crew.py`): the same functions run the
same trials under the same limits as on one machine, and a trial that hangs or kills its process neither holds nor kills
the Dask worker. Files come back as bytes.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from flocking.errors import InputError, StorageError
from trials.batch import machine, worker
from trials.batch.crew import Crew, Stopped, Task
from trials.batch.folders import Files
from trials.simulations import watch

IDLE_S = 60.0
"""Wall time after which the process of a thread without trials is ended."""
LOOK_S = 0.5
"""Wall time between two looks at whether the trials at work are still wanted."""
PREPARATION_LIMIT_S = 300.0
"""Processor time for imports, and for filling the compiled cache for each set of code."""

IMPORTS = "imports"


class Sent(NamedTuple):
    """A trial on its way to a worker."""

    task: Task
    """Without the trial's files, which are the last of its arguments."""
    warm_up: tuple[str, Task] | None
    """What compiles the trial's code, and a text that is the same for the same code."""
    series: bool
    recording: bool
    """Which files it leaves."""


class Chunk(NamedTuple):
    """Trials that go to a worker together, with all that it needs for them."""

    client: str
    """The connection that they come from: a process is used for the trials of one alone."""
    made_with: dict[str, Any]
    """`machine.alike` of the process that planned them."""
    law_limit_s: float
    still_s: float
    trials: tuple[Sent, ...]
    imports: Callable[[], None] | None = None
    """Called in the process before its first trial."""


class Came(NamedTuple):
    """How a trial ended: as in `crew.Ended`, with its files."""

    key: int
    answer: Any
    died: str
    turn: watch.Turn | None
    series: bytes | None
    recording: bytes | None


class Answer(NamedTuple):
    """What a worker sends back for a chunk."""

    worker: str
    """Its address."""
    made_with: dict[str, Any]
    """`machine.alike` of the process that ran the trials."""
    trials: list[Came]
    """Empty where create-herd is not the one that planned them."""
    seconds: float
    """Wall time that they took."""


@dataclass
class _Hand:
    """The process of one thread of a Dask worker; there is none while its crew has no worker."""

    crew: Crew = field(default_factory=lambda: Crew(1, worker.prepare, ()))
    client: str = ""
    made_with: dict[str, Any] = field(default_factory=dict)
    warm: set[str] = field(default_factory=set)
    """The code that was compiled in it."""


@dataclass
class _Place:
    """Where a thread keeps its process from chunk to chunk."""

    hand: _Hand = field(default_factory=_Hand)
    lock: threading.Lock = field(default_factory=threading.Lock)
    """Held while the process is at work or is being ended."""
    idle: threading.Timer | None = None


_own = threading.local()


def run_chunk(data: bytes) -> bytes:
    """Runs the trials of a pickled `Chunk`, one after the other, and returns a pickled `Answer`.

    A trial's errors are part of the answer, which is empty if the trials were not wanted any more. Raises `InputError`
    if no process can be started.
    """
    from distributed import get_worker

    dask = get_worker()
    chunk: Chunk = pickle.loads(data)
    _may_have_children()
    try:
        with _wanted(dask, dask.get_current_task()) as wake, _hand(chunk, wake) as hand:
            ours = not machine.is_other_version(chunk.made_with, hand.made_with)
            if ours:
                _warm_up(chunk, hand, wake)
            began = perf_counter()
            trials = list(_run(chunk, hand, wake, dask.local_directory)) if ours else []
            took = perf_counter() - began
    except Stopped:
        return b""
    except OSError as error:
        raise StorageError(f"worker {dask.address}: {error}") from None
    return pickle.dumps(Answer(dask.address, hand.made_with, trials, took))


def _warm_up(chunk: Chunk, hand: _Hand, wake: int) -> None:
    """Imports and compiles what the trials need. Errors are left to the trials themselves."""
    imports = [(IMPORTS, Task(0, chunk.imports, (), PREPARATION_LIMIT_S))] if chunk.imports is not None else []
    for code, task in [*imports, *(sent.warm_up for sent in chunk.trials if sent.warm_up is not None)]:
        if code not in hand.warm:
            hand.warm.add(code)
            for _ in hand.crew.run([task], wake):
                pass


def _run(chunk: Chunk, hand: _Hand, wake: int, scratch: str) -> Iterator[Came]:
    with tempfile.TemporaryDirectory(prefix="herd-", dir=scratch) as folder:
        tasks = [_with_files(sent, Path(folder)) for sent in chunk.trials]
        for ended in hand.crew.run(tasks, wake):
            files: Files = ended.task.args[-1]
            yield Came(ended.task.key, ended.answer, ended.died, ended.turn, *map(_taken, files))


def _with_files(sent: Sent, folder: Path) -> Task:
    stem = folder / f"{sent.task.key:04d}"
    files = Files(
        stem.with_suffix(".npz") if sent.series else None, stem.with_suffix(".rrd") if sent.recording else None
    )
    return sent.task._replace(args=(*sent.task.args, files))


def _taken(path: Path | None) -> bytes | None:
    """The content of a file, which is removed; None if the trial left none."""
    if path is None or not path.is_file():
        return None
    data = path.read_bytes()
    path.unlink()
    return data


@contextmanager
def _hand(chunk: Chunk, wake: int) -> Iterator[_Hand]:
    """The process of this thread, started where there is none yet; ended at once if the block does not come through."""
    place: _Place = vars(_own).setdefault("place", _Place())
    if place.idle is not None:
        place.idle.cancel()
    with place.lock:
        if not place.hand.crew.workers or place.hand.client != chunk.client:
            place.hand.crew.stop()
            crew = Crew(1, worker.prepare, (None,), chunk.law_limit_s, chunk.still_s)
            place.hand = _Hand(crew, chunk.client)
        hand = place.hand
        try:
            if not hand.made_with:
                (described,) = hand.crew.run([Task(0, machine.alike, (), PREPARATION_LIMIT_S)], wake)
                if not isinstance(described.answer, dict):
                    raise InputError(f"a process cannot say what it runs: {described.died or described.answer!r}")
                hand.made_with = described.answer
            yield hand
        except BaseException:
            hand.crew.stop()
            raise
        place.idle = threading.Timer(IDLE_S, _end, [place])
        place.idle.daemon = True
        place.idle.start()


def _end(place: _Place) -> None:
    """Ends a process that has been idle, unless it is at work again."""
    if place.lock.acquire(blocking=False):
        place.hand.crew.stop()
        place.lock.release()


def _may_have_children() -> None:
    """Lets this process have processes of its own, each with one thread.

    A Dask worker that its nanny started is marked as one that may have none, since `multiprocessing` would not end them
    with it; those of a crew end by themselves when their parent does (`worker.end_with_parent`).
    """
    vars(multiprocessing.current_process())["_config"]["daemon"] = False
    os.environ.update(worker.ONE_THREAD)


@contextmanager
def _wanted(dask: Any, key: Any) -> Iterator[int]:
    """A descriptor on which a byte comes once the Dask worker ends, or the task of that key was cancelled."""
    wake, told = os.pipe()
    over = threading.Event()

    def look() -> None:
        while not over.wait(LOOK_S):
            task = dask.state.tasks.get(key)
            if task is None or task.state == "cancelled" or dask.status.name in ("closing", "closed"):
                os.write(told, b"\x01")
                return

    looking = threading.Thread(target=look, daemon=True, name="herd-wanted")
    looking.start()
    try:
        yield wake
    finally:
        over.set()
        looking.join()
        os.close(wake)
        os.close(told)
