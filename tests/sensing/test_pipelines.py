"""The pipelines that read scans: closed forms, invariances, neighbours, and what is to be rejected."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from flocking.types import Own
from robots import body
from sensing.pipelines import member_based, member_extrapolated, sensor_based
from sensing.shapes import recognition
from sensing.types import NOBODY, Detection, Scan, Senses

CREATE = body.load("create")

STEP = 2.0 * math.pi / 1024
ANGLES = STEP * (np.arange(682) - 340.5)
R = CREATE.silhouette_radius
OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), 0.1, 0, 0)
MODEL = CREATE.spec().compile()
BRIGHT, DARK = 100.0, 0.5


def seen(discs=(), segments=(), reach: float = 5.6, turn: float = 0.0, noise=None) -> tuple[np.ndarray, np.ndarray]:
    """Ranges and owners (the disc's number) along ANGLES of an ideal scan: discs (x, y, radius), segments (4,)."""
    angles = ANGLES + turn
    x, y = np.cos(angles), np.sin(angles)
    ranges, owners = np.full(len(angles), np.inf), np.full(len(angles), NOBODY)
    for number, (cx, cy, radius) in enumerate(discs):
        along, aside = x * cx + y * cy, x * cy - y * cx
        hit = (np.abs(aside) < radius) & (along > 0)
        distance = np.where(hit, along - np.sqrt(np.maximum(radius**2 - aside**2, 0.0)), np.inf)
        owners[distance < ranges] = number
        ranges = np.minimum(ranges, distance)
    for x0, y0, x1, y1 in segments:
        cross = x * (y1 - y0) - y * (x1 - x0)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (x0 * (y1 - y0) - y0 * (x1 - x0)) / cross
            share = (x0 * y - y0 * x) / cross
        distance = np.where((cross != 0) & (distance > 0) & (share >= 0) & (share <= 1), distance, np.inf)
        owners[distance < ranges] = NOBODY
        ranges = np.minimum(ranges, distance)
    owners[ranges > reach] = NOBODY
    ranges[ranges > reach] = np.inf
    if noise is not None:
        ranges = ranges + 0.010 * np.where(np.isfinite(ranges), np.maximum(ranges, 1.0), 1.0) * noise
    return ranges, owners


def run(pipeline, ranges, intensities=None, **parameters) -> Detection:
    state = pipeline.start(pipeline.Parameters(**parameters), MODEL, CREATE.mount("laser").height_m, ANGLES)
    intensities = np.full(len(ANGLES), np.nan) if intensities is None else intensities
    detection, _ = pipeline.detect(Senses(Scan(0.0, ANGLES, ranges, intensities), None), OWN, state)
    return detection


def facing_mean(distance: float) -> float:
    """Mean x of the surface of a disc ahead that faces the laser, over bearings: by quadrature."""
    edge = math.asin(R / distance)

    def x(angle: float) -> float:
        return (distance * math.cos(angle) - math.sqrt(R**2 - (distance * math.sin(angle)) ** 2)) * math.cos(angle)

    return quad(x, -edge, edge)[0] / (2 * edge)


@pytest.mark.parametrize("distance", [0.34, 0.5, 1.0, 2.0, 3.5, 5.0])
def test_a_member_is_one_point_at_the_mean_of_the_facing_surface(distance):
    found = run(member_based, seen([(distance, 0.0, R)])[0])
    beams = 2 * math.asin(R / distance) / STEP
    assert found.members.positions.shape == (1, 2)
    # one beam more or less at each edge, where the surface is up to R deeper, moves the mean by 2 R / beams
    assert found.members.positions[0, 0] == pytest.approx(facing_mean(distance), abs=2 * R / beams)
    assert found.members.positions[0, 1] == pytest.approx(0.0, abs=1e-9)  # symmetric beams
    assert found.members.bearings[0] == pytest.approx(0.0, abs=1e-9)
    assert distance - R < found.members.positions[0, 0] < distance - 0.5 * R  # on the front, not at the centre
    assert np.all(found.members.ids == -1)
    assert np.all(np.isnan(found.members.headings))
    assert np.all(np.isnan(found.members.velocities))
    assert found.obstacles.points.shape == (0, 2)


def test_extrapolated_inputs_are_the_readings_whose_mean_is_the_member_based_input():
    ranges, owners = seen([(1.2, 0.5, R), (2.0, -0.9, R)])
    one, many = run(member_based, ranges), run(member_extrapolated, ranges)
    assert np.array_equal(one.beams >= 0, many.beams >= 0)
    assert np.array_equal(many.beams[owners >= 0], np.arange(np.sum(owners >= 0)))
    hit = many.beams >= 0
    points = ranges[hit, None] * np.column_stack((np.cos(ANGLES[hit]), np.sin(ANGLES[hit])))
    np.testing.assert_allclose(many.members.positions, points, atol=1e-12)
    for row in range(2):
        mean = many.members.positions[one.beams[hit] == row].mean(axis=0)
        np.testing.assert_allclose(one.members.positions[row], mean, atol=1e-12)
    bearings = np.arctan2(one.members.positions[:, 1], one.members.positions[:, 0])
    np.testing.assert_allclose(one.members.bearings, bearings, atol=1e-12)


SCENE = [(1.0, 0.3, R), (2.2, -0.8, R), (0.2, 1.0, R), (3.0, 0.9, R), (1.5, -0.25, 0.4)]
WALLS = [(-4.0, -1.5, 5.0, -1.5), (5.0, 1.8, -4.0, 1.8)]


@pytest.mark.parametrize("pipeline", [member_based, member_extrapolated, sensor_based])
def test_a_mirrored_scan_gives_the_mirrored_detection(pipeline):
    rng = np.random.default_rng(2)
    for _ in range(20):
        ranges, owners = seen(SCENE, WALLS, noise=rng.normal(size=682))
        ranges[rng.integers(0, 682, 5)] = np.nan
        light = np.where(owners >= 0, BRIGHT, DARK)
        plain, mirrored = run(pipeline, ranges, light), run(pipeline, ranges[::-1].copy(), light[::-1].copy())
        np.testing.assert_allclose(
            mirrored.members.positions, plain.members.positions[::-1] * (1, -1), atol=1e-9
        )  # sums in reverse order: rounding
        np.testing.assert_allclose(np.sort(mirrored.obstacles.points[:, 0]), np.sort(plain.obstacles.points[:, 0]))


@pytest.mark.parametrize("pipeline", [member_based, member_extrapolated, sensor_based])
def test_beams_shifted_are_the_detection_turned(pipeline):
    shift = 60
    ranges, owners = seen([(1.0, 0.3, R), (2.0, -0.6, R)], noise=np.random.default_rng(4).normal(size=682))
    light = np.where(owners >= 0, BRIGHT, DARK)
    plain = run(pipeline, ranges, light)
    turned = run(pipeline, np.roll(ranges, shift), np.roll(light, shift))
    cosine, sine = math.cos(shift * STEP), math.sin(shift * STEP)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    assert len(plain.members.positions) >= 2
    np.testing.assert_allclose(turned.members.positions, plain.members.positions @ turn.T, atol=1e-9)
    np.testing.assert_allclose(turned.members.bearings, plain.members.bearings + shift * STEP, atol=1e-9)
    np.testing.assert_array_equal(turned.beams, np.roll(plain.beams, shift))


@pytest.mark.parametrize("turn", [0.0, 0.7, -1.9, 2.0])
def test_order_is_that_of_the_beams(turn):
    found = run(member_based, seen([(1, 0.5, R), (1, -0.5, R), (0, 1.2, R), (-0.3, -1, R)], turn=turn)[0])
    assert np.all(np.diff(found.members.bearings) > 0)
    rows = found.beams[found.beams >= 0]
    assert np.all(np.diff(rows) >= 0)
    assert set(rows.tolist()) == set(range(len(found.members.bearings)))


@pytest.mark.parametrize("code", [math.inf, -math.inf, math.nan])
@pytest.mark.parametrize("pipeline", [member_based, member_extrapolated, sensor_based])
def test_a_scan_without_readings_detects_nothing(pipeline, code):
    found = run(pipeline, np.full(682, code), np.full(682, BRIGHT))
    assert found.members.positions.shape == (0, 2)
    assert found.obstacles.points.shape == (0, 2)
    assert np.all(found.beams == NOBODY)


@pytest.mark.parametrize("pipeline", [member_based, member_extrapolated, sensor_based])
def test_a_single_beam_or_none(pipeline):
    for angles in (np.array([0.1]), np.empty(0)):
        state = pipeline.start(pipeline.Parameters(), MODEL, CREATE.mount("laser").height_m, angles)
        scan = Scan(0.0, angles, np.full(len(angles), 2.0), np.full(len(angles), DARK))
        found, _ = pipeline.detect(Senses(scan, None), OWN, state)
        assert len(found.members.positions) == 0
        np.testing.assert_allclose(found.obstacles.points[:, 0], 2.0 * np.cos(angles), atol=1e-12)


def test_a_member_cut_by_the_edge_of_the_scan_is_at_least_an_obstacle():
    edge = ANGLES[-1]
    for inside in (-0.15, -0.1, 0.0, 0.1, 0.15):
        centre = (1.0 * math.cos(edge - inside), 1.0 * math.sin(edge - inside), R)
        found = run(member_based, seen([centre])[0])
        assert len(found.members.positions) + len(found.obstacles.points) == 1
    assert len(run(member_based, seen([centre])[0]).members.positions) == 1  # nearly whole


def test_members_before_a_wall_are_found_and_the_wall_is_an_obstacle():
    wall = (-3.0, 1.0, 3.0, 1.0)
    ranges, _ = seen([(0.8, 0.7, R), (0.0, 0.6, R)], [wall])
    found = run(member_based, ranges)
    assert len(found.members.positions) == 2
    assert np.min(np.abs(found.obstacles.points[:, 1] - 1.0)) == pytest.approx(0.0, abs=1e-9)
    # a wall split by members is one obstacle a piece; the nearest point of each lies on the wall
    np.testing.assert_allclose(found.obstacles.points[:, 1], 1.0, atol=1e-9)


def test_two_touching_members_are_told_apart_only_while_the_notch_between_them_is_deep():
    near = run(member_based, seen([(0.8, R, R), (0.8, -R, R)])[0])
    # beams 5 mm apart at 0.8 m step down the notch by less than the splitting distance: one wide segment, no member
    assert len(near.members.positions) == 0
    assert len(near.obstacles.points) == 1
    behind = run(member_based, seen([(0.8, 0.0, R), (0.8 + R, 2 * R, R)])[0])
    assert len(behind.members.positions) == 2  # one half behind the other: the step at its edge splits them
    apart = run(member_based, seen([(0.8, R + 0.03, R), (0.8, -R - 0.03, R)])[0])
    assert len(apart.members.positions) == 2


@pytest.mark.parametrize("radius", [0.02, 0.05, 0.08, 0.3, 0.5])
def test_a_post_of_another_radius_is_an_obstacle(radius):
    found = run(member_based, seen([(1.2, 0.2, radius)])[0])
    assert len(found.members.positions) == 0
    nearest = (1 - radius / math.hypot(1.2, 0.2)) * np.array([1.2, 0.2])
    # the nearest beam is at most half a step off the centre's bearing: 3 mm aside at 1 m
    np.testing.assert_allclose(found.obstacles.points, [nearest], atol=0.004)


@pytest.mark.parametrize("half", [0.02, 0.05, 0.3, 1.0, 3.0])
def test_a_wall_is_no_member(half):
    for angle in (0.0, 0.5, 1.2):
        along = half * np.array([math.sin(angle), math.cos(angle)])
        middle = np.array([1.5, 0.3])
        found = run(member_based, seen([], [(*(middle - along), *(middle + along))])[0])
        assert len(found.members.positions) == 0


def test_the_threshold_and_the_splitting_distance_are_obeyed():
    ranges, _ = seen([(1.0, 0.0, R)], noise=np.random.default_rng(3).normal(size=682))
    assert len(run(member_based, ranges, threshold_m=0.0).members.positions) == 0
    assert len(run(member_based, ranges).members.positions) == 1
    assert len(run(member_based, ranges, split_m=0.001).members.positions) == 0
    # a wall 0.2 m behind the member is one with it, once the limit reaches so far
    with_wall, _ = seen([(1.0, 0.0, R)], [(1.2, -1.0, 1.2, 1.0)])
    assert len(run(member_based, with_wall).members.positions) == 1
    assert len(run(member_based, with_wall, split_m=0.4).members.positions) == 0


def test_detection_at_data_sheet_noise_is_as_calibrated():
    # scripts/calibrate_detection.py: 0.985 of whole members from 1 to 2 m, 0.59 from 4 to 5 m (with mixed readings)
    rng, counts = np.random.default_rng(12), {}
    trials = 300
    for low, high in ((1.0, 2.0), (4.0, 5.0)):
        hits = []
        for _ in range(trials):
            distance, bearing = rng.uniform(low, high), rng.uniform(-1.5, 1.5)
            disc = (distance * math.cos(bearing), distance * math.sin(bearing), R)
            hits.append(len(run(member_based, seen([disc], noise=rng.normal(size=682))[0]).members.positions) > 0)
        counts[low] = np.mean(hits)
    # three standard errors of a share of 300: 0.087 at most
    assert counts[1.0] > 0.985 - 3 * math.sqrt(0.985 * 0.015 / trials)
    assert counts[4.0] > 0.59 - 3 * math.sqrt(0.25 / trials)
    assert counts[4.0] < counts[1.0]


def test_noise_moves_the_input_by_no_more_than_the_mean_of_its_readings():
    rng = np.random.default_rng(13)
    ideal, owners = seen([(1.0, 0.0, R)])
    beams, truth = int(np.sum(owners >= 0)), run(member_based, ideal).members.positions[0]
    # a limit so large that noise splits no reading off the edges, where the surface recedes by 0.04 m a beam
    noisy = [run(member_based, seen([(1.0, 0.0, R)], noise=rng.normal(size=682))[0], split_m=0.2) for _ in range(200)]
    errors = np.array([found.members.positions[0] - truth for found in noisy if len(found.members.positions)])
    assert len(errors) > 190
    # along the beams: standard error 0.01 m / sqrt(beams); the spread of 200 draws is within 5 σ of it (relative
    # standard deviation 1/sqrt(400) = 0.05), the mean within 5 standard errors
    sigma = 0.010 / math.sqrt(beams)
    assert abs(errors[:, 0].std() / sigma - 1) < 0.25
    assert abs(errors[:, 0].mean()) < 5 * sigma / math.sqrt(200)


def test_sensor_based_takes_every_bright_reading_and_only_those():
    ranges, owners = seen([(1.0, 0.4, R), (2.0, -0.5, 0.05)], [(-3.0, 1.0, 5.0, 1.0)])
    light = np.where(owners >= 0, BRIGHT, DARK)
    found = run(sensor_based, ranges, light)
    hit = np.flatnonzero(owners >= 0)
    points = ranges[hit, None] * np.column_stack((np.cos(ANGLES[hit]), np.sin(ANGLES[hit])))
    np.testing.assert_allclose(found.members.positions, points, atol=1e-12)
    assert np.array_equal(found.beams[hit], np.arange(len(hit)))
    np.testing.assert_allclose(found.obstacles.points[:, 1], 1.0, atol=1e-9)  # nothing is left but the wall


def test_the_intensity_threshold_is_inclusive_and_codes_give_no_input():
    ranges, light = np.full(682, np.nan), np.full(682, np.nan)
    threshold = sensor_based.Parameters().threshold
    ranges[:6] = [1.0, 1.0, 1.0, math.nan, math.inf, -math.inf]
    light[:6] = [threshold, np.nextafter(threshold, 0), math.nan, BRIGHT, BRIGHT, BRIGHT]
    found = run(sensor_based, ranges, light)
    assert found.beams[:6].tolist() == [0, -1, -1, -1, -1, -1]
    assert len(found.obstacles.points) == 1


def test_intensity_on_every_second_beam_makes_no_obstacle_of_a_member():
    ranges, owners = seen([(1.0, 0.0, R)])
    light = np.where(owners >= 0, BRIGHT, DARK)
    light[::2] = np.nan
    found = run(sensor_based, ranges, light)
    assert len(found.members.positions) == np.sum((owners >= 0)[1::2])
    assert len(found.obstacles.points) == 0


def test_both_pipelines_by_shape_share_their_parameters_and_so_does_sensor_based():
    assert member_based.Parameters is member_extrapolated.Parameters is recognition.Parameters
    assert sensor_based.Parameters().split_m == member_based.Parameters().split_m
