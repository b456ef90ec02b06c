"""Segmentation against colorsys and OpenCV, the published ranges, overlaps, and calibration."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np
import pytest

from flocking.errors import InputError
from sensing.camera.calibration import MARGINS, NARROW, calibrated
from sensing.camera.colours import HSV, KINDS, MONOCHROME, PUBLISHED, RGB, Colour, Segmentation, checked
from sensing.camera.segmentation import agreement, channels, hsv, matches, monochrome, segmented

RNG = np.random.default_rng(5)
NOISE = RNG.integers(0, 256, (60, 80, 3), dtype=np.uint8)
"""All colours, and below some greys and black."""
NOISE[:2] = NOISE[:2, :, :1]
NOISE[0, :5] = 0
EDGES = np.array([0, 1, 51, 60, 110, 111, 127, 128, 200, 204, 254, 255], np.uint8)
CUBE = np.stack(np.meshgrid(EDGES, EDGES, EDGES, indexing="ij"), -1).reshape(-1, 12, 3)


def test_hsv_is_that_of_colorsys():
    expected = np.array([colorsys.rgb_to_hsv(*(p / 255.0)) for p in NOISE.reshape(-1, 3)]).reshape(NOISE.shape)
    ours = hsv(NOISE)
    grey = NOISE.max(axis=-1) == NOISE.min(axis=-1)
    assert np.all(np.isnan(ours[grey][:, 0]))
    np.testing.assert_allclose(ours[~grey][:, 0], expected[~grey][:, 0] * 360.0, atol=1e-9)
    assert np.all((ours[~grey][:, 0] >= 0) & (ours[~grey][:, 0] < 360))
    black = NOISE.max(axis=-1) == 0
    np.testing.assert_allclose(ours[~black][:, 1:], expected[~black][:, 1:], atol=1e-12)
    assert np.all(np.isnan(ours[black][:, 1]))
    assert np.all(ours[black][:, 2] == 0)


def test_hsv_is_that_of_opencv_in_floats():
    expected = cv2.cvtColor(NOISE.astype(np.float32) / 255.0, cv2.COLOR_RGB2HSV)
    coloured = NOISE.max(axis=-1) > NOISE.min(axis=-1)
    # OpenCV adds 1.2e-7 to what it divides by, here at least 1/255
    np.testing.assert_allclose(hsv(NOISE)[coloured], expected[coloured], atol=300 * 1.2e-7 * 255)


def test_monochrome_subtraction_takes_the_light_away():
    """A grey added to a pixel changes what is left by 0.0001 of it: the weights of 3.9 add up to 0.9999."""
    dark = RNG.integers(0, 100, (9, 9, 3), dtype=np.uint8)
    np.testing.assert_allclose(monochrome(dark + np.uint8(100)), monochrome(dark), atol=0.0101)
    weights = np.array([0.2989, 0.5870, 0.1140])
    np.testing.assert_allclose(monochrome(dark) @ weights, dark @ weights * 1e-4, atol=1e-9)


def colours_of(kind: str) -> tuple[Colour, ...]:
    """Several that overlap: the published one, a wide one, one through red (hsv), one of everything but black."""
    if kind == HSV:
        more = (Colour("red", (-20.0, 0.3, 0.2), (10.0, 1.0, 1.0)), Colour("any", (0.0, 0.0, 0.9), (360.0, 1.0, 1.0)))
    elif kind == RGB:
        more = (Colour("red", (60.0, 0.0, 0.0), (255.0, 80.0, 80.0)), Colour("any", (240.0, 0.0, 0.0), (255.0,) * 3))
    else:
        more = (Colour("red", (40.0, -255.0, -255.0), (255.0, 0.0, 0.0)), Colour("any", (-5.0,) * 3, (5.0,) * 3))
    return (*PUBLISHED[kind].colours, *more)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("image", [NOISE, CUBE], ids=["noise", "cube"])
def test_compiled_labels_are_those_of_plain_formulas_and_the_last_match_wins(kind, image):
    segmentation = Segmentation(kind, colours_of(kind))
    expected = np.zeros(image.shape[:2], np.uint8)
    for k, colour in enumerate(segmentation.colours):
        expected[matches(image, kind, colour)] = k + 1
    np.testing.assert_array_equal(segmented(image, segmentation), expected)
    assert len(np.unique(expected)) >= 3
    overlap = matches(image, kind, segmentation.colours[1]) & matches(image, kind, segmentation.colours[2])
    turned = segmented(image, Segmentation(kind, segmentation.colours[::-1]))
    assert np.all(expected[overlap] == 3)
    both = matches(image, kind, segmentation.colours[1]) & ~matches(image, kind, segmentation.colours[0])
    assert np.all(turned[both] == 2)


def test_hsv_labels_are_those_of_colorsys():
    """The published range pixel by pixel in another's arithmetic; 0.8 and 0.5 are excluded, as it says "greater"."""
    found = segmented(CUBE, PUBLISHED[HSV])
    for at in np.ndindex(CUBE.shape[:2]):
        h, s, v = colorsys.rgb_to_hsv(*(CUBE[at] / 255.0))
        if min(abs(h * 360 - 5), abs(h * 360 - 20), abs(s - 0.8), abs(v - 0.5)) > 1e-9:
            assert found[at] == (5 < h * 360 < 20 and s > 0.8 and v > 0.5)
    just = np.array([[[255, 51 + 17, 51]]], np.uint8)  # hue 5, saturation exactly 0.8
    assert hsv(just)[0, 0] == pytest.approx([5.0, 0.8, 1.0])
    assert segmented(just, PUBLISHED[HSV])[0, 0] == 0
    assert segmented(just - np.uint8([[[0, 1, 1]]]), PUBLISHED[HSV])[0, 0] == 0  # hue 4.97
    assert segmented(np.array([[[255, 70, 50]]], np.uint8), PUBLISHED[HSV])[0, 0] == 1


def test_the_published_mask_and_the_published_hsv_range_exclude_one_another():
    mask = PUBLISHED[RGB].colours[0]
    steps = [np.arange(low, high + 1) for low, high in zip(mask.low, mask.high, strict=True)]
    every = np.stack(np.meshgrid(*steps, indexing="ij"), -1).reshape(-1, 21, 3).astype(np.uint8)
    assert np.all(segmented(every, PUBLISHED[RGB]) == 1)
    assert np.all(segmented(every, PUBLISHED[HSV]) == 0)
    assert np.all(segmented(every, PUBLISHED[MONOCHROME]) == 1)


def test_the_published_monochrome_range_is_the_smallest_with_one_digit_that_holds_the_mask():
    corners = np.array(np.meshgrid([60, 110], [0, 20], [0, 20])).T.reshape(1, -1, 3).astype(np.uint8)
    values = monochrome(corners)[0]
    colour = PUBLISHED[MONOCHROME].colours[0]
    assert np.all(np.abs(values.min(axis=0) - colour.low) < 0.1)
    assert np.all(np.abs(values.max(axis=0) - colour.high) < 0.1)


def test_greys_have_no_hue_and_black_no_saturation():
    grey = np.full((1, 3, 3), 200, np.uint8)
    black = np.zeros((1, 3, 3), np.uint8)
    narrow = Segmentation(HSV, (Colour("c", (0.0, 0.0, 0.0), (359.0, 1.0, 1.0)),))
    whole = Segmentation(HSV, (Colour("c", (0.0, 0.0, 0.0), (360.0, 1.0, 1.0)),))
    some = Segmentation(HSV, (Colour("c", (0.0, 0.0, 0.0), (360.0, 0.9, 1.0)),))
    for image in (grey, black):
        assert not segmented(image, narrow).any()
        assert segmented(image, whole).all()
    assert segmented(grey, some).all()
    assert not segmented(black, some).any()


@pytest.mark.parametrize(
    ("kind", "low", "high", "words"),
    [
        (RGB, (60, 20, 0), (110, 0, 20), "green from 20 to 0 is upside down: expected 0 to 20"),
        (RGB, (60, 0, 0), (256, 20, 20), "red from 60 to 256: expected both from 0 to 255"),
        (HSV, (350, 0.8, 0.5), (10, 1, 1), "hue from 350 to 10 is upside down: .* or -10 to 10 through 0"),
        (HSV, (5, 80, 0.5), (20, 100, 1), "saturation from 80 to 100: expected both from 0 to 1"),
        (HSV, (5, float("nan"), 0.5), (20, 1, 1), "saturation"),
        (MONOCHROME, (-300, 0, 0), (0, 0, 0), "red less monochrome"),
        ("hvs", (0, 0, 0), (1, 1, 1), "did you mean hsv"),
    ],
)
def test_ranges_upside_down_or_out_of_range_are_refused_in_one_line(kind, low, high, words):
    with pytest.raises(InputError, match=words) as refused:
        segmented(NOISE, Segmentation(kind, (Colour("orange", low, high),)))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("image", [NOISE[..., 0], NOISE.astype(float), NOISE[..., :2]])
def test_an_image_that_is_none_is_refused(image):
    with pytest.raises(InputError, match="expected \\(H, W, 3\\), uint8"):
        segmented(image, PUBLISHED[HSV])


def test_no_colour_and_too_many_are_refused():
    with pytest.raises(InputError, match="0 colours"):
        checked(Segmentation(RGB, ()))
    with pytest.raises(InputError, match="33 colours"):
        checked(Segmentation(RGB, PUBLISHED[RGB].colours * 33))


def shaded(rgb, rng, shape=(40, 50)) -> np.ndarray:
    """One colour in light from 0.6 to 1."""
    return np.round(rng.uniform(0.6, 1.0, shape)[..., None] * np.array(rgb)).astype(np.uint8)


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_calibrated_finds_what_it_was_calibrated_on(kind):
    rng = np.random.default_rng(8)
    names = {"orange": (255, 64, 0), "red": (250, 10, 25), "blue": (10, 30, 240)}
    image = np.concatenate([np.full((10, 50, 3), 128, np.uint8), *(shaded(c, rng) for c in names.values())])
    mask = np.repeat([0, 1, 2, 3], [10, 40, 40, 40])[:, None].repeat(50, axis=1)
    blank = Segmentation(kind, tuple(Colour(n, (0.0,) * 3, (1.0,) * 3) for n in names))
    made = calibrated(blank, [image], [mask], margins=NARROW[kind])
    assert [c.name for c in made.colours] == list(names)
    found, right = agreement([segmented(image, made)], [mask])
    assert found > 0.97
    assert right > 0.97
    assert not segmented(image, made)[:10].any()
    for k, colour in enumerate(made.colours):  # margins apart, no wider than the pixels
        values = channels(image[mask == k + 1][None], kind)[0]
        if kind != HSV:
            assert np.all(np.array(colour.low) >= values.min(axis=0) - 5.0)
            assert np.all(np.array(colour.high) <= values.max(axis=0) + 5.0)


def test_a_red_that_goes_through_zero_is_calibrated_in_one_piece():
    rng = np.random.default_rng(9)
    image = np.concatenate([shaded((250, 10, 25), rng), shaded((250, 25, 10), rng)])
    blank = Segmentation(HSV, (Colour("red", (0.0,) * 3, (1.0,) * 3),))
    (red,) = calibrated(blank, [image], [np.ones(image.shape[:2], int)], margins=NARROW[HSV]).colours
    assert red.low[0] < 0 < red.high[0]
    assert red.high[0] - red.low[0] < 20


def test_what_is_calibrated_on_one_colour_is_as_wide_as_published():
    """All of a channel that the range is cut off by apart: blue below 0, saturation and value above 1."""
    for kind in KINDS:
        image = np.full((3, 3, 3), (190, 47, 0), np.uint8)
        (made,) = calibrated(PUBLISHED[kind], [image], [np.ones((3, 3), int)]).colours
        published = np.subtract(PUBLISHED[kind].colours[0].high, PUBLISHED[kind].colours[0].low)
        width = np.subtract(made.high, made.low)
        if kind == HSV:
            assert width[:2] == pytest.approx(published[:2])
            assert made.low[2] == pytest.approx(0.5, abs=0.01)
        else:
            assert width == pytest.approx(published, abs=0.5)
            assert 2 * np.array(MARGINS[kind])[:2] == pytest.approx(published[:2], abs=0.5)


def test_calibration_without_pixels_or_with_masks_of_another_size_is_refused():
    with pytest.raises(InputError, match="no pixel of 'orange'"):
        calibrated(PUBLISHED[HSV], [NOISE], [np.zeros(NOISE.shape[:2], int)])
    with pytest.raises(InputError, match="a mask of its size"):
        calibrated(PUBLISHED[HSV], [NOISE], [np.zeros((3, 3), int)])
