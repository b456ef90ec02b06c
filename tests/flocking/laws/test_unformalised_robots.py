"""The unformalised laws that were made for robots, each against what its publication says or what follows from it."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.kinematic.herd import Space, start_uniform
from flocking.laws import arkin_balch, kelly_keating, moshtagh_kirchner
from flocking.measures import formation as measures
from flocking.types import Kind, Motion
from tests.flocking.laws.asking import ask, run

ROUNDING = 1e-9
"""A few ulps of numbers of order 1 to 100."""


class TestKellyKeating:
    def test_nobody_to_follow_makes_a_leader(self) -> None:
        assert ask("kelly-keating", [[-1.0, 0.0]])[1] == "lead"
        assert ask("kelly-keating")[1] == "lead"

    def test_of_two_that_face_each_other_the_larger_id_follows(self) -> None:
        rules = [ask("kelly-keating", [[1.0, 0.0]], math.pi, ids=[id_], own_id=3)[1] for id_ in (2, 4)]
        assert rules == ["keep position", "lead"]

    def test_one_seen_from_behind_is_followed_whatever_its_id(self) -> None:
        assert ask("kelly-keating", [[1.0, 0.0]], 0.0, ids=[9], own_id=3)[1] == "keep position"

    def test_a_flock_in_the_distance_is_headed_for_faster(self) -> None:
        motion, rule = ask("kelly-keating", [[3.0, 1.0], [4.0, 0.0]], 0.0)
        assert (rule, motion.kind) == ("catch up", Kind.HEADING)
        assert motion.x == pytest.approx(math.atan2(1.0, 3.0))
        assert motion.y == 0.35 > kelly_keating.Parameters().speed_m_s

    def test_avoidance_comes_first_and_turns_away_from_the_nearest(self) -> None:
        motion, rule = ask("kelly-keating", [[0.2, 0.2], [1.0, 0.0]], obstacles=[[0.2, -0.1]])
        assert rule == "avoid"
        assert motion.x == 0.6

    def test_a_follower_takes_the_leaders_velocity_and_the_spacing(self) -> None:
        poses = np.array([[0.0, 0.0, 0.0], [1.4, 0.2, 0.0]])
        history = run("kelly-keating", poses, steps=400, dt=0.1, speed=0.2, given={"wander_turn_rad": 0.0})
        gap = np.hypot(*(history.positions_w[-1, 0] - history.positions_w[-1, 1]))
        # forty seconds of a correction at 0.5 per second leave exp(-20) of the error
        assert gap == pytest.approx(0.8, abs=1e-6)
        assert_allclose(history.velocities_w[-1], [[0.2, 0.0], [0.2, 0.0]], atol=1e-6)

    def test_a_leader_that_turns_into_the_flock_hands_over(self) -> None:
        behind = [[-1.0, 0.3], [-1.2, -0.3]]
        assert ask("kelly-keating", behind, 0.0, ids=[5, 6], own_id=7)[1] == "lead"
        turned_round = -np.array(behind)
        assert ask("kelly-keating", turned_round, math.pi, ids=[5, 6], own_id=7)[1] == "keep position"


class TestArkinBalch:
    STILL: ClassVar[dict[str, float]] = {"noise_gain": 0.0, "formation_gain": 0.0}

    @pytest.mark.parametrize(("distance", "strength"), [(5.1, 0.998), (27.5, 0.5), (50.0, 0.0), (60.0, 0.0)])
    def test_repulsion_falls_linearly_to_the_sphere_of_influence(self, distance: float, strength: float) -> None:
        motion, _ = ask("arkin-balch", obstacles=[[0.0, distance]], obstacle_gain=0.8, **self.STILL)
        assert_allclose([motion.x, motion.y], [0.0, -0.8 * strength], atol=1e-3)

    def test_within_the_minimum_range_only_flight_counts(self) -> None:
        motion, rule = ask("arkin-balch", [[3.0, 0.0]], goal=(100.0, 0.0))
        assert rule == "flight"
        assert_allclose([motion.x, motion.y], [-1.0, 0.0], atol=ROUNDING)

    def test_the_goal_alone_gives_its_gain(self) -> None:
        motion, _ = ask("arkin-balch", goal=(30.0, 40.0), noise_gain=0.0)
        assert_allclose([motion.x, motion.y], [0.48, 0.64], atol=ROUNDING)

    def test_noise_keeps_its_direction_for_its_persistence(self) -> None:
        memory = np.zeros(arkin_balch.MEMORY)
        motions = [ask("arkin-balch", u=k / 20.0, memory=memory)[0][1:3] for k in range(13)]
        directions = [round(math.atan2(y, x) % (2.0 * math.pi), 9) for x, y in motions]
        expected = [0.0] * 6 + [2.0 * math.pi * 6 / 20.0] * 6 + [2.0 * math.pi * 12 / 20.0]
        assert_allclose(directions, expected, atol=1e-8)

    @pytest.mark.parametrize("zone", ["dead", "controlled", "ballistic"])
    def test_maintain_formation_has_three_zones(self, zone: str) -> None:
        # a column of two with a spacing of 50 m; the focal member is second, its place 25 m behind the centre
        error = {"dead": 5.0, "controlled": 15.0, "ballistic": 25.0}[zone]
        motion, _ = ask(
            "arkin-balch",
            [[50.0 - 2.0 * error, 0.0]],
            ids=[0],
            own_id=1,
            formation=arkin_balch.COLUMN,
            dead_m=6.0,
            robot_gain=0.0,
            robot_least_m=0.0,
            controlled_m=24.0,
            noise_gain=0.0,
        )
        expected = {"dead": 0.0, "controlled": (15.0 - 6.0) / (24.0 - 6.0), "ballistic": 1.0}[zone]
        assert_allclose([motion.x, motion.y], [-expected, 0.0], atol=ROUNDING)

    @pytest.mark.parametrize("formation", range(4))
    @pytest.mark.parametrize("count", [1, 2, 4, 7])
    def test_places_are_apart_and_centred(self, formation: int, count: int) -> None:
        places = np.array([arkin_balch.centred_place(formation, rank, count) for rank in range(count)])
        assert_allclose(places.mean(axis=0), 0.0, atol=ROUNDING)
        gaps = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) + 9.0 * np.eye(count)
        assert gaps.min() >= 1.0 - ROUNDING

    @pytest.mark.parametrize("formation", range(4))
    def test_four_robots_form_up_on_their_way(self, formation: int) -> None:
        spacing = 50.0
        poses = start_uniform(4, 2.0 * spacing, np.random.default_rng(1))
        goals = np.tile([1e6, 0.0], (4, 1))
        given = {"formation": formation, "noise_gain": 0.0}
        history = run("arkin-balch", poses, steps=1500, dt=0.5, given=given, goals_w=goals, every=1500)
        there = history.positions_w[-1] - history.positions_w[-1].mean(axis=0)
        places = np.array([arkin_balch.centred_place(formation, rank, 4) for rank in range(4)])
        # the goal is not infinitely far: courses differ by 50 m / 1000 km
        assert_allclose(there, spacing * places, atol=0.1)
        assert_allclose(history.velocities_w[-1], [[0.8, 0.0]] * 4, atol=1e-3)

    def test_places_go_by_id_and_not_by_order(self) -> None:
        positions, ids = [[10.0, 40.0], [-30.0, 5.0]], [7, 2]
        motion, _ = ask("arkin-balch", positions, ids=ids, own_id=5, noise_gain=0.0)
        again, _ = ask("arkin-balch", positions[::-1], ids=ids[::-1], own_id=5, noise_gain=0.0)
        swapped, _ = ask("arkin-balch", positions, ids=[1, 2], own_id=5, noise_gain=0.0)
        assert motion == pytest.approx(again)
        assert motion != pytest.approx(swapped)


class TestMoshtaghKirchner:
    def test_the_turn_is_equation_3_8(self) -> None:
        x, y, vx, vy = 1.0, 0.4, 0.1, -0.2
        distance = math.hypot(x, y)
        bearing_rate = -(x * vy - y * vx) / distance**2  # clockwise
        tau = -distance / ((x * vx + y * vy) / distance)
        omega = -0.5 * bearing_rate * math.sqrt(1.0 + 1.0 / (tau * bearing_rate) ** 2)
        assert moshtagh_kirchner.alignment_rate(x, y, vx, vy) == pytest.approx(omega)
        motion, rule = ask(
            "moshtagh-kirchner", [[x, y]], velocities=[vx + 0.3, vy], own_velocity=(0.3, 0.0), coupling=1.5
        )
        assert rule == "flock"
        assert motion.x == pytest.approx(1.5 * omega * 0.1)

    @pytest.mark.parametrize("heading", [-2.0, -0.5, 0.3, 1.5])
    def test_members_ahead_at_equal_speed_turn_it_by_the_half_angle(self, heading: float) -> None:
        v, distance = 0.3, 2.0
        rate = moshtagh_kirchner.alignment_rate(distance, 0.0, v * (math.cos(heading) - 1.0), v * math.sin(heading))
        assert rate == pytest.approx(v / distance * math.sin(heading / 2.0))

    def test_beyond_the_ideal_distance_the_speed_grows_by_the_closure_in_150_inches(self) -> None:
        memory = np.zeros(moshtagh_kirchner.MEMORY)
        motion, _ = ask("moshtagh-kirchner", [[2.0, 0.0]], velocities=[0.5, 0.0], memory=memory)
        assert motion.y == pytest.approx(0.3 + 0.5 * 0.1 / (150.0 * 0.0254))
        closing, _ = ask("moshtagh-kirchner", [[2.0, 0.0]], velocities=[-0.5, 0.0])
        assert closing.y == 0.3

    @pytest.mark.parametrize(("inches", "degrees", "rate"), [(10.0, 0.0, 15.0), (36.0, 110.0, 5.0), (23.0, 55.0, 10.0)])
    def test_turning_away_is_equation_3_18(self, inches: float, degrees: float, rate: float) -> None:
        turn = moshtagh_kirchner.turn_away_rate(inches * 0.0254, math.radians(degrees))
        assert math.degrees(turn) == pytest.approx(rate)

    def test_too_near_it_slows_down_then_turns_away_then_stops(self) -> None:
        memory = np.zeros(moshtagh_kirchner.MEMORY)
        seen = [
            ask("moshtagh-kirchner", [[d, 0.1]], velocities=[-0.1, 0.0], memory=memory)
            for d in (0.8, *np.linspace(0.75, 0.5, 12), 0.2)
        ]
        assert [rule for _, rule in seen][::13] == ["flock", "danger"]
        assert seen[0][0].y == pytest.approx(0.3 - 0.2 * 0.1)
        assert seen[12][1] == "turn away"
        assert seen[12][0].y == 0.1
        assert seen[12][0].x < 0.0  # the other is to the left
        assert seen[13][0].y == 0.0

    def test_nobody_in_view_means_straight_ahead_at_the_speed_it_has(self) -> None:
        memory = np.array([0.44, 1.0, 0.0])
        for positions in ([], [[-1.0, 0.1]], [[2.5, 0.0]]):
            motion, rule = ask("moshtagh-kirchner", positions, velocities=[1.0, 0.0], memory=memory)
            assert (rule, motion.x, motion.y) == ("straight ahead", 0.0, 0.44)

    def test_all_in_view_add_up_unless_only_the_nearest_counts(self) -> None:
        positions, velocities = [[1.0, 0.0], [0.0, 1.5]], [[0.1, 0.2], [-0.2, 0.1]]
        single = [
            ask("moshtagh-kirchner", [p], velocities=[v])[0].x for p, v in zip(positions, velocities, strict=True)
        ]
        assert ask("moshtagh-kirchner", positions, velocities=velocities)[0].x == pytest.approx(single[0])
        both, _ = ask("moshtagh-kirchner", positions, velocities=velocities, nearest_only=False)
        assert both.x == pytest.approx(sum(single))

    def test_the_three_robot_test_ends_as_a_flock(self) -> None:
        """Section 4.2: two robots six feet apart, the third between them 4.5 feet ahead; at last 3.1 and 6.3 feet."""
        foot = 0.3048
        poses = np.array([[0.0, 3.0 * foot, 0.0], [0.0, -3.0 * foot, 0.0], [4.5 * foot, 0.0, 0.0]])
        rng = np.random.default_rng(3)
        for _ in range(5):
            poses[:, 2] = rng.uniform(-0.2, 0.2, 3)
            history = run("moshtagh-kirchner", poses, steps=600, dt=0.1, speed=0.3, every=600)
            order = measures.polarization(history.headings_w)
            # in twenty other starts the order rose to 0.9999 and the largest distance was 4.0 to 5.4 feet
            assert order[-1] > 0.999 > order[0]
            assert measures.nearest_neighbour_distance(history.positions_w[-1]).max() < 6.3 * foot


class TestBumperOnly:
    GIVEN: ClassVar[dict[str, float]] = {"wait_s": 0.2, "back_s": 0.1, "turn_least_rad": 0.5, "turn_most_rad": 0.5}

    def rules_after(self, contacts: tuple[bool, bool], steps: int, **given: Any) -> list[tuple[str, Motion]]:
        memory, said = np.zeros(4), []
        turn_rate = 0.0
        for k in range(steps):
            motion, rule = ask(
                "bumper-only",
                contacts=contacts if k == 0 else (False, False),
                memory=memory,
                turn_rate=turn_rate,
                **{**self.GIVEN, **given},
            )
            turn_rate = motion.x / 0.1 if rule == "turn" else 0.0
            said.append((rule, motion))
        return said

    def test_neighbours_and_obstacles_do_not_matter(self) -> None:
        motion, rule = ask("bumper-only", [[0.1, 0.0]], obstacles=[[0.1, 0.0]])
        assert (rule, motion.x, motion.y) == ("straight ahead", 0.0, 0.25)

    def test_waits_backs_off_turns_once_and_goes_on(self) -> None:
        said = self.rules_after((True, False), 6)
        names = [rule for rule, _ in said]
        assert names == ["wait", "wait", "back off", "turn", "straight ahead", "straight ahead"]
        assert said[2][1].y == -0.1
        assert (said[3][1].x, said[3][1].y) == (-0.5, 0.0)

    def test_turns_away_from_the_pressed_side_or_with_it(self) -> None:
        turns = {
            (side, turn_with): dict(self.rules_after(side, 5, turn_with=turn_with))["turn"].x
            for side in ((True, False), (False, True))
            for turn_with in (False, True)
        }
        assert turns == {
            ((True, False), False): -0.5,
            ((False, True), False): 0.5,
            ((True, False), True): 0.5,
            ((False, True), True): -0.5,
        }

    def test_a_slow_body_turns_until_its_odometry_says_so(self) -> None:
        memory = np.zeros(4)
        given = {"wait_s": 0.0, "back_s": 0.0, "turn_least_rad": 0.5, "turn_most_rad": 0.5}
        turned, rate, rules = 0.0, 0.0, []
        for k in range(20):
            motion, rule = ask("bumper-only", contacts=(False, k == 0), memory=memory, turn_rate=rate, **given)
            rules.append(rule)
            rate = min(motion.x / 0.1, 1.0) if rule == "turn" else 0.0
            turned += rate * 0.1
        assert turned == pytest.approx(0.5)
        assert rules.count("turn") == 5

    def test_a_turn_that_something_blocks_is_given_up(self) -> None:
        memory = np.zeros(4)
        rules = [
            ask("bumper-only", contacts=(k == 0, False), memory=memory, wait_s=0.0, back_s=0.0, patience_s=0.5)[1]
            for k in range(8)
        ]
        assert rules == ["turn"] * 5 + ["straight ahead"] * 3

    def test_drawn_turns_fill_their_range_to_both_sides(self) -> None:
        rng = np.random.default_rng(5)
        turns = []
        for _ in range(400):
            motion, _ = ask(
                "bumper-only",
                contacts=(True, True),
                u=rng.random(2),
                wait_s=0.0,
                back_s=0.0,
                turn_least_rad=0.3,
                turn_most_rad=1.2,
            )
            turns.append(motion.x)
        sizes = np.abs(turns)
        assert 0.3 <= sizes.min() < 0.32 < 1.18 < sizes.max() <= 1.2
        # four standard errors of a uniform mean, and of a fair coin thrown 400 times
        assert sizes.mean() == pytest.approx(0.75, abs=4.0 * 0.9 / math.sqrt(12 * 400))
        assert abs(np.sum(np.array(turns) > 0.0) - 200) < 4.0 * math.sqrt(400 * 0.25)

    def test_two_that_collide_part_at_a_smaller_angle(self) -> None:
        given = {"wait_s": 0.0, "back_s": 0.0, "turn_least_rad": 0.3, "turn_most_rad": 0.3}
        poses = np.array([[0.0, 0.5, -0.7], [0.0, -0.5, 0.7]])
        history = run("bumper-only", poses, steps=60, dt=0.1, given=given, radius_m=0.165)
        before, after = (history.headings_w[k, 1] - history.headings_w[k, 0] for k in (0, -1))
        # each contact takes both turns off the angle, until they no longer approach each other
        assert before == pytest.approx(1.4)
        assert after == pytest.approx(1.4 - 3.0 * 0.6)

    def test_waiting_gathers_members_where_they_meet(self) -> None:
        nearest = {}
        for wait in (0.0, 8.0):
            gaps = []
            for seed in range(4):
                poses = start_uniform(16, 5.0, np.random.default_rng(seed))
                history = run(
                    "bumper-only",
                    poses,
                    steps=2000,
                    dt=0.1,
                    given={"wait_s": wait},
                    radius_m=0.165,
                    space=Space("bounded", 5.0),
                    every=100,
                    seed=seed,
                )
                gaps.append(measures.nearest_neighbour_distance(history.positions_w[5:]).mean())
            nearest[wait] = float(np.mean(gaps))
        assert nearest[8.0] < nearest[0.0]
