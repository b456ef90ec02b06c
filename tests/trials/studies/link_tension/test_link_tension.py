"""Link tension as an experiment: starts, counts, estimates, claims; the spring that the index is made of."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.errors import InputError
from flocking.kinematic import Band, Schedule, simulate
from flocking.measures.links import link_lengths, link_outcomes, link_tension, links_within
from trials import design
from trials.batch.store import Row
from trials.evidence.runs import Cells, UndecidedError
from trials.evidence.statistics import mean_interval
from trials.simulations.kinematic import fields, lattice_starts, links
from trials.simulations.kinematic.lattice_starts import BOTH, POSITION, VELOCITY
from trials.simulations.kinematic.loop import run_trial
from trials.studies.link_tension.claims import KEYS, claims, contingency
from trials.studies.link_tension.design import LINKED, with_links
from trials.studies.link_tension.estimates import one_more, precision, ratio, recall, reliability
from trials.studies.link_tension.pictures import again, snapshots
from trials.types import Trial, TrialResult

EXACT = 1e-12
"""Rounding of a few float64 operations on numbers of order 1."""
LINK = np.array([[0, 1]])


def _start(formation: str, **given: Any) -> tuple[np.ndarray, np.ndarray]:
    parameters = lattice_starts.Parameters(spacing_m=1.0, **{"strength": 3.0, **given})
    return lattice_starts.start(formation, parameters, 100, np.random.default_rng(4))


# Starts


@pytest.mark.parametrize(("arrangement", "count"), [("rows", 261), ("rhombus", 261), ("disc", 264)])
def test_arrangements_are_lattices_of_regular_triangles(arrangement: str, count: int) -> None:
    places = lattice_starts.arranged(arrangement, 100, 2.0)
    found = links_within(places, 2.0 * 1.6)
    assert len(found) == count
    assert link_lengths(places, found) == pytest.approx(np.full(count, 2.0), abs=EXACT * 10)


def test_no_block_of_rows_has_the_published_number_of_links() -> None:
    """The publication counts 262; a block of 100 in rows of any width, shifted in turn or to one side, has fewer."""
    for columns in range(2, 51):
        rows, places = np.divmod(np.arange(100), columns)
        for shift in (rows % 2, rows):
            block = np.column_stack([places + 0.5 * shift, rows * math.sqrt(0.75)])
            assert len(links_within(block, 1.3)) <= 261


@pytest.mark.parametrize("velocities", ["disc", "norm", "circle", "square", "quadrant"])
def test_velocities_are_below_their_bound(velocities: str) -> None:
    poses, speeds = _start(VELOCITY, velocities=velocities)
    vx, vy = speeds * np.cos(poses[:, 2]), speeds * np.sin(poses[:, 2])
    if velocities in ("square", "quadrant"):
        assert max(np.abs(vx).max(), np.abs(vy).max()) < 3.0 < speeds.max()
    else:
        assert speeds.max() < 3.0 + EXACT
    assert bool((vx < 0.0).any()) == bool((vy < 0.0).any()) == (velocities != "quadrant")
    if velocities == "circle":
        assert speeds == pytest.approx(np.full(100, 3.0), abs=EXACT)


def test_disc_and_norm_have_the_mean_square_speed_of_their_distributions() -> None:
    """beta²/2 uniformly over the disc, beta²/3 uniformly in norm: standard errors of 4000 are below 0.02 beta²."""
    for velocities, share in (("disc", 0.5), ("norm", 1.0 / 3.0)):
        given = lattice_starts.Parameters(spacing_m=1.0, strength=2.0, velocities=velocities)
        _, speeds = lattice_starts.start(VELOCITY, given, 4000, np.random.default_rng(1))
        assert np.mean(speeds**2) == pytest.approx(share * 4.0, abs=0.02 * 4.0)


@pytest.mark.parametrize(("shifts", "low"), [("both", -3.0), ("positive", 0.0)])
def test_shifts_have_the_signs_asked_for(shifts: str, low: float) -> None:
    poses, speeds = _start(POSITION, shifts=shifts)
    moved = poses[:, :2] - lattice_starts.arranged("rows", 100, 1.0)
    assert moved.min() >= low
    assert moved.max() < 3.0
    assert moved.max() - moved.min() > 0.9 * (3.0 - low)
    assert not speeds.any()


def test_the_third_start_has_the_shifts_of_one_and_the_velocities_of_the_other() -> None:
    both, first, second = _start(BOTH), _start(VELOCITY), _start(POSITION)
    assert np.array_equal(both[0][:, :2], second[0][:, :2])
    assert np.array_equal(both[1], first[1])
    assert np.array_equal(both[0][:, 2], first[0][:, 2])


def test_lattices_stand_in_unbounded_space() -> None:
    with pytest.raises(InputError, match="unbounded"):
        lattice_starts.check("periodic")


# What the index is made of


def _pair(damper: float, dt: float, seconds: float, speed: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities of two members of Akama and Naruse's law, with a range that they do not leave."""
    law = lawentry.load("akama-naruse")
    band = Band(law, 2, {"range_m": 10.0, "spring_per_s2": 2.0, "damper_per_s": damper})
    poses = np.array([[0.0, 0.0, 0.0], [0.6 * length, 0.8 * length, 0.0]])
    velocities = np.array([[0.1, 0.2], [0.1 + 0.6 * speed, 0.2 + 0.8 * speed]])
    history = simulate(
        band, poses, Schedule(dt, round(seconds / dt)), rng=np.random.default_rng(0), velocities_w=velocities
    )
    return history.positions_w, history.velocities_w


def test_two_undamped_members_reach_the_distance_that_the_reduced_mass_predicts() -> None:
    """Semi-implicit Euler errs by about dt / 2 of the amplitude times the frequency: 1e-3 at a step of 1e-3 s."""
    positions, velocities = _pair(damper=0.0, dt=1e-3, seconds=4.0, speed=1.5, length=1.2)
    reach = float(np.hypot(*(positions[:, 1] - positions[:, 0]).T).max())
    index = {
        reading: 10.0 + float(link_tension(positions[0], velocities[0], LINK, 10.0, 1.0, inertia)[0])
        for reading, inertia in links.inertias(2.0).items()
    }
    assert reach == pytest.approx(index["reduced"], abs=2e-3)
    assert index["printed"] - reach > 0.5  # equation 7 drops m / k_p, and counts the whole mass
    assert index["spring"] - reach > 0.1  # the other of the two is free as well


def test_a_damped_pair_stays_within_the_predicted_distance() -> None:
    positions, velocities = _pair(damper=0.4, dt=1e-3, seconds=4.0, speed=1.5, length=1.2)
    reach = float(np.hypot(*(positions[:, 1] - positions[:, 0]).T).max())
    assert reach < 10.0 + float(link_tension(positions[0], velocities[0], LINK, 10.0, 1.0, 0.25)[0]) - 0.05


def test_of_members_at_rest_only_links_shorter_than_twice_the_rest_less_the_range_are_foretold_to_break() -> None:
    """Why table 2's 227 of 267 cannot come from equation 8 without velocities."""
    lengths = np.linspace(0.01, 1.6, 400)
    positions = np.stack([np.zeros_like(lengths), lengths])
    foretold = [
        link_tension(np.array([[0.0, 0.0], [x, 0.0]]), np.zeros((2, 2)), LINK, 1.6, 1.0)[0] > 0.0 for x in positions[1]
    ]
    assert np.array_equal(np.array(foretold), lengths < 2.0 * 1.0 - 1.6)


@pytest.mark.parametrize("name", [name for name, linked in LINKED.items() if linked.stiffness is not None])
def test_stiffness_is_the_slope_of_a_pair_at_rest(name: str) -> None:
    """Central difference over ± 1e-4 of the rest length: the third derivative is some tens of the slope."""
    law, linked = lawentry.load(name), LINKED[name]
    given = law.parameters({})
    named = dict(zip(law.parameter_names, given, strict=True))
    rest, dt = float(named[linked.rest_m]), 1e-6
    pulls = []
    for length in (rest * (1.0 + 1e-4), rest * (1.0 - 1e-4)):
        poses = np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]])
        history = simulate(Band(law, 2), poses, Schedule(dt, 1), rng=np.random.default_rng(0))
        pulls.append(history.velocities_w[1, 0, 0] / dt)
    slope = (pulls[0] - pulls[1]) / (2e-4 * rest)
    assert linked.stiffness is not None
    assert linked.stiffness(_named(law, given)) == pytest.approx(slope, rel=1e-5)


def _named(law: Any, given: Any) -> Any:
    return dataclasses.make_dataclass("Given", law.parameter_names)(*given)


# Counts


def _made_up() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Members 0 and 1 rest at 1 m; 2 leaves 1's range after 0.75 s and is back at 1.5 s; 3 leaves 2's for good."""
    times = np.arange(0.0, 5.01, 0.25)
    swing = 3.0 + np.where((times >= 0.75) & (times < 1.5), 0.0, -1.0) + 0.2
    positions = np.zeros((len(times), 4, 2))
    positions[:, 1, 0], positions[:, 2, 0] = 1.0, swing
    positions[:, 3, 0] = np.where(times < 1.0, swing + 1.0, 30.0)
    return times, positions, np.zeros_like(positions)


def test_links_are_counted_at_each_horizon_apart_and_ever() -> None:
    given = links.Parameters(range_m=1.6, rest_m=1.0, stiffness_per_s2=0.0, unit_s=1.0)
    found = links.measure(*_made_up(), given, None)
    broken = {
        (horizon, kind): int(links.counts(found, 0, horizon, kind).broken.sum())  # type: ignore[union-attr]
        for horizon in links.HORIZONS
        for kind in links.KINDS
    }
    assert found["links"] == 3.0
    assert [broken[h, "apart"] for h in links.HORIZONS] == [0, 0, 2, 1, 1]
    assert [broken[h, "ever"] for h in links.HORIZONS] == [0, 0, 2, 2, 2]
    assert found["links_broken"] == pytest.approx(2.0 / 3.0)
    assert found["link_recall"] == 0.0  # at rest, and none closer than 0.4 m
    assert math.isnan(found["link_precision"])


def test_a_trial_too_short_for_a_horizon_has_no_counts_of_it() -> None:
    times, positions, velocities = _made_up()
    found = links.measure(times[:6], positions[:6], velocities[:6], links.Parameters(), None)
    assert links.counts(found, 0, 1.0) is not None
    assert links.counts(found, 0, 2.0) is None
    assert links.counts(found, 1, 0.25) is not None
    assert links.counts(found, 1, 1.0) is None


def test_bins_add_up_to_the_contingency() -> None:
    rng = np.random.default_rng(3)
    index, broken = rng.normal(0.0, 1.5, 500), rng.random(500) < 0.3
    index[:20] = 0.0
    bins = links.binned(index, 1.0)
    counts = links.Counts(*(np.bincount(b, minlength=links.BINS).astype(float) for b in (bins, bins[broken])))
    assert counts.outcomes() == link_outcomes(index, broken)


def test_counts_agree_with_a_trial_followed_by_hand() -> None:
    trial = _small(VELOCITY)
    result = run_trial(trial, reraise=True)
    positions, velocities, dt = again(trial)
    first = round(1.0 / dt)
    pairs = links_within(positions[first], 1.6)
    index = link_tension(positions[first], velocities[first], pairs, 1.6, 1.0)
    broken = link_lengths(positions[2 * first], pairs) > 1.6
    counted = links.counts(result.measures, 1, 1.0)
    assert counted is not None
    assert counted.outcomes() == link_outcomes(index, broken)
    taken = snapshots(result)
    assert taken is not None
    assert np.array_equal(taken[1].tension, index)


def test_a_trial_that_does_not_run_again_as_it_ran_is_not_drawn() -> None:
    result = run_trial(_small(VELOCITY), reraise=True)
    assert snapshots(dataclasses.replace(result, poses_w=result.poses_w + 1e-3)) is None


# Estimates


def test_a_ratio_of_equal_wholes_has_the_interval_of_a_mean() -> None:
    parts = np.array([3.0, 5.0, 4.0, 7.0, 1.0])
    assert ratio(parts, np.full(5, 10.0))[:3] == pytest.approx(mean_interval(parts / 10.0), abs=EXACT)


def test_a_ratio_weighs_by_the_whole_and_leaves_out_what_has_none() -> None:
    assert ratio([1, 3, 0], [2, 8, 0]).measured == pytest.approx(0.4)
    assert ratio([1, 3, 0], [2, 8, 0]).n == 2
    assert math.isnan(ratio([0], [0]).measured)
    assert ratio([1, 2, 3], [2, 4, 6])[1:3] == pytest.approx((0.5, 0.5), abs=EXACT)


def test_precision_recall_and_reliability_of_made_up_counts() -> None:
    whole, broken = np.zeros(links.BINS), np.zeros(links.BINS)
    whole[links.POSITIVE - 1], whole[links.POSITIVE] = 10.0, 20.0
    broken[links.POSITIVE - 1], broken[links.POSITIVE] = 1.0, 4.0
    found = [links.Counts(whole, broken)] * 3
    assert precision(found).measured == pytest.approx(4.0 / 20.0)
    assert recall(found).measured == pytest.approx(4.0 / 5.0)
    shares = [share.measured for share in reliability(found)]
    assert shares[links.POSITIVE - 1 : links.POSITIVE + 1] == pytest.approx([0.1, 0.2])
    assert np.isnan(shares[: links.POSITIVE - 1]).all()


def test_one_more_holds_within_the_prediction_interval_alone() -> None:
    values = np.random.default_rng(5).normal(10.0, 2.0, 100)
    assert one_more(values, 12.0).agrees is True
    assert one_more(values, 18.0).agrees is False
    assert one_more(np.full(100, 261.0), 262.0).agrees is False
    assert one_more(np.full(100, 261.0), 261.0).agrees is True
    assert one_more(values[:10], 18.0).agrees is None
    # an interval of some ±4 decides for what it holds only where that is narrow enough to mean something
    assert one_more(values, 12.0, widest=5.0).agrees is True
    assert one_more(values, 12.0, widest=3.0).agrees is None
    assert one_more(values, 18.0, widest=3.0).agrees is False


# The experiments


def _small(formation: str) -> Trial:
    trials = design.plan("link-tension", repeats=1).trials
    chosen = {"formation": formation, "herd.law.range_m": 1.6, "formation.strength": 3.0}
    (trial,) = [trial for trial in trials if trial.conditions == chosen]
    return trial


def test_there_are_nine_settings_of_each_start_and_a_hundred_seeds() -> None:
    trials = design.plan("link-tension").trials
    cells = [tuple(trial.conditions[key] for key in KEYS) for trial in trials]
    assert len(set(cells)) == 27
    assert len(cells) == 2700
    assert {sum(group.count for group in trial.groups) for trial in trials} == {100}
    given = [fields.links_of(trial) for trial in trials[:27]]
    assert [one.range_m for one in given if one] == [cell[1] for cell in cells[:27]]
    times = fields.of_trial(trials[0])
    assert times.steps * times.timestep_s == pytest.approx(5.0)


def test_what_the_user_sets_stays() -> None:
    trial = design.plan("link-tension", repeats=1, settings={"steps": 7, "timestep_s": 0.1}).trials[0]
    assert fields.of_trial(trial).steps == 7
    swept = design.plan("link-tension", repeats=1, sweep={"herd.law.spring_per_s2": [1.0, 4.0]}).trials
    assert {trial.setup["links.stiffness_per_s2"] for trial in swept} == {1.0, 4.0}


def test_a_law_whose_links_are_not_known_is_refused() -> None:
    trial = dataclasses.replace(_small(VELOCITY), groups=(fields.group("vicsek", 10),))
    with pytest.raises(InputError, match=r"'vicsek'.*akama-naruse"):
        with_links(trial)


def test_beyond_covers_five_laws_and_three_sizes() -> None:
    trials = design.plan("link-tension-beyond", repeats=1).trials
    assert {(t.groups[0].law, t.groups[0].count) for t in trials} == {(w, n) for w in LINKED for n in (25, 100, 400)}
    assert len(LINKED) >= 4
    for trial in trials:
        given = fields.links_of(trial)
        assert given is not None
        assert given.rest_m < given.range_m


class _Run:
    """A finished run without a folder."""

    folder = Path()

    def __init__(self, trials: list[Trial]) -> None:
        self.trials = trials
        self.results = {trial.index: run_trial(trial, reraise=True) for trial in trials}

    def rows(self) -> Sequence[Row]:
        return [
            Row(t.index, "done", "", t.seed, t.repeat, dict(t.conditions), dict(self.results[t.index].measures))
            for t in self.trials
        ]

    def series(self, index: int) -> TrialResult:
        return self.results[index]


@pytest.fixture(scope="module")
def run() -> _Run:
    """Of three starts at two settings, two seconds long, three seeds each."""
    settings = {"formation.strength": 3.0, "steps": 200}
    return _Run(
        design.plan("link-tension", repeats=3, settings=settings, sweep={"herd.law.range_m": [1.6, 1.9]}).trials
    )


def test_every_table_number_and_claim_has_an_entry(run: _Run) -> None:
    entries = claims(run)
    assert len(entries) == 6 + 6 + 3
    tables = [entry for entry in entries if entry.quantity.startswith("table")]
    assert all(len(entry.outcomes) == 4 and entry.agrees is None for entry in tables)  # of three seeds nothing is said
    (first,) = [entry for entry in entries if entry.quantity.startswith("claim 1")]
    assert first.agrees is None  # nor of shares near 1
    assert first.measured > 0.95


def test_tables_add_up_to_the_links(run: _Run) -> None:
    cells = Cells(run.trials, run.rows(), KEYS)
    made = contingency(cells, 0, VELOCITY, 1.6, 3.0)
    assert {sum(one) for one in made.values() if one is not None} == {261}
    with pytest.raises(UndecidedError):
        contingency(cells, 0, VELOCITY, 1.3, 3.0)


def test_the_reports_figures_are_drawn(run: _Run, tmp_path: Path) -> None:
    drawn = design.load("link-tension").figures(run, tmp_path)
    assert [figure.name for figure in drawn] == ["tables", "flocks", "settings", "over-time", "calibration"]
    assert all(figure.path.stat().st_size > 0 for figure in drawn)
    text = drawn[0].path.read_text(encoding="utf-8")
    assert "published 210" in text
    assert "table 2 (b)" in text


def test_the_same_trial_gives_the_same_counts(run: _Run) -> None:
    trial = run.trials[0]
    assert run_trial(trial).measures == pytest.approx(run.results[trial.index].measures, abs=0.0, nan_ok=True)
