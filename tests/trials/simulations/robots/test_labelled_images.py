"""Labelled images of a trial: each label where the picture shows it, pictures as the cameras take them."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from flocking.errors import InputError
from robots.eyes import CONE_RADIUS
from sensing.camera import opengl
from sensing.camera.labels import decoded
from sensing.camera.lens import Lens, places
from tests.trials.simulations.robots.test_eyes import SMALL, pair
from trials import simulations
from trials.commands import cli
from trials.simulations.robots.fields import group
from trials.simulations.robots.seen import cone_of, lenses_of
from trials.types import with_setup


@pytest.fixture(scope="module", autouse=True)
def rendering() -> None:
    """All of these need OpenGL, but for what is refused before."""
    try:
        opengl.library()
    except InputError as error:
        pytest.skip(str(error))


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

    def test_those_who_detect_by_images_take_them_and_the_labels_tell_how(self, tmp_path: Path) -> None:
        made = pair(seconds_=0.1, **{"imperfections.light": 0.5})
        lead = with_setup(group("drive", 1, name="lead", pipeline="perfect"), {"body": "create-with-cameras"})
        lead = with_setup(lead, {"formation": "single-file", "start_x_m": 3.0})
        follower = dataclasses.replace(made.groups[0], count=1)
        made = dataclasses.replace(made, groups=(lead, follower))
        write = simulations.of(made).write_images
        assert write is not None
        assert write(made, tmp_path, 1.0) == 2
        labels = json.loads((tmp_path / "labels.json").read_text(), parse_constant=pytest.fail)
        assert {image["robot"] for image in labels["images"]} == {1}
        (told,) = labels["info"]["robots"]
        assert told["robot"] == 1
        assert told["imperfections"]["light"] == 0.5
        assert told["cameras"]["width_px"] == SMALL["cameras.width_px"]

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
