"""Trials of generated environments: what is judged, beside what, and that nothing else decides it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Floats
from generation.group import Job
from trials.batch import series
from trials.simulations import check, run_trial, settled
from trials.simulations.environments import fields, herds, ways
from trials.simulations.environments.loop import poses_of, walls_of
from trials.simulations.kinematic.fields import group
from trials.types import Trial, TrialResult, with_setup

NOTHING = '''
"""Nothing at all."""
from typing import NamedTuple
from generation.environment import Environment

FILTER, BEHAVIOUR = "", "corralling"

class Parameters(NamedTuple):
    pass

def workspace():
    return Environment()

def generate(parameters, workspace, rng):
    return workspace
'''
PEN = (
    NOTHING.replace("Nothing at all", "A pen about the origin")
    .replace(
        "return workspace\n",
        "corners = tuple((x, y) for x, y in ((-9, -9), (9, -9), (9, 9), (-9, 9)))\n"
        '    return Environment(construct=(Polygon(corners, "inside"),))\n',
    )
    .replace("import Environment", "import Environment\nfrom generation.primitives import Polygon")
)
WALK = {"speed_m_s": 2.0, "turn_rad": 0.5}


def trial(schema: str, count: int = 5, size_m: float = 10.0, **setup: float | str) -> Trial:
    return fields.trial(
        "some",
        1,
        [group("random-motion", count, law_parameters=WALK, obstacles="avoid")],
        schema,
        formation_parameters={"size_m": size_m},
        **{"environments": 6, **setup},
    )


@pytest.fixture(scope="module")
def of_grammar() -> TrialResult:
    return run_trial(settled(trial("splitting", environments=20)), reraise=True)


def test_without_a_construct_there_is_no_uplift(tmp_path: Path) -> None:
    (tmp_path / "nothing.py").write_text(NOTHING)
    found = run_trial(trial(str(tmp_path / "nothing.py"), behaviour="simple-split"), reraise=True)
    assert found.measures["pass_rate"] == 1.0
    assert found.measures["uplift"] == found.measures["gained"] == found.measures["lost"] == 0.0
    np.testing.assert_array_equal(found.tables["fitness"], found.tables["control"])


def test_a_pen_holds_what_would_walk_away(tmp_path: Path) -> None:
    """At 2 m an iteration five walkers are far from the origin, and from one another, long before 500 iterations."""
    (tmp_path / "pen.py").write_text(PEN)
    late = {"behaviour.consecutive": 450}
    found = run_trial(with_setup(trial(str(tmp_path / "pen.py")), late), reraise=True)
    assert found.measures["valid_rate"] == 1.0
    assert found.measures["control_rate"] == 0.0
    assert found.measures["uplift"] == found.measures["gained"] == found.measures["tightness"] == 1.0
    assert found.measures["fence"] == pytest.approx(4 * 18.0)
    ways = found.tables["example_ways"]
    assert ways.shape[0] == 3
    assert (np.abs(ways) <= 9.0).all()


def test_the_same_trial_gives_the_same_result(of_grammar: TrialResult) -> None:
    again = run_trial(of_grammar.trial, reraise=True)
    assert series.pack(again) == series.pack(of_grammar)
    assert series.unpack(series.pack(again)).tables.keys() == of_grammar.tables.keys()


def test_environments_are_the_same_whatever_their_number_the_herd_and_the_behaviour(of_grammar: TrialResult) -> None:
    fewer = run_trial(
        settled(trial("splitting", 7, environments=10, behaviour="balanced-split", iterations=2)), reraise=True
    )
    for number in range(10):
        np.testing.assert_array_equal(walls_of(fewer.tables, number), walls_of(of_grammar.tables, number))
    np.testing.assert_array_equal(fewer.tables["passed"], of_grammar.tables["passed"][:10])


def test_rates_are_those_of_the_tables(of_grammar: TrialResult) -> None:
    tables, measures = of_grammar.tables, of_grammar.measures
    passed = tables["passed"]
    assert 0 < passed.sum() < 20
    np.testing.assert_array_equal(passed, tables["terminals"] >= 3)
    assert np.isnan(tables["fitness"][~passed]).all()
    assert np.isfinite(tables["fitness"][passed]).all()
    assert measures["pass_rate"] == passed.mean()
    assert measures["valid_rate"] == (tables["fitness"][passed] == 1.0).mean()
    assert measures["control_rate"] == (tables["control"][passed] == 1.0).mean()
    assert measures["uplift"] == pytest.approx(measures["gained"] - measures["lost"], abs=1e-12)  # sums of shares
    assert measures["tightness"] == measures["valid"] / 20


def test_the_control_has_the_start_and_the_numbers_of_its_environment() -> None:
    given = trial("splitting")
    whole = herds.environment(given, 3, fields.chosen_by(given))
    with_walls, without = herds.job(given, 3, whole), herds.job(given, 3, herds.without_construct(whole))
    np.testing.assert_array_equal(with_walls.poses_w, without.poses_w)
    assert with_walls.seed == without.seed
    assert len(without.environment.walls()) == 0
    assert without.environment.markers == whole.markers


def test_another_behaviour_judges_the_same_herd_without_simulating_it_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    simple, balanced, longer, other = (
        settled(dataclasses.replace(trial("splitting", count=9, environments=20, **setup), seed=seed))
        for seed, setup in [
            (11, {"behaviour": "simple-split", "iterations": 60}),
            (11, {"behaviour": "balanced-split", "iterations": 60}),
            (11, {"behaviour": "simple-split", "iterations": 20}),
            (12, {"behaviour": "simple-split", "iterations": 60}),
        ]
    )
    apart = {}
    for name, given in {"simple": simple, "balanced": balanced}.items():
        run_trial(other, reraise=True)
        apart[name] = run_trial(given, reraise=True)
    simulated = []
    trajectories = ways.Members.trajectories

    def counted(group: ways.Members, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        simulated.append(len(jobs))
        return trajectories(group, jobs, iterations)

    monkeypatch.setattr(ways.Members, "trajectories", counted)
    run_trial(other, reraise=True)
    assert len(simulated) == 2  # the environments and their controls
    for again in (run_trial(simple, reraise=True), run_trial(simple, reraise=True)):
        assert again.measures == pytest.approx(apart["simple"].measures, rel=0, abs=0, nan_ok=True)
    together = run_trial(balanced, reraise=True)
    assert len(simulated) == 4
    assert together.measures == pytest.approx(apart["balanced"].measures, rel=0, abs=0, nan_ok=True)
    np.testing.assert_array_equal(together.tables["control"], apart["balanced"].tables["control"])
    assert not np.array_equal(apart["simple"].tables["fitness"], apart["balanced"].tables["fitness"], equal_nan=True)
    run_trial(longer, reraise=True)
    assert len(simulated) == 6
    assert ways.shares(simple) == ways.shares(balanced) != ways.shares(other)


def test_the_example_is_in_the_result(of_grammar: TrialResult) -> None:
    if len(of_grammar.tables["example_numbers"]):
        number = int(of_grammar.tables["example_numbers"][0])
        np.testing.assert_array_equal(of_grammar.walls_w, walls_of(of_grammar.tables, number))
        np.testing.assert_allclose(of_grammar.poses_w[..., :2], of_grammar.tables["example_ways"][0], rtol=1e-6)
    assert np.isfinite(of_grammar.poses_w).all()


def test_headings_follow_the_way() -> None:
    ways = np.array([[[0.0, 0.0]], [[1.0, 0.0]], [[1.0, 1.0]], [[0.0, 1.0]]])
    np.testing.assert_allclose(poses_of(ways)[:, 0, 2], [0.0, 0.0, np.pi / 2, np.pi])


def test_a_behaviour_that_returns_more_than_one_fails_the_trial_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        '"""Mine."""\nfrom typing import NamedTuple\nITERATIONS = 3\nSUCCESS = 1.0\n'
        "class Parameters(NamedTuple):\n    pass\ndef fitness(positions, environment, parameters):\n    return 1.7\n"
    )
    found = run_trial(trial("splitting", behaviour=str(tmp_path / "mine.py")))
    assert found.outcome == "failed"
    assert "returned the fitness 1.7" in found.reason
    assert "\n" not in found.reason
    assert found.tables["passed"].any()  # what was found until then is kept


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"behaviour": "corraling"}, "did you mean corralling"),
        ({"filter": "terminal"}, "did you mean terminals"),
        ({"behaviour.consecutiv": 3}, "behaviour.consecutive"),
        ({"environments": 0}, "from 1 to"),
    ],
)
def test_names_and_numbers_are_checked_before_anything_runs(change: dict[str, float | str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        check(with_setup(trial("splitting"), change))


def test_an_unknown_schema_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean splitting"):
        check(trial("spliting"))
