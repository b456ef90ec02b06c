"""Verdicts of an experiment's claims on a made-up run of all its trials."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tests.trials.made_up_run import finished
from trials import design
from trials.evidence.claims import Entry

Measures = Callable[[Mapping[str, Any]], Mapping[str, float]]
"""Conditions → means of the measures."""
SPREAD = 0.01
"""Relative deviation from trial to trial: far below every margin."""


def judged(experiment: str, measures: Measures, repeats: int | None = None) -> list[Entry]:
    """The entries of an experiment whose trials measured what `measures` says, give or take the spread."""
    trials = design.plan(experiment, repeats=repeats).trials
    run = finished(trials, lambda trial: measures(trial.conditions), seed=5, spread=SPREAD)
    entries: list[Entry] = design.load(experiment).claims(run)
    return entries


def verdicts(experiment: str, measures: Measures) -> list[bool | None]:
    return [entry.agrees for entry in judged(experiment, measures)]
