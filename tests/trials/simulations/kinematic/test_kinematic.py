"""Kinematic trials: starts, measures in closed form, what a trial is made of, and what goes wrong."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Floats
from trials import keys, simulations
from trials.batch import series
from trials.simulations.kinematic import fields, formations, places
from trials.simulations.kinematic.fields import group, trial
from trials.simulations.kinematic.recordings import write
from trials.simulations.tracks import period_of, strips
from trials.types import Trial

EXACT = 1e-9
"""Relative error of sums over a few hundred steps in double precision."""
ORDERS = ("own", "backward", "forward")
FAILING = '''
import math
from typing import NamedTuple
from flocking.types import Kind, Motion

NEEDS = frozenset({"positions"})


class Parameters(NamedTuple):
    pass


def law(own, members, sets, obstacles, parameters, memory, u):
    """Straight on; the third member returns nan."""
    return Motion(Kind.VELOCITY, math.nan if own.id == 2 else 0.1, 0.0, 0)
'''


def straight(count: int = 20, steps: int = 40, world: str = "unbounded", **given: Any) -> Trial:
    """Members that all go straight on along x: Vicsek's rule without noise from a common heading."""
    parameters = {"heading_spread_deg": 0.0}
    return trial(
        "test",
        1,
        [group("vicsek", count, law_parameters={"noise_rad": 0.0}, **given)],
        world=world,
        formation_parameters=parameters,
        steps=steps,
    )


def start(formation: str, count: int = 50, size_m: float = math.inf, seed: int = 1, **given: Any) -> Floats:
    parameters = places.FORMATION_PARAMETERS[formation](**{"spacing_m": 0.5, **given})
    return formations.poses(formation, parameters, count, size_m, np.random.default_rng(seed))


class TestStart:
    def test_split_groups_stand_apart_by_their_gap(self) -> None:
        starts = np.array([start("split-group", 400, seed=seed, gap_m=9.9) for seed in range(50)])
        middles = starts[:, :200, 0].mean(axis=1), starts[:, 200:, 0].mean(axis=1)
        side = 0.5 * math.sqrt(200)
        error = math.sqrt(2.0 * side**2 / 12.0 / (200 * 50))  # of the difference of two means of uniform numbers
        assert np.mean(middles[1] - middles[0]) == pytest.approx(9.9, abs=4.0 * error)
        assert np.ptp(starts[:, :200, 0], axis=1).max() <= side
        assert np.ptp(starts[:, 200:, 1], axis=1).max() <= side

    def test_an_odd_member_goes_to_one_of_the_groups(self) -> None:
        assert (start("split-group", 7)[:, 0] > 0.0).sum() == 4

    def test_single_group_has_the_spacing_of_its_law(self) -> None:
        places = start("single-group", 10_000)[:, :2]
        assert np.abs(places).max() <= 0.5 * 0.5 * 100.0
        assert np.ptp(places, axis=0) == pytest.approx(50.0, rel=0.01)  # 10⁴ draws come that near to both ends

    def test_every_inner_member_of_a_triangular_lattice_has_six_neighbours_at_the_spacing(self) -> None:
        places = start("triangular-lattice", 100)[:, :2]
        gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + 10.0 * np.eye(100)
        assert gaps.min(axis=1) == pytest.approx(0.5, rel=EXACT)
        touching = (gaps < 0.5 * (1.0 + EXACT)).sum(axis=1)
        assert touching.max() == 6
        assert (touching == 6).sum() > 50
        assert places.mean(axis=0) == pytest.approx(0.0, abs=EXACT)

    def test_square_lattice_of_a_hundred_is_ten_by_ten(self) -> None:
        places = start("square-lattice", 100)[:, :2]
        assert [len(np.unique(places[:, k].round(6))) for k in (0, 1)] == [10, 10]

    def test_uniform_fills_a_sized_world_and_nothing_beside_it(self) -> None:
        places = start("uniform", 4000, size_m=12.0)[:, :2]
        assert places.min() >= 0.0
        assert places.max() <= 12.0
        assert places.mean(axis=0) == pytest.approx(6.0, abs=4.0 * 12.0 / math.sqrt(12.0 * 4000))

    def test_a_start_wider_than_its_world_is_refused_with_the_size_that_would_do(self) -> None:
        with pytest.raises(InputError, match=r"split-group.*8 m; .*world\.size_m=1[0-9]"):
            start("split-group", 50, size_m=8.0, gap_m=9.9)

    def test_repeats_differ_and_conditions_share_their_start(self) -> None:
        one = trial("test", 1, [group("vicsek", 10)], steps=1)
        other = dataclasses.replace(one, groups=(group("couzin", 10),), formation_parameters={"spacing_m": 0.5})
        again = dataclasses.replace(one, repeat=2)
        first, second, third = (simulations.run_trial(t).poses_w[0] for t in (one, other, again))
        side = 0.5 * math.sqrt(10.0)
        assert first - [side / 2, side / 2, 0] == pytest.approx(second, abs=EXACT)  # periodic, unbounded
        assert not np.isclose(first, third).any()


class TestMeasures:
    @pytest.mark.parametrize("world", ["unbounded", "periodic"])
    def test_members_that_go_straight_on_together(self, world: str) -> None:
        result = simulations.run_trial(straight(steps=400, world=world, informed_share=0.1))
        found = result.measures
        way = 400 * 0.03
        assert found["net_displacement"] == pytest.approx(way, rel=EXACT)
        assert found["distance_travelled"] == pytest.approx(way, rel=EXACT)
        for name in ("polarization", "relative_speed", "directedness", "goal_alignment"):
            assert found[name] == pytest.approx(1.0, rel=1e-7), name
        assert found["group_speed"] == pytest.approx(0.03, rel=1e-7)
        assert found["mmd_end"] == pytest.approx(found["mmd_start"], rel=1e-7)
        assert found["groups_end"] == found["groups_start"]

    def test_a_goal_behind_them_turns_the_sign_of_the_alignment(self) -> None:
        result = simulations.run_trial(straight(informed_share=1.0, goal_x_m=-1e9))
        assert result.measures["goal_alignment"] == pytest.approx(-1.0, rel=EXACT)

    def test_nobody_informed_leaves_nothing_to_measure(self) -> None:
        assert math.isnan(simulations.run_trial(straight()).measures["goal_alignment"])

    def test_two_far_groups_are_two_and_half_the_members_each(self) -> None:
        far = trial(
            "test",
            1,
            [group("lch-member-pose", 50, selection="distance-based(0, 3)")],
            formation="split-group",
            formation_parameters={"gap_m": 40.0},
            steps=75,
        )
        found = simulations.run_trial(far).measures
        assert found["groups_end"] == 2.0
        assert found["largest_share_end"] == 0.5
        assert found["split_entropy"] == pytest.approx(1.0, rel=0.1)  # before they are compact there are more
        assert found["mmd_end"] == pytest.approx(20.0, abs=0.5)  # each group's centre varies by 2.5 / sqrt(12 · 25)


class TestResult:
    def test_it_packs_and_unpacks_as_any_other(self) -> None:
        result = simulations.run_trial(straight())
        again = series.unpack(series.pack(result))
        assert series.pack(again) == series.pack(result)
        assert again.trial == result.trial
        assert np.array_equal(again.poses_w, result.poses_w)

    def test_equal_trials_give_equal_bytes_and_order_of_turns_matters(self) -> None:
        noisy = trial("test", 1, [group("vicsek", 30, law_parameters={"noise_rad": 1.0})], steps=20)
        packed = [series.pack(simulations.run_trial(noisy)) for _ in range(2)]
        assert packed[0] == packed[1]
        turns = simulations.run_trial(keys.put(noisy, "synchronous", False))
        assert not np.allclose(turns.poses_w[-1], simulations.run_trial(noisy).poses_w[-1])

    def test_only_every_so_many_steps_are_kept(self) -> None:
        result = simulations.run_trial(keys.put(straight(steps=40), "every", 10))
        assert result.times == pytest.approx([0.0, 10.0, 20.0, 30.0, 40.0])

    def test_a_law_that_fails_fails_its_trial_and_is_named_with_member_and_step(self, tmp_path: Path) -> None:
        (tmp_path / "mine.py").write_text(FAILING)
        failing = keys.put(straight(count=5), "herd.law", str(tmp_path / "mine.py"))
        result = simulations.run_trial(failing)
        assert result.outcome == "failed"
        assert "mine.py" in result.reason
        assert "member 3 at step 1" in result.reason
        assert result.poses_w.shape == (1, 5, 3)
        with pytest.raises(ValueError, match=r"mine\.py"):
            simulations.run_trial(failing, reraise=True)

    @pytest.mark.parametrize("world", ["periodic", "obstacles"])
    def test_its_recording_is_written(self, tmp_path: Path, world: str) -> None:
        from rerun.chunk import RrdReader

        result = simulations.run_trial(straight(steps=200, world=world))
        write(result, tmp_path / "trial.rrd")
        entities = {str(chunk.entity_path) for chunk in RrdReader(tmp_path / "trial.rrd").stream()}
        assert {"/world/members", "/world/headings", "/world/trails", "/world/walls"} <= entities

    def test_a_way_across_the_border_of_a_periodic_world_is_not_drawn(self) -> None:
        way = np.array([[[0.5, 1.0], [9.8, 1.0]], [[0.6, 1.0], [0.1, 1.0]], [[0.7, 1.0], [0.2, 1.0]]])
        pieces, counts = strips(way, 10.0)
        assert counts.tolist() == [1, 2]
        assert np.abs(np.diff(pieces, axis=1)).max() < 5.0
        assert strips(way, None)[1].tolist() == [2, 2]

    def test_the_period_of_a_trial_is_the_side_of_its_periodic_world(self) -> None:
        result = simulations.run_trial(straight(world="periodic"), reraise=True)
        assert period_of(result) == result.period_m == fields.world_of(result.trial).size_m
        assert period_of(series.unpack(series.pack(result))) == result.period_m
        unbounded = simulations.run_trial(straight(world="unbounded"), reraise=True)
        assert period_of(unbounded) is None


class TestKeys:
    def test_every_shown_key_can_be_set_to_the_value_shown(self) -> None:
        everything: list[Trial] = [
            straight(world="obstacles"),
            straight(world="periodic"),
            trial("test", 1, [group("couzin", 9, informed_share=0.5)], formation="split-group"),
        ]
        for one in everything:
            for row in keys.rows(one):
                again = keys.put(one, row.key, row.value)
                assert {r.key: r.value for r in keys.rows(again)}.get(row.key) == row.value

    def test_what_is_left_open_follows_the_law(self) -> None:
        one = straight()
        values = {row.key: row.value for row in keys.rows(one)}
        assert (values["timestep_s"], values["herd.speed_m_s"], values["formation.spacing_m"]) == (1.0, 0.03, 0.5)
        other = {row.key: row.value for row in keys.rows(keys.put(one, "herd.law", "couzin"))}
        assert (other["timestep_s"], other["formation.spacing_m"]) == (0.2, 1.5)

    def test_a_herd_updates_as_its_laws_publication_unless_told_otherwise(self) -> None:
        turning = {"law_parameters": {"noise_rad": 1.0}}
        one = trial("test", 1, [group("vicsek", 9, **turning)], steps=5, world="unbounded")
        shown = {row.key: row.value for row in keys.rows(one)}
        assert shown["updating"] == "forward"
        assert {row.key: row.value for row in keys.rows(keys.put(one, "herd.law", "couzin"))}["updating"] == "backward"
        ways = {order: simulations.run_trial(keys.put(one, "updating", order)).poses_w for order in ORDERS}
        assert np.array_equal(ways["own"], ways["forward"])
        steps = {order: np.hypot(*np.diff(way[:, :, :2], axis=0).T) for order, way in ways.items()}
        assert steps["forward"] == pytest.approx(0.03, rel=EXACT)
        headings = ways["forward"][0, :, 2]
        first = np.column_stack([np.cos(headings), np.sin(headings)])
        assert ways["forward"][1, :, :2] - ways["forward"][0, :, :2] == pytest.approx(0.03 * first, abs=EXACT)
        assert not np.isclose(ways["backward"][1, :, :2], ways["forward"][1, :, :2]).all()

    @pytest.mark.parametrize(
        ("key", "value", "expected"),
        [
            ("updating", "backwards", "did you mean backward"),
            ("steps", 0, "at least 1|from 1"),
            ("step", 3, "did you mean steps"),
            ("world", "corridr", "did you mean corridor"),
            ("world.size_m", 3.0, "world.size_m"),
            ("formation", "single", "did you mean single-group"),
            ("formation.gap_m", 3.0, "formation.gap_m"),
            ("herd.law", "viczek", "did you mean vicsek"),
            ("herd.law.range", 3.0, "did you mean herd.law.range_m"),
            ("herd.pipeline", "perfect-members", "perfect or member-based"),
            ("herd.information", "velocities", "poses or bearings"),
            ("herd.selection", "nearst", "nearst"),
            ("herd.body", "create", "herd.body"),
            ("herd.informed_share", 1.5, "to 1"),
            ("synchronous", 1, "true or false"),
        ],
    )
    def test_what_does_not_exist_or_fit_is_refused(self, key: str, value: Any, expected: str) -> None:
        with pytest.raises(InputError, match=expected):
            keys.put(straight(), key, value)

    def test_sets_named_side_by_side_are_checked_with_the_law(self) -> None:
        couzin = keys.put(straight(), "herd.law", "couzin")
        text = "repulsion: nearest; interaction: distance-based(1, 3)"
        simulations.check(keys.put(couzin, "herd.selection", text))
        with pytest.raises(InputError, match="did you mean repulsion"):
            simulations.check(keys.put(couzin, "herd.selection", text.replace("repulsion", "repulsoin")))

    def test_a_law_that_needs_more_than_bearings_is_refused_them(self) -> None:
        with pytest.raises(InputError, match=r"vicsek.*headings.*information=poses"):
            simulations.check(keys.put(straight(), "herd.information", "bearings"))

    def test_too_many_positions_to_keep_are_refused_with_a_way_out(self) -> None:
        with pytest.raises(InputError, match="every="):
            simulations.check(keys.put(straight(count=10_000), "steps", 1_000_000))
