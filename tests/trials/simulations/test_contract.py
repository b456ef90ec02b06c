"""A simulation is a folder: each fulfils the contract, and one from outside the package runs as the others do."""

from __future__ import annotations

import dataclasses
import json
import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import trials.simulations
import trials.studies
from flocking.errors import InputError
from trials import design, keys, simulations
from trials.batch import runfile, series, store, worker
from trials.commands import cli
from trials.reports.report import report
from trials.types import Trial, with_setup

SIMULATION = '''
"""Members that walk on a line, each at its own pace."""

import dataclasses
from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter, filled
from trials.rows import below, section
from trials.simulations.contract import Simulation
from trials.types import Measure, TrialResult, no_contacts, no_updates, with_setup


class TrialFields(NamedTuple):
    steps: Annotated[int, Parameter("", "a choice", low=1)] = 3
    world: Annotated[str, Parameter("", "a choice", choices=("line",))] = "line"


class GroupFields(NamedTuple):
    count: Annotated[int, Parameter("members", "a choice", low=1)] = 2  # type: ignore[assignment]
    pace_m: Annotated[float, Parameter("m", "a choice", low=0.0)] = 1.0


def of_trial(trial):
    return filled(TrialFields, {"world": trial.world, **below(trial.setup, "")})


def of_group(group):
    return filled(GroupFields, {"count": group.count, **below(group.setup, "")}, prefix=f"{group.name}.")


def keys_of(trial, group=None):
    if group is None:
        return [section("", TrialFields, lambda: of_trial(trial)._asdict())]
    return [section("", GroupFields, lambda: of_group(group)._asdict())]


def check(trial):
    for group in trial.groups:
        if of_group(group).pace_m > 9.0:
            raise InputError(f"{group.name}.pace_m = {of_group(group).pace_m:g}: expected at most 9")


def run_trial(trial, scans, reraise, folder):
    steps = of_trial(trial).steps
    paces = np.concatenate([np.full(group.count, of_group(group).pace_m) for group in trial.groups])
    poses_w = np.zeros((steps + 1, len(paces), 3))
    poses_w[..., 0] = np.arange(steps + 1)[:, None] * paces
    count = len(paces)
    return TrialResult(
        trial=trial, times=np.arange(steps + 1.0), poses_w=poses_w, odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), bool), robot_names=tuple(f"m{k}" for k in range(count)), radii=np.zeros(count),
        rules=(), walls_w=np.empty((0, 4)), period_m=np.nan, updates=no_updates(count), contacts=no_contacts(),
        scans=None, measures={"way": float(poses_w[-1, :, 0].mean())}, outcome="done", reason="", timing={},
    )


SIMULATION = Simulation(
    keys_of=keys_of,
    check=check,
    settled=lambda trial: trial,
    run_trial=run_trial,
    record=lambda result, path: path.write_bytes(b"toy"),
    measures={"way": Measure("m", "how far members came")},
    key_measures=("way",),
    limit_s=lambda trial: 10.0,
    moment=lambda trial: with_setup(trial, {"steps": 1}),
    prepare=lambda: None,
    at_step=lambda trial, step: f"at step {step}",
    listed=lambda kind: {},
    constants=lambda trial: [],
)
'''
EXPERIMENT = '''
"""Toys that walk: how far by their pace."""

from trials.types import Group, Trial

REPEATS = 2
CONDITIONS = {"walkers.pace_m": (1.0, 2.0)}


def base(repeat):
    return Trial("toy-walk", repeat, "toy", "line", "none", (Group("none", 4, "none", name="walkers"),))
'''


@pytest.fixture
def toys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A simulation and a study in folders outside the package, added for the time of a test."""
    for folder, package in (("simulations", "toy"), ("studies", "toys")):
        (tmp_path / folder / package).mkdir(parents=True)
        (tmp_path / folder / package / "__init__.py").touch()
    (tmp_path / "simulations" / "toy" / "simulation.py").write_text(SIMULATION)
    (tmp_path / "studies" / "toys" / "toy_walk.py").write_text(EXPERIMENT)
    monkeypatch.chdir(tmp_path)
    for package in (trials.simulations, trials.studies):
        package.__path__.append(str(tmp_path / package.__name__.rpartition(".")[2]))
    simulations.named.cache_clear()
    yield
    for package in (trials.simulations, trials.studies):
        package.__path__.pop()
    for name in [name for name in sys.modules if name.startswith(("trials.simulations.toy", "trials.studies.toys"))]:
        del sys.modules[name]
    simulations.named.cache_clear()


@pytest.mark.usefixtures("toys")
class TestOneFromOutside:
    def test_it_is_found_and_its_experiment_is_planned(self) -> None:
        assert "toy" in simulations.names()
        plan = design.plan("toy-walk", settings={"steps": 5})
        assert [row.key for row in plan.parameters] == ["steps", "world", "walkers.count", "walkers.pace_m"]
        assert len(plan.trials) == 4
        assert plan.trials[1].groups[0].setup == {"pace_m": 2.0}
        with pytest.raises(InputError, match=r"walkers\.pace_m"):
            design.plan("toy-walk", settings={"walkers.pase_m": 1.0})

    def test_its_trials_run_are_kept_and_reported(self, tmp_path: Path) -> None:
        plan = design.plan("toy-walk")
        run = {"format": runfile.FORMAT, "experiment": "toy-walk", "trials": [trial.as_dict() for trial in plan.trials]}
        kept = store.create(tmp_path / "run", run, {})
        for trial in plan.trials:
            simulations.check(trial)
            files = kept.files(trial.index, record=True)
            output = worker.run_and_write(trial.as_dict(), "none", files)
            assert output.status == "done"
            assert files.recording is not None
            assert files.recording.read_bytes() == b"toy"
            row = store.Row(trial.index, "done", "", 1, trial.repeat, dict(trial.conditions), dict(output.measures))
            kept.add(row, output.timing)
        np.testing.assert_array_equal(kept.series(2).poses_w[:, 0, 0], [0.0, 2.0, 4.0, 6.0])
        kept.close()
        cells = {entry["quantity"]: entry["measured"] for entry in json.loads(report(tmp_path / "run", as_json=True))}
        assert cells == {"pace_m 1: way": 3.0, "pace_m 2: way": 6.0}
        assert "way" in report(tmp_path / "run")

    def test_the_command_runs_it_in_workers_and_resumes_it(self, tmp_path: Path) -> None:
        """Every process of the command, its workers too, is told of the stranger's folders as it starts."""
        (tmp_path / "sitecustomize.py").write_text(
            "import trials.simulations, trials.studies\n"
            f"trials.simulations.__path__.append({str(tmp_path / 'simulations')!r})\n"
            f"trials.studies.__path__.append({str(tmp_path / 'studies')!r})\n"
        )
        root = str(Path(simulations.__file__).parents[2])
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(tmp_path), root))}

        def herd(*words: str) -> str:
            command = [sys.executable, "-m", "trials.commands.cli", *words]
            done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout + done.stderr
            return done.stdout

        assert "4 trials: 4 done, 0 failed" in herd("run", "toy-walk", "--jobs", "2", "--out", "kept")
        with sqlite3.connect(tmp_path / "kept" / "results.sqlite") as tables:
            tables.execute("DELETE FROM trials WHERE idx = 3")
        tables.close()
        assert "4 trials: 4 done, 0 failed, 1 of them now" in herd("resume", "kept")

    def test_the_command_shows_it_and_refuses_what_it_has_not(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        for words, told in (
            (["list", "experiments"], "Toys that walk"),
            (["show", "toy-walk"], "walkers.pace_m"),
            (["run", "toy-walk", "--only", "2", "--dry-run"], "1 of 4 trials"),
        ):
            monkeypatch.setattr(sys, "argv", ["herd", *words])
            assert cli.main() == 0
            assert told in capsys.readouterr().out
        for words, told in (
            (["run", "toy-walk", "--body", "create", "--dry-run"], "has no bodies"),
            (["run", "toy-walk", "--scans", "all", "--dry-run"], "has no lasers"),
            (["run", "toy-walk", "--set", "walkers.pace_m=10", "--dry-run"], "expected at most 9"),
            (["world", "toy-walk", "--out", "world.xml"], "no world for MuJoCo"),
        ):
            monkeypatch.setattr(sys, "argv", ["herd", *words])
            assert cli.main() == 2
            assert told in capsys.readouterr().err


def one_of(name: str) -> Trial:
    """The first trial of the first experiment that the simulation runs."""
    bases = (design.load(experiment).base(1) for experiment in design.experiment_names())
    return next(base for base in bases if base.simulation == name)


@pytest.mark.parametrize("name", simulations.names())
class TestEvery:
    def test_every_key_that_is_shown_can_be_put(self, name: str) -> None:
        trial = one_of(name)
        for row in keys.rows(trial):
            again = keys.put(trial, row.key, row.value) if row.value == row.value else trial  # nan is left open
            assert {r.key: r.value for r in keys.rows(again)}[row.key] == pytest.approx(row.value, nan_ok=True)

    def test_a_setup_that_is_not_declared_is_refused(self, name: str) -> None:
        trial = one_of(name)
        with pytest.raises(InputError, match="unknown parameter 'colour'"):
            simulations.check(with_setup(trial, {"colour": "red"}))
        for misplaced in ("world", "formation"):
            with pytest.raises(InputError, match=f"unknown parameter '{misplaced}'"):
                simulations.check(with_setup(trial, {misplaced: "corridor"}))

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"world": "bogus"}, "unknown world 'bogus'"),
            ({"formation": "bogus"}, "unknown formation 'bogus'"),
            ({"groups": ()}, "expected at least one group"),
            ({"world_parameters": {"bogus": 1.0}}, r"unknown parameter 'world\.bogus'"),
        ],
    )
    def test_what_does_not_exist_is_refused_in_one_line(self, name: str, changes: dict[str, Any], words: str) -> None:
        changed = dataclasses.replace(one_of(name), **changes)
        for run in (simulations.check, simulations.run_trial):
            with pytest.raises(InputError, match=words):
                run(changed)

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"setup": {"law.bogus": 1.0}}, r"unknown parameter '\w+\.law\.bogus'"),
            ({"law_parameters": {"bogus": 1.0}}, r"unknown parameter '\w+\.law\.bogus'"),
            ({"pipeline_parameters": {"bogus": 1.0}}, r"unknown parameter '\w+\.pipeline\.bogus'"),
            ({"spread": {"bogus": 0.1}}, r"unknown parameter '\w+\.spread\.bogus'"),
        ],
    )
    def test_what_a_group_is_given_is_declared(self, name: str, changes: dict[str, Any], words: str) -> None:
        trial = one_of(name)
        group = dataclasses.replace(trial.groups[0], **changes)
        with pytest.raises(InputError, match=words):
            simulations.check(dataclasses.replace(trial, groups=(group,)))

    def test_a_value_of_a_law_has_its_place_in_the_law_alone(self, name: str) -> None:
        trial = one_of(name)
        key = next(row.key for row in keys.rows(trial) if ".law." in row.key).partition(".")[2]
        group = with_setup(trial.groups[0], {key: 1.0})
        with pytest.raises(InputError, match="unknown parameter"):
            simulations.check(dataclasses.replace(trial, groups=(group,)))

    def test_its_moment_gives_what_it_declares(self, name: str) -> None:
        trial = one_of(name)
        own = simulations.of(trial)
        result = simulations.run_trial(own.moment(trial), reraise=True)
        measured = {measure for measure in result.measures if "/" not in measure}
        assert measured <= own.measures.keys()
        assert set(own.key_measures) <= own.measures.keys()
        assert set(own.headings) <= own.measures.keys()
        assert series.unpack(series.pack(result)).trial == result.trial


def test_an_unknown_simulation_is_refused_with_the_nearest_name() -> None:
    trial = one_of("robots")
    with pytest.raises(InputError, match="unknown simulation 'robot'; did you mean robots"):
        simulations.check(Trial(**{**vars(trial), "simulation": "robot"}))
