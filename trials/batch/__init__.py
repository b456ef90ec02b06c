"""Batches: the trials of a run in worker processes, and the folder in which they are kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any


def run(
    experiment: str,
    out: Path | None = None,
    *,
    repeats: int | None = None,
    seed: int = 1,
    settings: Mapping[str, Any] | None = None,
    sweep: Mapping[str, Sequence[Any]] | None = None,
    law: str | None = None,
    pipeline: str | None = None,
    body: str | None = None,
    jobs: int | None = None,
    record: str | None = None,
    until_decided: bool = False,
    budget: str | None = None,
    cluster: str | None = None,
) -> Path:
    """Runs an experiment on all cores, as `herd run` does, and returns the run's folder; prints a summary.

    The arguments are the options of `herd run`: `settings` and `sweep` by dotted key, `record` one of `all`, `first`
    and `none`, `budget` as `10m` or `40`, `cluster` the address of a Dask scheduler, whose workers then run the trials.
    Local workers import the script that calls this: the call must stand under `if __name__ == "__main__":`.
    Raises `InputError` for anything that does not exist or fit, and where that line is missing.
    """
    from trials.batch import deciding, running, worker
    from trials.batch.asked import Asked

    asked = Asked(
        experiment,
        repeats=repeats,
        seed=seed,
        settings=dict(settings or {}),
        sweep={key: list(values) for key, values in (sweep or {}).items()},
        law=law,
        pipeline=pipeline,
        body=body,
        record=record,
        until_decided=until_decided,
        budget=deciding.budget(budget) if budget is not None else deciding.NO_BUDGET,
    )
    return running.start(asked, out, jobs or worker.cores(), report=lambda folder: "", cluster=cluster)[1]
