"""Several groups of robots in one trial, each with its own body, law, pipeline and formation."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import trials.studies
from flocking.errors import InputError
from generation.environment import Environment
from generation.primitives import Polygon
from trials import design, keys, simulations
from trials.simulations.robots import fields
from trials.simulations.robots.herd import assemble
from trials.simulations.robots.starts import check_starts, starting_poses
from trials.types import Trial
from worlds.starts import Starting

EXPERIMENT = '''
"""A pursuer beside a herd."""

from trials.simulations.robots.fields import group, trial

REPEATS = 1
CONDITIONS = {"pursuer.speed_m_s": (0.2, 0.4)}


def base(repeat):
    herd = group("vicsek", 3)
    pursuer = group(
        "snn", 1, name="pursuer", pipeline="perfect", formation="scattered", start_x_m=-4.0, speed_m_s=0.4
    )
    pilots = group(
        "extended-hamilton", 2, name="pilots", body="create-small", pipeline="sensor-based", formation="single-group",
        start_x_m=4.0, start_heading_deg=180.0,
    )
    return trial("pursuit", repeat, [herd, pursuer, pilots], duration_s=3.0)
'''


def pursuit(**pursuer: object) -> Trial:
    """Three Creates in the trial's formation, and one elsewhere that heads for the nearest of them."""
    given = {"count": 1, "name": "pursuer", "formation": "single-group", "start_x_m": -4.0, **pursuer}
    groups = [fields.group(count=3), fields.group("snn", **given)]  # type: ignore[arg-type]
    return fields.trial("pursuit", 1, groups, duration_s=3.0)


@pytest.fixture
def experiment(tmp_path: Path) -> Iterator[str]:
    (tmp_path / "pursuits").mkdir()
    (tmp_path / "pursuits" / "__init__.py").touch()
    (tmp_path / "pursuits" / "pursuit.py").write_text(EXPERIMENT)
    trials.studies.__path__.append(str(tmp_path))
    yield "pursuit"
    trials.studies.__path__.pop()
    for name in [name for name in sys.modules if name.startswith("trials.studies.pursuits")]:
        del sys.modules[name]


class TestFromAFile:
    def test_each_group_has_its_own_law_body_pipeline_and_formation(self, experiment: str) -> None:
        plan = design.plan(experiment)
        for trial in plan.trials:
            simulations.check(trial)
        result = simulations.run_trial(plan.trials[1], scans="all", reraise=True)
        assert result.robot_names == ("herd-1", "herd-2", "herd-3", "pursuer-1", "pilots-1", "pilots-2")
        assert len({result.rules[0], result.rules[3], result.rules[4]}) == 3
        assert result.radii[0] > result.radii[4]
        speeds = np.abs(result.updates.commands[result.updates.robots == 3, 0])
        assert 0.25 < speeds.max() <= 0.4
        pursuer_start, pilots_start = result.poses_w[0, 3], result.poses_w[0, 4:]
        assert pursuer_start[0] < -0.9
        assert pilots_start[:, 0].mean() == pytest.approx(4.0, abs=0.2)  # the jitter is 0.05 m
        assert np.all(np.abs(np.abs(pilots_start[:, 2]) - math.pi) <= math.radians(30.0))

    def test_every_key_has_its_groups_name(self, experiment: str) -> None:
        changed = design.plan(experiment, settings={"pilots.law.exclusion_m": 0.2, "herd.count": 4}).trials[0]
        assert changed.groups[2].law_parameters["exclusion_m"] == 0.2
        assert [group.count for group in changed.groups] == [4, 1, 2]
        with pytest.raises(InputError, match=r"unknown parameter 'pilot\.count'; did you mean pilots\.count"):
            design.plan(experiment, settings={"pilot.count": 3})

    def test_a_law_by_its_option_is_the_herds(self, experiment: str) -> None:
        plan = design.plan(experiment, law="couzin")
        assert [group.law for group in plan.trials[0].groups] == ["couzin", "snn", "extended-hamilton"]
        assert plan.notes == ["--law is of herd; of another group: --set pursuer.law=couzin"]


class TestFormations:
    def test_the_others_stand_as_if_the_group_were_not_there(self) -> None:
        alone = fields.trial("pursuit", 1, [fields.group(count=3)], duration_s=3.0)
        np.testing.assert_array_equal(starting_poses(pursuit())[:3], starting_poses(alone))

    def test_a_formation_is_turned_and_put_where_the_group_says(self) -> None:
        plain = starting_poses(pursuit(count=4))[3:]
        turned = starting_poses(pursuit(count=4, start_x_m=1.0, start_y_m=2.0, start_heading_deg=90.0))[3:]
        x, y = plain[:, 0] + 4.0, plain[:, 1]
        expected = np.stack([1.0 - y, 2.0 + x, plain[:, 2] + math.pi / 2], axis=1)
        np.testing.assert_allclose(turned, expected, atol=1e-12)

    def test_a_groups_own_formation_has_parameters_of_its_own(self) -> None:
        changed = keys.put(pursuit(count=4), "pursuer.formation.spacing_m", 0.5)
        wide, close = (starting_poses(trial)[3:, :2] for trial in (pursuit(count=4), changed))
        # both have the same jitter about places that are twice as far apart
        block = np.array([[0.5, 0.5], [0.5, -0.5], [-0.5, 0.5], [-0.5, -0.5]])
        np.testing.assert_allclose(wide - close, 0.5 * block, atol=1e-12)
        np.testing.assert_array_equal(starting_poses(changed)[:3], starting_poses(pursuit())[:3])
        assert {row.key: row.value for row in keys.rows(changed)}["pursuer.formation.spacing_m"] == 0.5
        with pytest.raises(InputError, match=r"unknown parameter 'herd\.formation\.spacing_m'"):
            keys.put(pursuit(), "herd.formation.spacing_m", 0.5)  # it has none of its own

    def test_the_trials_formation_has_parameters(self) -> None:
        trial = keys.put(pursuit(count=1), "formation.heading_spread_deg", 0.0)
        assert np.all(starting_poses(trial)[:3, 2] == 0.0)
        with pytest.raises(InputError, match=r"formation\.jitter_m = -1"):
            keys.put(pursuit(), "formation.jitter_m", -1.0)

    def test_repeats_differ_and_conditions_do_not(self) -> None:
        first, same = starting_poses(pursuit()), starting_poses(pursuit(speed_m_s=0.1))
        np.testing.assert_array_equal(first, same)
        second = fields.trial("pursuit", 2, pursuit().groups, duration_s=3.0)
        assert np.all(starting_poses(second)[:, :2] != first[:, :2])

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"start_x_m": 0.0, "count": 3}, "overlap by .* expected formations that stand apart"),
            ({"start_y_m": 1.05}, r"pursuer-1 starts at .* reaches 0\.\d\d m into a wall; expected a start within"),
            ({"start_y_m": 1.1}, r"pursuer-1 starts at .* m, inside a wall; expected a start within the world"),
            ({"start_y_m": 30.0}, r"pursuer-1 starts at .* m, behind a wall; expected a start within the world"),
            ({"formation": "single"}, r"unknown formation 'single'; did you mean single-file or single-group"),
            ({"name": "herd"}, "two groups are called 'herd'"),
            ({"name": "world"}, "group 'world': expected a name of letters"),
            ({"body": "creates"}, r"unknown body 'creates'; did you mean create"),
        ],
    )
    def test_what_cannot_be_is_refused(self, change: dict[str, object], words: str) -> None:
        with pytest.raises(InputError, match=words):
            simulations.check(pursuit(**change))


def test_a_start_in_a_pillar_is_named_as_inside_a_wall() -> None:
    """Wide enough that its middle lies far behind its faces; beside it there is room."""
    pillar = Environment((Polygon(((0, -1), (0, 1), (2, 1), (2, -1))),))
    start, beside, radii = np.array([[1.0, 0.0, 0.0]]), np.array([[3.0, 0.0, 0.0]]), np.array([0.165])
    alone = np.array([True])
    check_starts(Starting(["herd-1"], beside, radii, alone), pillar)
    with pytest.raises(InputError, match=r"herd-1 starts at \(1.00, 0.00\) m, inside a wall"):
        check_starts(Starting(["herd-1"], start, radii, alone), pillar)


def test_each_group_has_streams_of_its_own() -> None:
    """Members with the same law and number in different groups draw different random numbers."""
    herd = assemble(pursuit(count=3), record=False)
    draws = [robot.law_rng.random() for robot in herd.robots]
    assert len(set(draws)) == len(draws)
