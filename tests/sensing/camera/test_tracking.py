"""Tracks: which cone is which, over own motion, crossings and gaps, and how fast they are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.types import Own
from sensing.camera.images import Images
from sensing.camera.lens import Lens, column_angles
from sensing.camera.tracking import NO_TRACKS, Settings, followed, moved
from sensing.pipelines import cone_blobs
from sensing.types import Senses
from tests.sensing.camera.scenes import Cone, model_with_cameras, pictures

SETTINGS = Settings(0.8, math.radians(1.0), 0.12, 0.5, 0.17, 1.0)
DT = 0.1


def own_at(velocity=(0.0, 0.0), turn_rate=0.0) -> Own:
    return Own(np.array(velocity), turn_rate, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), DT, 0, 0)


def body_frame(points_w: np.ndarray, pose: np.ndarray) -> np.ndarray:
    x, y, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    return (points_w - (x, y)) @ np.array([[c, -s], [s, c]])


def followed_for(places_w, poses, noise=0.0, hidden=None, seed=1):
    """Tracks over places (K, M, 2) and the robot's poses (K, 3) in the world; returns the last tracks, pairs, ids."""
    rng = np.random.default_rng(seed)
    tracks, ids = NO_TRACKS, []
    for k, (places, pose) in enumerate(zip(places_w, poses, strict=True)):
        last = poses[max(k - 1, 0)]
        way = math.hypot(*(pose - last)[:2])
        if k:
            tracks = moved(tracks, own_at((way / DT, 0.0), (pose[2] - last[2]) / DT))
        seen = body_frame(places, pose)
        seen *= 1.0 + noise * rng.normal(size=(len(seen), 1))
        rows = [m for m in range(len(seen)) if hidden is None or not hidden(k, m)]
        tracks, pairs = followed(tracks, seen[rows], np.zeros(len(rows), np.int64), SETTINGS)
        ids.append(dict(zip(rows, tracks.ids[pairs].tolist(), strict=True)))
    return tracks, pairs, ids


def straight(starts, velocities, steps=40):
    return np.array(starts) + np.arange(steps)[:, None, None] * DT * np.array(velocities)


def circling(steps=40, speed=0.2, rate=0.5):
    poses = np.zeros((steps, 3))
    for k in range(1, steps):
        middle = poses[k - 1, 2] + rate * DT / 2
        poses[k] = poses[k - 1] + (speed * math.cos(middle) * DT, speed * math.sin(middle) * DT, rate * DT)
    return poses


def test_a_robot_that_moves_sees_standing_cones_stand():
    places = straight([(1.0, 0.5), (0.7, -0.8), (2.0, 0.0)], np.zeros((3, 2)))
    tracks, pairs, ids = followed_for(places, circling())
    assert all(each == {0: 0, 1: 1, 2: 2} for each in ids)
    np.testing.assert_allclose(tracks.velocities[pairs], 0.0, atol=1e-3)
    np.testing.assert_allclose(tracks.places[pairs], body_frame(places[-1], circling()[-1]), atol=1e-3)


def test_velocities_over_ground_come_out_in_the_bodys_axes():
    velocities = np.array([(0.2, 0.1), (-0.1, 0.2)])
    tracks, pairs, _ = followed_for(straight([(1.0, 0.5), (0.9, -0.8)], velocities), circling())
    heading = circling()[-1, 2]
    expected = body_frame(velocities, np.array([0.0, 0.0, heading]))
    np.testing.assert_allclose(tracks.velocities[pairs], expected, atol=5e-3)


def test_the_second_image_gives_the_displacement_over_its_time():
    tracks, pairs, _ = followed_for(straight([(1.0, 0.0)], [(0.3, 0.1)], steps=2), np.zeros((2, 3)))
    np.testing.assert_allclose(tracks.velocities[pairs], [(0.3, 0.1)], atol=1e-9)


def test_noise_of_the_distance_is_smoothed():
    errors = []  # α = 0.5 and β = 0.17 leave 0.64 of the noise, by the filter's own formula
    for seed in range(100):
        places = straight([(1.5, 0.3)], [(0.1, 0.0)])
        tracks, pairs, _ = followed_for(places, np.zeros((40, 3)), noise=0.05, seed=seed)
        errors.append((tracks.places[pairs] - places[-1])[0])
    assert np.hypot(*np.array(errors).T).mean() < 0.75 * 0.05 * 1.89 * math.sqrt(2 / math.pi)


def test_cones_that_pass_one_another_keep_their_ids():
    places = straight([(1.0, -0.4), (1.6, 0.4)], [(0.0, 0.2), (0.0, -0.2)])
    _, _, ids = followed_for(places, np.zeros((40, 3)), noise=0.02)
    assert all(each == {0: 0, 1: 1} for each in ids)


@pytest.mark.parametrize(("gap", "same"), [(6, True), (12, False)])
def test_a_cone_out_of_sight_is_the_same_when_it_is_back_in_time(gap, same):
    places = straight([(1.0, -0.3), (0.8, 0.5)], [(0.0, 0.1), (0.0, 0.0)])
    _, _, ids = followed_for(places, np.zeros((40, 3)), hidden=lambda k, m: m == 0 and 15 <= k < 15 + gap)
    assert 0 not in ids[20]
    assert (ids[-1][0] == ids[0][0]) == same
    assert all(each[1] == ids[0][1] for each in ids)
    assert same or ids[-1][0] == 2


def test_colours_are_never_confused():
    first = np.array([(1.0, 0.0), (1.0, 0.05)])
    tracks, _ = followed(NO_TRACKS, first, np.array([0, 1]), SETTINGS)
    _, pairs = followed(moved(tracks, own_at()), first[::-1], np.array([0, 1]), SETTINGS)
    assert pairs.tolist() == [0, 1]


def test_no_cones_and_no_tracks():
    tracks, pairs = followed(NO_TRACKS, np.empty((0, 2)), np.empty(0, np.int64), SETTINGS)
    assert len(tracks.ids) == len(pairs) == 0
    assert moved(tracks, own_at((1.0, 0.0), 1.0)) is tracks


def test_the_pipeline_gives_velocities_from_the_second_image_on_and_moves_on_what_it_saw():
    lens = Lens()
    pipeline = cone_blobs
    state = pipeline.start(pipeline.Parameters(), model_with_cameras(), 0.3, np.tile(column_angles(lens), (2, 1)))
    velocities = []
    for k in range(15):
        images, _ = pictures([Cone(0.8 + 0.03 * k, 0.2)], lens, time=DT * k)
        detection, state = pipeline.detect(Senses(None, None, images=images), own_at((0.1, 0.0)), state)
        velocities.append(detection.members.velocities[0])
        assert state.tracks.ids[state.rows].tolist() == [0]
    assert np.all(np.isnan(velocities[0]))
    assert np.all(np.isfinite(velocities[1:]))
    # 0.3 m/s farther while the robot follows at 0.1: steps of whole pixels leave noise
    assert np.mean(velocities[5:], axis=0) == pytest.approx([0.4, 0.0], abs=0.1)

    held, after = pipeline.detect(Senses(None, None, images=images), own_at((0.5, 0.0)), state)
    assert held.members.positions[0, 0] == pytest.approx(
        detection.members.positions[0, 0] + DT * (detection.members.velocities[0, 0] - 0.5)
    )
    np.testing.assert_array_equal(held.beams, detection.beams)
    nothing = np.full_like(images.left, 120)
    gone, after = pipeline.detect(Senses(None, None, images=Images(9.9, nothing, nothing)), own_at(), after)
    assert len(gone.members.ids) == 0
    assert len(after.tracks.ids) == 1
