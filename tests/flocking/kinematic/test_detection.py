"""Stage 2 of the kinematic herd: discs as a laser that looks all around sees them, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.kinematic import Band, Space, detection
from flocking.kinematic.detection import BEAM_RAD, BEAMS, Detection
from flocking.kinematic.herd import KinematicHerd
from flocking.types import Floats, Ints
from tests.flocking.kinematic.herds import TOLD, law_of, poses

RADIUS = 0.165
ROUNDING = 1e-12
"""Of ranges of a few metres."""


def scanned(places: Any, radius: float = RADIUS, sight: float = math.inf) -> tuple[Floats, Ints]:
    centres = np.asarray(places, dtype=float).reshape(-1, 2)
    ranges, owners = np.empty(BEAMS), np.empty(BEAMS, np.int64)
    detection.readings(centres, len(centres), radius, sight, ranges, owners)
    return ranges, owners


def detected(kind: Detection, places: Any, radius: float = RADIUS, sight: float = math.inf) -> tuple[Floats, Ints]:
    """The points that a detection makes of discs at these places, and which disc each is of."""
    centres = np.asarray(places, dtype=float).reshape(-1, 2)
    points, sources = np.empty((BEAMS, 2)), np.empty(BEAMS, np.int64)
    found = detection.inputs(
        int(kind),
        centres,
        len(centres),
        radius,
        sight,
        np.empty(BEAMS),
        np.empty(BEAMS, np.int64),
        points,
        sources,
    )
    return points[:found], sources[:found]


class TestReadings:
    @pytest.mark.parametrize("distance", [0.166, 0.2, 0.5, 1.0, 3.0, 5.6, 30.0])
    @pytest.mark.parametrize("bearing", [0.0, 1.0, math.pi, -2.5, 0.5 * BEAM_RAD])
    def test_a_disc_takes_the_beams_within_its_angle(self, distance: float, bearing: float) -> None:
        _, owners = scanned([distance * math.cos(bearing), distance * math.sin(bearing)])
        half = math.asin(RADIUS / distance)
        offs = (np.arange(BEAMS) * BEAM_RAD - bearing + math.pi) % (2.0 * math.pi) - math.pi
        assert (owners[np.abs(offs) < half - 1e-9] == 0).all()
        assert (owners[np.abs(offs) > half + 1e-9] == -1).all()
        assert abs((owners == 0).sum() - 2.0 * half / BEAM_RAD) <= 1.0

    def test_ranges_end_on_the_disc(self) -> None:
        centre = np.array([0.7, -1.1])
        ranges, owners = scanned(centre)
        hit = owners == 0
        bearings = np.arange(BEAMS)[hit] * BEAM_RAD
        points = ranges[hit, None] * np.stack([np.cos(bearings), np.sin(bearings)], axis=1)
        assert_allclose(np.hypot(*(points - centre).T), RADIUS, atol=1e-9)
        assert (ranges[hit] < math.hypot(*centre)).all()
        assert np.isinf(ranges[~hit]).all()

    def test_the_beam_straight_at_the_centre_is_a_radius_short(self) -> None:
        ranges, _ = scanned([2.0, 0.0])
        assert ranges[0] == pytest.approx(2.0 - RADIUS, abs=ROUNDING)

    def test_the_nearer_disc_hides_the_farther_whatever_their_order(self) -> None:
        near, far = [1.0, 0.0], [3.0, 0.05]
        for places, first in (([near, far], 0), ([far, near], 1)):
            ranges, owners = scanned(places)
            # 9.5 degrees to either side against 3.1: nothing of the far one is seen
            assert set(owners) == {-1, first}
            assert ranges[0] == pytest.approx(1.0 - RADIUS, abs=ROUNDING)

    def test_half_hidden(self) -> None:
        """The edge of the near disc points at the centre of the far one."""
        edge = math.asin(RADIUS / 1.0)
        far = [3.0 * math.cos(edge), 3.0 * math.sin(edge)]
        _, owners = scanned([[1.0, 0.0], far])
        assert abs((owners == 1).sum() - math.asin(RADIUS / 3.0) / BEAM_RAD) <= 1.0

    def test_sight_ends_where_it_ends(self) -> None:
        assert (scanned([2.0, 0.0], sight=2.0 - RADIUS - 1e-9)[1] == -1).all()
        ranges, owners = scanned([2.0, 0.0], sight=2.0 - RADIUS / 2.0)
        assert 0 < (owners == 0).sum() < 2.0 * math.asin(RADIUS / 2.0) / BEAM_RAD - 2.0
        assert ranges[owners == 0].max() <= 2.0 - RADIUS / 2.0

    def test_a_disc_that_holds_the_member_is_not_seen(self) -> None:
        assert (scanned([[0.1, 0.0], [0.0, 0.0], [RADIUS, 0.0]])[1] == -1).all()
        for kind in (Detection.MEMBER_BASED, Detection.MEMBER_EXTRAPOLATED, Detection.SENSOR_BASED):
            assert len(detected(kind, [[0.1, 0.0], [0.0, 0.0]])[0]) == 0

    def test_nobody(self) -> None:
        assert (scanned([])[1] == -1).all()


def mean_along(distance: float) -> float:
    """Mean x of the readings of a disc straight ahead, for beams without number.

    The mean over the angle of r(t) cos t with r = d cos t - sqrt(R² - d² sin² t); the root's part is half the area of
    the disc over d.
    """
    half = math.asin(RADIUS / distance)
    whole = distance * (half + math.sin(half) * math.cos(half)) - math.pi * RADIUS**2 / (2.0 * distance)
    return whole / (2.0 * half)


class TestDetections:
    @pytest.mark.parametrize("distance", [0.3, 0.6, 1.0, 2.0, 4.0])
    def test_member_based_is_the_mean_of_the_readings(self, distance: float) -> None:
        points, sources = detected(Detection.MEMBER_BASED, [distance, 0.0])
        assert sources.tolist() == [0]
        assert points[0, 1] == pytest.approx(0.0, abs=ROUNDING)
        beams = 2.0 * math.asin(RADIUS / distance) / BEAM_RAD
        # the outermost beams may lie up to one step within the edge, where ranges are up to R longer than the mean
        assert points[0, 0] == pytest.approx(mean_along(distance), abs=2.0 * RADIUS / beams)
        assert distance - RADIUS < points[0, 0] < distance

    def test_the_mean_lies_between_the_near_side_and_the_centre_wherever_it_is_seen(self) -> None:
        rng = np.random.default_rng(0)
        for _ in range(50):
            bearing, distance = rng.uniform(-math.pi, math.pi), rng.uniform(0.3, 4.0)
            ((x, y),), _ = detected(
                Detection.MEMBER_BASED, [distance * math.cos(bearing), distance * math.sin(bearing)]
            )
            assert math.remainder(math.atan2(y, x) - bearing, 2.0 * math.pi) == pytest.approx(0.0, abs=BEAM_RAD)
            beams = 2.0 * math.asin(RADIUS / distance) / BEAM_RAD
            assert math.hypot(x, y) == pytest.approx(mean_along(distance), abs=2.0 * RADIUS / beams)

    def test_extrapolated_and_sensor_based_have_a_point_for_each_reading(self) -> None:
        places = [[1.0, 0.0], [0.0, -2.0]]
        _, owners = scanned(places)
        for kind in (Detection.MEMBER_EXTRAPOLATED, Detection.SENSOR_BASED):
            points, sources = detected(kind, places)
            assert [(sources == k).sum() for k in (0, 1)] == [(owners == k).sum() for k in (0, 1)]
            for k in (0, 1):
                assert_allclose(np.hypot(*(points[sources == k] - places[k]).T), RADIUS, atol=1e-9)

    @pytest.mark.parametrize("hidden", [0.3, 0.7])
    def test_less_than_half_of_a_disc_is_no_member_but_readings_all_the_same(self, hidden: float) -> None:
        edge, half = math.asin(RADIUS / 1.0), math.asin(RADIUS / 2.0)
        turn = edge - half + 2.0 * half * (1.0 - hidden)
        places = [[1.0, 0.0], [2.0 * math.cos(turn), 2.0 * math.sin(turn)]]
        based = detected(Detection.MEMBER_BASED, places)[1]
        extrapolated = detected(Detection.MEMBER_EXTRAPOLATED, places)[1]
        assert set(based) == set(extrapolated) == ({0, 1} if hidden < 0.5 else {0})
        shown = (detected(Detection.SENSOR_BASED, places)[1] == 1).sum()
        assert abs(shown - 2.0 * half * (1.0 - hidden) / BEAM_RAD) <= 1.0

    def test_fewer_than_five_readings_have_no_shape(self) -> None:
        for distance, beams in ((6.0, 8), (10.0, 5), (14.0, 3)):
            points, _ = detected(Detection.SENSOR_BASED, [distance, 0.0])
            assert abs(len(points) - beams) <= 1
            assert len(detected(Detection.MEMBER_BASED, [distance, 0.0])[0]) == (len(points) >= 5)

    def test_a_crowd_fills_no_more_than_all_beams(self) -> None:
        places = np.random.default_rng(1).uniform(-3.0, 3.0, (300, 2))
        for kind in (Detection.MEMBER_EXTRAPOLATED, Detection.SENSOR_BASED):
            points, _ = detected(kind, places)
            assert len(points) <= BEAMS
        assert len(detected(Detection.SENSOR_BASED, places)[0]) > 0.9 * BEAMS


WRITING = (
    TOLD.replace("MEMORY = 1", "MEMORY = 6")
    .replace(
        "    memory[0] += 1.0\n",
        """    memory[0] = len(members.ids)
    if len(members.ids) > 0:
        k = 0
        for j in range(len(members.ids)):
            if members.ids[j] < members.ids[k]:
                k = j
        memory[1], memory[2] = members.positions[k, 0], members.positions[k, 1]
        memory[3], memory[4], memory[5] = members.bearings[k], members.headings[k], members.ids[k]
""",
    )
    .replace('{"compass", "positions", "contacts"}', '{"compass", "positions", "bearings", "headings", "contacts"}')
)
"""Writes down how many inputs there are, and the first of the least id."""


def written(places: Any, headings: Any = 0.0, space: Space | None = None, **band: Any) -> Floats:
    """What each member has written down after one step."""
    start = poses(places, headings)
    group = Band(law_of(WRITING), len(start), {"see": 100.0}, **band)
    herd = KinematicHerd([group], start, space or Space(), None, 1.0, np.random.default_rng(0))
    herd.advance(1, np.empty((1, len(start), 5)), 1, 0, True)
    return herd.bodies.memory


class TestInTheHerd:
    PLACES = ((0.0, 0.0), (3.0, 0.0), (0.0, 5.0), (6.0, 0.1))

    def test_perfect_detection_sees_through_everybody(self) -> None:
        notes = written(self.PLACES, [0.0, 1.0, 2.0, 3.0])
        assert notes[:, 0].tolist() == [3.0] * 4
        assert_allclose(notes[0, 1:], [3.0, 0.0, 0.0, 1.0, 1.0], atol=ROUNDING)

    def test_discs_hide_what_is_behind(self) -> None:
        notes = written(self.PLACES, detection="member-based")
        assert notes[:, 0].tolist() == [2.0, 3.0, 3.0, 2.0]
        assert notes[0, 1] == pytest.approx(mean_along(3.0), abs=0.02)
        assert notes[:, 5].tolist() == [1.0, 0.0, 0.0, 1.0]

    def test_readings_carry_the_heading_of_their_member_seen_from_the_body(self) -> None:
        for kind in ("member-based", "member-extrapolated", "sensor-based"):
            notes = written([[0.0, 0.0], [0.0, 1.0]], [math.pi / 2.0, -math.pi / 2.0], detection=kind)
            # each straight ahead of the other, with the opposite heading
            assert_allclose(notes[:, 3], 0.0, atol=math.asin(RADIUS) + BEAM_RAD)
            assert_allclose(np.abs(notes[:, 4]), math.pi, atol=ROUNDING)
            assert (notes[:, 0] >= (1 if kind == "member-based" else 50)).all()

    def test_sight_and_silhouette_are_the_bands(self) -> None:
        notes = written(self.PLACES, detection="sensor-based", sight_m=4.0, silhouette_m=0.3)
        assert notes[2, 0] == 0.0
        assert abs(notes[0, 0] - 2.0 * math.asin(0.1) / BEAM_RAD) <= 1.0
        assert written(self.PLACES, sight_m=4.0)[2, 0] == 3.0  # perfect detection has no range of its own

    def test_a_reading_within_the_laws_reach_of_a_centre_beyond_it(self) -> None:
        start = poses([[0.0, 0.0], [1.05, 0.0]])
        group = Band(law_of(WRITING), 2, {"see": 1.0}, detection="member-based")
        herd = KinematicHerd([group], start, Space(), None, 1.0, np.random.default_rng(0))
        herd.advance(1, np.empty((1, 2, 5)), 1, 0, True)
        assert herd.bodies.memory[:, 0].tolist() == [1.0, 1.0]

    @pytest.mark.parametrize("kind", ["perfect", "member-based"])
    def test_of_bearings_alone_members_stand_at_the_assumed_distance(self, kind: str) -> None:
        notes = written([[0.0, 0.0], [3.0, 4.0]], detection=kind, information="bearings", assumed_distance_m=0.7)
        bearing = math.atan2(4.0, 3.0)
        off = 0.0 if kind == "perfect" else BEAM_RAD
        assert notes[0, 3] == pytest.approx(bearing, abs=off + ROUNDING)
        assert_allclose(notes[0, 1:3], [0.42, 0.56], atol=0.7 * off + ROUNDING)

    def test_over_the_seam(self) -> None:
        notes = written([[0.5, 5.0], [9.5, 5.0]], space=Space("periodic", 10.0), detection="member-based")
        assert notes[0, 1] == pytest.approx(-mean_along(1.0), abs=0.02)
        assert notes[1, 1] == pytest.approx(mean_along(1.0), abs=0.02)

    @pytest.mark.parametrize("kind", ["member-based", "member-extrapolated", "sensor-based"])
    def test_crowds_of_any_size_are_finite(self, kind: str) -> None:
        rng = np.random.default_rng(2)
        for count in (1, 2, 60):
            places = rng.uniform(0.0, 2.0, (count, 2))
            places[-1] = places[0]
            notes = written(places, detection=kind)
            assert np.isfinite(notes).all()
