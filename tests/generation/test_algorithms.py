"""Algorithms 3 to 5 of Fine 2015, and the theorems of its appendix B about the grid."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import Floats
from generation import found
from generation.algorithms import MOST_CANDIDATES, candidates, gccg, gcg, geg, grid
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Job
from generation.primitives import Segment
from generation.schema import Schema


class Parameters(NamedTuple):
    """Of a wall."""

    length_m: Annotated[float, Parameter("m", "test", low=0.5, high=2.0)] = 1.0
    turns: Annotated[int, Parameter("", "test", low=-1, high=3)] = 0
    solid: Annotated[bool, Parameter("", "test")] = True
    side: Annotated[str, Parameter("", "test", choices=("left", "right"))] = "left"
    weight: Annotated[float, Parameter("", "test", low=0.0)] = 1.0
    named: Annotated[str, Parameter("", "test")] = ""


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    angle = parameters.turns * math.pi / 2
    end = parameters.length_m * math.cos(angle), parameters.length_m * math.sin(angle)
    return Environment(workspace.workspace, (Segment(0.0, 0.0, *end),), origin={"drawn": float(rng.random())})


WALL = Schema("wall", "A wall", Parameters, Environment, generate, "", "long")
EVERYTHING = {"length_m": 0.5, "turns": 2, "solid": 1, "side": 1}


class Still:
    """A group whose members stand where the wall ends."""

    count = 2

    def __init__(self) -> None:
        self.asked: list[int] = []

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        self.asked.append(len(jobs))
        for job in jobs:
            end = job.environment.construct_walls()[0, 2:]
            yield np.broadcast_to(end, (iterations + 1, self.count, 2)).copy()


class Nothing(NamedTuple):
    """No parameters."""


def long(positions: Floats, environment: Environment, parameters: Nothing) -> float:
    return min(1.0, float(np.hypot(*positions[-1, 0])) / 2.0)


LONG = Behaviour("long", "Far out", Nothing, 3, 0.75, long)


def start(environment: Environment, number: int) -> Job:
    return Job(environment, np.zeros((2, 3)), (number,))


def test_the_grid_is_enumerated_exactly_once() -> None:
    """Appendix B, first theorem: resolution complete."""
    points = list(grid(Parameters, EVERYTHING))
    assert len(points) == len(set(points))
    assert set(points) == {
        Parameters(length, turns, solid, side)
        for length, turns, solid, side in itertools.product(
            (0.5, 1.0, 1.5, 2.0), (-1, 1, 3), (False, True), ("left", "right")
        )
    }


@pytest.mark.parametrize("resolutions", [EVERYTHING, {"length_m": 0.4}, {"turns": 1}, {"side": 1}, {}])
def test_the_number_of_candidates_is_the_product_over_parameters(resolutions: dict[str, float]) -> None:
    """Appendix B, second theorem; each factor is the printed one with both ends of its interval."""
    factors = {"length_m": lambda r: int(1.5 / r + 1e-9) + 1, "turns": lambda r: 4 // r + 1}
    expected = math.prod(factors.get(name, lambda r: 2)(step) for name, step in resolutions.items())
    assert candidates(Parameters, resolutions) == len(list(grid(Parameters, resolutions))) == expected


@pytest.mark.parametrize("step", [0.1, 0.3, 0.05, 0.15, 0.0125])
def test_rounding_loses_no_end_of_an_interval(step: float) -> None:
    values = [point.length_m for point in grid(Parameters, {"length_m": step})]
    assert values[0] == 0.5
    assert values[-1] == pytest.approx(2.0)
    assert max(values) <= 2.0
    assert np.diff(values) == pytest.approx(step)


def test_the_grid_is_lazy_and_so_is_what_is_made_of_it() -> None:
    fine = {"length_m": 1.5 / (MOST_CANDIDATES - 1)}
    first = list(itertools.islice(gccg(WALL, fine, Environment()), 3))
    assert first[0][0].length_m == 0.5
    assert len({environment.origin["drawn"] for _, environment in first}) == 1
    assert first[0][1].construct == (Segment(0.0, 0.0, 0.5, 0.0),)


@pytest.mark.parametrize(
    ("resolutions", "told"),
    [
        ({"lenght_m": 0.1}, "unknown parameter 'lenght_m'; did you mean length_m"),
        ({"length_m": 0.0}, "resolution of length_m = 0.0: expected a number above 0"),
        ({"length_m": math.nan}, "resolution of length_m = nan: expected a number above 0"),
        ({"turns": 0.5}, "resolution of turns = 0.5: expected a whole number"),
        ({"weight": 1.0}, "parameter 'weight' has no bounds"),
        ({"named": 1.0}, "parameter 'named' is a text without choices"),
        ({"length_m": 1e-9}, "expected at most 10000000, with coarser resolutions"),
    ],
)
def test_a_bad_resolution_is_refused_before_anything_is_made(resolutions: dict[str, float], told: str) -> None:
    with pytest.raises(InputError) as caught:
        grid(Parameters, resolutions)
    assert told in str(caught.value)


def test_as_many_candidates_pass_as_were_asked_for() -> None:
    schema, rng = found.load("splitting"), np.random.default_rng(1)
    parameters = schema.parameters()
    made = list(gcg(schema, parameters, Environment(), lambda e: len(e.construct) >= 3, 50, rng))
    assert len(made) == 50
    assert all(len(environment.construct) >= 3 for environment in made)


def test_generation_stops_where_nothing_passes_and_keeps_what_did() -> None:
    """Every fourth passes until ten have, and none afterwards."""
    calls = itertools.count()
    rng = np.random.default_rng(2)
    kept: list[Environment] = []
    made = gcg(WALL, Parameters(), Environment(), lambda _: _passes(next(calls)), 20, rng, 50)
    with pytest.raises(InputError) as caught:
        kept.extend(environment for environment in made)
    assert len(kept) == 10
    assert "the last 50 environments do not pass the filter; passed so far: 10 of 87 (11.5%)" in str(caught.value)
    assert "\n" not in str(caught.value)


def _passes(call: int) -> bool:
    return call % 4 == 0 and call < 40


@pytest.mark.parametrize("chunk", [1, 5, 64])
def test_valid_environments_are_those_that_elicit_the_behaviour_in_their_order(chunk: int) -> None:
    group = Still()
    made = (environment for _, environment in gccg(WALL, {"length_m": 0.25}, Environment()))
    valid = list(geg(made, LONG, group, start, chunk=chunk))
    assert [environment.construct[0].x1_m for environment in valid] == [1.5, 1.75, 2.0]  # type: ignore[union-attr]
    assert sum(group.asked) == candidates(Parameters, {"length_m": 0.25}) == 7


@pytest.mark.parametrize("value", [1.7, math.nan, -0.1, None, "far"])
def test_a_behaviour_that_returns_no_fitness_is_refused_and_what_was_valid_is_kept(value: object) -> None:
    def broken(positions: Floats, environment: Environment, parameters: Nothing) -> object:
        return 1.0 if environment.construct[0].x1_m < 1.0 else value  # type: ignore[union-attr]

    kept: list[Environment] = []
    made = (environment for _, environment in gccg(WALL, {"length_m": 0.25}, Environment()))
    valid = geg(made, Behaviour("mine", "", Nothing, 3, 1.0, broken), Still(), start)
    with pytest.raises(InputError, match="expected a number from 0 to 1"):
        kept.extend(environment for environment in valid)
    assert len(kept) == 2
