"""What a real camera forces: each by what it must do, and nothing by default."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.parameters import declared, filled
from sensing.camera.images import Images
from sensing.camera.imperfections import (
    DRAWS,
    SETTINGS,
    Parameters,
    adapted,
    begun,
    blurred,
    due,
    light_at,
    lit,
    noisy,
    seen,
    with_glare,
)

GREY = np.full((60, 80, 3), 100, np.uint8)


def pair(time: float, level: int = 100) -> Images:
    picture = np.full_like(GREY, level)
    return Images(time, picture, picture.copy())


def run(parameters: Parameters, pairs: list[Images | None], seed: int = 1):
    generator = np.random.default_rng(seed)
    memory = begun(parameters, generator, 60, 80)
    given = []
    for images in pairs:
        out, memory = seen(images, parameters, memory, generator)
        given.append(out)
    return given, memory, generator


def test_nothing_is_imperfect_by_default_and_nothing_is_copied():
    pairs = [pair(0.1 * k, 90 + k) for k in range(5)]
    given, _, _ = run(Parameters(), pairs)
    assert all(a is b for a, b in zip(given, pairs, strict=True))
    assert SETTINGS["none"] == Parameters()


@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_settings_are_within_the_declared_bounds(name):
    assert filled(Parameters, SETTINGS[name]._asdict()) == SETTINGS[name]
    assert all(each.about.source for each in declared(Parameters).values())


@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_every_update_draws_as_many_numbers_whatever_was_seen(name):
    first, second = [pair(0.1 * k) for k in range(6)], [pair(0.1 * k, 10 * k) for k in range(6)]
    second[2] = None
    _, _, a = run(SETTINGS[name], first)
    _, _, b = run(SETTINGS[name], second)
    assert a.random() == b.random()


def test_what_is_on_draws_as_many_as_what_is_off_but_for_the_pool():
    generator = np.random.default_rng(3)
    memory = begun(Parameters(), generator, 60, 80)
    seen(pair(0.0), Parameters(), memory, generator)
    expected = np.random.default_rng(3)
    expected.random(DRAWS)
    assert generator.random() == expected.random()


@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_images_are_never_changed_and_the_same_seed_gives_the_same(name):
    pairs = [pair(0.1 * k) for k in range(5)]
    one, _, _ = run(SETTINGS[name], pairs)
    two, _, _ = run(SETTINGS[name], pairs)
    assert all(np.all(p.left == 100) and np.all(p.right == 100) for p in pairs)
    for a, b in zip(one, two, strict=True):
        assert (a is None) == (b is None)
        if a is not None:
            np.testing.assert_array_equal(a.left, b.left)
            np.testing.assert_array_equal(a.right, b.right)


def test_noise_has_its_standard_deviation_and_differs_between_images():
    (given,), memory, _ = run(Parameters(noise_levels=5.0), [pair(0.0)])
    off = given.left.astype(float) - 100
    assert abs(off.mean()) < 0.2
    assert off.std() == pytest.approx(5.0, rel=0.05)
    assert abs(np.corrcoef(off.ravel(), given.right.astype(float).ravel())[0, 1]) < 0.05
    white = noisy(np.full_like(GREY, 255), memory.pool, 7)
    assert white.max() == 255  # it saturates and does not wrap
    assert white.min() > 200


def test_light_scales_and_saturates():
    ramp = np.arange(256, dtype=np.uint8)[None, :, None].repeat(3, axis=2)
    np.testing.assert_array_equal(lit(ramp, 0.5)[0, :, 0], np.round(np.arange(256) * 0.5))
    assert lit(ramp, 2.0)[0, 128:].min() == 255
    parameters = Parameters(light=0.8, light_change=0.25, light_period_s=8.0)
    assert light_at(parameters, 2.0) == pytest.approx(1.0)
    assert light_at(parameters, 6.0) == pytest.approx(0.6)
    assert light_at(parameters, 4.0) == pytest.approx(0.8)


def test_exposure_is_settled_at_first_and_follows_a_step_of_light_with_its_time_constant():
    parameters = Parameters(auto_exposure=True, exposure_level=120.0, exposure_lag_s=0.5)
    pairs = [pair(0.1 * k, 100 if k < 5 else 50) for k in range(30)]
    given, _, _ = run(parameters, pairs)
    means = np.array([each.left.mean() for each in given])
    assert np.all(means[:5] == 120)
    assert means[5] == pytest.approx(60, abs=1)  # the exposure is that of before
    for k in range(6, 30):
        gain = 2.4 + (1.2 - 2.4) * math.exp(-0.1 * (k - 5) / 0.5)
        assert means[k] == pytest.approx(50 * gain, abs=1)
    assert adapted(1.0, 3.0, 0.1, 0.0) == 3.0
    assert adapted(1.0, 3.0, math.nan, 0.5) == 1.0


def test_the_exposures_gain_has_bounds():
    parameters = Parameters(auto_exposure=True, exposure_level=120.0)
    (dark,), _, _ = run(parameters, [pair(0.0, 5)])
    assert np.all(dark.left == 20)
    (black,), _, _ = run(parameters, [pair(0.0, 0)])
    assert np.all(black.left == 0)


def test_glare_is_white_in_its_middle_and_nothing_far_away():
    made = with_glare(GREY, 30.0, 40.0, 300.0, 3.0)
    assert np.all(made[29:31, 39:41] == 255)
    assert np.all(made[:10] == 100)
    np.testing.assert_array_equal(made, made[::-1, ::-1])
    outside = with_glare(GREY, -100.0, 40.0, 300.0, 3.0)
    np.testing.assert_array_equal(outside, GREY)


def test_blur_keeps_the_mean_and_has_its_width():
    spot = np.zeros((61, 81, 3), np.uint8)
    spot[30, 40] = 255
    made = blurred(spot, 1.0).astype(float)[..., 0]
    assert made.sum() == pytest.approx(255, rel=0.05)
    columns = np.arange(81) - 40
    assert (made.sum(axis=0) * columns**2).sum() / made.sum() == pytest.approx(1.0, rel=0.15)
    np.testing.assert_array_equal(blurred(GREY, 3.0), GREY)


def test_frames_come_at_their_own_rate():
    parameters = Parameters(frame_rate_hz=4.0)
    memory, taken = begun(parameters, np.random.default_rng(1), 60, 80), []
    for k in range(20):
        time = 0.1 * k
        if due(parameters, memory, time):
            taken.append(time)
            _, memory = seen(pair(time), parameters, memory, np.random.default_rng(k))
        else:
            held, memory = seen(None, parameters, memory, np.random.default_rng(k))
            assert held.time == taken[-1]
    assert taken == pytest.approx([0.0, 0.3, 0.5, 0.8, 1.0, 1.3, 1.5, 1.8])
    assert due(Parameters(), memory, 1.8)  # one each update


def test_dropped_pairs_are_the_one_before():
    parameters = Parameters(dropped=0.3)
    pairs = [pair(0.1 * k, k % 200) for k in range(2000)]
    given, _, _ = run(parameters, pairs)
    fresh = [a is not None and a.time == b.time for a, b in zip(given, pairs, strict=True)]
    assert np.mean(fresh) == pytest.approx(0.7, abs=0.03)
    times = [-1.0 if each is None else each.time for each in given]
    assert times == sorted(times)
    none, _, _ = run(Parameters(dropped=1.0), pairs[:3])
    assert none == [None] * 3


def test_values_out_of_bounds_are_refused_in_one_line():
    with pytest.raises(InputError, match="noise_levels = -1"):
        filled(Parameters, {"noise_levels": -1.0})
