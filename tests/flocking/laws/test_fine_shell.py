"""The rules of the detection case study: extended HA and SNN as algorithm 2 and section 2.1.1 of Fine 2015 say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from flocking import lawentry
from flocking.types import NO_OBSTACLES, Kind, Motion, Own, members_at


def decide(name: str, positions: np.ndarray, u: float = 0.3, **parameters: float) -> Motion:
    law = lawentry.load(name)
    own = Own(np.array([0.2, 0.0]), 0.1, math.nan, np.full(2, math.nan), np.zeros(2, dtype=bool), 0.1, 0, 0)
    return law.decide(
        own,
        members_at(positions),
        np.ones((1, len(positions)), dtype=np.bool_),
        NO_OBSTACLES,
        law.parameters(parameters),
        np.zeros(law.memory),
        np.full(law.draws, u),
    )


def moved(motion: Motion) -> np.ndarray:
    return np.array([motion.x, motion.y])


class TestExtendedHamilton:
    RULES = lawentry.load("extended-hamilton").rules

    def rule(self, motion: Motion) -> str:
        return self.RULES[motion.rule]

    def test_nothing_detected_keeps_the_last_command(self) -> None:
        motion = decide("extended-hamilton", np.empty((0, 2)))
        assert motion.kind == Kind.HOLD
        assert self.rule(motion) == "none"

    def test_one_input_is_snn(self) -> None:
        motion = decide("extended-hamilton", np.array([[2.0, 1.0]]))
        assert self.rule(motion) == "snn"
        assert moved(motion).tolist() == [2.0, 1.0]

    def test_way_point_is_on_the_line_the_repulsion_distance_from_the_nearest(self) -> None:
        a1, a2 = np.array([2.0, 0.0]), np.array([2.0, 3.0])
        motion = decide("extended-hamilton", np.array([a2, a1]), repulsion_m=0.66, exclusion_m=0.5)
        assert self.rule(motion) == "hamilton"
        assert_allclose(moved(motion), [2.0, 0.66])

    def test_way_point_does_not_lie_beyond_the_second_member_unless_told_so(self) -> None:
        positions = np.array([[2.0, 0.0], [2.0, 0.5]])
        assert_allclose(moved(decide("extended-hamilton", positions, exclusion_m=0.0)), [2.0, 0.5])
        beyond = decide("extended-hamilton", positions, exclusion_m=0.0, beyond_gap=True)
        assert_allclose(moved(beyond), [2.0, 0.66])

    def test_second_member_is_nearest_among_those_beyond_the_exclusion_distance(self) -> None:
        positions = np.array([[2.0, 0.0], [2.0, 0.3], [2.0, -0.9], [2.0, 2.0]])
        near, far = (decide("extended-hamilton", positions, exclusion_m=e) for e in (0.2, 0.5))
        assert_allclose(moved(near), [2.0, 0.3])
        assert_allclose(moved(far), [2.0, -0.66])

    @pytest.mark.parametrize(("gap", "rule"), [(0.5 + 1e-9, "hamilton"), (0.5 - 1e-9, "snn")])
    def test_exclusion_distance_is_exact(self, gap: float, rule: str) -> None:
        positions = np.array([[1.0, 0.0], [1.0 + gap, 0.0]])
        assert self.rule(decide("extended-hamilton", positions, exclusion_m=0.5)) == rule

    def test_the_nearest_is_never_its_own_second(self) -> None:
        motion = decide("extended-hamilton", np.array([[1.0, 0.5], [1.0, 0.5]]), exclusion_m=0.0)
        assert self.rule(motion) == "snn"

    @settings(max_examples=60, deadline=None)
    @given(angle=st.floats(-3.0, 3.0), distance=st.floats(0.05, 0.6), u=st.floats(0.0, 0.999))
    def test_within_the_repulsion_distance_the_way_point_is_perpendicular(
        self, angle: float, distance: float, u: float
    ) -> None:
        a1 = distance * np.array([math.cos(angle), math.sin(angle)])
        a2 = np.array([1.5, 2.0])
        motion = decide("extended-hamilton", np.array([a1, a2]), u=u)
        assert self.rule(motion) == "perpendicular"
        assert np.dot(moved(motion), a2 - a1) == pytest.approx(0.0, abs=1e-12)
        assert np.hypot(*moved(motion)) == pytest.approx(0.66)

    def test_both_signs_of_the_perpendicular_are_equally_likely(self) -> None:
        rng = np.random.default_rng(3)
        positions = np.array([[0.4, 0.0], [2.0, 0.0]])
        ups = sum(decide("extended-hamilton", positions, u=u).y > 0 for u in rng.random(400))
        # four standard errors of a fair coin thrown 400 times
        assert abs(ups - 200) < 4 * math.sqrt(400 * 0.25)


class TestSnn:
    def test_moves_to_the_nearest_and_stops_within_the_repulsion_distance(self) -> None:
        assert moved(decide("snn", np.array([[3.0, 0.0], [0.0, 2.0]]))).tolist() == [0.0, 2.0]
        assert decide("snn", np.array([[0.3, 0.0], [0.0, 2.0]])).kind == Kind.STOP
