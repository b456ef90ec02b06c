"""How bright surfaces are, and how the laser tells."""

import math

import numpy as np
import pytest

from sensing.laser.draws import intensity_draws, range_draws
from sensing.laser.hokuyo import ANGLES, SETTINGS, Lasers
from sensing.laser.intensity import returned

FRONT, BEAMS = 340, 682
IDEAL = SETTINGS["ideal"]
ROUND_OFF = 1e-9


def read(scene, parameters, seed=0, intensity=True):
    lasers = Lasers(scene.model, scene.sites, scene.roots, [parameters] * len(scene.roots))
    rngs = np.random.default_rng(seed), np.random.default_rng(seed + 1)
    return lasers.read(scene.data, 0, 0.0, range_draws(rngs[0]), intensity_draws(rngs[1]) if intensity else None)


def wall_at(distance):
    return (0.1 + distance + 0.1, 0.0, math.pi / 2, 20.0, 0.1)


def test_white_head_on_at_one_metre_is_one():
    assert returned(1.0, 0.0, 1.0, 1.0) == 1.0


def test_a_diffuse_surface_follows_the_cosine_and_the_inverse_square():
    for angle in (0.0, 0.5, 1.5):
        for distance in (0.5, 2.0):
            expected = 0.8 * math.cos(angle) / distance**2
            assert returned(0.8, 0.0, math.cos(angle), distance) == pytest.approx(expected)


def test_retroreflective_sheeting_is_flat_and_loses_half_at_forty_degrees():
    bright = returned(0.0, 300.0, 1.0, 2.0)
    assert bright == pytest.approx(75.0)
    assert returned(0.0, 300.0, math.cos(math.radians(40)), 2.0) == pytest.approx(bright / 2)
    for degrees in (50, 70, 85):  # far flatter than a cosine towards grazing
        kept = returned(0.0, 300.0, math.cos(math.radians(degrees)), 2.0) / bright
        assert kept > 0.18
    falling = [returned(0.0, 300.0, cosine, 2.0) for cosine in np.linspace(1, 0, 50)]
    assert np.all(np.diff(falling) < 0)


def test_a_wall_shines_by_its_albedo_incidence_and_distance(arena):
    scan, truth = read(arena([(0, 0, 0)], [wall_at(2.0)]), IDEAL)
    hit = np.isfinite(truth.ranges)
    np.testing.assert_allclose(scan.intensities[hit], (0.8 * np.cos(ANGLES) / truth.ranges**2)[hit], rtol=ROUND_OFF)
    assert np.all(scan.intensities[~hit] == 0.0)  # nothing comes back


def test_a_robot_shines_by_its_sheeting_and_the_slope_of_its_side(arena):
    scan, truth = read(arena([(0, 0, 0), (1.1, 0, 0)]), IDEAL)
    hit = np.isfinite(truth.ranges)
    off = np.sin(ANGLES[hit]) / 0.15  # sine of incidence on a disc of radius 0.15 m, 1 m off
    expected = (0.3 * np.sqrt(1 - off**2) + 300 * 2 ** -(off**2 / math.sin(math.radians(40)) ** 2)) / truth.ranges[
        hit
    ] ** 2
    np.testing.assert_allclose(scan.intensities[hit], expected, rtol=1e-6)  # round-off grows towards the limb


def test_without_a_stream_no_intensity_is_given(arena):
    scan, _ = read(arena([(0, 0, 0), (1, 0, 0)]), SETTINGS["datasheet"], intensity=False)
    assert np.isnan(scan.intensities).all()


def test_noise_is_in_proportion(arena):
    scene = arena([(0, 0, 0)], [wall_at(2.0)])
    exact = read(scene, IDEAL)[0].intensities
    hit = exact > 0
    relative = np.concatenate(
        [
            (read(scene, IDEAL._replace(intensity_noise=0.1), seed)[0].intensities[hit] / exact[hit])
            for seed in range(0, 40, 2)
        ]
    )
    n = len(relative)  # five standard errors
    assert relative.mean() == pytest.approx(1.0, abs=5 * 0.1 / math.sqrt(n))
    assert relative.std() == pytest.approx(0.1, rel=5 / math.sqrt(2 * n))
    loud = read(scene, IDEAL._replace(intensity_noise=1.0))[0].intensities
    assert loud.min() == 0.0  # never negative


def test_a_lost_reading_has_no_intensity(arena):
    scan, _ = read(arena([(0, 0, 0)], [wall_at(2.0)]), IDEAL._replace(dropout=0.2))
    np.testing.assert_array_equal(np.isnan(scan.intensities), np.isnan(scan.ranges))
    assert 0.1 < np.isnan(scan.ranges).mean() < 0.3  # six standard errors about 0.2


def test_at_half_resolution_even_beams_range_and_their_left_neighbours_shine(arena):
    scene = arena([(0, 0, 0), (1.1, 0, 0)], [wall_at(2.0)])
    full, _ = read(scene, IDEAL)
    half, _ = read(scene, IDEAL._replace(intensity_mode="half-resolution"))
    np.testing.assert_array_equal(half.ranges[::2], full.ranges[::2])
    np.testing.assert_array_equal(half.intensities[::2], full.intensities[1::2])
    assert np.isnan(half.ranges[1::2]).all()
    assert np.isnan(half.intensities[1::2]).all()
    plain, _ = read(scene, IDEAL._replace(intensity_mode="half-resolution"), intensity=False)
    np.testing.assert_array_equal(plain.ranges, full.ranges)  # nobody asks for intensity: all beams range


@pytest.mark.parametrize("intensity", [True, False])
def test_a_strong_return_gives_a_code_in_place_of_its_range(arena, intensity):
    scene = arena([(0, 0, 0), (1.1, 0, 0)], [wall_at(2.0)])
    strong = IDEAL._replace(intensity_mode="strong-code", strong_return=30.0)
    exact, truth = read(scene, IDEAL)
    coded, coded_truth = read(scene, strong, intensity=intensity)
    bright = exact.intensities >= 30.0
    assert 10 < bright.sum() < truth.lit[1] + 1
    assert np.isnan(coded.ranges[bright]).all()
    np.testing.assert_array_equal(coded.ranges[~bright], exact.ranges[~bright])
    np.testing.assert_array_equal(coded_truth.owners, truth.owners)  # the code still is that robot's doing
    if intensity:
        assert np.all(coded.intensities[bright] == 30.0)
        assert np.isnan(coded.intensities[~bright]).all()
    else:
        assert np.isnan(coded.intensities).all()
