"""Running herds: scripts, starts, measures on ways that are made up, point masses and robots for a moment."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr
from numpy.testing import assert_allclose, assert_array_equal

from flocking.errors import InputError
from flocking.herding.loop import no_touching
from flocking.types import Floats
from trials import simulations
from trials.simulations.running import fields, herd, loop, script
from trials.simulations.running.creatures import Legged
from trials.simulations.running.limbs import limbs_of, replayed
from trials.simulations.running.measures import measure
from trials.types import Trial, TrialResult


def trial(count: int = 20, body: str = "particles", repeat: int = 1, **setup: Any) -> Trial:
    group = fields.herd(count, body=body, **{key: setup.pop(key) for key in ("velocities", "users") if key in setup})
    return fields.trial("a-test", repeat, group, **{"duration_s": 2.0, **setup})


class TestScript:
    def test_a_velocity_alone_is_for_all_of_the_time(self) -> None:
        assert script.parse("2, -1") == (script.Leg(0.0, 2.0, -1.0),)

    def test_the_leg_at_a_time_is_the_last_that_has_begun(self) -> None:
        legs = script.parse("0: 2, 0; 30: 3, 0; 60: 1.5, 0")
        assert [script.at(legs, time).x_m_s for time in (-5.0, 0.0, 29.9, 30.0, 1e3)] == [2.0, 2.0, 2.0, 3.0, 1.5]

    @pytest.mark.parametrize(
        "text", ["", "2", "1: 2, 0", "0: 2, 0; 0: 3, 0", "0: 2, 0; x: 3, 0", "nan, 0", "0: 1, 2, 3"]
    )
    def test_what_is_none_is_refused(self, text: str) -> None:
        with pytest.raises(InputError, match="expected"):
            script.parse(text)


class TestStart:
    def test_the_herd_fills_an_ellipse_evenly_behind_its_user_in_the_middle(self) -> None:
        made = trial(count=105)
        start = herd.start_of(dataclasses.replace(made, formation_parameters={"jitter_m": 0.0}))
        x, y = start.positions.T
        # a share of 1.2 m each way: the ellipse has the area of 105 of them
        along = 1.2 * math.sqrt(105 / (math.pi * 0.6))
        assert np.hypot(x / along, y / (0.6 * along)).max() <= 1.0
        assert np.abs(start.positions.mean(axis=0)).max() < 0.1
        assert np.hypot(*start.positions[0]) == np.hypot(x, y).min()
        # of an even ellipse the root of the moments' ratio is its aspect; 105 places are even to some percent
        assert y.std() / x.std() == pytest.approx(0.6, abs=0.03)

    def test_both_bodies_start_at_the_same_places_and_repeats_at_others(self) -> None:
        first, second = herd.start_of(trial()), herd.start_of(trial(repeat=2))
        assert_array_equal(first.positions, herd.start_of(trial(body="one-legged")).positions)
        assert not np.array_equal(first.positions, second.positions)

    @pytest.mark.parametrize(
        ("setup", "words"),
        [
            ({"settle_s": 2.0}, "settle_s = 2: expected less"),
            ({"duration_s": 1e5, "every_s": 0.01, "count": 10_000}, "every_s"),
        ],
    )
    def test_what_does_not_fit_is_refused(self, setup: dict[str, Any], words: str) -> None:
        with pytest.raises(InputError, match=words):
            simulations.check(trial(**setup))

    def test_robots_refuse_a_start_that_they_cannot_run(self) -> None:
        fast = {"formation_parameters": {"speed_m_s": 9.0}}
        with pytest.raises(InputError, match=r"formation\.speed_m_s = 9: expected at most 3.5"):
            simulations.check(dataclasses.replace(trial(body="one-legged"), **fast))  # type: ignore[arg-type]
        simulations.check(dataclasses.replace(trial(), **fast))  # type: ignore[arg-type]

    def test_no_more_can_break_away_than_there_are(self) -> None:
        with pytest.raises(InputError, match=r"formation\.breakaway = 20: expected fewer"):
            simulations.check(dataclasses.replace(trial(), formation_parameters={"breakaway": 20}))

    def test_a_breakaway_group_starts_behind_by_its_gap(self) -> None:
        apart = {"breakaway": 30, "breakaway_m": 12.0, "jitter_m": 0.0}
        x = herd.start_of(dataclasses.replace(trial(105), formation_parameters=apart)).positions[:, 0]
        assert x[:75].min() - x[75:].max() == pytest.approx(12.0)

    def test_a_law_that_no_user_can_steer_needs_none(self) -> None:
        group = dataclasses.replace(fields.herd(5), law="vicsek", selection="all")
        with pytest.raises(InputError, match="expected users = 0"):
            simulations.check(fields.trial("a-test", 1, group))

    def test_robots_refuse_a_time_step_that_their_control_cannot_keep(self) -> None:
        with pytest.raises(InputError, match="timestep_s"):
            simulations.run_trial(trial(body="one-legged", timestep_s=0.02), reraise=True)


def made_up(places: Floats, every_s: float = 0.5, fallen: dict[int, float] | None = None, **setup: Any) -> TrialResult:
    """A trial whose creatures went these ways (T, N, 2)."""
    times = every_s * np.arange(len(places))
    count = places.shape[1]
    own = trial(count, duration_s=max(float(times[-1]), 0.1), **setup)
    fallen_s = np.full(count, math.nan)
    for member, time in (fallen or {}).items():
        fallen_s[member] = time
    result = simulations.run_trial(trial(count, duration_s=0.01), reraise=True)
    disc = np.array([[10.0, 0.0, 2.0]]) if setup.get("obstacle_radius_m") else np.empty((0, 3))
    poses = np.concatenate([places, np.zeros((*places.shape[:2], 1))], axis=2)
    tables = {"obstacle": disc, "fallen_s": fallen_s, "causes": np.full(count, "")}
    return dataclasses.replace(result, trial=own, times=times, poses_w=poses, tables=tables)


def straight(starts: Any, velocity: Any, moments: int = 41, every_s: float = 0.5) -> Floats:
    at = every_s * np.arange(moments)[:, None, None]
    ways: Floats = np.asarray(starts, dtype=np.float64)[None] + at * np.asarray(velocity, dtype=np.float64)
    return ways


SQUARE = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]]


class TestMeasures:
    def test_a_square_that_runs_on(self) -> None:
        found = measure(made_up(straight(SQUARE, [2.0, 0.0])), 3, 0.4)
        assert found["radius_end"] == pytest.approx(math.sqrt(2.0))
        assert found["aspect_end"] == pytest.approx(1.0)
        assert found["speed_ratio"] == pytest.approx(1.0)
        assert found["unrest"] == pytest.approx(0.0, abs=1e-9)
        assert found["ahead_1"] == pytest.approx(1.0)
        assert found["user_away"] == pytest.approx(math.sqrt(2.0))
        assert found["off_course"] == pytest.approx(0.0, abs=1e-9)
        assert (found["groups_end"], found["breakaways"], found["regroup_s"]) == (1.0, 0.0, 0.0)
        assert found["collisions_a_minute"] == pytest.approx(9.0)  # three in 20 s
        assert math.isnan(found["obstacle_hits"])

    def test_each_leg_has_its_own_way_ahead(self) -> None:
        places = straight(SQUARE, [2.0, 0.0])
        places[21:, 0, 0] += 3.0  # after the moment that ends one leg and begins the next
        found = measure(made_up(places, script="0: 2, 0; 10: 2, 0"), 0, 1.0)
        assert found["ahead_1"] == pytest.approx(1.0)
        # 3 m further ahead of a centre that lies a quarter of that further ahead too
        # of the seven moments of the leg's first third the first is that of the change
        assert found["ahead_2"] == pytest.approx(1.0 + 6.0 / 7.0 * 0.75 * 3.0)
        assert math.isnan(found["ahead_3"])

    def test_a_herd_that_splits_for_a_while_regroups(self) -> None:
        places = straight(SQUARE, [2.0, 0.0])
        places[10:20, :2, 0] += 10.0
        found = measure(made_up(places), 0, 1.0)
        assert found["groups_most"] == 2.0
        assert found["regroup_s"] == pytest.approx(5.0)
        assert found["breakaways"] == 0.0

    def test_a_group_that_breaks_away_for_good_is_counted(self) -> None:
        starts = [[0.0, 0.0], *([x, y] for x in (1.0, 2.0, 3.0) for y in (-1.0, 0.0, 1.0))]
        places = straight(starts, [2.0, 0.0])
        places[10:, 7:, 0] += 10.0
        found = measure(made_up(places), 0, 1.0)
        assert (found["breakaways"], found["strays"], found["user_lost"]) == (1.0, 0.0, 0.0)
        assert math.isnan(found["regroup_s"])
        assert found["largest_share_end"] == pytest.approx(6.0 / 9.0)

    def test_one_that_strays_and_a_user_that_is_lost_are_no_groups(self) -> None:
        starts = [[0.0, 0.0], *([x, y] for x in (1.0, 2.0, 3.0) for y in (-1.0, 0.0, 1.0))]
        places = straight(starts, [2.0, 0.0])
        places[10:, 9, 0] += 10.0
        places[10:, 0, 0] -= 20.0
        found = measure(made_up(places), 0, 1.0)
        assert (found["groups_end"], found["breakaways"], found["strays"], found["user_lost"]) == (2.0, 0.0, 1.0, 1.0)

    def test_a_herd_that_passes_the_obstacle_on_both_sides_is_parted_until_it_closes(self) -> None:
        starts = [[0.0, 0.2], [0.0, 0.4], [0.0, -0.4], [0.0, -0.2]]
        places = straight(starts, [2.0, 0.0])
        places[:, :, 1] *= np.where((places[:, :1, 0] > 6.0) & (places[:, :1, 0] < 14.0), 12.0, 1.0)
        found = measure(made_up(places, obstacle_radius_m=2.0), 0, 1.0)
        assert found["parted_m"] == pytest.approx(12.0 * (0.4 + 0.2))  # of those who follow
        assert found["rejoin_s"] == pytest.approx(3.5)  # from 7 m to 14 m, a moment each half second
        assert found["obstacle_hits"] == 0.0

    def test_the_lag_is_the_delay_with_which_the_herd_does_as_told(self) -> None:
        at = 0.5 * np.arange(81)
        late = np.clip(at - 10.0 - 3.0, 0.0, None)  # the turn is told at 10 s and done at 13 s
        centre = np.column_stack([2.0 * at - 2.0 * late, 2.0 * late])
        places = centre[:, None] + np.array(SQUARE)[None]
        found = measure(made_up(places, script="0: 2, 0; 10: 0, 2"), 0, 1.0)
        assert found["lag_s"] == pytest.approx(3.0, abs=0.25)  # a moment each half second
        assert math.isnan(measure(made_up(places), 0, 1.0)["lag_s"])

    def test_a_gait_is_no_unrest_and_a_creature_that_drifts_is(self) -> None:
        at = 0.1 * np.arange(401)
        swing = 0.05 * np.sin(2.0 * np.pi * at / 0.5)[:, None] * np.array([1.0, -1.0, 1.0, -1.0])
        places = straight(SQUARE, [2.0, 0.0], 401, 0.1)
        places[:, :, 0] += swing
        assert measure(made_up(places, 0.1), 0, 1.0)["unrest"] < 0.001
        places[:, 0, 1] += 0.1 * at
        # one of four goes 0.1 m/s aside: 0.075 from the mean, and three 0.025
        expected = math.sqrt((0.075**2 + 3 * 0.025**2) / 4)
        assert measure(made_up(places, 0.1), 0, 1.0)["unrest"] == pytest.approx(expected, rel=0.02)

    def test_a_user_that_fell_counts_no_more(self) -> None:
        places = straight(SQUARE, [2.0, 0.0])
        places[20:, 0] = places[20, 0]
        found = measure(made_up(places, fallen={0: 9.9}), 0, 1.0)
        assert found["user_away"] == pytest.approx(math.sqrt(2.0), abs=0.2)
        assert math.isnan(found["user_lost"])

    def test_who_fell_counts_as_fallen_and_no_more(self) -> None:
        places = straight(SQUARE, [2.0, 0.0])
        places[20:, 3] = places[20, 3]
        found = measure(made_up(places, fallen={3: 10.0}), 0, 1.0)
        assert (found["upright"], found["falls"], found["groups_end"]) == (0.75, 1.0, 1.0)
        assert found["speed_end"] == pytest.approx(2.0)

    def test_who_runs_through_the_obstacle_hits_it_between_two_moments_too(self) -> None:
        starts = [[0.0, 0.5], [-1.0, 2.1], [-2.0, 1.9], [-3.0, -5.0]]
        places = straight(starts, [8.0, 0.0])  # 4 m from moment to moment
        found = measure(made_up(places, obstacle_radius_m=2.0, collision_m=0.0), 0, 1.0)
        assert found["obstacle_hits"] == 2.0
        wide = measure(made_up(places, obstacle_radius_m=2.0, collision_m=0.3), 0, 1.0)
        assert wide["obstacle_hits"] == 3.0  # bodies touch it whose middle passes 0.1 m beside
        assert found["first_hits"] == 1.0


class TestRuns:
    def test_the_same_trial_gives_the_same_result_and_its_recording(self, tmp_path: Path) -> None:
        own = trial(obstacle_radius_m=1.0, obstacle_ahead_m=6.0)
        first, second = (simulations.run_trial(own, reraise=True) for _ in range(2))
        assert_array_equal(first.poses_w, second.poses_w)
        assert first.times[-1] == pytest.approx(2.0)
        assert len(first.walls_w) > 0
        simulations.record(first, tmp_path / "a.rrd")
        assert (tmp_path / "a.rrd").stat().st_size > 1000

    def test_of_point_masses_desired_velocities_are_actual_ones(self) -> None:
        told = [simulations.run_trial(trial(velocities=name), reraise=True).poses_w for name in ("desired", "actual")]
        assert_array_equal(*told)

    def test_the_script_counts_from_the_tests_begin(self) -> None:
        own = trial(1, settle_s=1.0, script="0: 2, 0; 0.5: 0, 1")
        end = simulations.run_trial(own, reraise=True).poses_w[-1, 0, :2]
        start = herd.start_of(own).positions[0]
        # 1 s before the test and half a second in it along x, half a second along y
        assert_allclose(end - start, [3.0, 0.5], atol=1e-9)

    def test_errors_about_others_change_what_a_creature_does(self) -> None:
        own = trial()
        wrong = dataclasses.replace(own, groups=(fields.herd(20, place_error_m=0.2),))
        ways = [simulations.run_trial(each, reraise=True).poses_w for each in (own, wrong)]
        assert np.abs(ways[0] - ways[1]).max() > 0.01

    def test_a_law_that_fails_fails_its_trial(self, tmp_path: Path) -> None:
        path = tmp_path / "bad.py"
        path.write_text(BAD)
        group = dataclasses.replace(fields.herd(3, users=0), law=str(path), law_source=BAD)
        result = simulations.run_trial(fields.trial("a-test", 1, group, duration_s=0.1))
        assert result.outcome == "failed"
        assert "for member 1 at step 1" in result.reason


BAD = '''"""A law that gives no number. Source: a test."""
import math
from typing import NamedTuple

from flocking.types import Kind, Motion

RULES = ("bad",)


class Parameters(NamedTuple):
    """None."""


def law(own, members, sets, obstacles, parameters, memory, u):
    return Motion(Kind.VELOCITY, math.nan, 0.0, 0)
'''


class TestRobots:
    def test_they_run_as_their_user_is_told_and_stay_upright(self) -> None:
        result = simulations.run_trial(trial(15, "one-legged", duration_s=6.0))
        assert result.measures["upright"] == 1.0
        x, y = result.poses_w[-1, :, :2].mean(axis=0) - result.poses_w[0, :, :2].mean(axis=0)
        # robots hop on from 2 m/s and keep it to a tenth
        assert x == pytest.approx(12.0, abs=1.2)
        assert abs(y) < 1.2

    def test_a_recording_shows_their_limbs_where_they_were(self, tmp_path: Path) -> None:
        own = trial(4, "one-legged", duration_s=0.6)
        result = simulations.run_trial(own, reraise=True)
        limbs = limbs_of("one-legged")
        moments = replayed(own, limbs)
        assert [limb.name for limb in limbs] == ["trunk", "thigh", "shin", "foot"]
        assert moments.shape == (len(result.times), 4, 4, 7)
        # the trunk's middle is the hip, which is where the robot is; single precision keeps 1e-6 of some metres
        assert_allclose(moments[:, 0, :, :2], result.poses_w[:, :, :2], atol=1e-5)
        assert_allclose(np.linalg.norm(moments[..., 3:], axis=-1), 1.0, atol=1e-5)
        heights = moments[..., 2]
        assert (heights[:, 0] > heights[:, 1]).all()
        assert (heights[:, 1] > heights[:, 2]).all()
        assert (heights[:, 2] > heights[:, 3]).all()
        simulations.record(result, tmp_path / "a.rrd")
        entities = {chunk.entity_path for chunk in rr.chunk.RrdReader(tmp_path / "a.rrd").stream()}
        assert {f"/space/{limb.name}" for limb in limbs} <= entities

    def test_one_that_is_knocked_over_lies_where_it_fell_and_is_not_seen(self) -> None:
        own = trial(6, "one-legged", duration_s=3.0)
        creatures = loop.built(own)
        assert isinstance(creatures, Legged)
        first = creatures.model.jnt_dofadr[creatures.model.body_jntadr[creatures.fleet.root_bodies[2]]]
        creatures.data.qvel[first + 3 : first + 6] = [0.0, 25.0, 0.0]  # rad/s: head over heels
        ran = loop.run(own, creatures, no_touching(6, 0.46, 10))
        fallen = creatures.fallen_at
        assert np.isfinite(fallen).tolist() == [False, False, True, False, False, False]
        assert fallen[2] < 2.0
        assert creatures.causes[2] != ""
        assert not creatures.mind.there[2]
        assert (creatures.mind.herd.seen[0, : creatures.mind.herd.counts[0]] != 2).all()
        others = ran.poses_w[-1, [0, 1, 3, 4, 5], 0] - ran.poses_w[0, [0, 1, 3, 4, 5], 0]
        assert others.min() > 3.0  # the others ran on at about 2 m/s
