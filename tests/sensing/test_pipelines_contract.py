"""What every pipeline found by its file must do, whatever it senses."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest

from flocking import found
from flocking.parameters import declared
from flocking.types import Own
from robots import body
from sensing.camera.images import Images
from sensing.camera.lens import Lens, column_angles
from sensing.sonar import RING
from sensing.types import NOBODY, Echoes, Scan, Senses, WorldTruth
from tests.sensing.camera.scenes import model_with_cameras

CREATE = body.load("create")

ANGLES = 2.0 * math.pi / 1024 * (np.arange(682) - 340)
MODEL = CREATE.spec().compile()
LENS = Lens(width_px=128, height_px=40)
SEEING = model_with_cameras()
OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), 0.1, 0, 0)
NAMES = found.modules("sensing.pipelines")


@pytest.fixture(params=sorted(NAMES))
def pipeline(request):
    return importlib.import_module(NAMES[request.param])


def senses_of(rng: np.random.Generator, robots: int = 6) -> Senses:
    """Nonsense of every kind: near and far, codes, bright and dark, robots anywhere."""
    ranges = rng.choice([0.5, 1.0, 2.0, 5.0], 682) + rng.normal(0, 0.02, 682) * rng.integers(0, 2)
    ranges = np.repeat(ranges[::31], 31)[:682] + rng.normal(0, 0.005, 682)
    ranges[rng.random(682) < 0.05] = rng.choice([math.nan, math.inf, -math.inf])
    intensities = np.where(rng.random(682) < 0.9, rng.exponential(20.0, 682), np.nan)
    poses = np.column_stack((rng.uniform(-3, 3, (robots, 2)), rng.uniform(-9, 9, robots)))
    walls = rng.uniform(-3, 3, (4, 4))
    truth = WorldTruth(poses, rng.normal(size=(robots, 2)), np.full(robots, 0.165), int(rng.integers(robots)), walls)
    owners = np.where(np.isfinite(ranges), rng.integers(-1, robots, 682), NOBODY)
    images = Images(float(rng.random()), picture_of(rng), picture_of(rng))
    heard = np.where(rng.random(len(RING)) < 0.7, rng.uniform(0.1, 5.0, len(RING)), math.inf)
    echoes = Echoes(heard, np.array(RING), 0.47)
    return Senses(Scan(0.0, ANGLES, ranges, intensities), truth, owners, images, echoes)


def picture_of(rng: np.random.Generator) -> np.ndarray:
    """Orange boxes and triangles of all sizes, some across the border, on grey with orange specks."""
    picture = rng.integers(100, 140, (LENS.height_px, LENS.width_px, 1), dtype=np.uint8).repeat(3, axis=2)
    for _ in range(rng.integers(0, 5)):
        left, top, width = rng.integers(-10, LENS.width_px), rng.integers(0, 30), rng.integers(1, 40)
        shrinks = rng.integers(0, 2)
        for up in range(rng.integers(1, 20)):
            a, b = max(left + up * shrinks, 0), max(left + width - up * shrinks, 0)
            picture[max(top - up, 0), a:b] = (230, 58, 5)
    picture[rng.random(picture.shape[:2]) < 0.002] = (255, 64, 0)
    return picture


def nothing() -> Senses:
    walls, alone = np.empty((0, 4)), np.zeros((1, 3))
    truth = WorldTruth(alone, np.zeros((1, 2)), np.array([0.165]), 0, walls)
    grey = np.full((LENS.height_px, LENS.width_px, 3), 120, np.uint8)
    return Senses(
        Scan(0.0, ANGLES, np.full(682, math.inf), np.full(682, math.nan)),
        truth,
        np.full(682, NOBODY, dtype=np.int64),
        Images(0.0, grey, grey.copy()),
        Echoes(np.full(len(RING), math.inf), np.array(RING), 0.47),
    )


def only_what_it_reads(senses: Senses, reads: frozenset[str]) -> Senses:
    scan, truth, owners, images, echoes = senses
    if scan is not None and "intensity" not in reads:
        scan = scan._replace(intensities=np.full(682, np.nan))
    return Senses(
        scan if "scan" in reads else None,
        truth if "truth" in reads else None,
        owners if "owners" in reads else None,
        images if "images" in reads else None,
        echoes if "echoes" in reads else None,
    )


def begin(pipeline):
    if "images" in pipeline.READS:
        return pipeline.start(pipeline.Parameters(), SEEING, 0.3, np.tile(column_angles(LENS), (2, 1)))
    return pipeline.start(pipeline.Parameters(), MODEL, CREATE.mount("laser").height_m, ANGLES)


def arrays(detection) -> list[np.ndarray]:
    return [*detection.members, detection.obstacles.points, detection.beams]


def test_the_published_three_and_the_perfect_one_are_found():
    assert {"member-based", "member-extrapolated", "sensor-based", "perfect"} <= set(NAMES)


def test_it_declares_what_it_reads_and_its_parameters(pipeline):
    assert pipeline.__doc__
    assert frozenset() < pipeline.READS <= {"scan", "intensity", "truth", "owners", "images", "echoes"}
    assert "scan" in pipeline.READS or "intensity" not in pipeline.READS
    for parameter in declared(pipeline.Parameters).values():
        assert parameter.about.source


def test_outputs_are_finite_consistent_and_owned_by_beams(pipeline):
    rng = np.random.default_rng(21)
    state = begin(pipeline)
    for _ in range(60):
        senses = only_what_it_reads(senses_of(rng), pipeline.READS)
        detection, state = pipeline.detect(senses, OWN, state)
        members, obstacles, beams = detection
        count = len(members.positions)
        assert members.positions.shape == members.velocities.shape == (count, 2)
        assert members.bearings.shape == members.headings.shape == members.ids.shape == (count,)
        assert members.ids.dtype == beams.dtype == np.int64
        assert np.all(np.isfinite(members.bearings))
        assert np.all(np.isfinite(members.positions))
        assert np.all(np.abs(members.bearings) <= math.pi)
        expected = np.arctan2(members.positions[:, 1], members.positions[:, 0])
        np.testing.assert_allclose(members.bearings, expected, atol=1e-12)
        assert obstacles.points.shape == (len(obstacles.points), 2)
        assert np.all(np.isfinite(obstacles.points))
        assert all(a.flags.c_contiguous for a in arrays(detection))
        if "scan" in pipeline.READS:
            assert beams.shape == (682,)
            assert set(beams.tolist()) - {NOBODY} == set(range(count))
            assert np.all(np.isfinite(senses.scan.ranges[beams >= 0]))
        elif "images" in pipeline.READS:
            assert beams.shape == (2 * LENS.width_px,)
            assert set(beams.tolist()) - {NOBODY} == set(range(count))
            assert np.all(members.ids == -1)
        else:
            assert beams.shape == (0,)
            assert np.all(members.ids >= 0)


def test_nothing_there_gives_an_empty_detection(pipeline):
    detection, _ = pipeline.detect(only_what_it_reads(nothing(), pipeline.READS), OWN, begin(pipeline))
    assert len(detection.members.positions) == 0
    assert len(detection.obstacles.points) == 0


def test_the_same_senses_give_the_same_detection(pipeline):
    senses = [only_what_it_reads(senses_of(np.random.default_rng(s)), pipeline.READS) for s in range(10)]
    runs = []
    for _ in range(2):
        state, found_now = begin(pipeline), []
        for sensed in senses:
            detection, state = pipeline.detect(sensed, OWN, state)
            found_now.append(arrays(detection))
        runs.append(found_now)
    for first, second in zip(*runs, strict=True):
        for a, b in zip(first, second, strict=True):
            np.testing.assert_array_equal(a, b)


def test_what_was_given_onward_is_not_written_over_and_senses_are_not_changed(pipeline):
    rng = np.random.default_rng(22)
    first, second = (only_what_it_reads(senses_of(rng), pipeline.READS) for _ in range(2))
    before = [np.copy(a) for part in first if part is not None for a in part if isinstance(a, np.ndarray)]
    detection, state = pipeline.detect(first, OWN, begin(pipeline))
    kept = [a.copy() for a in arrays(detection)]
    pipeline.detect(second, OWN, state)
    for a, b in zip(arrays(detection), kept, strict=True):
        np.testing.assert_array_equal(a, b)
    after = [a for part in first if part is not None for a in part if isinstance(a, np.ndarray)]
    for a, b in zip(after, before, strict=True):
        np.testing.assert_array_equal(a, b)
