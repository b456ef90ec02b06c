"""Cameras before a cone: what they make of its distance, and what hides it from them."""

from __future__ import annotations

import dataclasses
import math

import pytest

from flocking.errors import InputError
from sensing.camera import opengl
from sensing.camera.cones import RADIUS_M
from sensing.camera.lens import PIXELS_PER_DEGREE
from trials import simulations
from trials.simulations.cones.fields import trial
from trials.simulations.cones.scene import axis_of
from trials.types import Trial, Value, with_setup


@pytest.fixture(scope="module", autouse=True)
def rendering() -> None:
    """All of these need OpenGL, but for what is refused before."""
    try:
        opengl.library()
    except InputError as error:
        pytest.skip(str(error))


def looked(pipeline: str = "cone-member-based", of_pipeline: dict[str, Value] | None = None, **given: Value) -> Trial:
    """Two looks at a cone that stands exactly where it is said to."""
    setup: dict[str, Value] = {"looks": 2, "placed_m": 0.0, **given}
    made = trial("cones", 1, pipeline=pipeline, **{k: v for k, v in setup.items() if "." not in k})
    (eyes,) = made.groups
    own = {key: value for key, value in setup.items() if "." in key}
    eyes = dataclasses.replace(with_setup(eyes, own), pipeline_parameters=of_pipeline or {})
    return dataclasses.replace(made, groups=(eyes,))


def measured(made: Trial) -> dict[str, float]:
    return dict(simulations.run_trial(made, reraise=True).measures)


def a_pixel(distance_m: float) -> float:
    """By how much a distance is off whose run is a pixel too short: equation 3.5."""
    alpha = 2.0 * math.atan(RADIUS_M / (distance_m + RADIUS_M))
    shorter = alpha - math.radians(1.0 / PIXELS_PER_DEGREE)
    return RADIUS_M / math.tan(shorter / 2.0) - RADIUS_M - distance_m


@pytest.mark.parametrize("bearing_deg", [47.5, 90.0, 0.0])
@pytest.mark.parametrize("distance_m", [0.1524, 0.6, 1.8288])
def test_an_equal_angle_image_gives_the_distance_to_within_a_pixel(distance_m: float, bearing_deg: float) -> None:
    found = measured(looked(distance_m=distance_m, bearing_deg=bearing_deg))
    assert found["detected"] == 1.0
    assert found["false_inputs"] == 0.0
    # a sphere's tangents and a cone's base differ by 4 % half a foot away, which the equation leaves out
    assert abs(found["distance"] - distance_m) <= a_pixel(distance_m) + 0.05 * distance_m
    assert found["bearing_error"] <= math.radians(1.0 / PIXELS_PER_DEGREE)


def test_a_pinhole_image_reads_too_far_in_its_middle() -> None:
    middle = measured(looked(**{"cameras.projection": "pinhole"}))
    assert middle["distance_error"] > 0.6
    by_lens = measured(looked(of_pipeline={"pixels_per_degree": "lens"}, **{"cameras.projection": "pinhole"}))
    assert abs(by_lens["distance_error"]) < 0.15  # a pixel of the middle is a third of a degree


def test_a_calibrated_segmentation_takes_the_cones_pixels_and_no_others() -> None:
    plain = measured(looked())
    # the ranges leave out the brightest and darkest hundredths, and pixels at the outline are of two colours
    assert plain["pixels_found"] > 0.9
    assert plain["pixels_false"] < 0.05
    dark = measured(looked(light=0.2))
    assert dark["pixels_found"] == 0.0
    assert math.isnan(dark["pixels_false"])
    assert math.isnan(measured(looked(cone=False))["pixels_found"])


def test_where_no_cone_stands_nothing_is_detected() -> None:
    found = measured(looked(cone=False, distractors=8))
    assert found["false_inputs"] == 0.0
    assert math.isnan(found["detected"])


@pytest.mark.parametrize("given", [{"light": 0.2}, {"hidden": 1.0}])
def test_in_the_dark_and_behind_a_board_there_is_no_cone(given: dict[str, Value]) -> None:
    assert measured(looked(**given))["detected"] == 0.0


def test_a_cone_half_hidden_reads_twice_as_far_by_its_run_and_not_by_its_visible_side() -> None:
    by_run, by_side = measured(looked(hidden=0.5)), measured(looked("cone-blobs", hidden=0.5))
    assert by_run["distance_error"] > 0.5
    assert abs(by_side["distance_error"]) < 0.25


def test_motion_during_the_exposure_blurs_the_cone() -> None:
    still, fast = measured(looked(speed_m_s=0.0)), measured(looked(speed_m_s=3.0))
    assert fast["run"] != still["run"] or fast["distance"] != still["distance"]


def test_the_same_trial_gives_the_same_result() -> None:
    made = looked(placed_m=0.01, distractors=3, **{"cameras.setting": "mild"})
    assert measured(made) == measured(made)


def test_the_axis_stands_a_radius_behind_the_near_side() -> None:
    x, y = axis_of((0.1, 0.03), 1.0, 90.0)
    assert (x, y) == pytest.approx((0.1, 0.03 + 1.0 + RADIUS_M))


@pytest.mark.parametrize(
    ("made", "told"),
    [
        (looked("member-based"), "unknown pipeline 'member-based'; did you mean cone-member-based"),
        (looked(body="create"), "body"),
        (looked(**{"cameras.projection": "fisheye"}), "projection"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(made: Trial, told: str) -> None:
    if told == "body":
        (eyes,) = made.groups
        made = dataclasses.replace(made, groups=(with_setup(eyes, {"body": "create"}),), setup={})
    with pytest.raises(InputError, match=told) as refused:
        simulations.check(made)
    assert "\n" not in str(refused.value)


def test_a_pixel_is_the_step_that_is_published() -> None:
    inch = 0.0254
    assert a_pixel(71.32 * inch) == pytest.approx((76.21 - 71.32) * inch, abs=0.01 * inch)
