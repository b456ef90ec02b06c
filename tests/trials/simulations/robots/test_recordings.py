"""Recordings are read back from their files and compared with the results from which they were written."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

from flocking.measures import formation
from flocking.types import Kind
from tests.trials.synthetic import synthetic_result
from trials.simulations.recording_file import recording_id
from trials.simulations.robots.recorded_senses import DENSE_INPUTS, INTENSITY_PALETTE, SPARSE_INPUTS
from trials.simulations.robots.recordings import PLOT_SAMPLES, rule_shares, write
from trials.types import Contacts, TrialResult

F32 = 4e-6
"""m: coordinates below 32 m are kept in single precision (spacing 2e-6), after a rotation in it."""

Row = tuple[float, Any]


class Recording:
    """One file read back: rows of (time in s, values) by entity and component."""

    def __init__(self, path: Path) -> None:
        reader = RrdReader(path)
        self.recordings, self.blueprints = reader.recordings(), reader.blueprints()
        self.batches: dict[str, list[Any]] = {}
        for chunk in reader.stream():
            self.batches.setdefault(chunk.entity_path, []).append(chunk.to_record_batch())
        self.views = {
            str(value)
            for chunk in (reader.stream(store=self.blueprints[0]) if self.blueprints else [])
            for name in chunk.to_record_batch().schema.names
            if name.endswith("class_identifier")
            for value in np.ravel(chunk.to_record_batch().column(name).to_pylist())
        }

    def rows(self, entity: str, component: str) -> list[Row]:
        """Rows in time order; static ones at nan."""
        found = []
        for batch in self.batches.get(entity, []):
            if component not in batch.schema.names:
                continue
            values = batch.column(component)
            times = np.full(len(values), np.nan)
            if "time" in batch.schema.names:
                times = batch.column("time").to_numpy(zero_copy_only=False).astype("int64") * 1e-9
            found += [(float(t), np.array(v.as_py())) for t, v in zip(times, values, strict=True)]
        return sorted(found, key=lambda row: row[0])


@pytest.fixture(scope="module")
def result() -> TrialResult:
    return synthetic_result(seconds=6.0)


@pytest.fixture
def written(tmp_path: Path) -> Callable[[TrialResult], Recording]:
    def read(result: TrialResult) -> Recording:
        write(result, tmp_path / "0001.rrd")
        return Recording(tmp_path / "0001.rrd")

    return read


def in_world(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Body to world by complex numbers, which the code does not use."""
    z = (points[:, 0] + 1j * points[:, 1]) * np.exp(1j * pose[2]) + pose[0] + 1j * pose[1]
    return np.stack([z.real, z.imag], axis=1)


def test_poses_and_their_times_come_back(result: TrialResult, written: Callable[..., Recording]) -> None:
    recording = written(result)
    for k, name in enumerate(result.robot_names):
        where = recording.rows(f"/world/robots/{name}", "Transform3D:translation")
        turned = recording.rows(f"/world/robots/{name}", "Transform3D:quaternion")
        # to the nearest nanosecond
        np.testing.assert_allclose([t for t, _ in where], result.times, atol=0.6e-9, rtol=0)
        np.testing.assert_allclose(np.array([v[0, :2] for _, v in where]), result.poses_w[:, k, :2], atol=F32, rtol=0)
        quaternions = np.array([v[0] for _, v in turned])
        np.testing.assert_array_equal(quaternions[:, :2], 0.0)
        headings = 2.0 * np.arctan2(quaternions[:, 2], quaternions[:, 3])
        # single precision of sine and cosine: 6e-8, doubled by the half angle and once more to be safe
        assert np.abs(np.angle(np.exp(1j * (headings - result.poses_w[:, k, 2])))).max() < 3e-7


def test_scan_points_are_the_finite_returns_in_the_world(
    result: TrialResult, written: Callable[..., Recording]
) -> None:
    recording, scans = written(result), result.scans
    assert scans is not None
    assert not np.isfinite(scans.ranges).all(), "codes must be among the readings for this test to mean anything"
    beams = np.stack([np.cos(scans.angles), np.sin(scans.angles)], axis=1)
    for k, name in enumerate(result.robot_names):
        rows = recording.rows(f"/world/scans/{name}", "Points2D:positions")
        rows = [row for row in rows if np.isfinite(row[0])]
        mine = np.flatnonzero(scans.robots == k)
        np.testing.assert_allclose([t for t, _ in rows], scans.times[mine], atol=0.6e-9, rtol=0)
        for s, (_, points) in zip(mine, rows, strict=True):
            hit = np.isfinite(scans.ranges[s])
            expected = in_world(scans.ranges[s, hit, None] * beams[hit], scans.poses_w[s])
            assert points.shape == expected.shape
            # The order of the beams is not kept: each point is among those expected and the other way round.
            gaps = np.abs((points[:, 0] + 1j * points[:, 1])[:, None] - (expected[:, 0] + 1j * expected[:, 1]))
            assert gaps.min(axis=0).max() < F32
            assert gaps.min(axis=1).max() < F32


def test_brighter_returns_have_other_colours_than_dim_ones_and_unknown_ones_are_grey(
    result: TrialResult, written: Callable[..., Recording]
) -> None:
    assert result.scans is not None
    known = written(result)
    name = f"/world/scans/{result.robot_names[0]}"
    colours = np.concatenate([v for _, v in known.rows(name, "Points2D:colors")])
    assert set(colours) <= set(INTENSITY_PALETTE[:-1])
    assert len(set(colours)) > 3
    dark = dataclasses.replace(result.scans, intensities=np.full_like(result.scans.intensities, np.nan))
    colours = np.concatenate(
        [v for _, v in written(dataclasses.replace(result, scans=dark)).rows(name, "Points2D:colors")]
    )
    assert set(colours) == {INTENSITY_PALETTE[-1]}
    # brightness grows with the level, so that bright looks bright
    red, green, blue = ((INTENSITY_PALETTE[:-1] >> shift & 0xFF).astype(float) for shift in (24, 16, 8))
    assert (np.diff(0.2126 * red + 0.7152 * green + 0.0722 * blue) > 0).all()


def test_inputs_and_way_points_stand_in_the_world(written: Callable[..., Recording]) -> None:
    result = synthetic_result(seconds=6.0, pipeline="member-based")
    recording, updates = written(result), result.updates
    for k, name in enumerate(result.robot_names):
        mine = np.flatnonzero(updates.robots == k)
        rows = [r for r in recording.rows(f"/world/members/{name}", "Points2D:positions") if np.isfinite(r[0])]
        np.testing.assert_allclose([t for t, _ in rows], updates.times[mine], atol=0.6e-9, rtol=0)
        for u, (_, points) in zip(mine, rows, strict=True):
            inputs = updates.input_positions[updates.input_starts[u] : updates.input_starts[u + 1]]
            expected = in_world(inputs, updates.poses_w[u])
            np.testing.assert_allclose(points.reshape(-1, 2), expected, atol=F32, rtol=0)
        origins = recording.rows(f"/world/way_points/{name}", "Arrows2D:origins")
        vectors = recording.rows(f"/world/way_points/{name}", "Arrows2D:vectors")
        assert len(origins) == len(mine)
        for u, (_, origin), (_, vector) in zip(mine, origins, vectors, strict=True):
            if updates.kinds[u] != Kind.WAY_POINT:
                assert origin.size == 0
                continue
            np.testing.assert_allclose(origin[0], updates.poses_w[u, :2], atol=F32, rtol=0)
            expected = in_world(updates.motions[u : u + 1], updates.poses_w[u])[0]
            np.testing.assert_allclose(origin[0] + vector[0], expected, atol=2 * F32, rtol=0)


def test_dense_inputs_are_kept_at_the_kept_scans_and_thinned(written: Callable[..., Recording]) -> None:
    result = synthetic_result(seconds=3.0, pipeline="sensor-based")
    updates = result.updates
    assert len(updates.input_positions) > DENSE_INPUTS * len(updates.times)
    assert result.scans is not None
    recording = written(result)
    everything = written(synthetic_result(seconds=3.0, pipeline="sensor-based", scans="all"))
    for k, name in enumerate(result.robot_names):
        rows = [r for r in recording.rows(f"/world/members/{name}", "Points2D:positions") if np.isfinite(r[0])]
        times = result.scans.times[result.scans.robots == k]
        np.testing.assert_allclose([t for t, _ in rows], times, atol=0.6e-9, rtol=0)
        assert all(len(points) <= SPARSE_INPUTS for _, points in rows)
    rows = everything.rows("/world/members/herd-1", "Points2D:positions")
    assert sum(np.isfinite(t) for t, _ in rows) == (updates.robots == 0).sum()


def test_rules_are_states_and_their_shares_sum_to_one(result: TrialResult, written: Callable[..., Recording]) -> None:
    recording, updates = written(result), result.updates
    for k, name in enumerate(result.robot_names):
        rows = recording.rows(f"/rules/{name}", "StateChange:state")
        mine = np.flatnonzero(updates.robots == k)
        spoke = np.array(result.rules[k])[updates.rules[mine]]
        # The state in force at each update is that of the last row at or before it.
        at = np.searchsorted([t for t, _ in rows], updates.times[mine] + 1e-9, side="right") - 1
        assert [str(rows[i][1][0]) for i in at] == spoke.tolist()
    shares = rule_shares(result)
    assert set(shares) == set(result.rules[0])
    # sums of at most 60 shares of equal denominators
    np.testing.assert_allclose(sum(share for _, share in shares.values()), 1.0, atol=1e-12)
    overall = np.mean([result.rules[0][rule] == "snn" for rule in updates.rules])
    # every full second holds the same number of updates, so the mean of the shares is the share
    assert shares["snn"][1].mean() == pytest.approx(overall, abs=1e-12)


def test_measures_are_those_of_the_measures_module(result: TrialResult, written: Callable[..., Recording]) -> None:
    recording = written(result)
    rows = recording.rows("/measures/polarization", "Scalars:scalars")
    np.testing.assert_allclose([t for t, _ in rows], result.times[::PLOT_SAMPLES], atol=0.6e-9, rtol=0)
    expected = formation.polarization(result.poses_w[::PLOT_SAMPLES, :, 2])
    np.testing.assert_array_equal([v[0] for _, v in rows], expected)
    assert {f"/measures/{name}" for name in ("mmd", "groups", "group_speed", "straightness")} <= set(recording.batches)


def test_contacts_and_bumpers_come_back(result: TrialResult, written: Callable[..., Recording]) -> None:
    recording, contacts = written(result), result.contacts
    assert len(contacts.times) > 1
    rows = [r for r in recording.rows("/world/contacts", "Points2D:positions") if np.isfinite(r[0])]
    np.testing.assert_allclose([t for t, _ in rows], contacts.times, atol=0.6e-9, rtol=0)
    np.testing.assert_allclose(np.array([v[0] for _, v in rows]), contacts.points_w, atol=F32, rtol=0)
    words = [str(v[0]) for _, v in recording.rows("/events", "TextLog:text")]
    assert any(word.endswith("touches a wall") for word in words)
    for k, name in enumerate(result.robot_names):
        rows = recording.rows(f"/bumpers/{name}", "StateChange:state")
        at = np.searchsorted([t for t, _ in rows], result.times + 1e-9, side="right") - 1
        told = [str(rows[i][1][0]) for i in at]
        left, right = (np.array([side in state for state in told]) for side in ("left", "right"))
        np.testing.assert_array_equal(np.stack([left, right], axis=1), result.bumpers[:, k])


def test_walls_that_rise_and_vanish_come_back(result: TrialResult, written: Callable[..., Recording]) -> None:
    one, other, third = [0.0, 0.0, 1.0, 0.0], [2.0, 0.0, 2.0, 1.0], [3.0, 3.0, 4.0, 4.0]
    table = np.array([[0.0, 0.5, *one], [0.0, np.nan, *other], [0.5, np.nan, *third]])
    rows = written(dataclasses.replace(result, tables={"standing": table})).rows(
        "/world/standing", "LineStrips2D:strips"
    )
    rows = [(time, strips) for time, strips in rows if np.isfinite(time)]
    assert [time for time, _ in rows] == [0.0, 0.5]
    np.testing.assert_allclose(np.array(rows[0][1]).reshape(-1, 4), [one, other])
    np.testing.assert_allclose(np.array(rows[1][1]).reshape(-1, 4), [other, third])


def test_the_file_brings_its_screen(result: TrialResult, written: Callable[..., Recording]) -> None:
    recording = written(result)
    assert len(recording.blueprints) == 1
    assert {"2D", "TimeSeries", "StateTimeline", "TextLog", "TextDocument"} <= recording.views
    assert [store.recording_id for store in recording.recordings] == [recording_id(result.trial)]
    about = str(recording.rows("/about", "TextDocument:text")[0][1][0])
    assert "herd.law.exclusion_m" in about
    walls = recording.rows("/world/walls", "LineStrips2D:strips")[0][1]
    np.testing.assert_allclose(walls.reshape(-1, 4), result.walls_w, atol=4e-6)  # single precision below 128 m


def test_one_trial_has_one_id_and_others_have_others(result: TrialResult) -> None:
    ids = [
        recording_id(trial)
        for trial in (
            result.trial,
            dataclasses.replace(result.trial),
            dataclasses.replace(result.trial, seed=2),
            dataclasses.replace(result.trial, conditions={}),
        )
    ]
    assert ids[0] == ids[1]
    assert len(set(ids)) == 3


@pytest.mark.parametrize("pipeline", ["member-based", "sensor-based"])
def test_a_minute_of_six_robots_is_small(tmp_path: Path, pipeline: str) -> None:
    path = tmp_path / "some.rrd"
    write(synthetic_result(pipeline=pipeline), path)
    assert path.stat().st_size < 5e6


def test_a_minute_of_six_robots_with_every_scan_fits(tmp_path: Path) -> None:
    write(synthetic_result(scans="all"), tmp_path / "all.rrd")
    assert (tmp_path / "all.rrd").stat().st_size < 30e6


@pytest.mark.parametrize("scans", ["none", "some"])
@pytest.mark.parametrize("seconds", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("robots", [1, 6])
def test_short_and_failed_trials_are_recorded(
    written: Callable[..., Recording], scans: str, seconds: float, robots: int
) -> None:
    result = synthetic_result(seconds=seconds, scans=scans, robots=robots, outcome="failed")
    recording = written(result)
    rows = recording.rows("/world/robots/herd-1", "Transform3D:translation")
    assert len(rows) == len(result.times)
    assert "diverged" in str(recording.rows("/about", "TextDocument:text")[0][1][0])
    assert ("/world/scans/herd-1" in recording.batches) == (scans == "some" and seconds > 0)


def test_a_trial_without_contacts_walls_inputs_and_samples_is_recorded(written: Callable[..., Recording]) -> None:
    result = synthetic_result(seconds=1.0, scans="none")
    none = np.empty(0)
    bare = dataclasses.replace(
        result,
        walls_w=np.empty((0, 4)),
        contacts=Contacts(none, none.astype(np.int64), none.astype(np.int64), np.empty((0, 2))),
        updates=dataclasses.replace(
            result.updates,
            input_starts=np.zeros_like(result.updates.input_starts),
            input_positions=np.empty((0, 2), dtype=np.float32),
            input_owners=np.empty(0, dtype=np.int16),
        ),
    )
    assert "/world/contacts" not in written(bare).batches
    empty = dataclasses.replace(
        bare, times=result.times[:0], poses_w=result.poses_w[:0], bumpers=result.bumpers[:0], outcome="failed"
    )
    assert len(written(empty).blueprints) == 1


def test_samples_with_nan_are_left_out(result: TrialResult, written: Callable[..., Recording]) -> None:
    poses = result.poses_w.copy()
    poses[-1, 0, 0] = np.nan
    rows = written(dataclasses.replace(result, poses_w=poses)).rows("/world/robots/herd-1", "Transform3D:translation")
    assert len(rows) == len(result.times) - 1


def test_a_file_that_cannot_be_written_is_an_os_error(result: TrialResult, tmp_path: Path) -> None:
    with pytest.raises(OSError, match="cannot write"):
        write(result, tmp_path / "missing" / "0001.rrd")
