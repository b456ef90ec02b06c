"""A made-up finished run in memory: cells whose measures a test lays down, for tests of claims and
reports."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from trials.simulations.robots import fields
from trials.types import Trial, TrialResult

PIPELINES = ("member-based", "member-extrapolated", "sensor-based")
EXCLUSIONS = (0.0, 0.5, 1.0)

Law = Callable[[str, float], Mapping[str, float]]
"""(pipeline, exclusion distance) → means of the measures"""


@dataclass(frozen=True)
class MadeUpRow:
    index: int
    status: str
    reason: str
    repeat: int
    conditions: Mapping[str, Any]
    measures: Mapping[str, float]


@dataclass
class MadeUpRun:
    trials: list[Trial]
    finished: list[MadeUpRow]
    folder: Path = Path("runs/detection-case-study/001")
    results: Mapping[int, TrialResult] = field(default_factory=dict)

    def rows(self) -> Sequence[MadeUpRow]:
        return self.finished

    def series(self, index: int) -> TrialResult:
        return self.results[index]


def finished(
    trials: list[Trial],
    measures: Callable[[Trial], Mapping[str, float]],
    seed: int,
    spread: float = 0.0,
    noise: float = 0.0,
) -> MadeUpRun:
    """Planned trials that have ended with these means; `spread` from trial to trial is relative, `noise` absolute."""
    rng = np.random.default_rng(seed)
    rows = []
    for trial in trials:
        values = {
            name: mean * (1.0 + spread * rng.normal()) + noise * rng.normal() for name, mean in measures(trial).items()
        }
        rows.append(MadeUpRow(trial.index, "done", "", trial.repeat, trial.conditions, values))
    return MadeUpRun(trials, rows)


def made_up_run(
    law: Law,
    repeats: int = 7,
    pipelines: Sequence[str] = PIPELINES,
    exclusions: Sequence[float] = EXCLUSIONS,
    arms: Sequence[Mapping[str, Any]] = ({},),
    spread: float = 0.01,
    experiment: str = "detection-case-study",
) -> MadeUpRun:
    """All cells with the law's means and, from trial to trial, a relative spread (and a tenth of it,
    absolute)."""
    rng = np.random.default_rng(11)
    trials, rows = [], []
    for repeat, arm, pipeline, exclusion in itertools.product(range(1, repeats + 1), arms, pipelines, exclusions):
        conditions = {**arm, "herd.pipeline": pipeline, "herd.law.exclusion_m": exclusion}
        index = len(trials) + 1
        trials.append(
            dataclasses.replace(
                fields.trial(
                    experiment,
                    repeat,
                    [fields.group(pipeline=pipeline, law_parameters={"exclusion_m": exclusion})],
                    duration_s=60.0,
                ),
                index=index,
                conditions=conditions,
            )
        )
        noise = {
            name: float(mean * (1 + spread * rng.normal()) + 0.1 * spread * rng.normal())
            for name, mean in law(pipeline, exclusion).items()
        }
        rows.append(MadeUpRow(index, "done", "", repeat, conditions, noise))
    return MadeUpRun(trials, rows)
