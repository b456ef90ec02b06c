"""The loop: the same trial gives the same result, whatever is recorded and in whatever order robots stand."""

from __future__ import annotations

import dataclasses
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking import found
from flocking.errors import InputError
from flocking.types import Kind
from trials.design import plan
from trials.simulations.robots.loop import run_trial
from trials.streams import Purpose, stream
from trials.types import Group, Trial, TrialResult, Value, with_setup

PIPELINES = tuple(sorted(found.modules("sensing.pipelines")))


def trial(**changes: Value) -> Trial:
    base = plan("detection-case-study", repeats=1).trials[1]
    world = {"world": str(changes.pop("world"))} if "world" in changes else {}
    return with_setup(dataclasses.replace(base, **world), {"duration_s": 3.0, **changes})


def herd(base: Trial, **changes: Value) -> Trial:
    own = {field.name for field in dataclasses.fields(Group)}
    group = with_setup(base.groups[0], {key: value for key, value in changes.items() if key not in own})
    named = {key: value for key, value in changes.items() if key in own}
    return dataclasses.replace(base, groups=(dataclasses.replace(group, **named),))  # type: ignore[arg-type]


def seeing(pipeline: str, **changes: Value) -> Trial:
    """The herd with that detection, on a body that has what it reads."""
    eyes: dict[str, Value] = {"body": "create-with-cameras", "cameras.width_px": 160, "cameras.height_px": 60}
    has_eyes = reads_images(pipeline)
    return herd(trial(duration_s=seconds_of(pipeline)), pipeline=pipeline, **(eyes if has_eyes else {}), **changes)


def reads_images(pipeline: str) -> bool:
    return "images" in found.load("sensing.pipelines", pipeline, "pipeline").READS


def seconds_of(pipeline: str) -> float:
    """How long a herd runs here: images take long."""
    return 1.0 if reads_images(pipeline) else 3.0


@cache
def result(pipeline: str) -> TrialResult:
    return run_trial(seeing(pipeline))


def assert_same(first: TrialResult, second: TrialResult) -> None:
    assert_array_equal(first.poses_w, second.poses_w)
    assert_array_equal(first.odometry, second.odometry)
    for one, other in zip(dataclasses.astuple(first.updates), dataclasses.astuple(second.updates), strict=True):
        assert_array_equal(one, other)
    assert repr(first.measures) == repr(second.measures)


@pytest.mark.parametrize("pipeline", PIPELINES)
class TestEveryPipeline:
    def test_runs_and_measures(self, pipeline: str) -> None:
        done = result(pipeline)
        assert (done.outcome, done.reason) == ("done", "")
        assert done.times[0] == 0.0
        seconds = seconds_of(pipeline)
        assert done.times[-1] == pytest.approx(seconds)
        assert done.poses_w.shape == (round(10 * seconds) + 1, 6, 3)
        assert np.isfinite(done.poses_w).all()
        assert done.measures["distance_travelled"] >= 0.0

    def test_updates_come_at_the_robots_own_clocks(self, pipeline: str) -> None:
        updates = result(pipeline).updates
        assert np.all(np.diff(updates.times) >= 0.0)
        phases = set()
        for robot in range(6):
            times = updates.times[updates.robots == robot]
            # 10 Hz; the phase is a whole number of physics steps
            np.testing.assert_allclose(np.diff(times), 0.1, atol=1e-9)
            phases.add(round(times[0] * 100))
        assert len(phases) > 1

    def test_the_same_trial_gives_the_same_result_recorded_or_not(self, pipeline: str) -> None:
        again = run_trial(seeing(pipeline), scans="all")
        assert_same(result(pipeline), again)
        kept = again.pictures if reads_images(pipeline) else again.scans
        assert kept is not None
        assert len(kept.times) == len(again.updates.times)

    def test_inputs_belong_to_updates(self, pipeline: str) -> None:
        updates = result(pipeline).updates
        assert updates.input_starts[-1] == len(updates.input_positions) == len(updates.input_owners)
        assert updates.input_owners.max() < 6
        counts = np.diff(updates.input_starts)
        owners = np.repeat(updates.robots, counts)
        assert not np.any(updates.input_owners == owners), "a robot saw itself"


@pytest.mark.parametrize("pipeline", [name for name in PIPELINES if not reads_images(name)])
@pytest.mark.parametrize("mode", ["half-resolution", "strong-code"])
def test_a_recording_changes_nothing_in_any_mode_of_intensity(pipeline: str, mode: str) -> None:
    moded = with_setup(seeing(pipeline, **{"sensors.intensity_mode": mode}), {"duration_s": 1.0})
    assert_same(run_trial(moded), run_trial(moded, scans="all"))


@pytest.mark.parametrize("pipeline", ["perfect-members", "perfect-readings"])
def test_perfect_classification_errs_neither_way(pipeline: str) -> None:
    done = run_trial(herd(trial(), pipeline=pipeline, sensors="ideal"))
    assert done.updates.input_owners.min() >= 0
    assert not np.any(done.updates.beams_made_up)
    assert done.measures["fn_share"] == 0.0


class TestPairs:
    def test_conditions_of_a_repeat_share_start_and_phase(self) -> None:
        firsts = [result(pipeline) for pipeline in PIPELINES]
        for other in firsts[1:]:
            assert_array_equal(other.poses_w[0], firsts[0].poses_w[0])
            assert_array_equal(other.updates.times[:6], firsts[0].updates.times[:6])

    def test_repeats_differ(self) -> None:
        second = run_trial(dataclasses.replace(trial(), repeat=2))
        assert not np.array_equal(second.poses_w[0], result("member-based").poses_w[0])

    def test_streams_of_purposes_and_members_differ(self) -> None:
        keys = [(1, 1, g, m, p) for g in range(2) for m in range(3) for p in Purpose]
        draws = {stream(*key).random() for key in keys}
        assert len(draws) == len(keys)


class TestClock:
    def test_together_means_all_at_once(self) -> None:
        done = run_trial(herd(trial(duration_s=1.0), phase="together"))
        assert len(set(done.updates.times.round(6))) == len(done.updates.times) / 6

    @pytest.mark.parametrize("rate_hz", [5.0, 20.0])
    def test_rate_sets_the_number_of_updates(self, rate_hz: float) -> None:
        done = run_trial(herd(trial(duration_s=2.0), rate_hz=rate_hz))
        # by its phase, a robot may have one update less
        assert abs(len(done.updates.times) - 6 * 2.0 * rate_hz) <= 6

    def test_a_longer_latency_moves_the_robots_later(self) -> None:
        def first_motion(latency_s: float) -> float:
            done = run_trial(herd(trial(duration_s=1.5), latency_s=latency_s, pipeline="perfect", start_moving=False))
            moved = np.abs(done.poses_w[:, :, :2] - done.poses_w[0, :, :2]).max(axis=(1, 2)) > 5e-3
            return float(done.times[moved][0])

        assert first_motion(0.55) - first_motion(0.05) == pytest.approx(0.5, abs=0.11)  # sampled at 0.1 s


class TestRefusals:
    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"rate_hz": 7.0}, "multiple of the physics time step"),
            ({"latency_s": 0.005}, "multiple of the physics time step"),
            ({"pipeline": "member-bsed"}, "member-based"),
            ({"law": "snnn"}, "snn"),
            ({"law_parameters": {"repulsion_m": -1.0}}, "repulsion_m"),
            ({"sensors": "datashet"}, "datasheet"),
            ({"body": "creates"}, "create"),
        ],
    )
    def test_what_does_not_exist_or_fit(self, change: dict[str, object], words: str) -> None:
        with pytest.raises(InputError, match=words):
            run_trial(herd(trial(), **change))

    def test_a_corridor_that_robots_could_leave_behind(self) -> None:
        with pytest.raises(InputError, match=r"world\.length_m"):
            run_trial(trial(duration_s=600.0))


NAN_LAW = """
import math
from typing import NamedTuple
from flocking.types import Kind, Motion

class Parameters(NamedTuple):
    pass

MEMORY = 1

def law(own, members, sets, obstacles, parameters, memory, u):
    memory[0] += 1.0
    x = math.nan if own.id == 3 and memory[0] > 5.0 else 1.0
    return Motion(Kind.WAY_POINT, x, 0.0, 0)
"""


class TestFailures:
    def test_a_law_that_returns_nan_fails_the_trial_and_keeps_what_was_measured(self, tmp_path: Path) -> None:
        path = tmp_path / "nan_law.py"
        path.write_text(NAN_LAW)
        done = run_trial(herd(trial(), law=str(path), law_parameters={}))
        assert done.outcome == "failed"
        assert "nan_law.py" in done.reason
        assert "herd-4" in done.reason
        assert 0.4 < done.times[-1] < 1.0
        assert len(done.updates.times) > 20

    def test_physics_that_diverges_fails_the_trial(self, monkeypatch: pytest.MonkeyPatch) -> None:
        from trials.simulations.robots import herd as herds

        build = herds.build

        def broken(*args: object) -> object:
            world = build(*args)  # type: ignore[arg-type]
            world.observers.append(lambda data: data.qvel.__setitem__(0, 1e12) if data.time > 0.5 else None)
            return world

        monkeypatch.setattr(herds, "build", broken)
        done = run_trial(trial())
        assert done.outcome == "failed"
        assert "diverged" in done.reason


class TestHold:
    @pytest.mark.parametrize(("start_moving", "speed"), [(True, 0.25), (False, 0.0)])
    def test_a_robot_that_sees_nobody_keeps_its_last_command(self, start_moving: bool, speed: float) -> None:
        lonely = herd(trial(duration_s=2.0, world="open-floor"), count=1, start_moving=start_moving)
        done = run_trial(lonely)
        assert set(done.updates.kinds.tolist()) == {int(Kind.HOLD)}
        assert np.all(done.updates.commands == (speed, 0.0))
        # the wheels' ramp costs a fraction of a second
        assert speed * 1.5 <= done.poses_w[-1, 0, 0] - done.poses_w[0, 0, 0] + 0.05 <= speed * 2.0 + 0.06
