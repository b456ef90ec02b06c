"""Obstacles: their selection, virtual members, and the avoidance that every law can be given."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from flocking import obstacle_selection
from flocking.avoidance import (
    Parameters,
    ahead,
    avoid,
    nearest,
    virtual_members,
    with_virtual_members,
    within,
)
from flocking.types import Kind, Obstacles, members_at

ROUNDING = 1e-9
"""A few ulps of lengths of a few metres, and the direction cosine's own tolerance."""
LOOK, MARGIN = Parameters().look_ahead_m, Parameters().margin_m
NOWHERE = np.empty((0, 2))


def moved(
    kind: Kind, x: float, y: float, points: object, own: tuple[float, float] = (0.25, 0.0), look: float = LOOK
) -> tuple[int, float, float, bool]:
    return avoid(
        int(kind), x, y, own[0], own[1], 0.1, np.ascontiguousarray(points, dtype=float).reshape(-1, 2), look, MARGIN
    )


class TestSelection:
    OBSTACLES = Obstacles(np.array([[2.0, 0.0], [0.0, 1.0], [-0.5, 0.0], [0.3, -0.4]]))

    def test_within_keeps_what_is_nearer(self) -> None:
        assert within(self.OBSTACLES, 1.0).tolist() == [False, False, True, True]

    def test_nearest_keeps_one_whatever_the_order(self) -> None:
        for order in ([0, 1, 2, 3], [3, 2, 1, 0]):
            points = self.OBSTACLES.points[order]
            # (-0.5, 0) and (0.3, -0.4) are equally near: the smaller x counts
            assert points[nearest(Obstacles(points))].tolist() == [[-0.5, 0.0]]

    def test_ahead_is_a_sector(self) -> None:
        assert ahead(self.OBSTACLES).tolist() == [True, False, False, True]
        assert ahead(self.OBSTACLES, math.pi / 2.0).tolist() == [True, False, False, False]

    def test_no_obstacles(self) -> None:
        for mask in (within(Obstacles(NOWHERE), 1.0), nearest(Obstacles(NOWHERE)), ahead(Obstacles(NOWHERE))):
            assert mask.shape == (0,)

    @pytest.mark.parametrize("text", ["all", "nearest", "within(1)", "ahead(90)", "within(1.2) & ahead(200) & nearest"])
    def test_the_compiled_selection_keeps_what_the_plain_one_keeps(self, text: str) -> None:
        steps = obstacle_selection.parse(text)
        rng = np.random.default_rng(3)
        for count in (0, 1, 12):
            points = rng.uniform(-2.0, 2.0, (count, 2))
            plain = obstacle_selection.select(steps, Obstacles(points)).points
            kept = obstacle_selection.keep_selected(*obstacle_selection.program(steps), points, count)
            assert points[:kept].tolist() == plain.tolist()


class TestVirtualMembers:
    def test_moves_along_the_wall_with_the_tangential_part_of_the_own_velocity(self) -> None:
        members = with_virtual_members(
            members_at(np.array([[1.0, 1.0]])),
            Obstacles(np.array([[0.0, 0.5], [0.6, 0.0], [3.0, 0.0]])),
            np.array([0.2, 0.1]),
            1.0,
        )
        assert members.positions.tolist() == [[1.0, 1.0], [0.0, 0.5], [0.6, 0.0]]
        assert_allclose(members.velocities[1:], [[0.2, 0.0], [0.0, 0.1]], atol=ROUNDING)
        assert_allclose(members.headings[1:], [0.0, math.pi / 2.0])
        assert_allclose(members.bearings[1:], [math.pi / 2.0, 0.0])
        assert members.ids.tolist() == [-1, -1, -1]

    @settings(max_examples=50, deadline=None)
    @given(bearing=st.floats(-3.1, 3.1), distance=st.floats(0.01, 0.99), course=st.floats(-3.1, 3.1))
    def test_never_moves_towards_or_away_and_never_faster(self, bearing: float, distance: float, course: float) -> None:
        point = distance * np.array([[math.cos(bearing), math.sin(bearing)]])
        positions, velocities = np.empty((1, 2)), np.empty((1, 2))
        assert virtual_members(point, math.cos(course), math.sin(course), 1.0, positions, velocities) == 1
        assert velocities[0] @ point[0] == pytest.approx(0.0, abs=ROUNDING)
        assert np.hypot(*velocities[0]) == pytest.approx(abs(math.sin(course - bearing)), abs=ROUNDING)

    def test_a_point_on_the_member_and_one_without_room_make_none(self) -> None:
        positions, velocities = np.empty((1, 2)), np.empty((1, 2))
        points = np.array([[0.0, 0.0], [0.5, 0.0], [0.6, 0.0]])
        assert virtual_members(points, 1.0, 0.0, 1.0, positions, velocities) == 1
        assert positions.tolist() == [[0.5, 0.0]]

    def test_a_standing_one_has_no_heading(self) -> None:
        members = with_virtual_members(members_at(NOWHERE), Obstacles(np.array([[0.5, 0.0]])), np.zeros(2), 1.0)
        assert np.isnan(members.headings).all()


class TestLeftAlone:
    @pytest.mark.parametrize("kind", list(Kind))
    def test_without_obstacles_nothing_changes(self, kind: Kind) -> None:
        assert moved(kind, 0.3, 0.1, NOWHERE) == (kind, 0.3, 0.1, False)

    @pytest.mark.parametrize("kind", [Kind.HOLD, Kind.WAY_POINT, Kind.VELOCITY, Kind.HEADING, Kind.ACCELERATION])
    def test_what_stands_behind_beside_or_far_ahead_does_not_matter(self, kind: Kind) -> None:
        x = 0.0 if kind == Kind.HEADING else 2.0
        y = 0.25 if kind == Kind.HEADING else 0.0
        points = [[-0.2, 0.0], [0.0, 0.1], [LOOK + MARGIN + 1e-6, 0.0]]
        assert moved(kind, x, y, points) == (kind, x, y, False)

    def test_standing_still_is_never_in_the_way_of_anything(self) -> None:
        assert moved(Kind.STOP, math.nan, math.nan, [[0.1, 0.0]])[3] is False
        assert moved(Kind.HOLD, math.nan, math.nan, [[0.1, 0.0]], own=(0.0, 0.0))[3] is False
        assert moved(Kind.HEADING, 1.0, 0.0, [[0.1, 0.1]]) == (Kind.HEADING, 1.0, 0.0, False)

    def test_a_way_point_before_the_margin_is_reached(self) -> None:
        assert moved(Kind.WAY_POINT, 0.2, 0.0, [[0.2 + MARGIN + 1e-6, 0.0]])[3] is False
        assert moved(Kind.WAY_POINT, 0.2, 0.0, [[0.2 + MARGIN - 1e-6, 0.0]])[3] is True


def wall(distance: float, bearing: float) -> list[list[float]]:
    return [[distance * math.cos(bearing), distance * math.sin(bearing)]]


class TestTurned:
    @settings(max_examples=80, deadline=None)
    @given(
        distance=st.floats(0.02, LOOK + MARGIN - 0.01),
        bearing=st.floats(0.02, 1.5),
        course=st.floats(-3.1, 3.1),
    )
    def test_a_velocity_keeps_its_speed_and_stays_out_of_the_margin(
        self, distance: float, bearing: float, course: float
    ) -> None:
        velocity = 0.25 * np.array([math.cos(course), math.sin(course)])
        point = np.array(wall(distance, course + bearing)[0])
        kind, x, y, acted = moved(Kind.VELOCITY, *velocity, [point])
        if math.cos(bearing) * LOOK <= distance - MARGIN:
            assert not acted
            return
        assert (kind, acted) == (Kind.VELOCITY, True)
        assert math.hypot(x, y) == pytest.approx(0.25)
        # the wall is nearest at `point`: how near it is after the look-ahead distance
        clearance = distance - LOOK * (point @ [x, y]) / (distance * 0.25)
        assert clearance >= MARGIN - ROUNDING or point @ [x, y] < 0.0
        # turned away from the wall, which is to the left
        assert velocity[0] * y - velocity[1] * x < 0.0

    def test_the_turn_is_the_least_one(self) -> None:
        point = np.array(wall(0.6, 0.3)[0])
        _, x, y, _ = moved(Kind.VELOCITY, 0.25, 0.0, [point])
        angles = np.linspace(-math.pi, math.pi, 200_001)
        free = 0.6 - LOOK * np.cos(angles - 0.3) >= MARGIN
        least = angles[free][np.argmin(np.abs(angles[free]))]
        # the grid's spacing
        assert math.atan2(y, x) == pytest.approx(least, abs=2.0 * math.pi / 200_000)

    def test_hold_and_acceleration_become_the_velocity_that_they_would_have_made(self) -> None:
        points = wall(0.5, 0.2)
        turned = moved(Kind.VELOCITY, 0.25, 0.05, points)
        assert turned[0] == Kind.VELOCITY
        assert moved(Kind.HOLD, math.nan, math.nan, points, own=(0.25, 0.05)) == turned
        assert moved(Kind.ACCELERATION, 1.5, 0.5, points, own=(0.1, 0.0)) == pytest.approx(turned)

    def test_a_heading_keeps_its_speed_backwards_too(self) -> None:
        points = wall(0.5, 0.2)
        _, x, y, _ = moved(Kind.VELOCITY, 0.25, 0.0, points)
        kind, bearing, speed, _ = moved(Kind.HEADING, 0.0, 0.25, points)
        assert (kind, speed) == (Kind.HEADING, 0.25)
        assert bearing == pytest.approx(math.atan2(y, x))
        _, bearing, speed, _ = moved(Kind.HEADING, math.pi, -0.25, points)
        assert speed == -0.25
        assert (-math.cos(bearing), -math.sin(bearing)) == pytest.approx((x / 0.25, y / 0.25))

    def test_a_way_point_behind_a_wall_is_projected_on_the_free_direction(self) -> None:
        kind, x, y, _ = moved(Kind.WAY_POINT, 2.0, -1.0, wall(MARGIN, 0.0))
        assert kind == Kind.WAY_POINT
        assert_allclose([x, y], [0.0, -1.0], atol=ROUNDING)

    def test_a_way_point_straight_behind_a_wall_is_drawn_back_to_the_margin(self) -> None:
        assert moved(Kind.WAY_POINT, 2.0, 0.0, wall(0.5, 0.0))[1:3] == pytest.approx((0.5 - MARGIN, 0.0))
        assert moved(Kind.WAY_POINT, 2.0, 0.0, wall(0.9 * MARGIN, 0.0))[0] == Kind.STOP

    def test_a_velocity_straight_at_a_wall_is_reversed(self) -> None:
        assert moved(Kind.VELOCITY, 0.25, 0.0, wall(0.5, 0.0)) == (Kind.VELOCITY, -0.25, 0.0, True)

    def test_a_fast_motion_is_looked_ahead_for_one_update(self) -> None:
        assert moved(Kind.VELOCITY, 30.0, 0.0, wall(3.2, 0.1))[3] is True

    def test_a_corridor_narrower_than_two_margins_can_be_passed(self) -> None:
        walls = [[0.0, 0.8 * MARGIN], [0.0, -0.8 * MARGIN]]
        assert moved(Kind.VELOCITY, 0.25, 0.0, walls)[3] is False
        kind, x, y, acted = moved(Kind.VELOCITY, 0.25, 0.02, walls)
        assert (kind, acted) == (Kind.VELOCITY, True)
        assert_allclose([x, y], [math.hypot(0.25, 0.02), 0.0], atol=ROUNDING)

    def test_a_corner_is_left_along_the_wall_that_is_less_in_the_way(self) -> None:
        kind, x, y, acted = moved(Kind.VELOCITY, 0.2, 0.1, [[MARGIN, 0.0], [0.0, MARGIN]])
        assert (kind, acted) == (Kind.VELOCITY, True)
        assert x <= ROUNDING
        assert y <= ROUNDING

    def test_a_small_room_is_no_reason_to_stand_still(self) -> None:
        half = MARGIN + 0.1
        kind, *_ = moved(Kind.VELOCITY, 0.25, 0.02, [[half, 0.0], [-half, 0.0], [0.0, half], [0.0, -half]])
        assert kind == Kind.VELOCITY

    def test_trapped_on_all_sides_it_stands(self) -> None:
        ring = [wall(0.5 * MARGIN, a)[0] for a in np.arange(3) * 2.0 * math.pi / 3.0 + 0.1]
        assert moved(Kind.VELOCITY, 0.25, 0.0, ring)[0] == Kind.STOP

    def test_an_obstacle_on_the_member_or_unknown_gives_no_direction(self) -> None:
        assert moved(Kind.VELOCITY, 0.25, 0.0, [[0.0, 0.0], [math.nan, math.nan]])[3] is False


def scenes(count: int = 200) -> list[tuple[Kind, float, float, np.ndarray]]:
    rng = np.random.default_rng(11)
    kinds = [Kind.WAY_POINT, Kind.VELOCITY, Kind.ACCELERATION]
    return [
        (kinds[i % 3], *rng.uniform(-1.0, 1.0, size=2), rng.uniform(-1.0, 1.0, size=(rng.integers(1, 6), 2)))
        for i in range(count)
    ]


class TestSymmetries:
    OWN = (0.2, 0.05)

    def test_mirrored_scenes_give_mirrored_motions(self) -> None:
        acted = 0
        for kind, x, y, points in scenes():
            one = moved(kind, x, y, points, own=self.OWN)
            other = moved(kind, x, -y, points * [1.0, -1.0], own=(self.OWN[0], -self.OWN[1]))
            assert (one[0], one[3]) == (other[0], other[3])
            assert_allclose([other[1], -other[2]], one[1:3], atol=ROUNDING)
            acted += one[3]
        assert acted > len(scenes()) // 4

    def test_headings_too(self) -> None:
        for _, x, _, points in scenes():
            one = moved(Kind.HEADING, 3.0 * x, 0.3, points)
            other = moved(Kind.HEADING, -3.0 * x, 0.3, points * [1.0, -1.0])
            assert (other[0], -other[1], other[2]) == pytest.approx(one[:3], nan_ok=True)

    def test_rotated_scenes_give_rotated_motions_in_any_order_of_obstacles(self) -> None:
        c, s = math.cos(0.7), math.sin(0.7)
        turn = np.array([[c, s], [-s, c]])
        for kind, x, y, points in scenes():
            one = moved(kind, x, y, points, own=self.OWN)
            own = np.array(self.OWN) @ turn
            other = moved(kind, *(np.array([x, y]) @ turn), (points @ turn)[::-1], own=(own[0], own[1]))
            assert (one[0], one[3]) == (other[0], other[3])
            assert_allclose(other[1:3], np.array(one[1:3]) @ turn, atol=1e-7)

    def test_compiled_and_plain_agree(self) -> None:
        for kind, x, y, points in scenes():
            plain = avoid.py_func(int(kind), x, y, 0.2, 0.05, 0.1, points, LOOK, MARGIN)
            # the same operations in the same order; only fused multiply-adds may differ
            assert_allclose(moved(kind, x, y, points, own=self.OWN)[:3], plain[:3], rtol=1e-13, atol=1e-13)


class TestWalks:
    """A point that walks by its own velocity with this avoidance alone, among walls."""

    SPEED, DT = 0.25, 0.1

    def test_no_wall_comes_nearer_than_the_margin(self) -> None:
        """In body axes: the walls' nearest points relative to the walker."""
        half = 1.5
        for seed in range(5):
            rng = np.random.default_rng(seed)
            p, course = rng.uniform(-0.6, 0.6, size=2), rng.uniform(-math.pi, math.pi)
            v = self.SPEED * np.array([math.cos(course), math.sin(course)])
            travelled = 0
            for _ in range(600):
                points = np.array([[half - p[0], 0.0], [-half - p[0], 0.0], [0.0, half - p[1]], [0.0, -half - p[1]]])
                assert np.hypot(*points.T).min() > MARGIN - 1e-6
                kind, x, y, acted = moved(Kind.HOLD, math.nan, math.nan, points, own=(v[0], v[1]))
                v = np.array([x, y]) if acted and kind == Kind.VELOCITY else v
                travelled += kind != Kind.STOP
                p = p + v * self.DT
            assert travelled == 600
