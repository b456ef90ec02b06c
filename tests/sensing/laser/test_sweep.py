"""The sweep: each beam is read at its own instant, while the robot and the world move."""

import numpy as np
import pytest

from sensing.laser.hokuyo import ANGLES
from sensing.laser.reference import difference
from sensing.laser.sweep import BEAM_S, SWEEP_S, TURN_S
from tests.sensing.laser.lasers import (
    BEAMS,
    EXACT,
    FRONT,
    IDEAL,
    SHEET,
    for_light,
    for_ranges,
    lasers_of,
    wall_at,
)


def test_the_sweep_takes_two_thirds_of_the_turn():
    assert abs(TURN_S - 0.1) < 1e-12
    assert abs(SWEEP_S - 0.0665) < 1e-5  # round-off of the published figure


def test_a_sweep_of_a_world_at_rest_is_an_instantaneous_scan(arena):
    scene = arena([(0, 0, 0.3), (1, 0.5, 0), (0.1, 1.5, 0)], [wall_at(2.0)])
    lasers = lasers_of(scene, SHEET._replace(sweep=True), SHEET, SHEET)
    for _ in range(10):
        lasers.remember(scene.data)
        scene.data.time += 0.01
    still = lasers_of(scene, SHEET)
    slow, slow_truth = lasers.read(scene.data, 0, 0.0, for_ranges(1), for_light(2))
    fast, fast_truth = still.read(scene.data, 0, 0.0, for_ranges(1), for_light(2))
    np.testing.assert_allclose(slow_truth.ranges, fast_truth.ranges, atol=EXACT)
    np.testing.assert_array_equal(slow.ranges, fast.ranges)
    np.testing.assert_allclose(slow.intensities, fast.intensities, rtol=1e-9)
    assert lasers.needs_history
    assert not still.needs_history


def test_each_beam_of_a_sweep_is_read_at_its_own_instant(arena):
    """Against instantaneous scans at the pose of each beam's instant, laser and neighbour both moving and turning."""
    scene = arena([(0, 0, 0), (1, 0.5, 0)], [wall_at(2.0), (0, 1.5, 0, 3, 0.1)])

    def go(time):
        scene.data.time = time
        scene.put(0, 0.4 * time, -0.1 * time, 2.0 * time)
        scene.put(1, 1.0 - 0.5 * time, 0.5 + 0.2 * time, 0.0)

    lasers, still = lasers_of(scene, IDEAL._replace(sweep=True)), lasers_of(scene, IDEAL)
    end = 0.2
    for step in range(21):
        go(0.01 * step)
        lasers.remember(scene.data)
    _, truth = lasers.read(scene.data, 0, end, for_ranges())
    expected = np.empty(BEAMS)
    for i in range(BEAMS):
        go(end - (BEAMS - 1 - i) * BEAM_S)
        expected[i] = still.cast(scene.data, 0)[0][i]
    differences = difference(truth.ranges, expected)
    # headings between steps: the chord of 0.02 rad stands off its arc by 5e-7 rad; a few beams at edges flip
    assert np.sum(differences > 1e-4) <= 3
    go(end)
    assert np.median(difference(still.cast(scene.data, 0)[0], truth.ranges)) > 0.01  # the first beams are 66 ms old


def test_driving_at_a_wall_shortens_a_sweep_by_the_way_driven(arena):
    scene = arena([(0, 0, 0)], [wall_at(2.0)])
    lasers = lasers_of(scene, IDEAL._replace(sweep=True))
    for step in range(21):
        scene.data.time = 0.01 * step
        scene.put(0, 0.5 * (scene.data.time - 0.2), 0.0, 0.0)
        lasers.remember(scene.data)
    scan, _ = lasers.read(scene.data, 0, 0.2, for_ranges())
    ages = (BEAMS - 1 - np.arange(BEAMS)) * BEAM_S
    ahead = abs(ANGLES) < 1.0
    np.testing.assert_allclose(scan.ranges[ahead], ((2.0 + 0.5 * ages) / np.cos(ANGLES))[ahead], atol=EXACT)


def test_a_world_set_back_in_time_forgets(arena):
    scene = arena([(0, 0, 0)], [wall_at(2.0)])
    lasers = lasers_of(scene, IDEAL._replace(sweep=True))
    for step in range(10):
        scene.data.time = 1.0 + 0.01 * step
        scene.put(0, -0.1 * step, 0.0, 0.0)
        lasers.remember(scene.data)
    scene.data.time = 0.0
    scene.put(0, 0.0, 0.0, 0.0)
    scan, _ = lasers.read(scene.data, 0, 0.0, for_ranges())
    assert scan.ranges[FRONT] == pytest.approx(2.0, abs=EXACT)
