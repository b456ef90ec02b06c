"""Trials of robots with sonars and cameras: what is an obstacle, what is heard and when, what a recording holds."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr

from flocking.errors import InputError
from sensing.camera import opengl
from sensing.sonar import HALF_WIDTH_RAD, LEAST_M, RING, Sonars
from trials import simulations
from trials.simulations.robots.fields import AVOID, group, trial
from trials.simulations.robots.recorded_echoes import arcs_w, obstacles_w
from trials.studies.monocular.design import LAW
from trials.types import Heard, Trial, Value, with_setup

SMALL: dict[str, Value] = {"cameras.width_px": 160, "cameras.height_px": 60, "cameras.judged": False}
MARGIN: dict[str, Value] = {"avoidance.margin_m": 0.45, "avoidance.look_ahead_m": 1.2}
PIPELINES = ["cone-member-based", "cone-member-extrapolated", "cone-sensor-based", "cone-blobs"]
RADIUS = 0.4


def herd(
    count: int = 1, seconds: float = 0.3, *, world: str = "post", at: float = 1.6, pipeline: str = PIPELINES[0],
    law: str = "moshtagh-kirchner", spacing: float = 1.2, **given: Value,
) -> Trial:  # fmt: skip
    """Pioneers in a file along x, and a post at `at` (m)."""
    made = group(law, count, pipeline=pipeline, law_parameters=LAW if law == "moshtagh-kirchner" else {})
    setup: dict[str, Value] = {"body": "pioneer", **SMALL, **MARGIN, "phase": "together", "obstacles": AVOID, **given}
    placed: dict[str, Value] = {"spacing_m": spacing, "jitter_m": 0.0, "heading_spread_deg": 0.0}
    return trial(
        "listening", 1, [with_setup(made, setup)], world=world, formation="single-file", duration_s=seconds,
        world_parameters={"x_m": at, "radius_m": RADIUS} if world == "post" else {}, formation_parameters=placed,
    )  # fmt: skip


@pytest.fixture
def rendering() -> None:
    try:
        opengl.library()
    except InputError as error:
        pytest.skip(str(error))


class TestRefused:
    @pytest.mark.parametrize("pipeline", PIPELINES)
    def test_obstacles_of_images_without_sonar(self, pipeline: str) -> None:
        simulations.check(herd(pipeline=pipeline))
        with pytest.raises(InputError, match=r"herd.obstacles = 'avoid' needs obstacles.* carries no sonar") as refused:
            simulations.check(herd(pipeline=pipeline, body="create-with-cameras"))
        assert "expected a body with cameras and sonar: pioneer, or pipeline 'perfect'" in str(refused.value)
        assert "\n" not in str(refused.value)

    def test_a_law_that_reads_obstacles_without_sonar(self) -> None:
        lone: dict[str, Any] = {"law": "lorek-white", "obstacles": "as-law", "pipeline": "cone-blobs"}
        simulations.check(herd(**lone))
        with pytest.raises(InputError, match=r"law 'lorek-white' needs obstacles.* carries no sonar"):
            simulations.check(herd(**lone, body="create-with-cameras"))

    def test_bodies_without_sonar_see_as_before_where_no_obstacle_is_asked_for(self) -> None:
        simulations.check(herd(obstacles="as-law", body="create-with-cameras"))


@pytest.mark.usefixtures("rendering")
class TestInATrial:
    @pytest.mark.parametrize("pipeline", PIPELINES)
    def test_a_post_ahead_is_an_obstacle_where_the_sonars_say(self, pipeline: str) -> None:
        """Of a round post a sonar hears the point towards its axis, or none where the axis is not in its cone."""
        result = simulations.run_trial(herd(pipeline=pipeline), scans="all", reraise=True)
        assert result.heard is not None
        x, y, heading = np.array(RING[3:5]).T
        expected = np.hypot(1.6 - x, y) - RADIUS  # both front sonars have the post's axis within 12 degrees of theirs
        points = np.column_stack([x + expected * np.cos(heading), y + expected * np.sin(heading)])
        found = result.heard.obstacles[0]
        # a millimetre: the post has straight pieces, and a cone has a ray a degree
        assert all(np.hypot(*(found - point).T).min() < 3e-3 for point in points)
        assert (np.hypot(*(found - (1.6, 0.0)).T) < RADIUS + 0.3).all()  # half of an arc at a metre is 0.26 m

    def test_a_flockmate_whose_cone_is_seen_is_no_obstacle_and_one_behind_is(self) -> None:
        """In a file, the front one heads on unseeing, and hears who is behind it."""
        made = herd(2, world="open-floor", start_moving=False, seconds=0.2)
        result = simulations.run_trial(made, scans="all", reraise=True)
        assert result.heard is not None
        rear = int(result.poses_w[0, :, 0].argmin())
        assert len(result.updates.input_positions) > 0
        for robot, ranges, found in zip(result.heard.robots, result.heard.ranges, result.heard.obstacles, strict=True):
            assert np.isfinite(ranges).any()  # each hears the other
            assert (len(found) == 0) == (robot == rear)
            assert (found[:, 0] < 0.0).all()

    def test_a_robot_that_avoids_does_not_touch_the_post_and_one_that_does_not_does(self) -> None:
        """At 0.2 m/s the post, 0.5 m ahead of the bumper and a little aside, would be met after 3 s."""
        given: dict[str, Any] = {"at": 1.2, "seconds": 5.0, "start_y_m": 0.05, "formation": "single-file"}
        placed: dict[str, Any] = {"formation.jitter_m": 0.0, "formation.heading_spread_deg": 0.0}
        avoids, blind = (
            simulations.run_trial(herd(**given, **placed, obstacles=way), reraise=True) for way in (AVOID, "as-law")
        )
        assert avoids.measures["wall_collisions"] == 0.0
        assert blind.measures["wall_collisions"] >= 1.0
        assert "avoiding" in avoids.rules[0]
        spoken = {avoids.rules[0][rule] for rule in avoids.updates.rules}
        assert "avoiding" in spoken

    def test_no_sonar_is_read_that_nobody_asks_for(self, monkeypatch: pytest.MonkeyPatch) -> None:
        times: list[int] = []
        read = Sonars.read

        def counted(self: Sonars, data: Any, k: int) -> Any:
            times.append(k)
            return read(self, data, k)

        monkeypatch.setattr(Sonars, "read", counted)
        result = simulations.run_trial(herd(obstacles="as-law"), scans="all", reraise=True)
        assert times == []
        assert result.heard is None
        simulations.run_trial(herd(pipeline="perfect"), reraise=True)
        assert times == []
        result = simulations.run_trial(herd(2, rate_hz=10.0), reraise=True)
        assert sorted(times) == [0] * (len(result.updates.times) // 2) + [1] * (len(result.updates.times) // 2)
        assert result.heard is None  # nothing is kept but for a recording

    def test_a_recording_has_echoes_and_obstacles_and_does_not_change_the_result(self, tmp_path: Path) -> None:
        plain, kept = (simulations.run_trial(herd(), scans=scans, reraise=True) for scans in ("none", "some"))
        assert np.array_equal(plain.poses_w, kept.poses_w)
        path = tmp_path / "heard.rrd"
        simulations.record(kept, path)
        found = {str(chunk.entity_path) for chunk in rr.chunk.RrdReader(str(path)).stream()}
        assert {f"/world/{what}/{kept.robot_names[0]}" for what in ("echoes", "obstacles")} <= found


def test_arcs_and_obstacles_are_drawn_where_the_robot_was() -> None:
    """A robot at (1, 2) that faces +y hears something 2 m ahead with a sonar 0.2 m before its middle."""
    pose = np.array([[1.0, 2.0, math.pi / 2]])
    ring, ranges = np.array([[0.2, 0.0, 0.0], [0.0, 0.1, 1.0]]), np.array([2.0, math.inf])
    heard = Heard(np.zeros(1), np.zeros(1, np.int64), pose, (ring,), (ranges,), (np.array([[2.2, 0.0]]),))
    np.testing.assert_allclose(obstacles_w(heard, 0), [[1.0, 4.2]], atol=1e-12)
    arcs = arcs_w(heard, 0)
    assert arcs.shape[0] == 1
    np.testing.assert_allclose(np.hypot(*(arcs[0] - (1.0, 2.2)).T), 2.0, atol=1e-12)
    np.testing.assert_allclose(arcs[0, 0], (1.0 + 2.0 * math.sin(HALF_WIDTH_RAD), 2.2 + 2.0 * math.cos(HALF_WIDTH_RAD)))
    assert LEAST_M < 2.0


def test_of_two_kinds_only_those_with_sonar_are_asked_for_obstacles() -> None:
    made = herd()
    blind = with_setup(dataclasses.replace(made.groups[0], name="blind"), {"body": "create-with-cameras"})
    both = dataclasses.replace(made, groups=(made.groups[0], with_setup(blind, {"obstacles": "as-law"})))
    own = {"formation": "single-file", "start_y_m": 2.0}
    groups = (both.groups[0], with_setup(both.groups[1], own))
    simulations.check(dataclasses.replace(both, groups=groups))
