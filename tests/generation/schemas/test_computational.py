"""Computational schemas: closed forms of their walls, frames, statistics of what is drawn, and refusals."""

import importlib
import math

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.parameters import declared
from generation import behaviours, files, filters
from generation.environment import Environment
from generation.primitives import Circle, Point, Polyline, Segment
from generation.workspaces import corridor, field, t_junction

NAMES = ["dirt", "dsdr", "galton", "itb", "sirt"]
DETERMINISTIC = ["dirt", "dsdr", "galton", "itb"]


def schema(name):
    return importlib.import_module(f"generation.schemas.{name}")


def generated(name, seed=1, workspace=None, **given):
    module = schema(name)
    workspace = module.workspace() if workspace is None else workspace
    return module.generate(module.Parameters(**given), workspace, np.random.default_rng(seed))


@pytest.mark.parametrize("name", NAMES)
def test_each_keeps_the_contract(name):
    module = schema(name)
    environment = generated(name)
    assert files.from_json(files.to_json(environment)) == environment
    assert environment.workspace == module.workspace().workspace
    assert module.BEHAVIOUR in behaviours.names()
    assert module.FILTER in ["", *filters.names()]
    assert not module.FILTER or filters.load(module.FILTER).accepts(environment)
    for parameter in declared(module.Parameters).values():
        assert parameter.about.low <= parameter.default <= parameter.about.high < math.inf


@pytest.mark.parametrize("name", DETERMINISTIC)
def test_a_deterministic_schema_draws_nothing(name):
    rng = np.random.default_rng(1)
    module, before = schema(name), np.random.default_rng(1).bit_generator.state
    module.generate(module.Parameters(), module.workspace(), rng)
    assert rng.bit_generator.state == before


@pytest.mark.parametrize("name", ["dirt", "itb"])
@pytest.mark.parametrize(("angle", "length"), [(0.0, 1.0), (90.0, 2.0), (225.0, 2.5), (330.0, 0.7)])
def test_a_wall_leaves_its_anchor_at_its_angle(name, angle, length):
    (wall,) = generated(name, angle_deg=angle, length_m=length, anchor=2).construct
    at = schema(name).workspace().markers["anchor-2"]
    assert (wall.x0_m, wall.y0_m) == (at.x_m, at.y_m)
    assert math.hypot(wall.x1_m - wall.x0_m, wall.y1_m - wall.y0_m) == pytest.approx(length, rel=1e-12)
    turn = math.degrees(math.atan2(wall.y1_m - wall.y0_m, wall.x1_m - wall.x0_m)) - angle
    assert math.cos(math.radians(turn)) == pytest.approx(1.0, abs=1e-12)


def test_the_anchors_of_the_junction_are_its_four_corners():
    junction = t_junction(width_m=2.0)
    corners = {(mark.x_m, mark.y_m) for name, mark in junction.markers.items() if name.startswith("anchor")}
    assert corners == {(-1.0, 0.0), (1.0, 0.0), (-1.0, 2.0), (1.0, 2.0)}
    assert junction.markers["anchor-4"] == Point(1.0, 2.0)  # right corner of the far wall


def test_the_junction_is_its_own_mirror_image():
    walls = t_junction().walls()
    mirrored = walls * (-1.0, 1.0, -1.0, 1.0)
    ends = {frozenset([(a, b), (c, d)]) for a, b, c, d in walls.tolist()}
    assert {frozenset([(a, b), (c, d)]) for a, b, c, d in mirrored.tolist()} == ends


def test_the_default_funnel_of_dsdr_is_its_own_mirror_image():
    left, right = generated("dsdr").construct
    assert np.allclose(np.array(left) * (-1.0, 1.0, -1.0, 1.0), right, rtol=0.0, atol=1e-12)  # cos 45 and cos 135
    assert left.x1_m > left.x0_m


@pytest.mark.parametrize(("name", "given"), [("dirt", {"length_m": 0.0}), ("dsdr", {"left_m": 0.0, "right_m": 0.0})])
def test_a_wall_without_length_is_none(name, given):
    assert generated(name, **given).construct == ()


def test_walls_of_itb_are_built_one_after_the_other():
    first = generated("itb", anchor=1)
    second = generated("itb", anchor=9, workspace=first)
    assert len(second.construct) == 2
    assert second.construct[0] == first.construct[0]


@pytest.mark.parametrize("name", ["dirt", "itb", "sirt", "dsdr"])
def test_a_workspace_without_the_anchor_is_refused(name):
    with pytest.raises(InputError, match=r"has no point anchor-\d \(anchors: none\)"):
        generated(name, workspace=Environment())


def test_sirt_takes_as_many_steps_of_each_rule_as_its_probabilities_say():
    steps, chances = 100, {"rule_1": 0.5, "rule_2": 0.2}
    counts = np.zeros(3)
    for seed in range(100):
        (wall,) = generated("sirt", seed, iterations=steps, x_m=-0.1, y_m=0.2, **chances).construct
        moves = np.diff(np.array(wall.points_m), axis=0)
        assert len(moves) == steps
        along = np.rint(moves / (-0.1, 0.2)).astype(int)
        assert set(map(tuple, along)) <= {(1, 0), (0, 1), (1, 1)}
        counts += [(along == rule).all(axis=1).sum() for rule in ((1, 0), (0, 1), (1, 1))]
    expected = np.array([0.5, 0.2, 0.3])
    errors = np.sqrt(expected * (1.0 - expected) / counts.sum())
    assert (np.abs(counts / counts.sum() - expected) < 4.0 * errors).all()  # four standard errors


def test_sirt_of_the_third_rule_alone_is_the_diagonal_of_dirt():
    (steps,) = generated("sirt", iterations=10, rule_1=0.0, rule_2=0.0).construct
    (wall,) = generated("dirt", angle_deg=225.0, length_m=10 * 0.2 * math.sqrt(2.0)).construct
    assert steps.points_m[0] == (wall.x0_m, wall.y0_m)
    assert np.allclose(steps.points_m[-1], (wall.x1_m, wall.y1_m), rtol=0.0, atol=1e-12)  # ten sums


def test_sirt_refuses_probabilities_above_one_and_forgives_rounding():
    with pytest.raises(InputError, match=r"rule_1 \+ rule_2 = 1.1"):
        generated("sirt", rule_1=0.6, rule_2=0.5)
    assert isinstance(generated("sirt", rule_1=0.1 + 0.2, rule_2=0.7).construct[0], Polyline)


@pytest.mark.parametrize("rows", [1, 4, 9])
def test_a_galton_board_has_a_triangle_of_pegs_and_one_bin_more_than_rows(rows):
    environment = generated("galton", rows=rows)
    pegs = [part for part in environment.construct if isinstance(part, Circle)]
    assert len(pegs) == rows * (rows + 1) // 2
    centres = np.array([(peg.x_m, peg.y_m) for peg in pegs])
    assert centres[:, 0].mean() == pytest.approx(0.0, abs=1e-9)  # sums
    below = {(round(x, 6), round(y, 6)) for x, y in centres}
    for x, y in below:
        if y > centres[:, 1].min() + 1e-6:
            assert {(round(x - 20.0, 6), round(y - 34.64, 6)), (round(x + 20.0, 6), round(y - 34.64, 6))} <= below
    bins = [mark for name, mark in environment.markers.items() if name.startswith("bin-")]
    middles = [np.mean(area.corners_m, axis=0)[0] for area in bins]
    assert np.allclose(middles, (np.arange(rows + 1) - rows / 2) * 40.0, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"peg_m": 20.0}, "pegs touch"),
        ({"gap_m": 281.0}, "width of the board"),
    ],
)
def test_a_galton_board_that_cannot_be_built_is_refused(given, told):
    with pytest.raises(InputError, match=told):
        generated("galton", **given)


def test_a_funnel_as_wide_as_the_board_is_none():
    assert not any(
        isinstance(part, Segment) and part.x0_m != part.x1_m for part in generated("galton", gap_m=280.0).construct
    )


def test_starts_and_goals_lie_in_the_free_space():
    for workspace in (t_junction(), corridor(), field()):
        assert filters.load("passage").accepts(workspace)
