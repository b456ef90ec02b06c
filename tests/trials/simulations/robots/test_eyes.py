"""Trials of robots that see by cameras: what they find, what is rendered, what is refused, what a recording holds."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr

from flocking.errors import InputError
from robots.eyes import CONE_RADIUS
from sensing.camera import opengl
from sensing.camera.rendering import Cameras
from sensing.types import ScanTruth
from trials import simulations
from trials.simulations.robots import recorded_cameras
from trials.simulations.robots.fields import group, trial
from trials.simulations.robots.robot import Robot
from trials.simulations.robots.seen import exact_inputs, lenses_of
from trials.studies.monocular import follow_1, monocular_flock
from trials.studies.monocular.design import LAW, Leg, arc_to, driven, from_the_lens, seconds
from trials.types import Trial, Value, with_setup

SMALL: dict[str, Value] = {"cameras.width_px": 160, "cameras.height_px": 60}
"""Images that are quickly rendered."""
A_PIXEL = 0.2
"""Relative error of a distance: in images of 160 columns a cone at 1.2 m is 4 to 5 of them wide."""


@pytest.fixture(scope="module", autouse=True)
def rendering() -> None:
    """All of these need OpenGL, but for what is refused before."""
    try:
        opengl.library()
    except InputError as error:
        pytest.skip(str(error))


def pair(pipeline: str = "cone-member-based", seconds_: float = 1.0, **given: Value) -> Trial:
    """Two Creates with eyes, one ahead of the other."""
    herd = group("moshtagh-kirchner", 2, pipeline=pipeline, body="create-with-cameras", law_parameters=LAW)
    setup: dict[str, Value] = {**SMALL, "phase": "together", "latency_s": 0.0, **given}
    return trial(
        "eyes", 1, [with_setup(herd, setup)], world="open-floor", formation="single-file",
        formation_parameters={"spacing_m": 1.2, "jitter_m": 0.0, "heading_spread_deg": 0.0}, duration_s=seconds_,
    )  # fmt: skip


def looks(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The times at which pairs of images are rendered from now on."""
    times: list[float] = []
    look = Cameras.look

    def counted(self: Cameras, data: Any, k: int, time: float, lag_s: float = 0.0) -> Any:
        times.append(time)
        return look(self, data, k, time, lag_s)

    monkeypatch.setattr(Cameras, "look", counted)
    return times


def test_the_rear_robot_sees_the_front_ones_cone_where_it_is() -> None:
    result = simulations.run_trial(pair(), reraise=True)
    assert result.measures["fn_share"] == 0.0  # from its first image on, when its velocity is not known yet
    assert result.measures["fp_input_share"] == 0.0
    assert result.measures["distance_error"] < A_PIXEL
    assert result.measures["bearing_error"] < np.radians(125.0 / 160.0)
    rear = 1 if result.poses_w[0, 0, 0] > result.poses_w[0, 1, 0] else 0
    assert set(result.updates.input_owners.tolist()) == {1 - rear}


@pytest.mark.parametrize("offset", ["camera", "middle", "none"])
def test_distances_are_from_the_robot_or_from_the_lens_and_are_judged_by_the_same(offset: str) -> None:
    """In a file 1.2 m apart: of the robot ahead a lens sees the near side of a cone over its centre."""
    made = pair(seconds_=0.2, **{"cameras.width_px": 640, "cameras.height_px": 120})
    herd = dataclasses.replace(made.groups[0], pipeline_parameters={"offset": offset, "pixels_per_degree": "lens"})
    result = simulations.run_trial(dataclasses.replace(made, groups=(herd,)), reraise=True)
    first = result.updates.times == 0.0
    found = np.hypot(*result.updates.input_positions[: int(first.sum())].T).min()
    lens_x, lens_y = lenses_of("create-with-cameras")[0]
    from_lens = np.hypot(1.2 - lens_x, lens_y) - CONE_RADIUS
    expected = 1.2 - CONE_RADIUS if offset == "camera" else from_lens
    # 0.05 m of 1.03 m is one of 20 columns; the two readings differ by the lens's 0.12 m
    assert found == pytest.approx(expected, rel=0.05)
    assert result.measures["distance_error"] < 0.05


def test_kirchners_robots_keep_their_distance_from_lens_to_cone() -> None:
    made = follow_1.finish(follow_1.base(1))
    herd = next(each for each in made.groups if each.name == "herd")
    assert herd.pipeline_parameters["offset"] == "middle"
    asked = dataclasses.replace(herd, pipeline_parameters={"offset": "camera"})
    assert from_the_lens(asked).pipeline_parameters["offset"] == "camera"
    perfect = dataclasses.replace(herd, pipeline="perfect", pipeline_parameters={})
    assert from_the_lens(perfect).pipeline_parameters == {}


def test_a_bearing_does_not_jump_where_a_cone_goes_over_from_one_image_to_the_other() -> None:
    """A cone some way ahead of a Pioneer crosses the middle of its view; its lenses are 12 cm apart."""
    made = follow_1.finish(follow_1.base(1))
    result = simulations.run_trial(with_setup(made, {"duration_s": 8.0}), reraise=True)
    x, y = result.updates.input_positions.astype(np.float64).T
    bearings = np.arctan2(y, x)
    assert bearings.min() < 0.0 < bearings.max()
    # robots turn by a few degrees between two images; the two lenses' bearings of a cone at 1.4 m differ by 5 degrees
    assert np.abs(np.diff(bearings)).max() < np.radians(3.0)
    assert result.measures["bearing_error"] < np.radians(0.3)
    assert result.measures["unseen_share"] == 0.0


def test_a_cone_seen_for_the_first_time_is_told_of_with_distance_and_bearing_alone() -> None:
    near = {"spacing_m": 0.45, "jitter_m": 0.0, "heading_spread_deg": 0.0}
    made = dataclasses.replace(pair(seconds_=0.2, **{"cameras.width_px": 640}), formation_parameters=near)
    result = simulations.run_trial(made, reraise=True)
    assert result.updates.times[0] == 0.0
    rear = int(result.poses_w[0, 0, 0] > result.poses_w[0, 1, 0])
    first = (result.updates.times == 0.0) & (result.updates.robots == rear)
    # a cone's near side 0.4 m from the rear robot's centre is nearer than 36 inches and farther than 10
    assert np.diff(result.updates.input_starts)[first].tolist() == [1]


def test_robots_with_eyes_have_time_for_their_images() -> None:
    """A pair takes 0.02 s where nothing else is at work: a limit below ten times that would end sound trials."""
    eyes, perfect = pair(seconds_=60.0, rate_hz=10.0), pair("perfect", seconds_=60.0, rate_hz=10.0)
    own = simulations.of(eyes)
    assert own.limit_s(eyes) - own.limit_s(perfect) > 10 * 0.02 * 2 * 600


def test_perfect_detection_is_exact_by_its_own_measure() -> None:
    result = simulations.run_trial(pair("perfect"), reraise=True)
    # positions are kept as 32-bit numbers, and robots move by less than a millimetre between two samples
    assert result.measures["distance_error"] < 1e-3
    assert result.measures["bearing_error"] < 1e-3


def test_the_same_trial_gives_the_same_result() -> None:
    noisy = pair(**{"imperfections.noise_levels": 4.0, "imperfections.dropped": 0.2})
    one, other = (simulations.run_trial(noisy, reraise=True) for _ in range(2))
    assert np.array_equal(one.poses_w, other.poses_w)
    assert np.array_equal(one.updates.input_positions, other.updates.input_positions)


def test_no_image_is_rendered_that_nobody_reads(monkeypatch: pytest.MonkeyPatch) -> None:
    times = looks(monkeypatch)
    simulations.run_trial(pair("perfect"), reraise=True)
    assert times == []
    simulations.run_trial(pair(rate_hz=10.0), reraise=True)
    assert len(times) == 2 * 11


def test_slow_cameras_render_at_their_own_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    times = looks(monkeypatch)
    result = simulations.run_trial(pair(rate_hz=10.0, **{"imperfections.frame_rate_hz": 5.0}), reraise=True)
    assert len(times) == 2 * 6
    assert len(result.updates.times) == 2 * 11


def test_truth_is_that_of_the_pair_that_the_robot_sees(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is lost shows nothing, and its right image's truth is as late as that image."""
    made, sensed = list[tuple[ScanTruth, float, float]](), list[tuple[float, float]]()
    truth, sense = Cameras.truth, Robot.sense

    def told(self: Cameras, data: Any, k: int, lag_s: float = 0.0) -> ScanTruth:
        found = truth(self, data, k, lag_s)
        made.append((found, data.time, lag_s))
        return found

    def sensing(self: Robot, *given: Any, **more: Any) -> Any:
        senses, shown = sense(self, *given, **more)
        of = [(time, lag_s) for found, time, lag_s in made if found is shown]
        assert len(of) == (senses.images is not None)
        if of:
            assert of == [(senses.images.time, 0.02)]
            sensed.append((given[1], senses.images.time))
        return senses, shown

    monkeypatch.setattr(Cameras, "truth", told)
    monkeypatch.setattr(Robot, "sense", sensing)
    simulations.run_trial(pair(**{"imperfections.dropped": 0.5, "imperfections.capture_offset_s": 0.02}), reraise=True)
    assert 0 < sum(now > taken for now, taken in sensed) < len(sensed)


def test_a_body_without_cameras_is_refused_with_those_that_have_some() -> None:
    with pytest.raises(InputError, match="carries no cameras") as refused:
        simulations.check(pair(body="create"))
    assert "create-with-cameras, pioneer" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("count", "colours", "given", "told"),
    [
        (2, "one-each", {}, "herd.pipeline.colours = 1 with herd.cameras.colours = 'one-each'"),
        (13, "one-each", {"colours": 12}, "herd.cameras.colours = 'one-each' with 13 robots: expected at most 12"),
        (2, "orange", {"colours": 2, "ranges": "published"}, "herd.pipeline.ranges = 'published' with"),
    ],
)
def test_colours_that_nobody_can_tell_are_refused(count: int, colours: str, given: dict[str, Value], told: str) -> None:
    made = pair(**{"cameras.colours": colours})
    herd = dataclasses.replace(made.groups[0], count=count, pipeline_parameters=given)
    with pytest.raises(InputError) as refused:
        simulations.check(dataclasses.replace(made, groups=(herd,)))
    assert told in str(refused.value)
    assert "\n" not in str(refused.value)
    fits = dataclasses.replace(made.groups[0], pipeline_parameters={"colours": 2})
    simulations.check(dataclasses.replace(made, groups=(fits,)))


def test_a_body_with_cameras_has_no_laser_to_read() -> None:
    with pytest.raises(InputError, match="carries no laser"):
        simulations.check(pair("member-based"))


def test_a_recording_has_the_images_and_the_estimates(tmp_path: Path) -> None:
    result = simulations.run_trial(pair(), scans="some", reraise=True)
    assert result.pictures is not None
    assert len(result.pictures.times) == 2 * 3  # at 2 Hz
    path = tmp_path / "eyes.rrd"
    simulations.record(result, path)
    found = {str(chunk.entity_path) for chunk in rr.chunk.RrdReader(str(path)).stream()}
    for name in result.robot_names:
        assert {f"/cameras/{name}/{side}/image" for side in ("left", "right")} <= found
        assert f"/cameras/{name}/left_taken_for" in found
    for line in ("distance_m/truth", "impact_s/estimate", "impact_s/truth"):
        assert any(entity.startswith("/eyes/") and entity.endswith(line) for entity in found)


def series_of(path: Path) -> dict[str, list[float]]:
    """The numbers of each line in a recording, by its entity; nan where it has a gap."""
    found: dict[str, list[float]] = {}
    for chunk in rr.chunk.RrdReader(str(path)).stream():
        batch, entity = chunk.to_record_batch(), str(chunk.entity_path)
        for name in batch.schema.names:
            if name.endswith("scalars") and entity.startswith("/eyes/"):
                found.setdefault(entity, []).extend(each[0] for each in batch.column(name).to_pylist())
    return found


def test_the_truth_in_a_recording_is_of_the_robot_that_the_input_belongs_to(tmp_path: Path) -> None:
    """A line of three: the first input of the last robot is told to be of each other one, and of nobody."""
    made = pair(seconds_=0.5, **{"cameras.width_px": 640, "cameras.height_px": 120})
    made = dataclasses.replace(made, groups=(dataclasses.replace(made.groups[0], count=3),))
    result = simulations.run_trial(made, scans="some", reraise=True)
    rear = int(result.poses_w[0, :, 0].argmin())
    updates = result.updates
    mine = np.flatnonzero(updates.robots == rear)
    assert (np.diff(updates.input_starts)[mine] == 1).all()
    inputs, owners = updates.input_starts[mine], updates.input_owners.copy()
    others = [k for k in range(3) if k != rear]
    owners[inputs] = np.resize([others[0], others[0], others[1], -1], len(mine))
    result = dataclasses.replace(result, updates=dataclasses.replace(updates, input_owners=owners))
    simulations.record(result, tmp_path / "eyes.rrd")
    found = series_of(tmp_path / "eyes.rrd")
    own = f"/eyes/{result.robot_names[rear]}"
    exact = exact_inputs(result, updates.times[mine], updates.robots[mine], updates.poses_w[mine])
    true = [np.hypot(*exact[u, owner]) if owner >= 0 else np.nan for u, owner in enumerate(owners[inputs])]
    np.testing.assert_allclose(found[f"{own}/distance_m/truth"], true, rtol=1e-6)
    np.testing.assert_allclose(
        found[f"{own}/distance_m/estimate"], np.hypot(*updates.input_positions[inputs].T), rtol=1e-6
    )


def test_the_time_to_impact_is_that_of_one_robot() -> None:
    """Straight at a cone at 0.5 m/s it is the distance over the speed; of two robots, and with a gap, there is none."""
    times = np.arange(5) * 0.1
    away = 2.0 - 0.5 * times
    at, impact = recorded_cameras._impact(times, away, np.zeros(5, np.int64))
    np.testing.assert_allclose(at, times[1:])
    np.testing.assert_allclose(impact, away[1:] / 0.5)
    at, _ = recorded_cameras._impact(times, away, np.array([0, 0, 1, 1, 1]))
    np.testing.assert_allclose(at, times[[1, 3, 4]])
    at, _ = recorded_cameras._impact(times, np.where(times == times[2], np.nan, away), np.zeros(5, np.int64))
    np.testing.assert_allclose(at, times[[1, 4]])


def test_recording_does_not_change_the_result() -> None:
    plain, kept = (simulations.run_trial(pair(), scans=scans, reraise=True) for scans in ("none", "all"))
    assert np.array_equal(plain.poses_w, kept.poses_w)


class TestTheLeadRobotsWay:
    @pytest.mark.parametrize(("x", "y"), [(1.72, 7.5), (7.3, -3.1), (1.7, -2.5)])
    def test_an_arc_leads_where_it_says(self, x: float, y: float) -> None:
        leg = arc_to(x, y)
        radius = leg.length_ft / leg.turn_rad
        end = radius * np.sin(leg.turn_rad), radius * (1.0 - np.cos(leg.turn_rad))
        assert end == pytest.approx((x, y))

    def test_the_script_takes_the_time_of_the_way(self) -> None:
        legs = (Leg(4.5), arc_to(7.3, -3.1))
        given = driven(legs)
        assert given["leg_1_s"] + given["leg_2_s"] == pytest.approx(seconds(legs), abs=0.05)  # type: ignore[operator]

    def test_a_robot_that_is_driven_ends_where_the_text_says(self) -> None:
        made = follow_1.base(1)
        alone = trial(
            "lead", 1, [next(each for each in made.groups if each.name == "lead")], world="open-floor",
            duration_s=float(made.setup["duration_s"]),
        )  # fmt: skip
        end = simulations.run_trial(alone, reraise=True).poses_w[-1, 0, :2] / 0.3048
        # within a foot: it gathers speed for half a second, and skids a little less than its firmware believes
        assert np.hypot(*(end - (8.0, 7.5))) < 1.0


def test_all_neighbours_take_a_detection_of_several() -> None:
    ways = monocular_flock.cells(monocular_flock.CONDITIONS)
    by_runs = [way for way in ways if way["herd.pipeline"] == "cone-member-based"]
    assert by_runs
    assert all(way["herd.law.nearest_only"] for way in by_runs)
    assert {way["herd.law.nearest_only"] for way in ways if way["herd.pipeline"] == "cone-blobs"} == {True, False}
