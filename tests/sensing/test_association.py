"""Association: velocities and headings from two detections, against members of which the truth is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.types import NO_OBSTACLES, members_at
from sensing.association import Association, Parameters
from sensing.types import NOBODY, Detection

DT = 0.1
ROUNDING = 1e-9
"""m/s or rad: positions of a few metres divided by 0.1 s, at double precision."""
BOTH = frozenset({"positions", "velocities", "headings"})
RAW = {"smoothing": "none", "memory_s": 0.0}


def detection(positions: np.ndarray, beams: np.ndarray | None = None) -> Detection:
    return Detection(members_at(positions), NO_OBSTACLES, np.empty(0, np.int64) if beams is None else beams)


def turned(vectors: np.ndarray, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def seen_from(pose: np.ndarray, points_w: np.ndarray) -> np.ndarray:
    return turned(points_w - pose[:2], -pose[2])


def follow(start_w: np.ndarray, velocities_w: np.ndarray, poses, needs=BOTH, order=None, **parameters):
    """The detections that come out while members go straight and the robot is at each of `poses` in turn."""
    association = Association(Parameters(**parameters), needs)
    found = []
    for k, pose in enumerate(np.asarray(poses, dtype=float)):
        points = seen_from(pose, start_w + velocities_w * k * DT)
        rows = np.arange(len(points)) if order is None else order(k, len(points))
        found.append(association.infer(detection(points[rows]), k * DT, pose))
    return found


def still(count: int) -> np.ndarray:
    return np.zeros((count, 3))


def test_velocities_are_over_ground_in_the_robots_axes_however_it_moves_itself() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        start_w = np.array([[2.0, 1.0], [-1.0, 2.0], [0.5, -2.5]]) + rng.uniform(-0.2, 0.2, (3, 2))
        velocities_w = rng.uniform(-0.3, 0.3, (3, 2))
        own = rng.uniform(-3, 3, 3) + np.arange(4)[:, None] * rng.uniform(-0.04, 0.04, 3)
        found = follow(start_w, velocities_w, own, **RAW)
        assert len(found[0].members.ids) == 0, "of one scan nothing is known"
        for k, pose in enumerate(own[1:], start=1):
            members = found[k].members
            np.testing.assert_allclose(members.velocities, turned(velocities_w, -pose[2]), atol=ROUNDING)
            expected = np.arctan2(velocities_w[:, 1], velocities_w[:, 0]) - pose[2]
            np.testing.assert_allclose(np.exp(1j * members.headings), np.exp(1j * expected), atol=ROUNDING / 0.05)


def test_pairs_do_not_depend_on_the_order_of_the_inputs() -> None:
    rng = np.random.default_rng(2)
    start_w, velocities_w = rng.uniform(-3, 3, (6, 2)), rng.uniform(-0.3, 0.3, (6, 2))
    orders = [rng.permutation(6) for _ in range(4)]
    plain = follow(start_w, velocities_w, still(4), **RAW)[-1].members.velocities
    mixed = follow(start_w, velocities_w, still(4), order=lambda k, n: orders[k], **RAW)[-1].members.velocities
    np.testing.assert_allclose(mixed, plain[orders[-1]], atol=ROUNDING)


def test_the_assignment_is_the_best_of_all_and_not_the_nearest_of_each() -> None:
    """A row that moves on by most of its gap: each one's nearest is its neighbour's old place."""
    start_w = np.array([[1.0, 0.0], [1.0, 0.2], [1.0, 0.4]])
    velocities_w = np.tile([0.0, 1.2], (3, 1))  # 0.12 m a scan, 0.2 m apart
    found = follow(start_w, velocities_w, still(2), top_speed_m_s=1.5, **RAW)[-1].members.velocities
    np.testing.assert_allclose(found, velocities_w, atol=ROUNDING)


def test_beyond_the_gate_nothing_is_paired_and_the_gate_grows_with_time() -> None:
    for gap_s, jump, known in ((0.1, 0.19, True), (0.1, 0.21, False), (0.4, 0.34, True), (0.4, 0.36, False)):
        association = Association(Parameters(gate_m=0.15, top_speed_m_s=0.5, **RAW), BOTH)
        association.infer(detection(np.array([[2.0, 0.0]])), 0.0, np.zeros(3))
        out = association.infer(detection(np.array([[2.0, jump]])), gap_s, np.zeros(3))
        assert len(out.members.ids) == known, (gap_s, jump)


def test_no_velocity_is_above_the_top_speed() -> None:
    out = follow(np.array([[2.0, 0.0]]), np.array([[0.0, 1.5]]), still(2), top_speed_m_s=0.5, **RAW)[-1]
    np.testing.assert_allclose(out.members.velocities, [[0.0, 0.5]], atol=ROUNDING)


def test_a_heading_is_kept_while_its_member_stands_and_turns_with_the_robot() -> None:
    association = Association(Parameters(**RAW), BOTH)
    place, pose = np.array([[2.0, 1.0]]), np.zeros(3)
    for k in range(6):
        if k < 3:
            place = place + np.array([[0.0, 0.02]])
        pose = np.array([0.0, 0.0, 0.1 * k])
        members = association.infer(detection(seen_from(pose, place)), k * DT, pose).members
    np.testing.assert_allclose(members.velocities, [[0.0, 0.0]], atol=ROUNDING)
    np.testing.assert_allclose(members.headings, [math.pi / 2 - 0.5], atol=ROUNDING)


def test_a_member_that_never_moved_has_a_velocity_and_no_heading() -> None:
    place = np.array([[2.0, 1.0]])
    assert len(follow(place, np.zeros((1, 2)), still(4))[-1].members.ids) == 0
    only_velocities = follow(place, np.zeros((1, 2)), still(4), needs=frozenset({"velocities"}))[-1].members
    np.testing.assert_allclose(only_velocities.velocities, [[0.0, 0.0]], atol=ROUNDING)
    assert np.isnan(only_velocities.headings).all()


def test_smoothing_weighs_by_age_and_forgets() -> None:
    """A step of velocity is followed as 1 − exp(−t / τ); noise is damped."""
    association = Association(Parameters(smoothing_s=0.3), frozenset({"velocities"}))
    x, speeds = 2.0, []
    for k in range(12):
        x += 0.03 if k > 1 else 0.0
        members = association.infer(detection(np.array([[x, 0.0]])), k * DT, np.zeros(3)).members
        speeds.append(members.velocities[0, 0] if len(members.ids) else math.nan)
    expected = 0.3 * (1.0 - np.exp(-np.arange(1, 11) * DT / 0.3))
    np.testing.assert_allclose(speeds[2:], expected, atol=ROUNDING)


@pytest.mark.parametrize(("memory_s", "known"), [(0.0, False), (0.15, False), (0.25, True)])
def test_a_member_missed_for_two_scans_is_taken_up_again_while_it_is_remembered(memory_s: float, known: bool) -> None:
    association = Association(Parameters(smoothing="none", memory_s=memory_s), BOTH)
    own = np.array([0.0, 0.0, 0.0])
    for k in range(6):
        own = np.array([0.05 * k, 0.0, 0.07 * k])
        place = np.array([[2.0, 0.03 * k]])
        points = seen_from(own, place) if k not in (3, 4) else np.empty((0, 2))
        members = association.infer(detection(points), k * DT, own).members
    assert len(members.ids) == known
    if known:
        np.testing.assert_allclose(turned(members.velocities, own[2]), [[0.0, 0.3]], atol=ROUNDING)


def test_all_inputs_of_a_body_are_given_what_its_mean_does() -> None:
    """Readings of two members: where a reading lies on its member changes, the mean of each moves on steadily."""
    rng = np.random.default_rng(3)
    arc = np.linspace(-0.1, 0.1, 9)
    association = Association(Parameters(**RAW), BOTH)
    for k in range(3):
        width = rng.uniform(0.8, 1.0)
        one = np.column_stack([2.0 + 0.02 * k + 0 * arc, width * arc])
        other = np.column_stack([1.0 + 0 * arc, 1.0 + arc - 0.03 * k])
        beams = np.concatenate([np.arange(18), [NOBODY]])
        out = association.infer(detection(np.vstack([one, other]), beams), k * DT, np.zeros(3))
    np.testing.assert_allclose(out.members.velocities[:9], np.tile([0.2, 0.0], (9, 1)), atol=ROUNDING)
    np.testing.assert_allclose(out.members.velocities[9:], np.tile([0.0, -0.3], (9, 1)), atol=ROUNDING)
    np.testing.assert_array_equal(out.beams, beams)


def test_beams_follow_their_inputs_when_others_are_left_out() -> None:
    """A newcomer between two known members: its beams made no input, and those of the others keep theirs."""
    association = Association(Parameters(**RAW), BOTH)
    known = np.array([[2.0, -1.0], [2.0, 1.0]])
    association.infer(detection(known, np.array([0, 1])), 0.0, np.zeros(3))
    now = np.array([[2.02, -1.0], [1.0, 0.0], [2.02, 1.0]])
    out = association.infer(detection(now, np.array([NOBODY, 0, 0, 1, 1, 2, NOBODY])), DT, np.zeros(3))
    np.testing.assert_allclose(out.members.positions, now[[0, 2]])
    np.testing.assert_allclose(out.members.bearings, np.arctan2(now[[0, 2], 1], now[[0, 2], 0]))
    assert out.beams.tolist() == [NOBODY, 0, 0, NOBODY, NOBODY, 1, NOBODY]


def test_the_same_scan_again_gives_the_same_again() -> None:
    association = Association(Parameters(), BOTH)
    for k in range(3):
        points = np.array([[2.0 + 0.02 * k, 0.0]])
        first = association.infer(detection(points), k * DT, np.zeros(3))
    again = association.infer(detection(points), 2 * DT, np.array([0.01, 0.0, 0.2]))
    for one, other in zip(first.members, again.members, strict=True):
        np.testing.assert_array_equal(one, other)


def test_nobody_in_sight_is_borne() -> None:
    association = Association(Parameters(), BOTH)
    for k in range(3):
        assert len(association.infer(detection(np.empty((0, 2))), k * DT, np.zeros(3)).members.ids) == 0
