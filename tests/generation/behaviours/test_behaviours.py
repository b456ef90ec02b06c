"""Behaviours: against a slow oracle, closed forms, invariances, and users' files that break their promise."""

import itertools
import math

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.measures.fragments import crossed, entered, fragments
from flocking.measures.groups import group_labels, group_sizes, share_entropy
from generation import behaviours
from generation.behaviours.reduce_x_deviation import x_deviation
from generation.environment import Environment
from generation.primitives import Circle, Point, Polygon, Segment

EMPTY = Environment()
ORIGIN = Environment(markers={"origin": Point(10.0, -5.0)})


def judged(name, positions, environment=EMPTY, **given):
    behaviour = behaviours.load(name)
    return behaviour.judged(np.asarray(positions), environment, behaviour.filled(given))


def apart(gaps, sizes=(3, 3)):
    """Two groups of members on two places, that far apart at each time, m: (T, N, 2)."""
    x = np.concatenate([np.zeros(sizes[0]), np.ones(sizes[1])])
    positions = np.zeros((len(gaps), sum(sizes), 2))
    positions[..., 0] = np.asarray(gaps, dtype=float)[:, None] * x
    return positions


def wandering(rng, times=60, count=12, spread=60.0):
    """Members that wander at random, m: (T, N, 2)."""
    start = rng.uniform(-spread / 2, spread / 2, (count, 2))
    return start + np.cumsum(rng.normal(0.0, 3.0, (times, count, 2)), axis=0)


def longest(holds):
    return max((len(list(run)) for held, run in itertools.groupby(holds) if held), default=0)


@pytest.mark.parametrize("name", behaviours.names())
def test_each_behaviour_keeps_the_contract(name):
    behaviour = behaviours.load(name)
    environment = Environment(markers={"origin": Point(), "goal": Segment(2.0, -9.0, 2.0, 9.0)})
    value = behaviour.judged(wandering(np.random.default_rng(1)), environment)
    assert 0.0 <= value <= 1.0
    assert behaviour.about
    assert behaviour.name == name


@pytest.mark.parametrize("name", behaviours.names())
def test_no_behaviour_depends_on_the_order_of_members(name):
    rng = np.random.default_rng(2)
    environment = Environment(markers={"origin": Point(), "goal": Segment(2.0, -9.0, 2.0, 9.0)})
    for spread in (20.0, 60.0, 90.0):
        positions = wandering(rng, spread=spread)
        values = [judged(name, positions[:, order], environment) for order in (slice(None), rng.permutation(12))]
        assert values[0] == pytest.approx(values[1], abs=1e-12)  # sums in another order


def test_fragments_are_the_groups_of_the_measure():
    positions = wandering(np.random.default_rng(3), times=200, spread=80.0)
    found = fragments(positions, 25.0)
    sizes = group_sizes(group_labels(positions, 25.0))
    assert np.array_equal(found.groups, (sizes > 0).sum(axis=-1))
    assert np.allclose(found.entropy, share_entropy(sizes), rtol=0.0, atol=1e-12)  # sums in another order
    assert len(set(found.groups)) > 2  # the formations differ


def test_a_link_of_the_threshold_joins_and_a_longer_one_does_not():
    assert fragments(apart([25.0, np.nextafter(25.0, 26.0)]), 25.0).groups.tolist() == [1, 2]


def test_a_chain_is_one_group_in_any_order():
    chain = np.column_stack([np.arange(9) * 24.9, np.zeros(9)])
    for seed in range(20):
        assert fragments(np.random.default_rng(seed).permutation(chain)[None], 25.0).groups.tolist() == [1]


@pytest.mark.parametrize(("run", "expected"), [(49, 0.0), (50, 1.0)])
def test_simple_split_wants_fifty_iterations_in_a_row(run, expected):
    gaps = np.zeros(201)
    gaps[100 : 100 + run] = 30.0
    gaps[20:69] = 30.0
    assert judged("simple-split", apart(gaps)) == expected


def test_the_start_is_no_iteration_and_nothing_counts_after_the_last_one():
    gaps = np.zeros(402)
    gaps[:50] = 30.0
    assert judged("simple-split", apart(gaps)) == 0.0
    gaps[50] = 30.0
    assert judged("simple-split", apart(gaps)) == 1.0
    late = np.zeros(402)
    late[152:] = 30.0
    assert judged("simple-split", apart(late)) == 0.0
    assert judged("simple-split", apart(late[1:])) == 1.0


@pytest.mark.parametrize("name", ["simple-split", "balanced-split", "corralling"])
@pytest.mark.parametrize("consecutive", [1, 3, 10])
def test_runs_are_found_as_by_looking_at_every_iteration(name, consecutive):
    rng = np.random.default_rng(4)
    seen = set()
    for spread in np.linspace(5.0, 60.0, 60):
        positions = wandering(rng, spread=spread, count=6)
        sizes = group_sizes(group_labels(positions[1:], 25.0))
        groups = (sizes > 0).sum(axis=-1)
        if name == "corralling":
            near = np.hypot(*(positions[1:].mean(axis=1) - (10.0, -5.0)).T) <= 25.0
            holds = (groups == 1) & near
        elif name == "balanced-split":
            holds = (groups > 1) & (share_entropy(sizes) >= 0.3)
        else:
            holds = groups > 1
        expected = float(longest(holds) >= consecutive)
        assert judged(name, positions, ORIGIN, consecutive=consecutive) == expected
        seen.add(expected)
    assert seen == {0.0, 1.0} or consecutive < 10


@pytest.mark.parametrize(("sizes", "expected"), [((24, 1), 0.0), ((23, 2), 1.0), ((12, 13), 1.0)])
def test_balance_is_entropy_relative_to_that_of_equal_groups(sizes, expected):
    shares = np.array(sizes) / 25.0
    entropy = -float((shares * np.log(shares)).sum()) / math.log(2)
    assert (entropy >= 0.3) == bool(expected)
    assert judged("balanced-split", apart([30.0] * 6, sizes)) == expected


def test_corralling_wants_the_whole_herd_near_the_origin_marker():
    near = np.full((51, 4, 2), (10.0, 19.9))
    far = np.full((51, 4, 2), (10.0, 20.1))
    assert judged("corralling", near, ORIGIN) == 1.0
    assert judged("corralling", far, ORIGIN) == 0.0
    assert judged("corralling", near - (10.0, -5.0)) == 1.0  # no marker: the origin of the frame
    near[30, 0] = (10.0, -40.0)
    assert judged("corralling", near, ORIGIN) == 0.0


def test_two_robots_of_three_are_enough_when_two_thirds_are_asked_for():
    two_of_three = apart([30.0] * 51, (2, 1))
    assert judged("corralling", two_of_three) == 0.0
    assert judged("corralling", two_of_three, connectivity=2.0 / 3.0) == 1.0
    assert judged("corralling", apart([30.0] * 51, (1, 2)), connectivity=2.0 / 3.0) == 0.0  # the two are far away
    assert judged("corralling", apart([30.0] * 51, (2, 2)), connectivity=2.0 / 3.0) == 0.0


def test_turn_right_is_the_share_of_members_that_crossed_the_line():
    ways = np.array([[[0, 0], [4, 0]], [[4, 0], [0, 0]], [[0, 0], [1, 0]], [[0, 2], [4, 2]]], dtype=float)
    environment = Environment(markers={"goal": Segment(2.0, -1.0, 2.0, 1.0)})
    assert judged("turn-right", ways.transpose(1, 0, 2), environment) == 0.5
    there_and_back = np.array([[[0.0, 0.0]], [[4.0, 0.0]], [[0.0, 0.0]]])
    assert judged("turn-right", there_and_back, environment) == 1.0


def test_crossing_is_the_same_in_every_frame():
    rng = np.random.default_rng(5)
    positions, line = wandering(rng, count=40, spread=60.0), np.array([-20.0, -10.0, 30.0, 25.0])
    expected = crossed(positions, line)
    assert 0.1 < expected.mean() < 0.9
    for turn in np.linspace(0.1, 6.0, 7):
        c, s = math.cos(turn), math.sin(turn)
        to = np.array([[c, s], [-s, c]])
        moved = np.concatenate([line[:2] @ to + (7.0, -3.0), line[2:] @ to + (7.0, -3.0)])
        assert np.array_equal(crossed(positions @ to + (7.0, -3.0), moved), expected)


def test_a_polygon_as_goal_counts_members_that_were_inside():
    corners = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)])
    path = np.array([[[1, 1], [2, 3], [5, 1], [-1, 2]], [[9, 9], [2, 2], [3.5, 1], [-1, 3]]], dtype=float)
    assert entered(path, corners).tolist() == [True, False, True, False]
    assert judged("turn-right", path, Environment(markers={"goal": Polygon(tuple(map(tuple, corners)))})) == 0.5


def test_deviation_is_that_of_a_known_formation_and_its_fitness_the_share_that_is_gone():
    start = np.array([[-3.0, 0.0], [3.0, 0.0], [-3.0, 5.0], [3.0, 5.0]])
    positions = np.stack([start, start * (0.25, 9.0)])
    assert x_deviation(positions).tolist() == [3.0, 0.75]
    assert judged("reduce-x-deviation", positions) == 0.75
    assert judged("reduce-x-deviation", positions[::-1]) == 0.0
    assert judged("reduce-x-deviation", positions[:, :1]) == 0.0
    assert judged("reduce-x-deviation", positions * (0.0, 1.0)) == 0.0


@pytest.mark.parametrize(
    ("markers", "told"),
    [({}, "'goal' is missing"), ({"goal": Circle()}, "'goal' is a circle; expected a segment or polygon")],
)
def test_a_missing_marker_is_told(markers, told):
    with pytest.raises(InputError, match=told):
        judged("turn-right", np.zeros((2, 1, 2)), Environment(markers=markers))


OWN = """'''Mine.'''
from typing import NamedTuple
ITERATIONS = 5
SUCCESS = 0.5
class Parameters(NamedTuple):
    pass
def fitness(positions, environment, parameters):
    return {value}
"""


@pytest.mark.parametrize(
    ("value", "told"),
    [("1.7", "1.7"), ("float('nan')", "nan"), ("-0.1", "-0.1"), ("'good'", "'good'"), ("None", "None"),
     ("1 / 0", "line 8: ZeroDivisionError")],
)  # fmt: skip
def test_a_users_behaviour_that_breaks_its_promise_is_told_in_one_line(tmp_path, value, told):
    path = tmp_path / "mine.py"
    path.write_text(OWN.format(value=value))
    behaviour = behaviours.load(str(path))
    with pytest.raises(InputError) as raised:
        behaviour.judged(np.zeros((6, 2, 2)), EMPTY)
    assert str(path) in str(raised.value)
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_users_behaviour_is_judged_like_any_other(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(OWN.format(value="0.25"))
    behaviour = behaviours.load(str(path))
    assert behaviour.judged(np.zeros((6, 2, 2)), EMPTY) == 0.25
    assert (behaviour.iterations, behaviour.about) == (5, "Mine.")
    assert not behaviour.succeeds(0.25)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [("SUCCESS = 0.5", "", "lacks SUCCESS"), ("ITERATIONS = 5", "ITERATIONS = 0", "ITERATIONS = 0"),
     ("SUCCESS = 0.5", "SUCCESS = 2", "SUCCESS = 2"), ("def fitness", "def fit", "lacks fitness")],
)  # fmt: skip
def test_a_users_file_that_is_no_behaviour_is_told(tmp_path, old, new, told):
    path = tmp_path / "mine.py"
    path.write_text(OWN.format(value=1).replace(old, new))
    with pytest.raises(InputError, match=told):
        behaviours.load(str(path))


def test_an_unknown_name_gets_the_nearest_ones():
    with pytest.raises(InputError, match="did you mean corralling"):
        behaviours.load("coralling")


@pytest.mark.parametrize("positions", [np.zeros((2, 2)), np.zeros((0, 3, 2)), np.full((2, 3, 2), np.nan)])
def test_bad_positions_are_refused(positions):
    with pytest.raises(InputError, match="positions"):
        behaviours.load("simple-split").judged(positions, EMPTY)
