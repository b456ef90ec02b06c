"""Kirchner's simulation: its setting; its claims on made-up runs: what was published holds, the contrary does not."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.trials.made_up_run import MadeUpRow, MadeUpRun, finished
from tests.trials.studies.judged import verdicts
from trials import design, simulations
from trials.evidence.claims import published
from trials.studies.monocular.boids import HERD, NORMAL_M, OBSTACLES, PIXEL_M, PREDATOR, SHORT_M, VIEW
from worlds import known

TOLD = published("trials.studies.monocular", "kirchner2006", "simulation")


def values(experiment: str) -> dict[str, Any]:
    return {row.key: row.value for row in design.plan(experiment, repeats=1).parameters}


def test_the_published_numbers_in_metres() -> None:
    found = values("boids-predator")
    assert pytest.approx(0.008) == PIXEL_M
    assert found[f"{HERD}.law.top_speed_m_s"] == pytest.approx(TOLD["speed_px_s"] * PIXEL_M)
    assert found[f"{HERD}.law.turn_rate_rad_s"] == TOLD["turn_rate_rad_s"]
    assert found[f"{HERD}.law.sight_deg"] == TOLD["field_of_view_deg"] / 2.0
    assert found["flocks.gap_m"] == pytest.approx(TOLD["flock_gap_px"] * PIXEL_M)
    assert pytest.approx(TOLD["vision_px"] * PIXEL_M) == NORMAL_M
    assert pytest.approx(TOLD["short_vision_px"] * PIXEL_M) == SHORT_M
    assert found["steps"] * found["timestep_s"] == pytest.approx(60.0 * TOLD["minutes"])
    assert values("boids-short-sight")["steps"] == 20 * found["steps"]
    failing = design.plan("boids-failures", repeats=1).conditions[f"{HERD}.failure_probability"]
    assert failing == [0.0, TOLD["failure_probability_per_step"]]


def test_all_settings_that_the_publication_names() -> None:
    found = [tuple(trial.conditions.values()) for trial in design.plan("boids-predator", repeats=1).trials]
    normal = {(n, NORMAL_M, p, o) for n in (3, 20) for p in (0, 1) for o in (0, 7)}
    assert len(found) == len(set(found))
    assert set(found) == normal | {(3, SHORT_M, 1, 0), (20, SHORT_M, 1, 0)}


def test_robots_know_the_predator_and_the_obstacles_by_number() -> None:
    trials = {tuple(t.conditions.values()): t for t in design.plan("boids-predator", repeats=1).trials}
    herd, predator, obstacles = trials[3, NORMAL_M, 1, 7].groups
    assert "threats: " in herd.selection
    assert "fixed-set(3)" in herd.selection
    assert "discs: fixed-set(4, 5, 6, 7, 8, 9, 10)" in herd.selection
    assert predator.selection == herd.selection
    assert trials[3, NORMAL_M, 0, 0].groups[0].selection == "all"
    assert (herd.name, predator.name, obstacles.name) == (HERD, PREDATOR, OBSTACLES)


def test_all_start_within_the_octagon_and_stay_there() -> None:
    (_, *trials) = design.plan("boids-predator", repeats=1, settings={"steps": 300, "every": 30}).trials
    walls = known.environment_of("octagon", "", {}).walls()
    assert len(walls) == 8
    along = walls[:, 2:] - walls[:, :2]
    inwards = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    for trial in trials[-2:]:
        places = simulations.run_trial(trial, reraise=True).poses_w[..., :2]
        depths = ((places[..., None, :] - walls[:, :2]) * inwards).sum(axis=-1)
        assert depths.min() > -1e-9
        assert np.ptp(places[:, 0], axis=0).max() > 0.0


def as_published(conditions: Mapping[str, Any], worse: float = 1.0) -> Mapping[str, float]:
    count, short = conditions[f"{HERD}.count"], conditions[VIEW] == SHORT_M
    usual = {3: TOLD["three_robots"]["flocks"], 20: TOLD["twenty_robots"]["flocks"]}[count]
    many = {3: 1.5, 20: TOLD["twenty_robots_short_vision"]["flocks"]}[count]
    small, large = TOLD["twenty_robots"]["centroid_std_px"]
    std = TOLD["three_robots"]["centroid_std_px"] if count == 3 else TOLD["twenty_robots_short_vision"]["mean_std_px"]
    return {
        "flocks_end": usual + worse * (many - usual) if short else usual,
        "alone_end": 0.0 if worse else 0.5 * count,
        "flock_std_end": std * PIXEL_M,
        "flock_rms_end": std * PIXEL_M,
        "flock_std_largest": large * PIXEL_M,
        "flock_std_others": small * PIXEL_M,
    }


def test_runs_as_published() -> None:
    assert verdicts("boids-predator", as_published) == 9 * [True]


def test_robots_that_short_sight_does_not_harm_or_that_are_alone() -> None:
    assert verdicts("boids-predator", lambda conditions: as_published(conditions, worse=0.0))[-2:] == [False, False]


@pytest.mark.parametrize(("least", "holds"), [(4.0, True), (2.0, False)])
def test_twenty_minutes(least: float, holds: bool) -> None:
    def measured(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        short = conditions[VIEW] == SHORT_M
        return {"flocks_least": least, "flocks_most": 9.0, "flocks_later": 6.0 if short else 2.0}

    assert verdicts("boids-short-sight", measured) == [holds]


@pytest.mark.parametrize(("after", "with_failures", "expected"), [(2.0, 2.1, [True, True]), (4.0, 5.0, [False, False])])
def test_failures(after: float, with_failures: float, expected: list[bool]) -> None:
    def measured(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        fails = conditions[f"{HERD}.failure_probability"] > 0.0
        found = {"flocks_after": after, "alone_after": 0.5 * after, "flocks_end": with_failures if fails else 2.0}
        return {**found, "largest_flock_end": 0.8}

    trials, module = design.plan("boids-failures").trials, design.load("boids-failures")
    made = finished(trials, lambda trial: {"flocks_before": 1.0, **measured(trial.conditions)}, seed=5, spread=0.0)
    assert [entry.agrees for entry in module.claims(made)] == expected


def test_only_flocks_that_were_one_before_count() -> None:
    plan, module = design.plan("boids-failures").trials, design.load("boids-failures")
    whole = {"flocks_before": 3.0, "flocks_after": 2.0, "alone_after": 0.0, "flocks_end": 2.0, "largest_flock_end": 1.0}
    entry = module.claims(finished(plan, lambda trial: whole, seed=5, spread=0.0))[0]
    assert entry.agrees is None
    assert entry.n == 0


@pytest.mark.parametrize("experiment", ["boids-predator", "boids-failures", "boids-short-sight"])
def test_figures_of_a_short_run(experiment: str, tmp_path: Path) -> None:
    settings: dict[str, Any] = {"steps": 120, "every": 30}
    if experiment == "boids-failures":
        settings |= {f"{HERD}.failure_time_s": 2.0, "flocks.after_s": 1.0, "flocks.gap_m": 50.0}
    trials = design.plan(experiment, repeats=1, settings=settings).trials
    results = {trial.index: simulations.run_trial(trial, reraise=True) for trial in trials}
    rows = [MadeUpRow(t.index, "done", "", t.repeat, t.conditions, results[t.index].measures) for t in trials]
    done = MadeUpRun(trials, rows, tmp_path, results)
    made = design.load(experiment).figures(done, tmp_path)
    assert made
    for figure in made:
        assert figure.path.stat().st_size > 1000
    names = {figure.name for figure in made}
    assert "flocks" in names
    assert ("ends" in names) == (experiment == "boids-predator")
    assert ("failure" in names) == (experiment == "boids-failures")
