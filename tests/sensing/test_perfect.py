"""Perfect detection: frames, field of view, range and occlusion, each against a case in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.types import Own
from sensing.pipelines import perfect
from sensing.types import Detection, Senses, WorldTruth

R = 0.165
OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), 0.1, 0, 0)
ALL_ROUND = 2.0 * math.pi
EDGE = 1e-6
"""How far a case stands from its limit, m or rad: far above rounding."""


def run(poses, focal: int = 0, walls=(), velocities=None, **parameters) -> Detection:
    poses = np.asarray(poses, dtype=float)
    velocities = np.zeros((len(poses), 2)) if velocities is None else np.asarray(velocities, dtype=float)
    truth = WorldTruth(poses, velocities, np.full(len(poses), R), focal, np.asarray(walls, dtype=float).reshape(-1, 4))
    return perfect.detect(Senses(None, truth), OWN, perfect.Parameters(**parameters))[0]


def ids(*args, **more) -> list[int]:
    return run(*args, **more).members.ids.tolist()


def test_positions_headings_and_velocities_are_in_the_focal_members_frame():
    found = run(
        [(1.0, 2.0, math.pi / 2), (1.0, 4.0, math.pi), (0.0, 2.5, 0.0)], velocities=[(0, 1), (0, 0.5), (0.3, 0)]
    )
    np.testing.assert_allclose(found.members.positions, [(2.0, 0.0), (0.5, 1.0)], atol=1e-12)
    np.testing.assert_allclose(found.members.bearings, [0.0, math.atan2(1.0, 0.5)], atol=1e-12)
    np.testing.assert_allclose(found.members.headings, [math.pi / 2, -math.pi / 2], atol=1e-12)
    np.testing.assert_allclose(found.members.velocities, [(0.5, 0.0), (0.0, -0.3)], atol=1e-12)
    assert found.members.ids.tolist() == [1, 2]


def test_moving_and_turning_the_whole_world_changes_nothing():
    rng = np.random.default_rng(31)
    for _ in range(30):
        poses = np.column_stack((rng.uniform(-3, 3, (7, 2)), rng.uniform(-3, 3, 7)))
        velocities, walls = rng.normal(size=(7, 2)), rng.uniform(-3, 3, (3, 4))
        angle, shift = rng.uniform(-3, 3), rng.uniform(-50, 50, 2)
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        moved = np.column_stack((poses[:, :2] @ turn + shift, poses[:, 2] + angle))
        ends = np.hstack([walls[:, :2] @ turn + shift, walls[:, 2:] @ turn + shift])
        a = run(poses, walls=walls, velocities=velocities).members
        b = run(moved, walls=ends, velocities=velocities @ turn).members
        assert a.ids.tolist() == b.ids.tolist()
        for one, other in zip(a[:4], b[:4], strict=True):
            difference = np.angle(np.exp(1j * (one - other))) if one.ndim == 1 else one - other
            np.testing.assert_allclose(difference, 0.0, atol=1e-9)  # rounding at coordinates of 50 m


def test_range_counts_to_the_nearest_part_of_a_member():
    # the nearest of 16 lines of sight passes R/16 beside the centre: it is R (1 − cos) = 0.33 mm farther
    for shift, expected in ((-0.001, [1]), (EDGE, [])):
        assert ids([(0, 0, 0), (2.0 + R + shift, 0, 0)], range_m=2.0) == expected


def test_field_of_view_counts_for_any_part_and_all_round_sees_behind():
    poses = [(0, 0, 0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    assert ids(poses, field_of_view_rad=ALL_ROUND) == [1, 2]
    assert ids(poses) == [2]
    half = math.pi / 2 - math.asin(R * 15 / 16)  # the outermost line of sight of the member on the left
    assert ids(poses, field_of_view_rad=2 * (half + EDGE)) == [2]
    assert ids(poses, field_of_view_rad=2 * (half - EDGE)) == []


def test_a_wall_hides_what_is_wholly_behind_it():
    poses, wall = [(0, 0, 0), (3.0, 0.0, 0.0)], (1.5, -1.0, 1.5, 1.0)
    assert ids(poses, walls=[wall]) == []
    assert ids(poses, walls=[wall], occlusion=False) == [1]
    assert ids(poses, walls=[(1.5, 0.0, 1.5, 1.0)]) == [1]  # half of it stands out
    assert ids(poses, walls=[(3.5, -1.0, 3.5, 1.0)]) == [1]  # the wall is behind


def test_a_member_in_line_hides_the_one_behind_it_and_a_step_aside_shows_it():
    line = [(0, 0, 0), (1.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
    assert ids(line) == [1]
    assert ids(line, occlusion=False) == [1, 2]
    # the shadow of the nearer disc at the farther one: edge at asin(R); the farther one's outermost line of sight
    # passes 15/16 R beside its centre, so it stands out once bearing + asin(15/16 R / d) exceeds asin(R)
    shadow, width = math.asin(R), math.asin(R * 15 / 16 / 3.0)
    for shift, expected in ((-EDGE, [1]), (EDGE, [1, 2])):
        bearing = shadow - width + shift
        line[2] = (3.0 * math.cos(bearing), 3.0 * math.sin(bearing), 0.0)
        assert ids(line) == expected


def test_members_that_overlap_the_focal_one_are_seen():
    assert ids([(0, 0, 0), (0.1, 0.0, 0.0)]) == [1]
    assert ids([(0, 0, 0), (0.0, 0.0, 1.0)]) == [1]


def test_alone_and_any_member_may_be_the_focal_one():
    assert ids([(3, 4, 5)]) == []
    assert ids(
        [(0, 0, 0), (1.0, 0, 0), (2.0, 1.0, math.pi)], focal=2, occlusion=False, field_of_view_rad=ALL_ROUND
    ) == [
        0,
        1,
    ]


@pytest.mark.parametrize("seed", range(5))
def test_occlusion_only_ever_removes_and_the_nearest_is_always_seen(seed):
    rng = np.random.default_rng(seed)
    poses = np.column_stack((rng.uniform(-3, 3, (12, 2)), np.zeros(12)))
    free = ids(poses, occlusion=False, field_of_view_rad=ALL_ROUND, range_m=20.0)
    seen = ids(poses, field_of_view_rad=ALL_ROUND, range_m=20.0)
    assert free == list(range(1, 12))
    assert set(seen) <= set(free)
    assert int(np.argmin(np.hypot(*(poses[1:, :2] - poses[0, :2]).T))) + 1 in seen


def test_obstacles_are_the_nearest_points_of_the_walls_in_view():
    """Against the nearest of many points along each wall; the field of view and the range cut walls anywhere."""
    rng = np.random.default_rng(32)
    along = np.linspace(0.0, 1.0, 20_001)
    seen = 0
    for _ in range(60):
        pose = np.array([*rng.uniform(-3, 3, 2), rng.uniform(-3, 3)])
        walls = rng.uniform(-4, 4, (5, 4))
        field, reach = rng.uniform(0.5, ALL_ROUND), rng.uniform(1.0, 5.0)
        found = run([pose], walls=walls, field_of_view_rad=field, range_m=reach).obstacles.points
        expected = []
        c, s = math.cos(pose[2]), math.sin(pose[2])
        for wall in walls:
            points = wall[:2] + along[:, None] * (wall[2:] - wall[:2]) - pose[:2]
            points = points @ np.array([[c, -s], [s, c]])
            distances = np.hypot(*points.T)
            distances[(np.abs(np.arctan2(points[:, 1], points[:, 0])) > field / 2) | (distances > reach)] = np.inf
            if np.isfinite(distances.min()):
                expected.append(points[distances.argmin()])
        assert len(found) == len(expected)
        if expected:
            # neighbouring points are at most 12 m / 20,000 apart; the nearest one errs by no more
            np.testing.assert_allclose(np.hypot(*found.T), np.hypot(*np.transpose(expected)), atol=6e-4)
        seen += len(expected)
    assert 50 < seen < 250, "cases on both sides of the limits"
