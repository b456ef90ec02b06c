"""The laws of selfish herds and of the local crowded horizon, each against what its own publication says of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import lawentry
from flocking.measures import formation
from flocking.types import Kind
from tests.flocking.laws.deciding import EXACT, decide, herd, moved, rule, square


class TestSelfishHerd:
    """Hamilton 1971, Viscido et al. 2002: nearest neighbours make many small groups, the crowded horizon one."""

    MEMBERS, SIDE, STEPS = 50, 28.0, 100
    LINK = 4.0
    """Body-lengths; members nearer than two repulsion distances are of one group."""

    @pytest.mark.parametrize("name", ["viscido-snn", "hamilton-2d", "viscido-ha"])
    def test_rules_of_the_nearest_neighbour_make_many_small_groups(self, name: str) -> None:
        for seed in range(5):
            end = herd(name, square(self.MEMBERS, self.SIDE, seed), self.STEPS).positions_w[-1]
            assert formation.number_of_groups(end, self.LINK) >= 3
            # each is with its group: two repulsion distances, and most far nearer
            assert np.median(formation.nearest_neighbour_distance(end)) < 2.0

    def test_local_crowded_horizon_makes_one_compact_group(self) -> None:
        for seed in range(5):
            starts = square(self.MEMBERS, self.SIDE, seed)
            end = herd("viscido-lch", starts, self.STEPS).positions_w[-1]
            assert formation.number_of_groups(end, self.LINK) == 1
            # steps of one body-length that pass the centre keep the members within one of it
            assert formation.mmd(end) < 1.0

    def test_snn_steps_one_body_length_and_stops_at_two(self) -> None:
        assert_allclose(moved(decide("viscido-snn", [[3.0, 4.0], [0.0, -6.0]])), [0.6, 0.8], atol=EXACT)
        assert decide("viscido-snn", [[0.0, 2.0]]).kind == Kind.STOP
        assert decide("viscido-snn", [[0.0, 2.0 + 1e-9]]).kind == Kind.WAY_POINT

    def test_hamilton_2d_is_snn_within_its_range(self) -> None:
        rng = np.random.default_rng(4)
        for positions in rng.uniform(-9.0, 9.0, (30, 6, 2)):
            assert decide("hamilton-2d", positions) == pytest.approx(decide("viscido-snn", positions), nan_ok=True)
        assert decide("hamilton-2d", [[3.0, 0.0]], range_m=2.9).kind == Kind.HOLD


class TestHamiltonsRule:
    def test_step_leads_to_the_point_two_body_lengths_from_the_nearest_towards_its_nearest(self) -> None:
        motion = decide("viscido-ha", [[4.0, 0.0], [4.0, 9.0], [-8.0, 0.0]])
        assert rule("viscido-ha", motion) == "hamilton"
        assert_allclose(moved(motion), np.array([4.0, 2.0]) / math.hypot(4.0, 2.0), atol=EXACT)

    def test_the_tables_point_lies_one_body_length_from_the_second_member(self) -> None:
        motion = decide("viscido-ha", [[4.0, 0.0], [4.0, 9.0]], from_second=True, offset_m=1.0)
        assert_allclose(moved(motion), np.array([4.0, 8.0]) / math.hypot(4.0, 8.0), atol=EXACT)

    def test_within_the_repulsion_distance_the_step_is_perpendicular_with_either_sign(self) -> None:
        positions = [[1.0, 0.5], [4.0, 4.5]]
        steps = [moved(decide("viscido-ha", positions, u=u)) for u in (0.0, 0.999)]
        assert_allclose(steps[0], -steps[1], atol=EXACT)
        assert_allclose([steps[0] @ [3.0, 4.0], np.hypot(*steps[0])], [0.0, 1.0], atol=EXACT)

    def test_differs_from_the_extended_rule_where_two_members_are_close_to_each_other(self) -> None:
        positions = [[2.0, 0.0], [2.0, 0.3]]
        original = decide("viscido-ha", positions, repulsion_m=0.66, offset_m=0.66)
        extended = decide("extended-hamilton", positions)
        assert rule("viscido-ha", original) == "hamilton"
        assert rule("extended-hamilton", extended) == "snn"


class TestHamiltonsPond:
    """Hamilton 1971, figure 2: a hundred frogs gather in ever fewer heaps."""

    def test_frogs_gather_in_ever_fewer_heaps(self) -> None:
        rng = np.random.default_rng(3)
        starts = np.column_stack([rng.uniform(0.0, 100.0, 100), np.full(100, 7.0), rng.uniform(-3.0, 3.0, 100)])
        track = herd("hamilton-1d", starts, 30).positions_w
        heaps = [len(np.unique(np.floor(track[t, :, 0]))) for t in (0, 2, 5, 20)]
        assert heaps == sorted(heaps, reverse=True)
        assert heaps[-1] < heaps[0] / 4
        assert_allclose(track[..., 1], 7.0, atol=1e-9)  # nobody leaves the rim

    @pytest.mark.parametrize("compass", [0.0, 1.0, math.pi])
    def test_jump_passes_the_neighbour_by_a_third_of_the_narrower_gap(self, compass: float) -> None:
        on_axis = np.array([-1.0, -4.0, 2.0, 2.9])
        c, s = math.cos(compass), math.sin(compass)
        positions = np.outer(on_axis, [c, -s])
        jump = moved(decide("hamilton-1d", positions, compass=compass))
        assert_allclose(jump, np.array([c, -s]) * (2.0 + 0.3), atol=EXACT)

    def test_stays_only_in_a_gap_narrower_than_both_beside_it(self) -> None:
        stays = [[-1.0, 0.0], [1.0, 0.0], [-3.1, 0.0], [3.1, 0.0]]
        assert decide("hamilton-1d", stays).kind == Kind.STOP
        goes = [[-1.0, 0.0], [1.0, 0.0], [-3.1, 0.0], [2.9, 0.0]]
        assert_allclose(moved(decide("hamilton-1d", goes)), [1.0 + 1.9 / 3.0, 0.0], atol=EXACT)

    def test_a_member_at_the_end_of_the_line_jumps_inwards(self) -> None:
        assert_allclose(moved(decide("hamilton-1d", [[1.0, 0.0], [4.0, 0.0]])), [2.0, 0.0], atol=EXACT)


class TestWeightedHorizon:
    def test_weight_runs_from_the_mean_position_to_the_mean_bearing(self) -> None:
        positions = np.array([[1.0, 0.0], [0.0, 8.0], [-3.0, 2.0]])
        mean = positions.mean(axis=0)
        bearing = (positions / np.hypot(*positions.T)[:, None]).mean(axis=0)
        unweighted = moved(decide("viscido-lch", positions, nearness_per_m=0.0))
        assert_allclose(unweighted, mean / np.hypot(*mean), atol=EXACT)
        steep = moved(decide("viscido-lch", positions, nearness_per_m=1e9))
        # weights 1 / (1 + 1e9 d) differ from 1e-9 / d by parts in 1e9
        assert_allclose(steep, bearing / np.hypot(*bearing), atol=1e-8)

    def test_as_printed_farther_members_pull_more_and_with_unit_vectors_nearer_ones(self) -> None:
        positions = [[1.0, 0.0], [0.0, 100.0]]
        near, far = 1.0 / 1.375, 1.0 / 38.5
        printed, units = (moved(decide("viscido-lch", positions, unit_vectors=flag)) for flag in (False, True))
        assert_allclose(printed, np.array([near, 100.0 * far]) / math.hypot(near, 100.0 * far), atol=EXACT)
        assert_allclose(units, np.array([near, far]) / math.hypot(near, far), atol=EXACT)
        assert (near, 100.0 * far) == pytest.approx((0.73, 2.6), abs=0.005)


LCH = ["lch-group-pose", "lch-member-pose", "lch-group-bearing", "lch-member-bearing"]


class TestLocalCrowdedHorizon:
    """Fine 2015, section 4.3 and table 4.1."""

    @pytest.mark.parametrize("name", LCH)
    def test_single_group_ends_with_the_published_spread(self, name: str) -> None:
        ends = [
            herd(name, square(50, 3.5, seed), 75, selection_text="distance-based(0, 3)").positions_w[-1]
            for seed in range(10)
        ]
        # table 4.1 prints 0.05; ten trials' mean has a standard error of 0.0015
        assert np.mean([formation.mmd(end) for end in ends]) == pytest.approx(0.05, abs=0.005)

    @pytest.mark.parametrize("name", LCH)
    def test_two_groups_out_of_range_stay_two(self, name: str) -> None:
        starts = square(50, 3.5, 1)
        starts[:25, 0] += 9.9
        end = herd(name, starts, 75, selection_text="distance-based(0, 3)").positions_w[-1]
        assert formation.number_of_groups(end, 3.0) == 2
        assert all(formation.number_of_groups(half, 0.5) == 1 for half in (end[:25], end[25:]))

    def test_group_centric_laws_follow_the_largest_cluster_and_member_centric_ones_the_mean(self) -> None:
        pair, third = [[2.0, 0.1], [2.0, -0.1]], [[0.0, 3.0]]
        for name in ("lch-group-pose", "lch-group-bearing"):
            assert_allclose(moved(decide(name, pair + third)), [0.1, 0.0], atol=EXACT)
        mean = np.array([4.0, 3.0]) / 5.0
        assert_allclose(moved(decide("lch-member-pose", pair + third)), 0.1 * mean, atol=EXACT)

    def test_bearing_variations_know_no_distance(self) -> None:
        positions = np.array([[2.0, 1.0], [1.0, 2.2], [-3.0, 0.4]])
        farther = positions * np.array([[7.0], [0.2], [1.5]])
        for name in ("lch-group-bearing", "lch-member-bearing"):
            assert decide(name, positions) == pytest.approx(decide(name, farther))
            assert lawentry.load(name).needs == {"bearings"}

    @pytest.mark.parametrize("name", LCH)
    def test_who_sees_nobody_stays_or_keeps_its_direction(self, name: str) -> None:
        assert decide(name, []).kind == Kind.STOP
        ahead = decide(name, [], keeps_direction=True, step_m=0.3)
        assert (ahead.kind, ahead.x, ahead.y) == (Kind.WAY_POINT, 0.3, 0.0)
