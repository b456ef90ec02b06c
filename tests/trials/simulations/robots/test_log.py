"""What is kept of a trial while it runs takes no more memory the longer the trial is, and comes back whole."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np

from flocking.types import NO_OBSTACLES, Kind, Members, Motion, unknown
from sensing.types import Detection, Scan
from trials.design import plan
from trials.simulations.robots.log import Log

ROBOTS, INPUTS, STEPS = 25, 6, 14_000
MOST_BYTES = 20e6
"""What a log may hold after any time: the rows that wait (up to 4096 of each kind) and a megabyte of each column
(measured: 13 to 16 MB at 8000 and at 14,000 steps). In memory the 14,000 samples and 70,000 updates would be 35 MB as
arrays, five times that as rows."""


def test_a_long_trial_lies_in_files_and_comes_back_whole(tmp_path: Path) -> None:
    log = Log(plan("detection-case-study", settings={"herd.count": ROBOTS}).trials[0], ROBOTS, "all", folder=tmp_path)
    rng = np.random.default_rng(5)
    poses_w, odometry, bumpers = rng.normal(size=(ROBOTS, 3)), rng.normal(size=(ROBOTS, 3)), np.ones((ROBOTS, 2), bool)
    places = rng.normal(size=(INPUTS, 2))
    detection = Detection(Members(places, np.zeros(INPUTS), *unknown(INPUTS)), NO_OBSTACLES, np.empty(0, np.int64))
    selected, owners, states = np.arange(INPUTS) < 4, np.arange(INPUTS), rng.integers(0, 3, ROBOTS)
    scan = Scan(0.0, np.zeros(8), np.arange(8.0), np.arange(8.0))
    tracemalloc.start()
    try:
        for step in range(STEPS):
            log.sample(float(step), poses_w, odometry + step, bumpers)
            for robot in range(0, ROBOTS, 5):
                motion = Motion(Kind.WAY_POINT, float(step), -1.0, 2)
                judgement = owners, states, 60, 2, 1
                log.update(step, robot, poses_w[robot], detection, selected, judgement, motion, (0.2, float(robot)))
            log.scan(float(step), 3, poses_w[3], scan)
        held, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert held < MOST_BYTES

    result = log.result(
        names=tuple("abc"),
        radii=np.ones(ROBOTS),
        rules=(),
        walls_w=np.empty((0, 4)),
        contacts=[],
        outcome="done",
        reason="",
        timing={},
    )
    updates = result.updates
    np.testing.assert_array_equal(result.times, np.arange(STEPS))
    np.testing.assert_array_equal(result.odometry[-1], odometry + STEPS - 1)
    np.testing.assert_array_equal(updates.motions[::5, 0], np.arange(STEPS))
    np.testing.assert_array_equal(updates.commands[:5, 1], np.arange(0, ROBOTS, 5))
    np.testing.assert_array_equal(updates.input_starts, INPUTS * np.arange(5 * STEPS + 1))
    np.testing.assert_array_equal(updates.input_positions[-INPUTS:], places.astype(np.float32))
    np.testing.assert_array_equal(updates.input_selected, np.tile(selected, 5 * STEPS))
    np.testing.assert_array_equal(updates.member_states[STEPS], states)
    assert result.scans is not None
    np.testing.assert_array_equal(result.scans.times, np.arange(STEPS))
    np.testing.assert_array_equal(result.scans.poses_w[-1], poses_w[3])
    assert list(tmp_path.iterdir()) == []
