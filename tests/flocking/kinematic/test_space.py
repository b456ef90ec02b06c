"""Periodic space, walls and bodies: nobody gets through, and what is stopped keeps what nothing stops."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.kinematic import Space, start_uniform
from flocking.kinematic.herd import KinematicHerd
from flocking.kinematic.motion import within
from flocking.kinematic.walls import apart, nearest_point, shortest, until_near, until_wall
from flocking.types import Floats
from tests.flocking.kinematic.herds import SQUARE, poses, run, segments_cross, told

ROUNDING = 1e-12
"""Of positions up to 10 m after some hundred steps, each good to 1e-15."""
CLEARANCE = 1e-8
"""What walls of a 10 m square keep off a point."""


class TestPeriodic:
    @pytest.mark.parametrize("period", [1.0, 7.3])
    def test_shortest_offset_is_the_least_of_all_images(self, period: float) -> None:
        rng = np.random.default_rng(0)
        for offset in rng.uniform(-period, period, 200):
            images = offset + period * np.arange(-3, 4)
            found = shortest(float(offset), period)
            assert abs(found) == pytest.approx(np.abs(images).min(), abs=ROUNDING)
            assert math.remainder(found - offset, period) == pytest.approx(0.0, abs=ROUNDING)

    def test_of_half_a_period_each_of_two_sees_the_other_at_it(self) -> None:
        assert (shortest(0.5, 1.0), shortest(-0.5, 1.0)) == (0.5, -0.5)

    def test_without_a_period_nothing_is_folded(self) -> None:
        assert shortest(1e300, 0.0) == 1e300
        assert within(-1e300, 0.0) == -1e300

    @pytest.mark.parametrize("x", [-1e-300, -1e-17, 0.0, 7.3, -7.3, 7.3 - 1e-16, 1e6, -1e6])
    def test_a_coordinate_is_brought_into_the_half_open_square(self, x: float) -> None:
        assert 0.0 <= within(x, 7.3) < 7.3

    def test_a_member_leaves_at_one_side_and_comes_in_at_the_other(self) -> None:
        history = run(told(1, {"x": 0.3, "y": -0.4}), poses([[9.9, 0.1]]), 100, space=Space("periodic", 10.0))
        times = np.arange(101)[:, None]
        gaps = history.positions_w[:, 0] - (np.array([9.9, 0.1]) + times * np.array([0.3, -0.4]))
        assert_allclose(gaps - 10.0 * np.round(gaps / 10.0), 0.0, atol=ROUNDING)
        assert history.positions_w.min() >= 0.0
        assert history.positions_w.max() < 10.0
        assert_allclose(history.velocities_w[1:, 0], [[0.3, -0.4]] * 100, atol=ROUNDING)

    def test_starts_outside_are_folded_into_the_square(self) -> None:
        history = run(told(3), poses([[10.0, -1e-20], [-3.0, 23.0], [1e7, 5.0]]), 0, space=Space("periodic", 10.0))
        assert history.positions_w.tolist() == [[[0.0, 0.0], [7.0, 3.0], [0.0, 5.0]]]

    def test_a_wall_at_the_seam_stops_those_who_come_over_it(self) -> None:
        wall = [[0.05, 2.0, 0.05, 8.0]]
        history = run(told(2, {"x": 0.2}), poses([[9.9, 5.0], [9.9, 1.0]]), 3, space=Space("periodic", 10.0, wall))
        assert history.positions_w[-1, 0, 0] == pytest.approx(0.05, abs=2 * CLEARANCE)
        assert history.positions_w[-1, 1, 0] == pytest.approx(0.5, abs=ROUNDING)

    def test_bodies_touch_over_the_seam(self) -> None:
        band = told(2, [{"x": 0.5}, {}], radius_m=0.2)
        history = run(band, poses([[9.5, 5.0], [0.5, 5.0]]), 5, space=Space("periodic", 10.0))
        assert history.positions_w[-1, 0, 0] == pytest.approx(0.1, abs=ROUNDING)


def a_room(rng: np.random.Generator) -> Floats:
    """Walls in the square: a wedge, a closed box, free ends, a post, crossing walls, random ones."""
    made = [
        [2.0, 2.0, 4.0, 2.2],
        [2.0, 2.0, 4.0, 1.8],
        [7.0, 7.0, 8.0, 7.0],
        [8.0, 7.0, 8.0, 8.0],
        [8.0, 8.0, 7.0, 8.0],
        [7.0, 8.0, 7.0, 7.0],
        [3.0, 6.0, 3.0, 9.0],
        [1.5, 7.5, 4.5, 7.5],
        [6.0, 3.0, 6.0, 3.0],
    ]
    return np.vstack([made, rng.uniform(0.5, 9.5, (6, 4))])


class TestWalls:
    @pytest.mark.parametrize("radius", [0.0, 0.05, 0.165])
    @pytest.mark.parametrize("synchronous", [True, False])
    def test_nobody_ever_leaves_the_square_or_crosses_a_wall(self, radius: float, synchronous: bool) -> None:
        """Steps of 1 mm to 10 m and more, so that most are long against the room."""
        rng = np.random.default_rng(1)
        walls = a_room(rng)
        space = Space("bounded", 10.0, walls)
        count = 30
        start = start_uniform(400, 10.0, rng)
        place = space.place()
        free = [p for p in start if min(apart(p[0], p[1], w)[0] for w in place.walls) > radius + 0.01]
        band = told(count, {"random": 10.0}, radius_m=radius)
        history = run(band, np.array(free[:count]), 3000, space=space, synchronous=synchronous)
        places = history.positions_w
        assert places.min() >= max(radius, 0.5 * CLEARANCE) - ROUNDING
        assert places.max() <= 10.0 - max(radius, 0.5 * CLEARANCE) + ROUNDING
        gaps = [np.abs(distances(places.reshape(-1, 2), wall)).min() for wall in place.walls]
        assert min(gaps) >= max(radius, 0.5 * CLEARANCE) - ROUNDING
        assert np.ptp(places[-500:], axis=(0, 1)).min() > 5.0  # they are not simply stuck

    def test_a_closed_room_within_the_square_is_never_entered_nor_left(self) -> None:
        """The way within one step may turn, but a closed room has no way out."""
        box = np.array([[4.0, 4.0, 6.0, 4.5], [6.0, 4.5, 5.5, 6.5], [5.5, 6.5, 3.5, 6.0], [3.5, 6.0, 4.0, 4.0]])
        start = np.vstack([np.tile([4.75, 5.2], (10, 1)), np.random.default_rng(0).uniform(0.1, 3.0, (10, 2))])
        history = run(told(20, {"random": 100.0}), poses(start), 4000, space=Space("bounded", 10.0, box))
        for t in (1000, 2000, 3000, 4000):
            inside = np.array([winding(place, box) for place in history.positions_w[t]])
            assert inside.tolist() == [True] * 10 + [False] * 10

    @pytest.mark.parametrize("size", [1e-3, 1e3, 1e7])
    def test_the_square_holds_at_any_scale(self, size: float) -> None:
        start = np.random.default_rng(2).uniform(0.2 * size, 0.8 * size, (20, 2))
        history = run(told(20, {"random": 100.0 * size}), poses(start), 2000, space=Space("bounded", size))
        assert history.positions_w.min() > 0.0
        assert history.positions_w.max() < size

    @pytest.mark.parametrize("angle_deg", [1e-7, 1e-3, 0.1, 5.0, 45.0, 89.9, 90.0, 135.0, 179.9])
    @pytest.mark.parametrize("radius", [0.0, 0.2])
    def test_what_leads_along_a_wall_is_kept(self, angle_deg: float, radius: float) -> None:
        turn = math.radians(angle_deg)
        step = {"x": 0.5 * math.cos(turn), "y": -0.5 * math.sin(turn)}
        history = run(told(1, step, radius_m=radius), poses([[5.0, 0.3]]), 5, space=SQUARE)
        places, steps = history.positions_w[:, 0], np.arange(6)
        assert_allclose(places[:, 0], 5.0 + step["x"] * steps, atol=ROUNDING)
        assert_allclose(places[:, 1], np.maximum(0.3 + step["y"] * steps, radius), atol=2 * CLEARANCE)
        if places[-1, 1] < 0.29:
            assert_allclose(history.velocities_w[-1, 0], np.diff(places, axis=0)[-1], atol=ROUNDING)

    def test_along_a_slanting_wall_the_tangential_part_is_kept_for_thousands_of_steps(self) -> None:
        wall = np.array([[100.0, 100.0, 900.0, 433.0]])
        along = np.array([800.0, 333.0]) / math.hypot(800.0, 333.0)
        start = np.array([200.0, 200.0])
        history = run(told(1, {"x": 0.1, "y": -0.05}), poses(start), 5000, space=Space("unbounded", walls=wall))
        places = history.positions_w[1:, 0]
        shift = np.array([0.1, -0.05]) @ along
        steps = np.diff(places[2000:], axis=0)
        # positions of hundreds of metres are good to 1e-13
        assert_allclose(steps, np.tile(shift * along, (len(steps), 1)), atol=1e-9)
        offs = (places - wall[0, :2]) @ np.array([-along[1], along[0]])
        assert offs.min() > 0.0
        assert offs[-1] < 1e-5

    def test_a_corner_holds_whoever_walks_into_it(self) -> None:
        for radius, (sx, sy) in itertools.product([0.0, 0.3], itertools.product([1.0, -1.0], repeat=2)):
            # exactly along the diagonal, past it to either side, and far beyond the corner
            given = [{"x": sx * a, "y": sy * b} for a, b in [(1, 1), (1.0, 0.9999999), (0.3, 0.7), (50, 50), (1e5, 1)]]
            starts = poses(np.full((5, 2), 5.0))
            for k, one in enumerate(given):
                history = run(told(1, one, radius_m=radius), starts[k : k + 1], 40, space=SQUARE)
                corner = [10.0 - radius if s > 0 else radius for s in (sx, sy)]
                assert_allclose(history.positions_w[-1, 0], corner, atol=3 * CLEARANCE)
                assert_allclose(history.velocities_w[-1, 0], 0.0, atol=3 * CLEARANCE)

    def test_from_an_outer_corner_one_slides_off_and_goes_on(self) -> None:
        wall = np.array([[0.0, 0.0, 0.0, 1.0]])
        history = run(told(1, {"x": 0.1, "y": 0.1}), poses([[-0.5, 0.0]]), 20, space=Space("unbounded", walls=wall))
        places = history.positions_w[:, 0]
        assert not segments_cross(places[:-1], places[1:], wall[0]).any()
        assert_allclose(places[-1, 1], 2.0, atol=ROUNDING)
        assert places[-1, 0] > 0.5

    def test_two_walls_that_share_an_end_leave_no_gap(self) -> None:
        rng = np.random.default_rng(3)
        for _ in range(200):
            corner, one, other = rng.uniform(-5.0, 5.0, (3, 2))
            walls = np.array([[*one, *corner], [*corner, *other]])
            start = corner + rng.uniform(-3.0, 3.0, 2)
            part, *_ = until_wall(*start, *(2.0 * (corner - start)), 1e-8, walls)
            assert 0.0 < part < 0.5  # before the corner, which is half way

    def test_a_disc_does_not_slip_through_a_gap_narrower_than_itself(self) -> None:
        walls = np.array([[5.0, 0.0, 5.0, 4.9], [5.0, 5.1, 5.0, 10.0]])
        space = Space("bounded", 10.0, walls)
        for y in (4.9, 5.0, 5.03):
            for speed in (0.05, 1.0, 100.0):
                big = run(told(1, {"x": speed}, radius_m=0.15), poses([[2.0, y]]), 120, space=space)
                assert big.positions_w[..., 0].max() < 5.0
        small = run(told(1, {"x": 0.05}, radius_m=0.05), poses([[2.0, 5.0]]), 120, space=space)
        assert small.positions_w[-1, 0, 0] > 5.5

    def test_whoever_starts_too_near_a_wall_may_leave_it(self) -> None:
        history = run(told(1, {"x": 0.1, "y": 0.05}, radius_m=0.3), poses([[0.1, 5.0]]), 10, space=SQUARE)
        assert_allclose(history.positions_w[-1, 0], [1.1, 5.5], atol=1e-6)
        into = run(told(1, {"x": -0.05, "y": 0.05}, radius_m=0.3), poses([[0.1, 5.0]]), 10, space=SQUARE)
        assert_allclose(into.positions_w[-1, 0], [0.1, 5.5], atol=1e-6)

    def test_whoever_starts_on_the_border_stays_within(self) -> None:
        starts = poses([[0.0, 5.0], [10.0, 10.0], [5.0, 0.0], [0.0, 0.0]])
        history = run(told(4, {"random": 10.0}), starts, 500, space=SQUARE)
        assert history.positions_w.min() > 0.0
        assert history.positions_w.max() < 10.0

    def test_walls_are_walls_in_unbounded_space_too(self) -> None:
        walls = np.array([[0.0, -5.0, 0.0, 5.0]])
        history = run(told(2, {"x": 3.0}), poses([[-4.0, 0.0], [-4.0, 6.0]]), 5, space=Space("unbounded", walls=walls))
        assert history.positions_w[-1, 0, 0] == pytest.approx(0.0, abs=CLEARANCE)
        assert history.positions_w[-1, 0, 0] < 0.0
        assert history.positions_w[-1, 1, 0] == 11.0

    def test_distances_and_normals_of_a_wall(self) -> None:
        wall = np.array([1.0, 1.0, 4.0, 5.0])
        assert nearest_point(0.0, 0.0, wall) == (1.0, 1.0)
        assert nearest_point(9.0, 9.0, wall) == (4.0, 5.0)
        assert apart(2.5 - 0.8, 3.0 + 0.6, wall) == pytest.approx((1.0, -0.8, 0.6))
        assert apart(2.5 + 0.8, 3.0 - 0.6, wall) == pytest.approx((1.0, 0.8, -0.6))
        assert apart(4.0, 7.0, wall) == pytest.approx((2.0, 0.0, 1.0))
        assert apart(1.0, 1.0, wall) == (0.0, 0.0, 0.0)


def distances(points: Floats, wall: Floats) -> Floats:
    """Of points (K, 2) from a segment."""
    along = wall[2:] - wall[:2]
    squared = along @ along
    part = np.clip((points - wall[:2]) @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(points))
    return np.hypot(*(points - wall[:2] - part[:, None] * along).T)


def winding(place: Floats, box: Floats) -> bool:
    """Whether a place is within a closed chain of walls: a ray from it crosses them an odd number of times."""
    far = place[None] + np.array([[100.0, 0.123]])
    return sum(bool(segments_cross(place[None], far, wall)[0]) for wall in box) % 2 == 1


class TestBodies:
    @pytest.mark.parametrize("space", [SQUARE, Space("periodic", 10.0), Space()])
    def test_discs_never_overlap_one_after_the_other(self, space: Space) -> None:
        rng = np.random.default_rng(4)
        lattice = np.array([(x, y) for x in np.arange(0.6, 9.6, 1.1) for y in np.arange(0.6, 9.6, 1.1)])
        given = [{"random": 3.0, "x": x, "y": y} for x, y in rng.uniform(-0.2, 0.2, (len(lattice), 2))]
        history = run(told(len(lattice), given, radius_m=0.4), poses(lattice), 400, space=space, synchronous=False)
        period = 10.0 if space.kind == "periodic" else 0.0
        least = min(nearest_pair(places, period) for places in history.positions_w)
        assert least >= 0.8 - ROUNDING
        assert least < 0.8 + 1e-9  # they do touch

    def test_the_step_ends_at_the_touch(self) -> None:
        history = run(told(2, [{"x": 1.0}, {}], radius_m=0.25), poses([[0.0, 0.0], [1.8, 0.3]]), 3)
        # centres 0.5 apart with 0.3 across: 0.4 along
        assert_allclose(history.positions_w[1:, 0, 0], [1.0, 1.4, 1.4], atol=ROUNDING)
        assert_allclose(history.velocities_w[1:, 0, 0], [1.0, 0.4, 0.0], atol=ROUNDING)
        assert (history.positions_w[:, 0, 1] == 0.0).all()

    def test_bodies_of_several_sizes_touch_at_the_sum_of_their_radii(self) -> None:
        bands = [told(1, {"x": 2.0}, radius_m=0.5), told(1, radius_m=0.1)]
        history = run(bands, poses([[0.0, 0.0], [3.0, 0.0]]), 3)
        assert history.positions_w[-1, 0, 0] == pytest.approx(2.4, abs=ROUNDING)

    def test_points_pass_through_bodies_and_bodies_through_points(self) -> None:
        for radii in ((0.0, 0.5), (0.5, 0.0)):
            bands = [told(1, {"x": 2.0}, radius_m=radii[0]), told(1, radius_m=radii[1])]
            assert run(bands, poses([[0.0, 0.0], [3.0, 0.0]]), 3).positions_w[-1, 0, 0] == 6.0

    def test_bodies_that_start_in_one_place_can_part(self) -> None:
        history = run(told(2, [{"x": 0.3}, {"x": -0.3}], radius_m=0.5), poses([[0.0, 0.0]] * 2), 5, synchronous=False)
        assert abs(np.diff(history.positions_w[-1, :, 0])[0]) == pytest.approx(3.0)

    @pytest.mark.parametrize(
        ("bearing_deg", "pressed"),
        [(0, (1, 1)), (10, (1, 1)), (-10, (1, 1)), (20, (1, 0)), (-20, (0, 1)), (80, (1, 0)), (-80, (0, 1))],
    )
    @pytest.mark.parametrize("heading", [0.0, 2.0, -3.1])
    @pytest.mark.parametrize("against", ["wall", "body"])
    def test_a_touch_presses_the_bumper_on_its_side(
        self, bearing_deg: float, pressed: tuple[int, int], heading: float, against: str
    ) -> None:
        """The obstacle stands at that bearing, and the member moves straight ahead a little, into it."""
        turn = heading + math.radians(bearing_deg)
        away = np.array([math.cos(turn), math.sin(turn)])
        if against == "wall":
            across = np.array([-away[1], away[0]])
            walls = np.array([[*(away * 0.3 - 5.0 * across), *(away * 0.3 + 5.0 * across)]])
            band, places, space = told(1, {"kind": 4, "y": 1.0}, radius_m=0.3 - 1e-6), [[0.0, 0.0]], Space(walls=walls)
        else:
            band = told(2, [{"kind": 4, "y": 1.0}, {}], radius_m=0.3)
            places, space = [[0.0, 0.0], list(away * (0.6 + 1e-6))], Space()
        herd = KinematicHerd([band], poses(places, heading), space, None, 0.1, np.random.default_rng(0))
        herd.advance(1, np.empty((1, len(places), 5)), 1, 0, True)
        assert tuple(herd.bodies.contacts[0].astype(int)) == pressed
        assert not herd.bodies.contacts[1:].any()

    def test_bumpers_are_released_by_a_step_that_touches_nothing(self) -> None:
        band = told(1, {"kind": 3, "x": 1.0, "back_off": True}, radius_m=0.2)
        history = run(band, poses([[8.5, 5.0]]), 6, space=SQUARE)
        # 9.5, 9.8 and pressed, back to 8.8, 9.8 and pressed, …
        assert_allclose(history.positions_w[1:, 0, 0], [9.5, 9.8, 8.8, 9.8, 8.8, 9.8], atol=1e-7)

    @pytest.mark.parametrize("radius", [0.0, 0.2])
    def test_limits_of_speed_hold_at_walls(self, radius: float) -> None:
        """All but the tiny push out of rounding."""
        band = told(20, {"random": 5.0}, radius_m=radius, max_speed_m_s=0.7)
        start = np.random.default_rng(5).uniform(0.5, 9.5, (20, 2))
        history = run(band, poses(start), 2000, space=SQUARE)
        assert np.hypot(*history.velocities_w.reshape(-1, 2).T).max() <= 0.7 + CLEARANCE

    def test_until_near_is_the_first_meeting_with_the_circle(self) -> None:
        rng = np.random.default_rng(6)
        met = 0
        for _ in range(300):
            offset, step = rng.uniform(-2.0, 2.0, 2), rng.uniform(-3.0, 3.0, 2)
            parts = np.linspace(0.0, 1.0, 20001)
            inside = np.hypot(*(offset[:, None] - step[:, None] * parts)) < 0.5
            found = until_near(*offset, *step, 0.5)
            if np.hypot(*offset) < 0.5:
                assert found in (0.0, 2.0)
            elif inside.any():
                met += 1
                assert found == pytest.approx(parts[inside.argmax()], abs=1e-4)
            else:
                assert not found < 1.0 - 1e-4 or np.hypot(*(offset - found * step)) > 0.5 - 1e-6
        assert met > 30


def nearest_pair(places: Floats, period: float) -> float:
    gaps = places[:, None] - places[None]
    if period:
        gaps -= period * np.round(gaps / period)
    lengths = np.hypot(gaps[..., 0], gaps[..., 1])
    return float(lengths[~np.eye(len(places), dtype=bool)].min())
