"""Beams against rectangles and discs: closed forms, invariances and an independent brute force."""

import math

import numpy as np
import pytest

from flocking.errors import InputError
from sensing.laser import planar
from sensing.laser.hokuyo import ANGLES, SETTINGS, Lasers

BEAMS, FRONT = 682, 340
ROUND_OFF = 1e-9  # m; a distance is one division away from sums of products of numbers below 10


def scan_of(rectangles=(), discs=(), laser=(0.0, 0.0, 0.0), max_range_m=5.6):
    """Distances and owners of surfaces; rectangles (x, y, angle, a, b), discs (x, y, radius), all fixed."""
    rows = [[x, y, math.cos(t), math.sin(t), a, b] for x, y, t, a, b in rectangles]
    rows += [[x, y, 1.0, 0.0, r, r] for x, y, r in discs]
    outlines, nobody = np.array(rows, dtype=float).reshape(-1, 6), np.full(len(rows), -1)
    shapes = planar.Shapes(outlines, len(rectangles), nobody, nobody, np.ones((len(rows), 2)))
    nearness, surfaces = np.empty(BEAMS), np.empty(BEAMS, np.int64)
    pose = planar.Pose(laser[0], laser[1], math.cos(laser[2]), math.sin(laser[2]))
    planar.cast(pose, 0, max_range_m, np.empty((0, 4)), shapes, nearness, surfaces)
    one = [planar.cast_one(i, pose, 0, max_range_m, np.empty((0, 4)), shapes) for i in range(BEAMS)]
    hit = surfaces >= 0
    distances = np.full(BEAMS, math.inf)
    distances[hit] = 1.0 / nearness[hit]
    return distances, surfaces, one


def test_bearings_are_those_of_the_data_sheet():
    assert len(ANGLES) == BEAMS
    assert ANGLES[FRONT] == 0.0
    np.testing.assert_allclose(np.diff(ANGLES), 2 * math.pi / 1024, rtol=1e-12)
    np.testing.assert_allclose(np.degrees(ANGLES[[0, -1]]), [-119.53, 119.88], atol=0.005)  # as published, rounded
    assert round(math.degrees(ANGLES[-1] - ANGLES[0]), 2) == 239.41


def test_what_stands_on_the_left_is_seen_by_later_beams():
    distances, _, _ = scan_of(discs=[(0.0, 2.0, 0.1)])
    assert np.all(ANGLES[np.isfinite(distances)] > 0.0)
    middle = np.flatnonzero(np.isfinite(distances)).mean()
    assert abs(middle - (FRONT + 256)) < 1.0  # a quarter turn is 256 beams


def test_a_wall_ahead_reads_its_distance_over_the_cosine():
    distances, _, _ = scan_of(rectangles=[(2.1, 0.0, 0.0, 0.1, 50.0)])
    expected = np.where(abs(ANGLES) < math.acos(2.0 / 5.6), 2.0 / np.cos(ANGLES), math.inf)
    np.testing.assert_allclose(distances, expected, atol=ROUND_OFF)


def test_a_disc_reads_the_nearer_root():
    distances, _, _ = scan_of(discs=[(1.5, 0.5, 0.3)])
    along, off = 1.5 * np.cos(ANGLES) + 0.5 * np.sin(ANGLES), 1.5 * np.sin(ANGLES) - 0.5 * np.cos(ANGLES)
    with np.errstate(invalid="ignore"):
        expected = np.where(abs(off) <= 0.3, along - np.sqrt(0.09 - off**2), math.inf)
    expected[along < 0] = math.inf
    np.testing.assert_allclose(distances, expected, atol=ROUND_OFF)


def test_a_disc_behind_is_seen_at_both_ends_of_the_sweep():
    distances, _, _ = scan_of(discs=[(-0.16, 0.0, 0.15)])
    half = math.asin(0.15 / 0.16)
    np.testing.assert_array_equal(np.isfinite(distances), abs(ANGLES) >= math.pi - half)
    assert np.isfinite(distances[[0, -1]]).all()


@pytest.mark.parametrize("bearing", [0.0, 1.0, -2.0, math.pi, 3.0])
def test_a_touching_disc_covers_half_of_the_horizon(bearing):
    gap = 1e-9
    reach = 0.15 + gap
    distances, _, _ = scan_of(discs=[(reach * math.cos(bearing), reach * math.sin(bearing), 0.15)])
    towards = np.cos(ANGLES - bearing)
    # the tangent stands sqrt(2 gap / radius) = 1.2e-4 rad off the quarter turn
    np.testing.assert_array_equal(np.isfinite(distances)[abs(towards) > 2e-4], (towards > 0)[abs(towards) > 2e-4])
    assert distances[towards > 0.1].max() < 1e-7  # gap over the cosine


@pytest.mark.parametrize("shape", [{"discs": [(0.1, 0.0, 0.15)]}, {"rectangles": [(0.1, 0.0, 0.3, 0.2, 0.1)]}])
def test_a_laser_inside_a_body_is_covered(shape):
    distances, surfaces, one = scan_of(**shape)
    assert np.all(distances == 0.0)
    assert np.all(surfaces == 0)
    assert all(near == math.inf for near, _ in one)


def test_a_closed_room_has_no_gap_at_its_corners():
    rng = np.random.default_rng(3)
    room = [(2.1, 0, 0, 0.1, 2.0), (-2.1, 0, 0, 0.1, 2.0), (0, 2.1, 0, 2.2, 0.1), (0, -2.1, 0, 2.2, 0.1)]
    for _ in range(200):
        x, y, heading = *rng.uniform(-1.99, 1.99, 2), rng.uniform(-4, 4)
        distances, _, _ = scan_of(rectangles=room, laser=(x, y, heading))
        ex, ey = np.cos(ANGLES + heading), np.sin(ANGLES + heading)
        with np.errstate(divide="ignore"):
            expected = np.minimum((2.0 - np.sign(ex) * x) / abs(ex), (2.0 - np.sign(ey) * y) / abs(ey))
        np.testing.assert_allclose(distances, expected, atol=ROUND_OFF)
    # beams straight into the corners, where two faces end
    for heading in np.arange(4) * math.pi / 2 + math.pi / 4:
        distances, _, _ = scan_of(rectangles=room, laser=(0.0, 0.0, heading))
        assert distances[FRONT] == pytest.approx(2 * math.sqrt(2), abs=ROUND_OFF)
        assert np.isfinite(distances).all()


def scenery(rng, count=12):
    rectangles = [
        (*rng.uniform(-4, 4, 2), rng.uniform(-4, 4), rng.uniform(0.02, 1.5), rng.uniform(0.02, 0.3))
        for _ in range(count)
    ]
    discs = [(*rng.uniform(-3, 3, 2), rng.uniform(0.03, 0.3)) for _ in range(count)]
    return rectangles, discs


def test_intervals_of_beams_give_what_each_beam_alone_gives():
    rng = np.random.default_rng(4)
    for _ in range(100):
        rectangles, discs = scenery(rng)
        distances, surfaces, one = scan_of(rectangles, discs, rng.uniform(-3, 3, 3))
        if distances.max() == 0.0:
            continue  # inside something: covered by whichever comes first
        alone = np.array([1.0 / near if surface >= 0 else math.inf for near, surface in one])
        np.testing.assert_array_equal(surfaces, [surface for _, surface in one])
        np.testing.assert_allclose(distances, alone, atol=ROUND_OFF)


def test_moving_the_whole_world_changes_nothing_and_mirroring_reverses_the_order():
    rng = np.random.default_rng(5)
    for _ in range(20):
        rectangles, discs = scenery(rng)
        laser = rng.uniform(-3, 3, 3)
        before, _, _ = scan_of(rectangles, discs, laser)
        turn, dx, dy = rng.uniform(-3, 3, 3)
        c, s = math.cos(turn), math.sin(turn)

        def moved(x, y, c=c, s=s, dx=dx, dy=dy):
            return c * x - s * y + dx, s * x + c * y + dy

        after, _, _ = scan_of(
            [(*moved(x, y), t + turn, a, b) for x, y, t, a, b in rectangles],
            [(*moved(x, y), r) for x, y, r in discs],
            (*moved(*laser[:2]), laser[2] + turn),
        )
        np.testing.assert_allclose(after, before, atol=1e-6)  # at grazing discs round-off grows as its square root
        mirrored, _, _ = scan_of(
            [(x, -y, -t, a, b) for x, y, t, a, b in rectangles],
            [(x, -y, r) for x, y, r in discs],
            (laser[0], -laser[1], -laser[2]),
        )
        # beams run from -340 to +341 steps: the last has no mirror image
        np.testing.assert_allclose(mirrored[: 2 * FRONT + 1], before[2 * FRONT :: -1], atol=1e-6)


def test_nothing_is_seen_beyond_the_greatest_range():
    wall = [(3.1, 0.0, 0.0, 0.1, 9.0)]
    assert np.isfinite(scan_of(wall, max_range_m=3.0 + 1e-6)[0]).any()
    assert not np.isfinite(scan_of(wall, max_range_m=3.0 - 1e-6)[0]).any()


def lean(scene, k, angle, lift=0.0):
    address = scene.model.jnt_qposadr[scene.model.body_jntadr[scene.roots[k]]]
    scene.data.qpos[address + 2] = lift
    scene.data.qpos[address + 3 : address + 7] = [math.cos(angle / 2), math.sin(angle / 2), 0.0, 0.0]


def test_the_bounds_on_leaning_and_lifting_are_where_they_are_stated(arena):
    scene = arena([(0, 0, 0), (1, 0, 0)])
    lasers = Lasers(scene.model, scene.sites, scene.roots, [SETTINGS["ideal"]] * 2)
    for k in range(2):
        lean(scene, k, planar.TILT_BOUND_RAD - 1e-6)
        lasers.cast(scene.data, 0)
        lean(scene, k, planar.TILT_BOUND_RAD + 1e-6)
        with pytest.raises(InputError, match=rf"body 'robot-{k}' leans.*sensing\.laser\.reference"):
            lasers.cast(scene.data, 0)
        lean(scene, k, 0.0, lift=planar.LIFT_BOUND_M - 1e-6)
        lasers.cast(scene.data, 0)
        lean(scene, k, 0.0, lift=planar.LIFT_BOUND_M + 1e-6)
        with pytest.raises(InputError, match=f"body 'robot-{k}'"):
            lasers.cast(scene.data, 0)
        lean(scene, k, 0.0, lift=math.nan)
        with pytest.raises(InputError, match=f"body 'robot-{k}'"):
            lasers.cast(scene.data, 0)
        lean(scene, k, 0.0)
