"""Calls shared among worker processes of this machine, whose answers come back in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from flocking.errors import InputError
from trials.batch import worker
from trials.batch.crew import LAW, SLOW, Ended, Task, crew
from trials.simulations import watch

LIMIT_S = 36_000.0
"""Processor time that one call may take: far beyond any; a law that does not return is ended sooner."""


def in_order(
    function: Callable[..., Any],
    calls: Sequence[tuple[Any, ...]],
    jobs: int,
    imports: Callable[[], None] | None = None,
    limit_s: float = LIMIT_S,
    law_limit_s: float = watch.STEP_LIMIT_S,
) -> Iterator[Any]:
    """What a module's function returns for each of the calls' arguments, in their order, from so many processes.

    `law_limit_s`: processor time that a law may use without progress while the watch is on. Raises what a call raised,
    and `InputError` where a worker died of one.
    """
    tasks = [Task(key, function, args, limit_s) for key, args in enumerate(calls)]
    early: dict[int, Any] = {}
    wanted = 0
    wake, ours = os.pipe()
    try:
        with crew(min(jobs, len(tasks)), worker.prepare, (imports,), law_limit_s) as made:
            for ended in made.run(tasks, wake):
                died = ended.died and InputError(_told(ended, limit_s, law_limit_s))
                early[ended.task.key] = died or ended.answer
                while wanted in early:
                    answer = early.pop(wanted)
                    wanted += 1
                    if isinstance(answer, Exception):
                        raise answer
                    yield answer
    finally:
        os.close(wake)
        os.close(ours)


def _told(ended: Ended, limit_s: float, law_limit_s: float) -> str:
    """Why a worker that died was ended, in words."""
    if ended.died == SLOW:
        return f"a simulation takes more than {limit_s:g} s"
    if ended.died != LAW:
        return f"a simulation ended its process ({ended.died})"
    turn = ended.turn
    where = f", at work for member {turn.member + 1} at step {turn.step + 1}" if turn is not None else ""
    return f"a law did not return within {law_limit_s:g} s of processor time{where}"
