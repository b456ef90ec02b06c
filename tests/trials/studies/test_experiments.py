"""Every experiment, found by its file: it plans, shows what it will do, and its base trial runs a moment."""

from __future__ import annotations

import pytest

from flocking.errors import InputError
from flocking.parameters import Parameter
from trials import design, simulations
from trials.commands import listing

NAMES = design.experiment_names()


@pytest.mark.parametrize("name", NAMES)
class TestExperiment:
    def test_it_plans_what_can_run_and_shows_it(self, name: str) -> None:
        module, made = design.load(name), design.plan(name)
        assert made.title.strip(".")
        assert len({trial.index for trial in made.trials}) == len(made.trials)
        assert {trial.experiment for trial in made.trials} == {name}
        kinds = {(*trial.conditions.values(), trial.formation): trial for trial in made.trials}
        for trial in kinds.values():
            simulations.check(trial)
        shown = listing.planned(made, made.trials)
        keys = {row.key for row in made.parameters}
        assert all(key in shown for key in made.conditions)
        assert getattr(module, "SOURCES", {}).keys() <= keys
        assert all(isinstance(source, Parameter) for source in getattr(module, "SOURCES", {}).values())
        assert getattr(module, "RECORD", "all") in ("all", "first", "none")

    def test_its_first_trial_runs_a_moment(self, name: str) -> None:
        whole = design.plan(name, repeats=1).trials[0]
        trial = simulations.of(whole).moment(whole)
        try:
            result = simulations.run_trial(trial, reraise=True)
        except InputError as error:
            if "OpenGL" in str(error):
                pytest.skip(str(error))
            raise
        assert result.outcome == "done"
        assert result.times[-1] > 0.0
        assert set(getattr(design.load(name), "KEY_MEASURES", ())) <= result.measures.keys()


def test_experiments_are_found_by_their_files() -> None:
    assert set(NAMES) == set(design.experiments()) >= {"detection-case-study", "lch-table-4-1"}
