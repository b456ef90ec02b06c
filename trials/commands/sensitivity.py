"""`herd sensitivity`: reads its options, runs the analysis, and says how to go on with one that was stopped."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from trials.invoked import command

if TYPE_CHECKING:
    from trials.sensitivity.study import Budget


def sensitivity(
    experiment: str,
    claim: int | None,
    budget: str,
    keys: str | None,
    repeats: int | None,
    seed: int,
    jobs: int,
    out: Path | None,
) -> int:
    """Runs an analysis and prints its table; returns the exit code."""
    from trials.sensitivity.points import StoppedError
    from trials.sensitivity.study import Asked, start

    names = tuple(key.strip() for key in keys.split(",")) if keys is not None else None
    try:
        table, folder = start(Asked(experiment, _budget(budget), claim, names, repeats, seed), out, jobs)
    except StoppedError as stop:
        again = ["sensitivity", experiment, "--budget", budget, "--out", str(stop.folder), *_said(claim, keys, repeats)]
        again += ["--seed", str(seed)] if seed != 1 else []
        print(f"herd: stopped; {stop}; go on with: {command(*again)}", file=sys.stderr)
        return 128 + stop.number
    print(table)
    print(f"results     {folder}")
    return 0


def _said(claim: int | None, keys: str | None, repeats: int | None) -> Sequence[str]:
    given = {"--claim": claim, "--keys": keys, "--repeats": repeats}
    return [word for option, value in given.items() if value is not None for word in (option, str(value))]


def _budget(text: str) -> Budget:
    """`10m`, `90s` and `2h` are wall time, a whole number is of trials. Raises `InputError`."""
    from trials.batch.deciding import time_or_number
    from trials.sensitivity.study import Budget

    return Budget(text, *time_or_number(text, "trials", "10m, 90s or 5000"))
