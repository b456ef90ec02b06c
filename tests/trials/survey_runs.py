"""Made-up runs of the experiments over all laws: the plan's own trials, with measures that a test lays down."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from tests.trials.made_up_run import MadeUpRun, finished
from trials.design import plan
from trials.types import Trial

NOISE = 1e-3
"""Standard deviation from repeat to repeat: far below every margin."""
REPEATS = 8
"""The sign test, which shares at their bounds have, shows a failure among six outcomes (Holm) from eight repeats on:
6 x 2 / 2^8 = 0.047."""


def made_up(
    experiment: str, measures: Callable[[Trial], Mapping[str, float]], laws: Sequence[str] = (), **asked: object
) -> MadeUpRun:
    """A finished run of an experiment, of some laws, or as asked."""
    sweep = {"herd.law": list(laws)} if laws else None
    trials = plan(experiment, repeats=REPEATS, settings=asked, sweep=sweep).trials
    return finished(trials, measures, seed=4, noise=NOISE)
