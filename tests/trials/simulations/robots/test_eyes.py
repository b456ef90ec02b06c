"""Trials of robots that see by cameras: what they find, what is rendered, what is refused, what a recording holds."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import rerun as rr

from flocking.errors import InputError
from robots.eyes import CONE_RADIUS
from sensing.camera import opengl
from sensing.camera.labels import decoded
from sensing.camera.lens import Lens, places
from sensing.camera.rendering import Cameras
from sensing.types import ScanTruth
from trials import simulations
from trials.commands import cli
from trials.simulations.robots.fields import group, trial
from trials.simulations.robots.robot import Robot
from trials.simulations.robots.seen import cone_of, lenses_of
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
    assert any(entity.startswith("/eyes/") and entity.endswith("distance_m/truth") for entity in found)


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


class TestLabelledImages:
    def test_each_cone_is_labelled_where_it_is(self, tmp_path: Path) -> None:
        made = pair(seconds_=0.5, **{"cameras.width_px": 640, "cameras.height_px": 120})
        write = simulations.of(made).write_images
        assert write is not None
        assert write(made, tmp_path, 0.5) == 2 * 2 * 2  # robots, cameras, moments
        labels = json.loads((tmp_path / "labels.json").read_text())
        assert {path.name for path in tmp_path.glob("*.png")} == {image["file_name"] for image in labels["images"]}
        cones = [each for each in labels["annotations"] if each["category_id"] == 1]
        assert cones
        by_id = {image["id"]: image for image in labels["images"]}
        for cone in cones:
            image = by_id[cone["image_id"]]
            picture = cv2.imread(str(tmp_path / image["file_name"]))
            assert picture is not None
            mask = decoded(cone["segmentation"])
            assert mask.shape == picture.shape[:2]
            assert cone["area"] == mask.sum()
            blue, green, red = picture[mask].mean(axis=0)
            assert red > 3.0 * max(green, blue)
            if image["time_s"] > 0.0:
                continue  # robots have moved
            # straight ahead of the robot is 47.5 degrees to the right of the left camera's axis
            (x, y), sign = lenses_of("create-with-cameras")[0], -1.0 if image["camera"] == "left" else 1.0
            assert cone["bearing_rad"] == pytest.approx(sign * (np.radians(47.5) + np.arctan(y / (1.2 - x))), abs=1e-6)
            # to the lens, which stands 0.12 m before the centre and 0.03 m aside, from the near side of the cone
            assert cone["distance_m"] == pytest.approx(1.2 - 0.12 - 0.05, abs=0.02)
        assert {each["category_id"] for each in labels["annotations"]} == {1, 2}

    def test_a_bearing_is_that_of_the_pixels_columns(self, tmp_path: Path) -> None:
        """The middle of a cone's columns is its axis's, in a right image that is taken later, by robots that turn."""
        made = pair("perfect", 1.0, **{"cameras.width_px": 640, "cameras.height_px": 120, "speed_m_s": 0.4})
        turning = {"leg_1_m_s": 0.4, "leg_1_rad_s": 0.8}
        driven_ = dataclasses.replace(made.groups[0], law="drive", law_parameters=turning)
        driven_ = with_setup(driven_, {"imperfections.capture_offset_s": 0.1})
        made = dataclasses.replace(made, groups=(driven_,))
        write = simulations.of(made).write_images
        assert write is not None
        write(made, tmp_path, 0.25)
        labels = json.loads((tmp_path / "labels.json").read_text())
        by_id = {image["id"]: image for image in labels["images"]}
        compared = list[str]()
        for each in labels["annotations"]:
            x, _, width, _ = each["bbox"]
            if each["category_id"] != 1 or x == 0 or x + width == 640:
                continue
            # a column is rendered for its middle, and either border is within half of one
            assert places(Lens(height_px=120), each["bearing_rad"]) == pytest.approx(x + width / 2.0, abs=1.0)
            compared.append(by_id[each["image_id"]]["camera"])
        assert min(compared.count(side) for side in ("left", "right")) >= 3

    def test_pictures_are_those_of_the_cameras_and_lost_pairs_are_not_written(self, tmp_path: Path) -> None:
        pictures = {}
        for name, given in (
            ("none", {}),
            ("dark", {"imperfections.light": 0.5}),
            ("mild", {"cameras.setting": "mild"}),
            ("dropped", {"imperfections.dropped": 0.5}),
            ("slow", {"imperfections.frame_rate_hz": 2.0}),
        ):
            made = pair("perfect", 1.0, **given)
            write = simulations.of(made).write_images
            assert write is not None
            (tmp_path / name).mkdir()
            count = write(made, tmp_path / name, 0.1)
            read = [cv2.imread(str(path)) for path in sorted((tmp_path / name).glob("*.png"))]
            assert count == len(read) == len(json.loads((tmp_path / name / "labels.json").read_text())["images"])
            pictures[name] = read
        assert len(pictures["none"]) == len(pictures["dark"]) == len(pictures["mild"]) == 2 * 2 * 11
        assert len(pictures["slow"]) == 2 * 2 * 3
        assert 0 < len(pictures["dropped"]) < 2 * 2 * 11
        assert len(pictures["dropped"]) % 2 == 0
        plain, dark, mild = (np.asarray(pictures[name][0], float) for name in ("none", "dark", "mild"))
        np.testing.assert_allclose(dark, plain / 2.0, atol=0.5)
        assert (plain != mild).any()

    def test_a_robot_is_labelled_at_its_own_centre(self, tmp_path: Path) -> None:
        """And its cone, which a Pioneer carries elsewhere, where that stands."""
        made = pair("perfect", 0.1, **{"cameras.width_px": 640, "cameras.height_px": 240, "body": "pioneer"})
        write = simulations.of(made).write_images
        assert write is not None
        write(made, tmp_path, 1.0)
        annotations = json.loads((tmp_path / "labels.json").read_text())["annotations"]
        lens_x, lens_y = lenses_of("pioneer")[0]
        cone_x, _ = cone_of("pioneer")
        assert abs(cone_x) > 0.02
        for category, away in (
            (1, np.hypot(1.2 + cone_x - lens_x, lens_y) - CONE_RADIUS),
            (2, np.hypot(1.2 - lens_x, lens_y)),
        ):
            found = [each["distance_m"] for each in annotations if each["category_id"] == category]
            assert found == pytest.approx([away] * len(found), abs=1e-3)
            assert found

    def test_a_robot_without_a_cone_is_labelled_at_its_centre(self, tmp_path: Path) -> None:
        made = pair(seconds_=0.1, **{"cameras.width_px": 640, "cameras.height_px": 240})
        plain = with_setup(group("drive", 1, name="plain", pipeline="perfect"), {"body": "create"})
        plain = with_setup(plain, {"formation": "single-file", "start_x_m": 2.4})
        alone = dataclasses.replace(made.groups[0], count=1)
        made = dataclasses.replace(made, groups=(alone, plain))
        write = simulations.of(made).write_images
        assert write is not None
        write(made, tmp_path, 1.0)
        labels = json.loads((tmp_path / "labels.json").read_text(), parse_constant=pytest.fail)
        assert {each["category_id"] for each in labels["annotations"]} == {2}
        for each in labels["annotations"]:
            assert each["distance_m"] == pytest.approx(2.4 - 0.12, abs=0.05)

    def test_robots_without_cameras_are_refused_with_those_that_have_some(self, tmp_path: Path) -> None:
        made = pair("perfect", body="create")
        write = simulations.of(made).write_images
        assert write is not None
        with pytest.raises(InputError, match="no robot of 'eyes' carries cameras") as refused:
            write(made, tmp_path, 0.5)
        assert "create-with-cameras" in str(refused.value)

    def test_the_command_refuses_a_folder_that_is_there(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        monkeypatch.setattr("sys.argv", ["herd", "images", "follow-1", "--out", str(tmp_path)])
        assert cli.main() == 2
        assert "expected a new one" in capsys.readouterr().err
