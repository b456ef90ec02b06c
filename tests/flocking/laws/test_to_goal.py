"""To a goal: the goal itself is the way-point, until it is reached, whatever else there is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking import lawentry
from flocking.types import Kind, Motion
from tests.flocking.laws.asking import ask, run

ARRIVED_M = lawentry.load("to-goal").parameters({}).arrived_m


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(0.0, 1.0))
def test_the_way_point_is_the_goal_and_a_goal_that_is_reached_is_none(x: float, y: float, arrived_m: float) -> None:
    motion, rule = ask("to-goal", goal=(x, y), arrived_m=arrived_m)
    if x * x + y * y > arrived_m * arrived_m:
        assert (motion, rule) == (Motion(Kind.WAY_POINT, x, y, 1), "go")
    else:
        assert (motion, rule) == (Motion(Kind.STOP, 0.0, 0.0, 0), "stand")


@pytest.mark.parametrize(("off", "rule"), [(1e-9, "go"), (-1e-9, "stand")])
def test_it_stands_within_a_twentieth_of_a_metre(off: float, rule: str) -> None:
    assert ARRIVED_M == 0.05
    for bearing in np.linspace(-3.0, 3.0, 7):
        reach = ARRIVED_M + off
        assert ask("to-goal", goal=(reach * math.cos(bearing), reach * math.sin(bearing)))[1] == rule


def test_without_a_goal_it_stands() -> None:
    assert ask("to-goal")[1] == "stand"
    assert ask("to-goal", goal=(math.nan, 1.0))[1] == "stand"


def test_nobody_and_nothing_near_changes_its_way() -> None:
    """Whoever tells the goal sees to it that the way is free."""
    alone = ask("to-goal", goal=(2.0, -1.0))
    among = ask(
        "to-goal", [[0.4, -0.2], [-0.3, 0.1]], obstacles=[[0.3, -0.15]], contacts=(True, True), goal=(2.0, -1.0)
    )
    assert among == alone


def test_a_kinematic_member_is_at_its_goal_after_a_step_and_stays() -> None:
    """Its way-points are where it is next, however far: so an idealised member moves."""
    goals = np.array([[3.0, 4.0], [-1.0, 0.5]])
    starts = np.array([[0.0, 0.0, 0.3], [2.0, 2.0, -1.0]])
    track = run("to-goal", starts, steps=5, dt=0.1, goals_w=goals).positions_w
    # rounding of a turn into the member's frame and back
    np.testing.assert_allclose(track[1], goals, atol=1e-9)
    np.testing.assert_array_equal(track[2:], np.broadcast_to(track[1], track[2:].shape))
