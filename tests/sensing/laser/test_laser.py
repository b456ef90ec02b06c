"""What the laser reports: limits, noise, codes, mixed readings, and the truth about them."""

import math

import numpy as np
import pytest

from flocking.parameters import checked, declared
from sensing.laser import readings
from sensing.laser.draws import AHEAD, Draws, intensity_draws, range_draws
from sensing.laser.hokuyo import ANGLES, MAX_RANGE_M, NO_INTENSITIES, SETTINGS, Parameters
from sensing.laser.readings import NORMALS
from sensing.laser.reference import difference
from sensing.types import NOBODY
from tests.sensing.laser.lasers import (
    BEAMS,
    EXACT,
    FRONT,
    HARSH,
    IDEAL,
    SHEET,
    STILL,
    for_light,
    for_ranges,
    lasers_of,
    wall_at,
)


def front_readings(arena, distance, parameters, count=3000, seed=1):
    scene = arena([(0, 0, 0)], [wall_at(distance)])
    lasers, draws = lasers_of(scene, parameters), for_ranges(seed)
    return np.array([lasers.read(scene.data, 0, 0.0, draws)[0].ranges[FRONT] for _ in range(count)])


def test_every_setting_keeps_its_parameters_bounds():
    about = declared(Parameters)
    for setting in SETTINGS.values():
        for name, value in setting._asdict().items():
            assert checked(name, value, about[name]) == value
    assert Parameters() == SHEET


def test_ideal_readings_are_the_exact_distances(arena):
    scene = arena([(0, 0, 0), (2, 0.5, 1)], [wall_at(3.0)])
    scan, truth = lasers_of(scene, IDEAL).read(scene.data, 0, 1.25, for_ranges())
    np.testing.assert_array_equal(scan.ranges, truth.ranges)
    assert scan.ranges[FRONT - 100] == pytest.approx(3.0 / math.cos(ANGLES[FRONT - 100]), abs=EXACT)
    assert scan.time == 1.25
    np.testing.assert_array_equal(scan.angles, ANGLES)
    assert np.isnan(scan.intensities).all()


@pytest.mark.parametrize(
    ("distance", "setting", "expected"),
    [(0.3, SHEET, 0.010), (0.95, SHEET, 0.010), (3.0, SHEET, 0.030), (0.5, HARSH, 0.030), (3.0, HARSH, 0.090)],
)
def test_noise_is_that_of_the_data_sheet(arena, distance, setting, expected):
    """30 mm, then 3 %: three standard deviations at `datasheet`, one at `harsh`."""
    count = 3000
    found = front_readings(arena, distance, setting._replace(dropout=0.0), count)
    # five standard errors, of a mean and of a standard deviation; rounding to 1 mm adds less than 0.1 %
    assert abs(found.mean() - distance) < 5 * expected / math.sqrt(count)
    assert found.std() == pytest.approx(expected, rel=5 / math.sqrt(2 * count))


def test_normal_deviates_are_normal():
    assert abs(NORMALS.mean(dtype=float)) < 1e-7  # symmetric, in single precision
    assert NORMALS.std(dtype=float) == pytest.approx(1.0, abs=1e-3)  # what 4096 cells lose in the tails
    assert (abs(NORMALS) > 3).mean() == pytest.approx(0.0026998, abs=2 / 4096)  # a cell at each end


def test_readings_are_whole_millimetres(arena):
    found = front_readings(arena, 1.2345, SHEET._replace(dropout=0.0), 200)
    np.testing.assert_array_equal(found, np.round(1000 * found) / 1000)
    exact = front_readings(arena, 1.2345, IDEAL._replace(resolution_mm=1.0), 1)
    assert exact[0] == 1.235 or exact[0] == 1.234


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        (0, math.inf),
        (6, math.inf),
        (7, math.nan),
        (16, math.nan),
        (18, math.nan),
        (19, math.nan),
        (20, 0.02),
        (5600, 5.6),
    ],
)
def test_codes_read_as_rep_117_has_them(code, expected):
    np.testing.assert_equal(readings.decoded(float(code)), expected)


@pytest.mark.parametrize(
    ("distance", "expected"), [(5.601, math.inf), (5.599, 5.599), (0.021, 0.021), (0.019, -math.inf)]
)
def test_range_limits_are_where_they_are_stated(arena, distance, expected):
    assert front_readings(arena, distance, IDEAL, 1)[0] == pytest.approx(expected, abs=EXACT)


def test_noise_carries_nothing_beyond_what_can_be_reported(arena):
    found = front_readings(arena, 5.55, STILL, 2000)
    beyond = found > MAX_RANGE_M
    assert set(found[beyond]) == {math.inf}
    # 50 mm are 50 / 55.5 = 0.9 standard deviations: 18.4 %
    assert beyond.mean() == pytest.approx(0.184, abs=5 * math.sqrt(0.184 * 0.816 / 2000))


def test_an_empty_world_returns_nothing(arena):
    scene = arena([(0, 0, 0)])
    scan, truth = lasers_of(scene, STILL).read(scene.data, 0, 0.0, for_ranges())
    assert np.all(scan.ranges == math.inf)
    assert np.all(truth.ranges == math.inf)
    assert np.all(truth.owners == NOBODY)


def test_lost_readings_come_as_often_as_stated(arena):
    scene = arena([(0, 0, 0)], [wall_at(1.0)])
    lasers, draws = lasers_of(scene, SHEET._replace(dropout=0.01)), for_ranges(5)
    count = 300
    lost = [np.isnan(lasers.read(scene.data, 0, 0.0, draws)[0].ranges).sum() for _ in range(count)]
    n = count * BEAMS
    assert sum(lost) / n == pytest.approx(0.01, abs=5 * math.sqrt(0.01 * 0.99 / n) + 1 / 65536)  # and one cell


def test_own_body_is_never_seen(arena):
    scene = arena([(0, 0, 0)], mount=(0.0, 0.0, 0.0))
    assert np.all(lasers_of(scene, IDEAL).cast(scene.data, 0)[0] == math.inf)


def test_every_scan_takes_as_many_draws(arena):
    """Whatever is seen, whatever the setting: conditions that share streams stay in step."""
    states = set()
    for walls in ([], [wall_at(1.0)]):
        for setting in (SHEET, HARSH, STILL, SHEET._replace(intensity_mode="half-resolution")):
            scene = arena([(0, 0, 0), (0.6, 0, 0)], walls)
            streams = [np.random.default_rng(seed) for seed in (1, 2)]
            lasers_of(scene, setting).read(
                scene.data, 0, 0.0, range_draws(streams[0], 1), intensity_draws(streams[1], 1)
            )
            states.add(tuple(stream.bit_generator.state["state"]["state"] for stream in streams))
    assert len(states) == 1


@pytest.mark.parametrize("a_beam", [1, 2])
def test_numbers_drawn_ahead_are_those_drawn_scan_by_scan(a_beam):
    ahead, each = (Draws(np.random.default_rng(6), a_beam, n) for n in (AHEAD, 1))
    kept = [ahead.next_scan() for _ in range(2 * AHEAD + 1)]
    for numbers in kept:
        np.testing.assert_array_equal(numbers, each.next_scan())
    assert all(len(numbers) >= a_beam * BEAMS for numbers in kept)


def test_scans_that_are_kept_are_not_written_over(arena):
    scene = arena([(0, 0, 0), (1, 0.3, 0)], [wall_at(2.0)])
    lasers, ranges, light = lasers_of(scene, HARSH), for_ranges(), for_light()
    read = [lasers.read(scene.data, 0, 0.0, ranges, light) for _ in range(2)]
    kept = [[field.copy() for field in (*scan[1:], *truth)] for scan, truth in read]
    scene.put(1, 2.0, -1.0, 0.0)
    for _ in range(2 * AHEAD):
        lasers.read(scene.data, 0, 0.0, ranges, light)
    for (scan, truth), before in zip(read, kept, strict=True):
        for field, was in zip((*scan[1:], *truth), before, strict=True):
            np.testing.assert_array_equal(field, was)


@pytest.mark.parametrize("mode", ["ideal", "strong-code"])
def test_intensities_that_nobody_reads_are_one_array_of_nan_that_cannot_be_written(arena, mode):
    scene = arena([(0, 0, 0), (0.6, 0, 0)])
    lasers = lasers_of(scene, SHEET._replace(intensity_mode=mode))
    for _ in range(2):
        scan, _ = lasers.read(scene.data, 0, 0.0, for_ranges())
        assert scan.intensities is NO_INTENSITIES
    assert np.isnan(NO_INTENSITIES).all()
    with pytest.raises(ValueError, match="read-only"):
        NO_INTENSITIES[0] = 1.0


def test_the_same_seed_gives_the_same_scan_and_reading_intensity_changes_no_range(arena):
    scene = arena([(0, 0, 0), (1, 0.3, 0)], [wall_at(2.0)])
    lasers = lasers_of(scene, HARSH)
    first, _ = lasers.read(scene.data, 0, 0.0, for_ranges(3))
    again, _ = lasers.read(scene.data, 0, 0.0, for_ranges(3), for_light(4))
    np.testing.assert_array_equal(first.ranges, again.ranges)
    assert not np.array_equal(first.ranges, lasers.read(scene.data, 0, 0.0, for_ranges(4))[0].ranges)


def test_readings_follow_qpos_without_lag(arena):
    scene = arena([(0, 0, 0), (2, 0, 0)])
    lasers = lasers_of(scene, IDEAL)
    for x in (1.0, 1.5):
        scene.put(1, x, 0.0, 0.0)
        assert lasers.read(scene.data, 0, 0.0, for_ranges())[0].ranges[FRONT] == pytest.approx(x - 0.25)


# mixed readings


def edge_scans(arena, parameters, poses=400):
    """Scans of a robot 1.5 m off in front of a wall 3 m off, at many bearings."""
    rng = np.random.default_rng(7)
    scene = arena([(0, 0, 0), (0, 0, 0)], [wall_at(3.0)])
    lasers = lasers_of(scene, parameters)
    ranges, light = for_ranges(8), for_light(9)
    for _ in range(poses):
        bearing = rng.uniform(-0.3, 0.3)
        scene.put(1, 0.1 + 1.5 * math.cos(bearing), 1.5 * math.sin(bearing), 0.0)
        yield lasers.read(scene.data, 0, 0.0, ranges, light)


def between(scan, truth):
    """Readings that stand clear of the robot all round (its far side is 1.65 m off) and of the wall."""
    return (scan.ranges > 1.65 + 0.05) & (scan.ranges < 3.0 - 0.05)


def test_an_edge_mixes_as_many_readings_as_the_footprint_covers_beams(arena):
    quiet = IDEAL._replace(footprint_rad=0.010)
    # a footprint of 10 mrad over beams 6.14 mrad apart; two edges; the robot's limb is 1.493 m off
    poses, expected = 400, 2 * 0.010 / (2 * math.pi / 1024)
    changed = [np.sum(difference(scan.ranges, truth.ranges) > 1e-9) for scan, truth in edge_scans(arena, quiet, poses)]
    assert np.mean(changed) == pytest.approx(expected, abs=5 * 0.7 / math.sqrt(poses))  # each edge mixes 1 or 2
    assert {2, 3, 4} >= set(changed)


def test_mixed_readings_lie_between_the_two_surfaces_and_belong_to_nobody(arena):
    quiet = IDEAL._replace(footprint_rad=0.010)
    shares = []
    for scan, truth in edge_scans(arena, quiet):
        mixed = between(scan, truth)
        assert np.all(truth.owners[mixed] == NOBODY)
        shares += list((scan.ranges[mixed] - 1.7) / 1.25)
        on_robot = scan.ranges < 1.5
        assert np.all(truth.owners[on_robot] == 1)
    # the edge falls anywhere, and so does the reading: the shares are uniform but for the wall's slope
    assert np.mean(shares) == pytest.approx(0.5, abs=5 / math.sqrt(12 * len(shares)) + 0.02)


def test_without_a_footprint_there_is_nothing_between(arena):
    assert not any(between(*both).any() for both in edge_scans(arena, IDEAL, 50))
    assert any(between(*both).any() for both in edge_scans(arena, SHEET, 50))


def test_intensities_mix_as_ranges_do(arena):
    quiet = IDEAL._replace(footprint_rad=0.010)
    for scan, truth in edge_scans(arena, quiet, 50):
        for i in np.flatnonzero(between(scan, truth)):
            others = [j for j in (i - 1, i + 1) if abs(truth.ranges[j] - truth.ranges[i]) > 1.0]
            assert len(others) == 1
            share = (scan.ranges[i] - truth.ranges[i]) / (truth.ranges[others[0]] - truth.ranges[i])
            assert 0.0 < share <= 0.5
            wall, robot = sorted((scan.intensities[max(i - 3, 0)], scan.intensities[i + 3]))
            assert wall < scan.intensities[i] < robot


def test_beyond_an_edge_into_the_open_nothing_is_mixed(arena):
    scene = arena([(0, 0, 0), (1.5, 0, 0)])
    scan, truth = lasers_of(scene, IDEAL._replace(footprint_rad=0.01)).read(scene.data, 0, 0.0, for_ranges())
    np.testing.assert_array_equal(scan.ranges, truth.ranges)


# truth


def test_lit_counts_the_beams_across_each_robot(arena):
    scene = arena([(0, 0, 0), (1.1, 0, 0), (0.1, -2.0, 0)], [wall_at(3.0)])
    for setting in (IDEAL, HARSH):
        _, truth = lasers_of(scene, setting).read(scene.data, 0, 0.0, for_ranges())
        for k, distance in ((1, 1.0), (2, 2.0)):
            assert abs(truth.lit[k] - 2 * math.asin(0.15 / distance) / (2 * math.pi / 1024)) <= 1
        assert truth.lit[0] == 0


def test_a_reading_belongs_to_the_member_whose_surface_it_is_near(arena):
    scene = arena([(0, 0, 0), (3.1, 0, 0)], [wall_at(4.0)])
    lasers, draws = lasers_of(scene, HARSH._replace(footprint_rad=0.0)), for_ranges()
    given, lost = 0, 0
    for _ in range(400):
        scan, truth = lasers.read(scene.data, 0, 0.0, draws)
        on_it = (truth.ranges < 3.2) & np.isfinite(scan.ranges)
        near = (
            difference(scan.ranges, truth.ranges) <= 3 * 0.03 * truth.ranges + 0.0005
        )  # and half a millimetre of rounding
        assert np.all(truth.owners[~on_it] == NOBODY)
        assert np.all(near[truth.owners == 1])
        given, lost = given + np.sum(truth.owners == 1), lost + np.sum(on_it & (truth.owners == NOBODY))
    assert lost / (given + lost) == pytest.approx(0.0027, abs=5 * math.sqrt(0.0027 / (given + lost)))


def test_exact_ranges_are_left_out_where_nobody_reads_them(arena):
    scene = arena([(0, 0, 0), (1, 0.3, 0)], [wall_at(2.0)])
    lasers = lasers_of(scene, HARSH)
    scan, truth = lasers.read(scene.data, 0, 0.0, for_ranges(), exact=False)
    full, whole_truth = lasers.read(scene.data, 0, 0.0, for_ranges())
    assert truth.ranges.shape == (0,)
    for left, right in zip((scan.ranges, truth.owners, truth.lit), (full.ranges, *whole_truth[::2]), strict=True):
        np.testing.assert_array_equal(left, right)
