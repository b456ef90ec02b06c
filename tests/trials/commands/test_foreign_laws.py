"""Every kinematic experiment with a law that is not its own: the report does without the numbers of its own law."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from flocking.errors import InputError
from tests.trials.made_up_run import MadeUpRow, MadeUpRun
from trials import design
from trials.simulations.kinematic import links
from trials.simulations.kinematic.measures import ABOUT
from trials.types import TrialResult

FOREIGN = ("dong", "couzin")
"""Laws in place of an experiment's own; the second is for those that refuse the first, of which no links are known."""
REPORTED = [
    name
    for name in design.experiment_names()
    if design.load(name).base(1).simulation == "kinematic"
    and (hasattr(design.load(name), "claims") or hasattr(design.load(name), "figures"))
]
"""Kinematic experiments with a report of their own."""


class Lost(dict[int, TrialResult]):
    """Stands for a store in which no trial has series."""

    def __missing__(self, index: int) -> TrialResult:
        raise InputError(f"trial {index}: its series is lost")


def planned(experiment: str) -> design.Plan:
    """The experiment planned with the first of the foreign laws that it takes."""
    for law in FOREIGN:
        try:
            return design.plan(experiment, repeats=2, law=law)
        except InputError as error:
            refused = error
    raise refused


def measured(rng: np.random.Generator) -> Mapping[str, float]:
    """Made-up numbers for all measures of a kinematic trial, with some of its links."""
    positions = np.cumsum(rng.normal(0.0, 0.3, (600, 12, 2)), axis=0) * 0.05 + rng.uniform(0.0, 3.0, (12, 2))
    given = links.Parameters(range_m=1.6, rest_m=1.0, stiffness_per_s2=1.0, unit_s=1.0)
    velocities = np.gradient(positions, 0.01, axis=0)
    counted = links.measure(np.arange(600) * 0.01, positions, velocities, given, None)
    return {name: float(rng.random()) for name in ABOUT} | counted


@pytest.mark.parametrize("experiment", REPORTED)
def test_the_report_of_a_foreign_law_can_be_written(experiment: str, tmp_path: Path) -> None:
    rng, module, plan = np.random.default_rng(3), design.load(experiment), planned(experiment)
    rows = [MadeUpRow(trial.index, "done", "", trial.repeat, trial.conditions, measured(rng)) for trial in plan.trials]
    run = MadeUpRun(plan.trials, rows, tmp_path, Lost())
    for entry in module.claims(run) if hasattr(module, "claims") else ():
        assert entry.source
        assert entry.agrees is None or entry.n > 0
    for figure in module.figures(run, tmp_path) if hasattr(module, "figures") else ():
        assert figure.caption


def test_an_experiment_without_its_condition_decides_nothing() -> None:
    plan = planned("vicsek-transition")
    assert "herd.law.noise_rad is left out" in " ".join(plan.notes)
    rows = [
        MadeUpRow(trial.index, "done", "", trial.repeat, trial.conditions, {"polarization": 0.5})
        for trial in plan.trials
    ]
    claims = design.load("vicsek-transition").claims(MadeUpRun(plan.trials, rows))
    assert {entry.agrees for entry in claims} == {None}
