"""Equations 3.3 to 3.7, 3.15 and 3.16: published numbers, inverses, and what either lens makes of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sensing.camera.cones import (
    RADIUS_M,
    Run,
    angle_of,
    bearing_rad,
    closure_rate_m_s,
    distance_m,
    distance_read,
    edges_of,
    run_of_disc,
    subtended_rad,
    time_to_impact_s,
)
from sensing.camera.lens import EQUAL_ANGLE, PINHOLE, PROJECTIONS, Lens, column_angles, column_edges

INCH, FOOT = 0.0254, 0.3048
AHEAD = math.radians(47.5)
"""Where straight ahead of the robot is in either camera, off its axis."""


@pytest.mark.parametrize(("pixels", "inches"), [(15, 76.21), (16, 71.32)])
def test_the_published_distances_of_15_and_16_pixels(pixels, inches):
    """Section 3.4."""
    assert distance_m(subtended_rad(pixels)) / INCH == pytest.approx(inches, abs=0.005)


def test_the_published_far_readings_are_16_and_17_pixels():
    """Appendix A, at 6 ft: 5.941667 and 5.583333."""
    assert distance_m(subtended_rad(16)) / FOOT == pytest.approx(5.941667, abs=0.003)
    assert distance_m(subtended_rad(17)) / FOOT == pytest.approx(5.583333, abs=0.003)


def test_3_5_is_the_inverse_of_3_3_and_never_below_nothing():
    for distance in (0.1, 0.5, 1.0, 7.0):
        assert distance_m(angle_of(distance)) == pytest.approx(distance)
    assert 0.0 < distance_m(math.radians(90.0)) == distance_m(math.radians(120.0)) < 0.01
    assert distance_m(subtended_rad(1)) / FOOT == pytest.approx(97.6, abs=0.1)


def test_bearings_are_left_positive_and_zero_in_the_middle():
    lens = Lens()
    assert bearing_rad(Run(310, 329), lens) == 0.0
    assert math.degrees(bearing_rad(Run(0, 0), lens)) == pytest.approx(62.5, abs=0.1)
    assert bearing_rad(Run(0, 99), lens) == -bearing_rad(Run(540, 639), lens)
    for run in (Run(0, 30), Run(100, 101), Run(500, 639)):  # the column's own angle, where angles are equal
        edges = column_edges(lens)
        assert bearing_rad(run, lens) == pytest.approx((edges[run.start] + edges[run.end + 1]) / 2)
        assert subtended_rad(run.length_px) == pytest.approx(edges[run.start] - edges[run.end + 1])


def test_closure_and_impact():
    """A cone that comes at 0.2 m/s from 1 m is there in 5 s; one that goes was there 5 s ago."""
    rate = closure_rate_m_s(1.0, 1.02, 0.1)
    assert rate == pytest.approx(-0.2)
    assert time_to_impact_s(1.0, rate) == pytest.approx(5.0)
    assert time_to_impact_s(1.0, -rate) == pytest.approx(-5.0)
    assert time_to_impact_s(1.0, 0.0) == math.inf
    assert math.isnan(closure_rate_m_s(1.0, math.nan, 0.1))


@pytest.mark.parametrize("bearing", [0.0, 0.3, AHEAD])
@pytest.mark.parametrize("feet", np.arange(0.5, 6.5, 0.5))
def test_equal_angles_read_within_6_per_cent_from_half_a_foot_to_six_feet(bearing, feet):
    """As appendix A's table; exact but for 3.5's own tangent, and with whole pixels within one pixel of that."""
    lens, distance = Lens(projection=EQUAL_ANGLE), feet * FOOT
    read = distance_read(lens, distance, bearing)
    axis = distance + RADIUS_M
    assert read == pytest.approx(math.sqrt(axis**2 - RADIUS_M**2) - RADIUS_M)
    assert 0.95 * distance < read <= distance
    whole = round(run_of_disc(lens, distance, bearing))
    assert distance_m(subtended_rad(whole)) == pytest.approx(distance, rel=0.06)


@pytest.mark.parametrize("feet", np.arange(0.5, 6.5, 0.5))
def test_a_pinhole_reads_double_at_the_centre_and_a_fifth_to_a_third_short_straight_ahead(feet):
    lens, distance = Lens(projection=PINHOLE), feet * FOOT
    assert 1.7 < distance_read(lens, distance, 0.0) / distance < 2.0
    assert (0.72 if feet >= 1 else 0.58) < distance_read(lens, distance, AHEAD) / distance < 0.80


def test_the_pinholes_bias_as_numbers():
    """Those of docs/cone_vision.md."""
    lens = Lens(projection=PINHOLE)

    def bias(feet: float, bearing: float) -> float:
        return distance_read(lens, feet * FOOT, bearing) / (feet * FOOT) - 1.0

    assert [round(100 * bias(f, 0.0)) for f in (0.5, 1, 3, 6)] == BIAS_CENTRE
    assert [round(100 * bias(f, AHEAD)) for f in (0.5, 1, 3, 6)] == BIAS_AHEAD
    lens = Lens(projection=EQUAL_ANGLE)
    assert [bias(f, AHEAD) for f in (0.5, 1, 3, 6)] == pytest.approx([-0.042, -0.012, -0.002, -0.0004], abs=6e-4)


BIAS_CENTRE = [92, 86, 80, 78]
BIAS_AHEAD = [-42, -27, -21, -20]


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_borders_of_columns_follow_from_their_middles(projection):
    lens = Lens(projection=projection)
    np.testing.assert_allclose(edges_of(column_angles(lens)), column_edges(lens), atol=2e-5)
    assert np.degrees(np.ptp(edges_of(column_angles(lens)))) == pytest.approx(125.0, abs=1e-3)
