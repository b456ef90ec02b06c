"""The laws of how animals lead, keep apart and follow, each against what its own publication says of it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.measures import formation
from flocking.types import Kind, Motion
from tests.flocking.laws.deciding import EXACT, FAR, decide, herd, moved, rule, square


class TestLeadingAccordingToNeed:
    """Conradt et al. 2009."""

    def test_repulsion_comes_first(self) -> None:
        motion = decide("conradt", [[0.0, 0.5], [3.0, 0.0]], velocities=[[1.0, 0.0]] * 2, goal=(0.0, 9.0))
        assert rule("conradt", motion) == "apart"
        assert motion.x == pytest.approx(-math.pi / 2.0, abs=EXACT)

    @pytest.mark.parametrize("assertiveness", [0.0, 0.5, 1.0, 3.0])
    def test_the_needier_a_member_is_the_more_it_turns_to_its_target(self, assertiveness: float) -> None:
        motion = decide("conradt", [[3.0, 0.0]], velocities=[[2.0, 0.0]], goal=(0.0, 40.0), assertiveness=assertiveness)
        assert motion.x == pytest.approx(math.atan2(0.5 * assertiveness, 0.5), abs=EXACT)

    def test_alone_it_goes_to_its_target_or_on(self) -> None:
        assert decide("conradt", [], goal=(-1.0, 1.0)).x == pytest.approx(0.75 * math.pi, abs=EXACT)
        assert decide("conradt", []).kind == Kind.HOLD

    def test_the_needy_lead_a_group_to_their_target(self) -> None:
        """Two of ten have a target 60 m away; the needier they are, the nearer the group comes to it."""
        target = np.array([60.0, 0.0])
        left = []
        for need in (0.1, 2.0):
            ends = []
            for seed in range(5):
                goals = np.full((10, 2), math.nan)
                goals[:2] = target
                end = herd(
                    "conradt", square(10, 5.0, seed), 400, dt=0.2, speed=1.0, seed=seed, goals=goals, assertiveness=need
                ).positions_w[-1]
                ends.append(np.hypot(*(end.mean(axis=0) - target)))
            left.append(np.mean(ends))
        assert left[1] < left[0] - 10.0


FRONT, LEFT_FRONT, RIGHT_FRONT = [1.0, 0.0], [0.7, 0.9], [0.7, -0.9]
LEFT_BACK, RIGHT_BACK = [-0.7, 0.9], [-0.7, -0.9]
SECTORS = {"F": FRONT, "LF": LEFT_FRONT, "RF": RIGHT_FRONT, "LB": LEFT_BACK, "RB": RIGHT_BACK}
MIRRORED = {"F": "F", "LF": "RF", "RF": "LF", "LB": "RB", "RB": "LB"}
RIGHT_ANGLE = math.pi / 2.0


class TestDynamicsOfHerds:
    """Gueron et al. 1996."""

    def stress(self, *sectors: str) -> Motion:
        return decide("gueron", [SECTORS[name] for name in sectors])

    @pytest.mark.parametrize(
        ("sectors", "turn", "speed"),
        [
            (("F",), 0.0, 0.5),
            (("LB", "RB"), 0.0, 2.0),
            (("LF",), -RIGHT_ANGLE, 1.0),
            (("LB",), -RIGHT_ANGLE, 1.0),
            (("RF",), RIGHT_ANGLE, 1.0),
            (("RB",), RIGHT_ANGLE, 1.0),
        ],
    )
    def test_cases_of_the_table(self, sectors: tuple[str, ...], turn: float, speed: float) -> None:
        motion = self.stress(*sectors)
        assert motion.kind == Kind.HEADING
        assert_allclose(moved(motion), [turn, speed], atol=EXACT)

    def test_two_in_front_stop_it(self) -> None:
        assert self.stress("LF", "RF").kind == Kind.STOP

    def test_every_combination_of_sectors_is_defined_and_mirrors(self) -> None:
        for size in range(1, 6):
            for sectors in itertools.combinations(SECTORS, size):
                motion, mirrored = self.stress(*sectors), self.stress(*(MIRRORED[name] for name in sectors))
                assert mirrored.kind == motion.kind
                if motion.kind == Kind.HEADING:
                    assert_allclose(moved(mirrored), moved(motion) * [-1.0, 1.0], atol=EXACT)
                assert (motion.kind == Kind.STOP) == ({"LF", "RF"} <= set(sectors))

    def test_a_sidestep_is_taken_across_the_course_of_a_member_on_the_move(self) -> None:
        turned = [[-LEFT_FRONT[1], LEFT_FRONT[0]]]
        motion = decide("gueron", turned, goal=(0.0, FAR))
        assert_allclose(motion.x, 0.0, atol=EXACT)

    @pytest.mark.parametrize(
        ("place", "name"),
        [([4.0, 1.0], "neutral"), ([9.0, 2.0], "attraction"), ([-4.0, 1.0], "lead"), ([40.0, 0.0], "alone")],
    )
    def test_zones_follow_one_another(self, place: list[float], name: str) -> None:
        assert rule("gueron", decide("gueron", [place])) == name
        if name != "alone":
            assert rule("gueron", decide("gueron", [place, FRONT])) == "slow behind"

    def test_strong_members_move_faster_by_the_same_law(self) -> None:
        weak, strong = (decide("gueron", [FRONT], role=role) for role in (0, 1))
        assert strong.y / weak.y == pytest.approx(1.2)
        assert strong.x == weak.x

    def test_one_far_behind_closes_up_to_the_herd_that_waits(self) -> None:
        starts = np.array([[0.0, 0.0, 0.0], [14.0, 1.0, 0.0]])
        goals = np.full((2, 2), [FAR, 0.0])
        track = herd("gueron", starts, 100, dt=0.1, speed=1.0, goals=goals).positions_w
        gap = np.hypot(*(track[:, 1] - track[:, 0]).T)
        # at twice against half the own speed: to the neutral zone of 5 m, within a step of 0.2 m
        assert gap[-1] == pytest.approx(5.0, abs=0.2)
        assert (track[-1, :, 0] > starts[:, 0]).all()


class TestEffectiveLeadership:
    """Couzin et al. 2005."""

    CROWDED = ([[0.5, 0.5], [4.0, 0.0]], [[1.0, 0.0]] * 2)
    """Places and velocities: one too near, one within the range of attraction."""

    def test_repulsion_has_priority_over_attraction_and_alignment(self) -> None:
        places, velocities = self.CROWDED
        motion = decide("couzin", places, velocities=velocities, u=0.5, turn_limit_rad_s=100.0)
        assert rule("couzin", motion) == "apart"
        assert motion.x == pytest.approx(-0.75 * math.pi, abs=EXACT)

    def test_the_informed_weigh_in_their_direction_after_repulsion_too(self) -> None:
        """Equation 3 has no condition."""
        motion = decide("couzin", [[-0.5, 0.0]], velocities=[[1.0, 0.0]], goal=(0.0, FAR), u=0.5)
        assert rule("couzin", motion) == "informed and apart"
        assert motion.x == pytest.approx(0.4, abs=EXACT)  # atan2(0.5, 1), cut to 2 rad/s in 0.2 s
        places, velocities = self.CROWDED
        motion = decide("couzin", places, velocities=velocities, goal=(FAR, 0.0), u=0.5, turn_limit_rad_s=100.0)
        half = math.sqrt(0.5)
        assert motion.x == pytest.approx(math.atan2(-half, 0.5 - half), abs=EXACT)

    def test_by_the_other_reading_the_direction_waits_while_somebody_is_too_near(self) -> None:
        places, velocities = self.CROWDED
        informed, not_informed = (
            decide("couzin", places, velocities=velocities, goal=goal, u=0.5, repulsion_first=True)
            for goal in ((0.0, FAR), (math.nan, math.nan))
        )
        assert rule("couzin", informed) == "apart"
        assert informed == not_informed

    def test_attraction_alignment_and_the_own_direction_count_alike(self) -> None:
        motion = decide("couzin", [[0.0, 3.0]], velocities=[[0.0, -2.0]], u=0.5, turn_limit_rad_s=100.0)
        assert motion.x == pytest.approx(0.0, abs=EXACT)
        both = decide("couzin", [[0.0, 3.0]], velocities=[[0.0, 2.0]], u=0.5, turn_limit_rad_s=100.0)
        assert both.x == pytest.approx(math.atan2(2.0, 1.0), abs=EXACT)

    @pytest.mark.parametrize("omega", [0.0, 0.5, 2.0])
    def test_the_informed_balance_their_direction_with_omega(self, omega: float) -> None:
        motion = decide("couzin", [], goal=(0.0, FAR), omega=omega, u=0.5, turn_limit_rad_s=100.0)
        assert motion.x == pytest.approx(math.atan2(omega, 1.0), abs=EXACT)

    def test_turning_is_limited_and_noise_is_normal(self) -> None:
        assert decide("couzin", [[-3.0, 0.1]], velocities=[[-1.0, 0.0]]).x == pytest.approx(0.4, abs=EXACT)
        turns = [decide("couzin", [], u=u).x for u in (np.arange(400) + 0.5) / 400]
        # quantile midpoints leave the tails out: 1 % of the standard deviation at 400 of them
        assert np.std(turns) == pytest.approx(0.01, rel=0.01)

    def test_accuracy_rises_with_the_share_of_informed_members(self) -> None:
        """Figure 1a: accuracy is one minus the mean deviation from the preferred direction, over half a turn."""
        accuracy = []
        for informed in (0, 3, 15):
            off = []
            for seed in range(12):
                goals = np.full((30, 2), math.nan)
                goals[:informed] = [FAR, 0.0]
                starts = square(30, 1.5 * math.sqrt(30.0), seed)
                track = herd("couzin", starts, 300, dt=0.2, seed=seed, speed=3.0, goals=goals).positions_w
                travelled = track[-1].mean(axis=0) - track[-51].mean(axis=0)
                off.append(abs(math.atan2(travelled[1], travelled[0])))
            accuracy.append(1.0 - np.mean(off) / math.pi)
        # uninformed groups: 0.5, with a standard error of 0.29 / sqrt(12) = 0.08; within three of it
        assert accuracy[0] == pytest.approx(0.5, abs=0.25)
        assert accuracy[1] > accuracy[0] + 0.1
        assert accuracy[2] > accuracy[1] + 0.05
        assert accuracy[2] > 0.85


class TestFishSchools:
    """Lopez et al. 2012."""

    @pytest.mark.parametrize(("gap", "sign"), [(0.4, -1.0), (1.0, 0.0), (1.7, 1.0)])
    def test_neighbours_repel_within_the_balance_distance_and_attract_beyond(self, gap: float, sign: float) -> None:
        motion = decide("lopez", [[0.0, gap]], headings=[0.0], noise=0.0)
        assert np.sign(round(motion.x, 9)) == sign

    def test_without_noise_a_school_comes_to_one_heading_and_stays_together(self) -> None:
        track = herd("lopez", square(30, 4.0, 2), 200, dt=0.1, speed=1.0, noise=0.0)
        polarization = formation.polarization(track.headings_w)
        assert polarization[0] < 0.5
        assert polarization[-1] > 0.99
        assert formation.number_of_groups(track.positions_w[-1], 5.0) == 1

    def test_noise_stronger_than_alignment_destroys_the_order(self) -> None:
        track = herd("lopez", square(30, 4.0, 2), 200, dt=0.1, speed=1.0, noise=20.0)
        # headings then are independent: polarization is 1 / sqrt(30) = 0.18 on average; three times that
        assert np.mean(formation.polarization(track.headings_w[50:])) < 0.55


class TestRandomMotion:
    def test_the_mean_squared_displacement_grows_by_the_squared_step(self) -> None:
        count, steps = 2000, 50
        track = herd("random-motion", square(count, 1.0, 5), steps, speed_m_s=0.7).positions_w
        squared = ((track[-1] - track[0]) ** 2).sum(axis=1)
        # squared displacement is nearly exponential: its standard error is its mean / sqrt(count); four of them
        assert squared.mean() == pytest.approx(steps * 0.7**2, rel=4.0 / math.sqrt(count))

    def test_a_direction_is_held_for_the_holding_time(self) -> None:
        track = herd("random-motion", square(20, 1.0, 6), 12, dt=0.5, hold_s=1.5)
        changes = np.abs(np.diff(np.unwrap(track.headings_w[1:], axis=0), axis=0)).max(axis=1)
        # three updates of 0.5 s each: the 1st, 4th, 7th and 10th choose
        chosen = np.flatnonzero(changes > 1e-9) + 2
        assert chosen.tolist() == [4, 7, 10]
