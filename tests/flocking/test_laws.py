"""Contract tests: every law that exists is found by itself and must bear all of this."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from flocking import lawentry
from flocking.parameters import declared
from flocking.types import NO_OBSTACLES, Kind, Members, Motion, Own, members_at

LAWS = lawentry.names()
ROUNDING = 1e-9
"""m; a rotation and back costs a few ulps of positions below 10 m, amplified by at most 1/gap (gaps > 1e-3 m)."""


def own() -> Own:
    return Own(np.array([0.2, 0.0]), 0.1, math.nan, np.full(2, math.nan), np.zeros(2, dtype=bool), 0.1, 0, 0)


def decide(name: str, positions: np.ndarray, u: float = 0.3, compiled: bool = True, **parameters: float) -> Motion:
    law = lawentry.load(name)
    members = members_at(positions)
    call = law.decide if compiled else law.function
    return call(
        own(),
        members,
        np.ones((len(law.sets), len(members.ids)), dtype=np.bool_),
        NO_OBSTACLES,
        law.parameters(parameters),
        np.zeros(law.memory),
        np.full(law.draws, u),
    )


def scenes(count: int = 40) -> list[np.ndarray]:
    rng = np.random.default_rng(7)
    return [rng.uniform(-4.0, 4.0, size=(rng.integers(1, 12), 2)) for _ in range(count)]


def turned(positions: np.ndarray, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return positions @ np.array([[c, s], [-s, c]])


def moved(motion: Motion) -> np.ndarray:
    return np.array([motion.x, motion.y])


@pytest.mark.parametrize("name", LAWS)
class TestEveryLaw:
    def test_says_where_it_comes_from(self, name: str) -> None:
        law = lawentry.load(name)
        assert "Source:" in (law.module.__doc__ or "")
        assert all(d.about.source for d in declared(law.module.Parameters).values())
        assert len(set(law.rules)) == len(law.rules) >= 1

    def test_order_of_neighbours_does_not_matter(self, name: str) -> None:
        rng = np.random.default_rng(1)
        for positions in scenes():
            assert decide(name, positions) == pytest.approx(decide(name, rng.permutation(positions)), nan_ok=True)

    def test_order_does_not_matter_among_equally_near_neighbours(self, name: str) -> None:
        ring = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        for shift in range(4):
            assert decide(name, np.roll(ring, shift, axis=0)) == pytest.approx(decide(name, ring), nan_ok=True)

    def test_rotated_neighbours_rotate_the_motion(self, name: str) -> None:
        for positions in scenes():
            motion, again = decide(name, positions), decide(name, turned(positions, 0.7))
            assert (again.kind, again.rule) == (motion.kind, motion.rule)
            if motion.kind in (Kind.WAY_POINT, Kind.VELOCITY, Kind.ACCELERATION):
                assert_allclose(moved(again), turned(moved(motion), 0.7), atol=ROUNDING)

    def test_mirrored_neighbours_mirror_the_motion(self, name: str) -> None:
        mirror = np.array([1.0, -1.0])
        for positions in scenes():
            # a random sign is mirrored by mirroring its draw
            motion, again = decide(name, positions, u=0.3), decide(name, positions * mirror, u=0.7)
            assert (again.kind, again.rule) == (motion.kind, motion.rule)
            if motion.kind in (Kind.WAY_POINT, Kind.VELOCITY, Kind.ACCELERATION):
                assert_allclose(moved(again), moved(motion) * mirror, atol=ROUNDING)

    def test_compiled_and_plain_agree(self, name: str) -> None:
        for positions in scenes():
            compiled, plain = decide(name, positions), decide(name, positions, compiled=False)
            # both run the same operations in the same order; only fused multiply-adds may differ
            assert_allclose(compiled, [float(v) for v in plain], rtol=1e-14, atol=1e-14)

    @pytest.mark.parametrize(
        "positions",
        [np.empty((0, 2)), np.zeros((1, 2)), np.ones((5, 2)), np.array([[1e-12, 0.0], [5.6, 0.0]])],
        ids=["nobody", "on the focal member", "coincident", "at both ends of the range"],
    )
    def test_limits_give_finite_motions(self, name: str, positions: np.ndarray) -> None:
        motion = decide(name, positions)
        assert motion.kind in list(Kind)
        if motion.kind not in (Kind.HOLD, Kind.STOP):
            assert np.isfinite(moved(motion)).all()

    def test_members_that_no_set_holds_do_not_matter(self, name: str) -> None:
        law = lawentry.load(name)
        kept, others = scenes(2)
        both = np.vstack([kept, others * 0.1])
        mask = np.zeros((len(law.sets), len(both)), dtype=np.bool_)
        mask[:, : len(kept)] = True
        motion = law.decide(
            own(),
            members_at(both),
            mask,
            NO_OBSTACLES,
            law.parameters({}),
            np.zeros(law.memory),
            np.full(law.draws, 0.3),
        )
        assert motion == pytest.approx(decide(name, kept), nan_ok=True)

    def test_runs_on_members_of_which_only_positions_are_known(self, name: str) -> None:
        members = members_at(np.array([[1.0, 2.0]]))
        assert isinstance(members, Members)
        if lawentry.load(name).needs <= {"positions", "bearings"}:
            assert np.isfinite(decide(name, members.positions).kind)


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
