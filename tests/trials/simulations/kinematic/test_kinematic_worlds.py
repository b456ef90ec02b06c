"""The kinematic herd in environments: its walls, its start at the marker, and what is refused."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.errors import InputError
from generation.environment import Environment
from generation.files import to_json
from generation.primitives import Circle, Point, Polygon, Segment
from trials import keys, simulations
from trials.simulations.kinematic import herd as herds
from trials.simulations.kinematic.fields import group, trial
from trials.types import Trial

ROOM = Polygon(((0, 0), (8, 0), (8, 6), (0, 6)), "inside")
START = Point(2.0, 3.0, math.pi / 2)


def within(environment: Environment, law: str = "random-motion", count: int = 9, **given: Any) -> Trial:
    made = trial("test", 1, [group(law, count, speed_m_s=0.1)], world="unbounded", steps=200, timestep_s=1.0)
    made = dataclasses.replace(made, world="a.json", world_source=to_json(environment))
    for key, value in {"formation.spacing_m": 0.3, **given}.items():
        made = keys.put(made, key, value)
    return made


def test_nobody_leaves_a_room() -> None:
    """Random walkers with steps of 0.1 m in a room 8 m by 6 m: without walls a walk of 200 steps is 1.4 m wide, and
    those that start within 0.5 m of a wall would get beyond it."""
    made = within(Environment((ROOM,), markers={"start": Point(0.5, 0.5)}), count=25, **{"formation.spacing_m": 0.1})
    result = simulations.run_trial(made, reraise=True)
    x, y = result.poses_w[..., 0], result.poses_w[..., 1]
    assert (x > 0.0).all()
    assert (x < 8.0).all()
    assert (y > 0.0).all()
    assert (y < 6.0).all()
    assert len(result.walls_w) == 4
    free = simulations.run_trial(dataclasses.replace(made, world="unbounded", world_source=""), reraise=True)
    assert (free.poses_w[..., 0] - free.poses_w[0, :, 0].mean()).min() < -0.5


def test_a_start_is_that_of_open_space_moved_to_the_marker() -> None:
    made = within(Environment((ROOM,), markers={"start": START}))
    there = herds.assemble(made)
    free = herds.assemble(dataclasses.replace(made, world="unbounded", world_source=""))
    assert_allclose(there.poses_w[:, 0], 2.0 - free.poses_w[:, 1], atol=1e-12)
    assert_allclose(there.poses_w[:, 1], 3.0 + free.poses_w[:, 0], atol=1e-12)
    assert_allclose(there.poses_w[:, 2], free.poses_w[:, 2] + math.pi / 2, atol=1e-12)
    np.testing.assert_array_equal(there.speeds, free.speeds)


def test_goals_are_given_from_the_start() -> None:
    made = keys.put(within(Environment((ROOM,), markers={"start": START})), "herd.informed_share", 1.0)
    made = keys.put(keys.put(made, "herd.goal_x_m", 1.0), "herd.goal_y_m", 0.5)
    (band,) = herds.assemble(made).bands
    assert_allclose(band.goals_w, np.tile([3.0, 3.5], (9, 1)))


def test_an_environment_is_scaled() -> None:
    made = within(Environment((ROOM,), markers={"start": START}), **{"world.scale": 2.0})
    herd = herds.assemble(made)
    assert np.max(herd.space.walls) == 16.0
    assert_allclose(herd.poses_w[:, :2].mean(axis=0), [4.0, 6.0], atol=0.5)


@pytest.mark.parametrize(
    ("environment", "given", "words"),
    [
        (Environment((ROOM,), markers={"start": Point(0.1, 3.0)}), {}, "herd-. starts at .* m, (in|be).*a wall"),
        (Environment((ROOM,)), {}, "(inside|behind) a wall; expected a start within the world"),
        (Environment((ROOM,), markers={"start": START}), {"formation.spacing_m": 3.0}, "a smaller formation"),
        (
            Environment((ROOM, Segment(2, 0, 2, 6)), markers={"start": Point(2.01, 3.0)}),
            {},
            "walls keep it apart from the herd's start",
        ),
        (
            Environment((ROOM, Circle(2.0, 3.0, 0.1)), markers={"start": Point(2.0, 4.0)}),
            {"herd.radius_m": 0.9, "formation.spacing_m": 0.01},
            r"m into a wall",
        ),
        (Environment((ROOM,), markers={"start": START}), {"world.scale": 1e4}, "scale = 10000"),
    ],
)
def test_a_start_that_does_not_fit_is_refused_in_one_line(
    environment: Environment, given: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words) as refused:
        simulations.check(within(environment, **given))
    assert "\n" not in str(refused.value)


def test_the_worlds_of_robots_are_worlds_of_the_kinematic_herd() -> None:
    made = keys.put(within(Environment()), "world", "corridor")
    assert made.world_source == ""
    result = simulations.run_trial(keys.put(made, "world.width_m", 5.0), reraise=True)
    assert np.ptp(result.walls_w[:, 1]) == 5.0
    with pytest.raises(InputError, match="unknown world 'coridor'; did you mean corridor"):
        keys.put(made, "world", "coridor")


def test_what_another_world_has_no_place_for_is_left_behind() -> None:
    made = trial("test", 1, [group("vicsek", 9)], world="periodic", world_parameters={"size_m": 5.0})
    assert keys.put(made, "world", "bounded").world_parameters == {"size_m": 5.0}
    assert keys.put(made, "world", "unbounded").world_parameters == {}


class TestPosesOfAFile:
    CSV = "x_m,y_m,heading_deg\n1,1,0\n2,2,90\n3,1,-90\n"

    def of(self, text: str, environment: Environment | None = None, **given: Any) -> Trial:
        made = within(environment or Environment((ROOM,), markers={"start": START}), count=3)
        made = dataclasses.replace(made, formation="p.csv", formation_source=text, formation_parameters={})
        for key, value in given.items():
            made = keys.put(made, key, value)
        return made

    def test_members_stand_where_the_file_says_whatever_the_marker(self) -> None:
        made = self.of(self.CSV)
        simulations.check(made)
        again = Trial.from_dict(made.as_dict())
        assert again == made
        poses = simulations.run_trial(again, reraise=True).poses_w[0]
        assert_allclose(poses, [[1, 1, 0], [2, 2, math.pi / 2], [3, 1, -math.pi / 2]], atol=1e-12)

    @pytest.mark.parametrize(
        ("text", "given", "words"),
        [
            (CSV.replace("3,1", "9,1"), {}, r"herd-3 starts at \(9.00, 1.00\) m, behind a wall"),
            (CSV, {"herd.radius_m": 0.8}, "herd-1 and herd-2 overlap by 0.19 m"),
            (CSV, {"herd.count": 4}, "p.csv has 3 poses for 4 members"),
            (CSV.replace("3,1", "3,x"), {}, "p.csv, line 4"),
        ],
    )
    def test_what_does_not_fit_is_refused(self, text: str, given: dict[str, Any], words: str) -> None:
        with pytest.raises(InputError, match=words):
            simulations.check(self.of(text, **given))

    def test_they_must_be_within_a_sized_world(self) -> None:
        made = dataclasses.replace(
            self.of(self.CSV), world="bounded", world_source="", world_parameters={"size_m": 2.5}
        )
        with pytest.raises(InputError, match=r"p.csv: \(3, 1\) m is outside of the world; expected 0 to 2.5 m"):
            simulations.check(made)

    def test_a_trial_without_them_is_what_it_was(self) -> None:
        assert "formation_source" not in within(Environment()).as_dict()
