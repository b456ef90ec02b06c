"""Schemas are found by their files, Python or TOML, and users' own by their paths."""

from __future__ import annotations

import itertools
import pickle
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.parameters import declared, filled
from generation import filters, found
from generation.environment import Environment
from generation.files import from_json, to_json
from generation.grammar import files
from generation.grammar.derivations import derive
from generation.primitives import Point, Segment
from generation.schema import Schema

MINE = '''"""A wall of mine, somewhere."""

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import Segment

FILTER = ""
BEHAVIOUR = "simple-split"


class Parameters(NamedTuple):
    length_m: Annotated[float, Parameter("m", "mine", low=0.1, high=10.0)] = 1.0


def workspace():
    return Environment()


def generate(parameters, workspace, rng):
    return Environment(construct=(Segment(0.0, 0.0, parameters.length_m, 0.0),))
'''


@pytest.mark.parametrize("name", found.schemas())
def test_every_schema_generates_what_a_file_can_hold_and_the_same_from_the_same_seed(name: str) -> None:
    schema = found.load(name)
    assert schema.about
    parameters, workspace = schema.parameters(), schema.workspace()
    for values in declared(schema.parameters).values():
        assert filled(schema.parameters, {values.name: values.default}) == parameters
    first, second = (schema.generate(parameters, workspace, np.random.default_rng(3)) for _ in range(2))
    assert first == second
    assert from_json(to_json(first), "memory").construct == first.construct
    assert pickle.loads(pickle.dumps(parameters)) == parameters


def test_grammars_and_modules_are_listed_together() -> None:
    assert {"splitting", "weiring", "points", "dirt", "sirt"} <= set(found.schemas())


def test_an_unknown_name_is_told_with_the_nearest() -> None:
    with pytest.raises(InputError, match="unknown schema 'spliting'; did you mean splitting"):
        found.load("spliting")
    with pytest.raises(InputError, match="unknown schema 'dsrd'; did you mean"):
        found.load("dsrd")


def test_a_users_own_file_is_a_schema(tmp_path: Path) -> None:
    (tmp_path / "my_wall.py").write_text(MINE)
    mine = found.load(str(tmp_path / "my_wall.py"))
    assert (mine.name, mine.about) == ("my-wall", "A wall of mine, somewhere.")
    made = mine.generate(filled(mine.parameters, {"length_m": 2.0}), mine.workspace(), np.random.default_rng(0))
    assert made.fence_length() == 2.0
    text = (found.FOLDER / "splitting.toml").read_text()
    (tmp_path / "my_tree.toml").write_text(text)
    tree = found.load(str(tmp_path / "my_tree.toml"))
    assert tree.name == "my-tree"
    assert _made(tree, 5) == _made(found.load("splitting"), 5)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("FILTER", "FLITER", "lacks FILTER; expected Parameters"),
        ('"""A wall of mine, somewhere."""', "", "lacks a docstring"),
        ("def workspace():\n    return Environment()", "workspace = 3", "workspace is 3; expected a function"),
        ('BEHAVIOUR = "simple-split"', "BEHAVIOUR = 3", "BEHAVIOUR is 3; expected a name"),
        ("def generate(", "def generate((", "my_wall.py, line 21: "),
        ('Annotated[float, Parameter("m", "mine", low=0.1, high=10.0)]', "float", "lacks its Parameter"),
    ],
)
def test_a_file_that_is_no_schema_is_refused_in_one_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in MINE
    (tmp_path / "my_wall.py").write_text(MINE.replace(old, new))
    with pytest.raises(InputError) as caught:
        found.load(str(tmp_path / "my_wall.py"))
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_fault_of_a_users_schema_names_its_line(tmp_path: Path) -> None:
    (tmp_path / "my_wall.py").write_text(MINE.replace("parameters.length_m, 0.0", "1 / 0, 0.0"))
    mine = found.load(str(tmp_path / "my_wall.py"))
    with pytest.raises(InputError, match=r"my_wall.py, line 22: ZeroDivisionError"):
        mine.generate(mine.parameters(), mine.workspace(), np.random.default_rng(0))


def test_a_grammar_that_builds_in_an_unknown_workspace_is_refused(tmp_path: Path) -> None:
    text = (found.FOLDER / "points.toml").read_text().replace('"sirt"', '"sirtt"')
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(InputError, match="schema 'sirtt'; did you mean sirt"):
        found.load(str(tmp_path / "mine.toml"))


def _made(schema: Schema, seed: int) -> Environment:
    return schema.generate(schema.parameters(), schema.workspace(), np.random.default_rng(seed))


# the grammars that come with the product


def test_the_splitting_grammar_gives_three_lines_and_more_with_its_exact_probability() -> None:
    """35/64, where a square brings 0, 1, 1 or 2 lines with a square each (Fine 2015: 53.7 % of 1000)."""
    schema, count = found.load("splitting"), 4000
    rng, passes = np.random.default_rng(17), filters.load(schema.filter)
    parameters = schema.parameters()
    made = [schema.generate(parameters, Environment(), rng) for _ in range(count)]
    share = np.mean([passes.accepts(environment) for environment in made])
    exact = 35 / 64
    assert abs(share - exact) < 3.0 * np.sqrt(exact * (1.0 - exact) / count)
    assert abs(share - 0.537) < 0.03
    assert {w for e in made for w in e.markers} == {"start"}


def test_the_exact_probability_of_three_lines() -> None:
    """Polynomials of the number of lines: each square brings 1, x, x or x^2, with a square for each x."""
    lines = np.array([1.0])
    for _ in range(3):  # after three generations, the coefficients below x^3 are final
        branch = np.concatenate([[0.0], lines])
        both = np.convolve(branch, branch)
        lines = np.zeros(len(both))
        lines[0] = 0.25
        lines[: len(branch)] += 0.5 * branch
        lines += 0.25 * both
    assert 1.0 - lines[:3].sum() == pytest.approx(35 / 64, abs=1e-12)


PASSING_WEIRS = {3: 10, 4: 39, 5: 123, 6: 372, 7: 1079, 8: 3131}
"""By the lines after the first, how many of the 3 ** lines ways to turn them pass, each way tried once."""


def test_the_weirs_that_pass_are_those_that_were_counted() -> None:
    """The ways of up to five lines, which take a second; those of more take a minute."""
    passes = filters.load("enclosing")
    for lines in (3, 4, 5):
        tried = [_weir(turns) for turns in itertools.product((0, 45, 90), repeat=lines)]
        assert sum(map(passes.accepts, tried)) == PASSING_WEIRS[lines]


def _weir(turns_deg: Sequence[int]) -> Environment:
    """The first line, 40 below the marker, and a line of 40 for each turn, at the end of the last one."""
    places = np.array([[-20.0, -40.0], [20.0, -40.0]])
    for heading in np.radians(np.cumsum(turns_deg)):
        places = np.vstack([places, places[-1] + 40.0 * np.array([np.cos(heading), np.sin(heading)])])
    walls = tuple(Segment(*map(float, (*a, *b))) for a, b in itertools.pairwise(places))
    return Environment(construct=walls, markers={"origin": Point()})


def test_weirs_pass_their_filter_with_their_exact_probability() -> None:
    """0.473: three standard errors of the sample, ±0.047, are allowed, and nothing for the publication's.

    Fine 2015, table 7.1, has 50.1 % of 1000. The reading is a choice; its probability lies within three standard errors
    of the publication's own sample.
    """
    schema, count = found.load("weiring"), 1000
    rng, passes = np.random.default_rng(19), filters.load(schema.filter)
    exact = np.mean([passing / 3**lines for lines, passing in PASSING_WEIRS.items()])
    error = np.sqrt(exact * (1.0 - exact) / count)
    made = [_of(schema, rng) for _ in range(count)]
    share = np.mean([passes.accepts(environment) for environment in made])
    assert abs(share - exact) < 3.0 * error
    assert abs(exact - 0.501) < 3.0 * np.sqrt(0.25 / 1000)
    for environment in made[:100]:
        walls = environment.construct_walls()
        lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
        assert lengths / 40 == pytest.approx(np.round(lengths / 40), abs=1e-9)  # lines in one direction are one
        assert environment.markers["origin"] == (0.0, 0.0, 0.0)


def test_both_ends_of_the_weirs_first_line_grow() -> None:
    """Its rule is applied mirrored in half of all cases: three standard errors."""
    grammar, rng, count = files.read(found.FOLDER / "weiring.toml"), np.random.default_rng(23), 400
    first = [derive(grammar, rng, 4, 4).moves[0] for _ in range(count)]
    assert {rule for rule, _ in first} == {"end"}
    assert abs(sum(under.mirrored for _, under in first) - count / 2) < 3.0 * np.sqrt(count) / 2


def test_points_are_those_of_sirt() -> None:
    """The mean and the spread of the wall's end, over 3000 walls of either: three standard errors."""
    points, sirt = found.load("points"), found.load("sirt")
    rng, workspace = np.random.default_rng(29), sirt.workspace()
    anchor = workspace.markers["anchor-4"]
    ends = {}
    for schema in (points, sirt):
        walls = [schema.generate(schema.parameters(), workspace, rng).construct_walls() for _ in range(3000)]
        ends[schema.name] = np.array([np.minimum(w[:, :2], w[:, 2:]).min(axis=0) for w in walls]) - anchor[:2]
    for axis in (0, 1):
        a, b = ends["points"][:, axis], ends["sirt"][:, axis]
        assert abs(a.mean() - b.mean()) < 3.0 * np.sqrt((a.var() + b.var()) / 3000)
        assert a.mean() == pytest.approx(-0.2 * 12 * 0.8, abs=3.0 * a.std() / np.sqrt(3000))


def test_the_probabilities_of_points_are_parameters() -> None:
    points = found.load("points")
    assert list(declared(points.parameters)) == ["most_steps", "probability_x", "probability_y", "probability_diagonal"]
    given = filled(points.parameters, {"probability_x": 0.5, "probability_y": 0.0, "probability_diagonal": 0.0})
    (wall,) = points.generate(given, points.workspace(), np.random.default_rng(0)).construct_walls()
    assert np.hypot(wall[2] - wall[0], wall[3] - wall[1]) == pytest.approx(12 * 0.2)
    nothing = filled(points.parameters, {"probability_x": 0.0, "probability_y": 0.0, "probability_diagonal": 0.0})
    with pytest.raises(InputError, match="all probabilities are 0"):
        points.generate(nothing, points.workspace(), np.random.default_rng(0))
    with pytest.raises(InputError, match="starts at the marker 'anchor-4'; the workspace has the points: none"):
        points.generate(given, Environment(), np.random.default_rng(0))


def test_a_least_limit_above_the_most_is_refused() -> None:
    weir = found.load("weiring")
    with pytest.raises(InputError, match="least_steps = 9: expected at most most_steps = 5"):
        weir.generate(
            filled(weir.parameters, {"least_steps": 9, "most_steps": 5}), Environment(), np.random.default_rng(0)
        )


def _of(schema: Schema, rng: np.random.Generator) -> Environment:
    return schema.generate(schema.parameters(), Environment(), rng)


def test_an_environments_file_is_no_schema_and_the_message_says_what_takes_it(tmp_path: Path) -> None:
    for name in ("plan.json", "plan.SVG"):
        with pytest.raises(InputError, match="herd validate"):
            found.load(str(tmp_path / name))
