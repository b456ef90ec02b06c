"""Calls shared among worker processes of this machine, whose answers come back in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from flocking.errors import InputError
from trials.batch import worker
from trials.batch.crew import SLOW, Task, crew

LIMIT_S = 36_000.0
"""Processor time that one call may take: far beyond any; a law that does not return is ended sooner."""


def in_order(
    function: Callable[..., Any],
    calls: Sequence[tuple[Any, ...]],
    jobs: int,
    imports: Callable[[], None] | None = None,
    limit_s: float = LIMIT_S,
) -> Iterator[Any]:
    """What a module's function returns for each of the calls' arguments, in their order, from so many processes.

    Raises what a call raised, and `InputError` where a worker died of one.
    """
    tasks = [Task(key, function, args, limit_s) for key, args in enumerate(calls)]
    early: dict[int, Any] = {}
    wanted = 0
    wake, ours = os.pipe()
    try:
        with crew(min(jobs, len(tasks)), worker.prepare, (imports,)) as made:
            for ended in made.run(tasks, wake):
                died = f"takes more than {limit_s:g} s" if ended.died == SLOW else f"ended its process ({ended.died})"
                early[ended.task.key] = InputError(f"a simulation {died}") if ended.died else ended.answer
                while wanted in early:
                    answer = early.pop(wanted)
                    wanted += 1
                    if isinstance(answer, Exception):
                        raise answer
                    yield answer
    finally:
        os.close(wake)
        os.close(ours)
