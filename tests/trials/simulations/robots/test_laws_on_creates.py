"""Any law on Creates: it runs, it gets all that it needs and never nan instead, it uses the values that were set."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from flocking import lawentry, lawsource, selection
from flocking.errors import InputError
from flocking.lawentry import OF_MEMBERS
from sensing.types import NOBODY
from trials.design import plan
from trials.rows import Row
from trials.simulations.robots import fields, information
from trials.simulations.robots.herd import assemble
from trials.simulations.robots.knowledge import COMPASS, GOAL, SOURCES
from trials.simulations.robots.loop import run_trial
from trials.simulations.robots.resolved import Resolved
from trials.types import Group, Trial

SECONDS = 2.0
NAN_WATCHER = """
import math
from typing import NamedTuple
from flocking.types import Kind, Motion
NEEDS = frozenset({"positions", "headings", "velocities"})
class Parameters(NamedTuple):
    pass
def law(own, members, sets, obstacles, parameters, memory, u):
    total = 0.0
    for j in range(len(members.ids)):
        total += members.headings[j] + members.velocities[j, 0] + members.velocities[j, 1] + members.positions[j, 0]
    return Motion(Kind.HEADING, 0.3 if total == total else math.nan, 0.2, 0)
"""
STRAIGHT_ON = """
from typing import NamedTuple
from flocking.types import Kind, Motion
class Parameters(NamedTuple):
    pass
def law(own, members, sets, obstacles, parameters, memory, u):
    return Motion(Kind.HEADING, 0.0, 0.2, 0)
"""


def trial(group: Group, **changes: object) -> Trial:
    return fields.trial("detection-case-study", 1, [group], **{"duration_s": SECONDS, **changes})  # type: ignore[arg-type]


def robots_of(group: Group):
    return assemble(trial(group), record=False).robots


def runnable(name: str) -> Group:
    """Three robots with member-based detection, or perfect detection for laws that need more."""
    law = lawentry.module_of(name)
    sets = selection.parse_sets("all", lawentry.sets_of(law), law.Parameters._fields)
    graphs = [
        one
        for one, steps in zip(lawentry.sets_of(law), sets, strict=True)
        if any(step.step is selection.Step.GRAPH for step in steps)
    ]
    text = "; ".join(f"{one}: fixed-set(0, 1, 2)" for one in graphs) or "all"
    group = fields.group(count=3, law=name, selection=text, informed=1, goal_x_m=50.0)
    try:
        information.check(Resolved(group))
    except InputError:
        return dataclasses.replace(group, pipeline="perfect")
    return group


@pytest.mark.parametrize("name", lawsource.names())
def test_every_law_runs_on_creates(name: str) -> None:
    group = runnable(name)
    done = run_trial(trial(group))
    assert (done.outcome, done.reason) == ("done", "")
    assert np.isfinite(done.poses_w).all()
    assert np.isfinite(done.updates.commands).all()
    assert len(done.updates.times) == pytest.approx(3 * SECONDS * fields.of_group(group).rate_hz, abs=3)
    assert np.ptp(done.poses_w[:, :, :2], axis=0).max() > 0.0
    if lawentry.module_of(name).NEEDS & OF_MEMBERS:
        assert done.updates.input_starts[-1] > 0, "somebody was seen"


class TestAssociation:
    @pytest.mark.parametrize(
        ("change", "works"),
        [
            ({"law": "extended-hamilton"}, False),
            ({"law": "vicsek"}, True),
            ({"law": "vicsek", "pipeline": "sensor-based"}, True),
            ({"law": "vicsek", "pipeline": "perfect"}, False),
            ({"law": "couzin"}, True),
        ],
    )
    def test_it_is_at_work_only_where_it_is_needed(self, change: dict[str, str], works: bool) -> None:
        assert all((robot.association is not None) == works for robot in robots_of(fields.group(count=2, **change)))

    @pytest.mark.parametrize("pipeline", ["member-based", "sensor-based"])
    @pytest.mark.parametrize("obstacles", ["as-law", "virtual-members"])
    def test_a_law_never_sees_nan_in_what_it_needs(self, tmp_path: Path, pipeline: str, obstacles: str) -> None:
        path = tmp_path / "watcher.py"
        path.write_text(NAN_WATCHER)
        group = fields.group(count=4, law=str(path), pipeline=pipeline, obstacles=obstacles)
        done = run_trial(trial(group, duration_s=4.0))
        assert (done.outcome, done.reason) == ("done", "")
        counts = np.diff(done.updates.input_starts)
        assert counts[:4].max() == 0, "of one scan nothing is known"
        assert counts.max() > 0

    def test_inputs_in_the_log_belong_to_the_robots_that_stand_there(self) -> None:
        """Each input of a member lies on the side of it that faces the focal one: within a radius of its centre."""
        group = fields.group(count=6, law="couzin", pipeline="member-extrapolated", sensors="ideal")
        updates = run_trial(trial(group, duration_s=5.0, formation="scattered")).updates
        poses_w, owned = {}, 0
        for u in range(len(updates.times)):
            robot, (x, y, heading) = updates.robots[u], updates.poses_w[u]
            poses_w[robot] = (x, y)
            rows = slice(updates.input_starts[u], updates.input_starts[u + 1])
            for point, owner in zip(updates.input_positions[rows], updates.input_owners[rows], strict=True):
                if owner == NOBODY or owner not in poses_w:
                    continue
                c, s = math.cos(heading), math.sin(heading)
                seen_w = (x + c * point[0] - s * point[1], y + s * point[0] + c * point[1])
                # its own last update is up to 0.1 s ago, at 0.5 m/s at most
                assert math.dist(seen_w, poses_w[owner]) < 0.17 + 0.05
                owned += 1
        assert owned > 1000

    def test_a_recording_changes_nothing(self) -> None:
        moving = trial(fields.group(count=3, law="vicsek"))
        np.testing.assert_array_equal(run_trial(moving).poses_w, run_trial(moving, scans="all").poses_w)


class TestValuesForCreates:
    def rows(self, law: str, **settings: object) -> tuple[dict[str, Row], Trial]:
        made = plan("detection-case-study", repeats=1, law=law, settings=settings)
        return {row.key: row for row in made.parameters}, made.trials[0]

    def test_they_are_shown_written_down_and_used(self) -> None:
        creates = lawentry.load("couzin").create
        assert creates
        rows, first = self.rows("couzin")
        for name, value in creates.items():
            row = rows[f"herd.law.{name}"]
            assert row.value == value
            assert "for Creates" in row.source
            assert not row.published
        assert first.groups[0].law_parameters == creates
        values = robots_of(dataclasses.replace(first.groups[0], law_parameters={}))[0].law_parameters
        expected = lawentry.load("couzin").parameters(creates)
        np.testing.assert_array_equal(values, expected)

    def test_what_is_set_goes_before_them(self) -> None:
        rows, first = self.rows("couzin", **{"herd.law.rho_m": 2.5})
        assert rows["herd.law.rho_m"].value == 2.5
        assert "set here" in rows["herd.law.rho_m"].source
        assert first.groups[0].law_parameters["rho_m"] == 2.5
        assert first.groups[0].law_parameters["alpha_m"] == lawentry.load("couzin").create["alpha_m"]

    def test_a_law_without_them_is_left_as_it_was(self) -> None:
        made = plan("detection-case-study", repeats=1)
        assert made.trials[0].groups[0].law_parameters == {"exclusion_m": 0.0}
        assert not any("for Creates" in row.source for row in made.parameters)


class TestOneself:
    @pytest.mark.parametrize("source", SOURCES)
    def test_goal_and_compass_are_in_the_robots_own_frame(self, source: str) -> None:
        group = fields.group(
            count=2,
            law="arkin-balch",
            pipeline="perfect",
            own_motion=source,
            informed=1,
            goal_x_m=30.0,
            goal_y_m=4.0,
        )
        herd = assemble(trial(group), record=False)
        robot, other = herd.robots
        x, y, heading = herd.world.fleet.poses(herd.world.data)[0]
        for one in herd.robots:
            one.sense(herd.world.data, 0.0, None, record=False)
        assert robot.own is not None
        assert other.own is not None
        c, s = math.cos(heading), math.sin(heading)
        expected = (c * (30.0 - x) + s * (4.0 - y), c * (4.0 - y) - s * (30.0 - x))
        np.testing.assert_allclose(robot.own.goal, expected, atol=1e-6)
        assert robot.own.compass == pytest.approx(heading, abs=1e-9)
        assert np.isnan(other.own.goal).all()
        assert (robot.own.role, other.own.role) == (1, 0)
        assert (robot.own.id, other.own.id) == (0, 1)

    @pytest.mark.parametrize(("source", "place_m", "heading_rad"), [("true", 1e-9, 1e-9), ("commands", 0.05, 0.05)])
    def test_the_own_way_is_followed(self, source: str, place_m: float, heading_rad: float) -> None:
        """A second alone on a steady arc. `commands`: wheels lag 40 ms behind (10 mm, 1 degree) and slip a little."""
        group = fields.group(count=1, law="hamilton-1d", own_motion=source)
        herd = assemble(trial(group, world="open-floor"), record=False)
        robot, world = herd.robots[0], herd.world
        robot.apply((0.2, 0.4))
        for k in range(1, 21):
            world.advance(to=10 * k)
            robot.sense(world.data, 0.1 * k, None, record=False)
        true = world.fleet.poses(world.data)[0]
        np.testing.assert_allclose(robot.knowledge.pose_w[:2], true[:2], atol=place_m)
        assert robot._own_row[COMPASS] == pytest.approx(true[2], abs=heading_rad)
        assert robot._own_row[0] == pytest.approx(0.2, abs=0.01)
        assert np.isnan(robot._own_row[GOAL]).all()

    def test_leaders_and_followers_make_one_herd(self) -> None:
        groups = (
            fields.group(name="leader", count=1, law="jadbabaie", role=1),
            fields.group(name="herd", count=2, law="vicsek", pipeline="perfect"),
        )
        mixed = dataclasses.replace(trial(fields.group()), groups=groups)
        robots = assemble(mixed, record=False).robots
        assert [robot.role for robot in robots] == [1, 0, 0]
        assert [robot.law.name for robot in robots] == ["jadbabaie", "vicsek", "vicsek"]
        assert run_trial(mixed).outcome == "done"

    def test_perfect_ids_are_the_robots_indices(self) -> None:
        herd = assemble(trial(fields.group(count=4, law="kelly-keating", pipeline="perfect")), record=False)
        poses_w = herd.world.fleet.poses(herd.world.data)
        robot = herd.robots[2]
        senses, _ = robot.sense(herd.world.data, 0.0, herd.world_truth(2, poses_w), record=False)
        assert set(robot.detect(senses).members.ids.tolist()) <= {0, 1, 3}


class TestObstacles:
    def straight(self, tmp_path: Path, obstacles: str) -> Group:
        path = tmp_path / "straight.py"
        path.write_text(STRAIGHT_ON)
        return fields.group(count=4, law=str(path), pipeline="perfect", obstacles=obstacles)

    def test_avoidance_keeps_a_law_that_has_none_off_the_walls(self, tmp_path: Path) -> None:
        walls = {}
        for obstacles in ("as-law", "avoid"):
            done = run_trial(trial(self.straight(tmp_path, obstacles), duration_s=15.0, formation="scattered"))
            assert (done.outcome, done.reason) == ("done", "")
            walls[obstacles] = int((done.contacts.others == -1).sum())
            assert ("avoiding" in done.rules[0]) == (obstacles == "avoid")
            if obstacles == "avoid":
                assert (done.updates.rules == done.rules[0].index("avoiding")).any()
        assert walls["as-law"] > 0
        assert walls["avoid"] == 0

    def test_virtual_members_are_seen_by_the_law_and_stay_out_of_the_log(self) -> None:
        group = fields.group(count=2, law="tanner-switching", pipeline="perfect", obstacles="virtual-members")
        herd = assemble(trial(group), record=False)
        robot = herd.robots[0]
        poses_w = herd.world.fleet.poses(herd.world.data)
        senses, _ = robot.sense(herd.world.data, 0.0, herd.world_truth(0, poses_w), record=False)
        detection = robot.detect(senses)
        # the corridor's walls are 1.15 m from its middle: with a wider reach both become members
        robot.obstacle_stage.parameters = robot.obstacle_stage.parameters._replace(virtual_range_m=3.0)
        heeded = robot.heed(detection)
        assert len(heeded.members.ids) == len(detection.members.ids) + 2
        assert len(robot.detect(senses).members.ids) == len(detection.members.ids)
        assert run_trial(trial(group)).outcome == "done"

    def test_obstacles_are_selected(self) -> None:
        herd = assemble(
            trial(fields.group(count=2, law="turgut", pipeline="perfect", obstacle_selection="nearest")), record=False
        )
        robot = herd.robots[0]
        poses_w = herd.world.fleet.poses(herd.world.data)
        senses, _ = robot.sense(herd.world.data, 0.0, herd.world_truth(0, poses_w), record=False)
        detection = robot.detect(senses)
        assert len(detection.obstacles.points) >= 2
        assert len(robot.heed(detection).obstacles.points) == 1

    def test_plus_adds_avoidance_to_a_name_and_to_a_file(self, tmp_path: Path) -> None:
        path = tmp_path / "straight.py"
        path.write_text(STRAIGHT_ON)
        for law in ("snn+", f"{path}+"):
            group = plan("detection-case-study", repeats=1, law=law).trials[0].groups[0]
            assert group.law == law.removesuffix("+")
            assert group.setup["obstacles"] == "avoid"
        swept = plan("detection-case-study", repeats=1, sweep={"herd.law": ["snn", "snn+"]}).trials
        assert {fields.of_group(one.groups[0]).obstacles for one in swept} == {"as-law", "avoid"}


def test_sets_are_replaced_by_their_names() -> None:
    made = plan(
        "detection-case-study",
        repeats=1,
        law="couzin",
        settings={"herd.selection": "interaction: k-nearest(2); repulsion: nearest"},
    )
    steps = Resolved(made.trials[0].groups[0]).selections
    assert [[step.step.name for step in one] for one in steps] == [["NEAREST"], ["K_NEAREST"]]
    limited = plan("detection-case-study", repeats=1, law="couzin", settings={"herd.selection": "nearest"})
    steps = Resolved(limited.trials[0].groups[0]).selections
    assert [[step.step.name for step in one] for one in steps] == [["NEAREST", "DISTANCE_BASED"]] * 2


@pytest.mark.parametrize("change", [{"own_motion": "compass"}, {"association": "three"}, {"obstacles": "avoids"}])
def test_names_that_do_not_exist_are_refused(change: dict[str, str]) -> None:
    with pytest.raises(InputError, match=next(iter(change))):
        run_trial(trial(fields.group(**change)))  # type: ignore[arg-type]
