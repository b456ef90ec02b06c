"""A function of known indices through the whole pipeline: designs, storage of outputs, analysis, flips."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.types import Floats
from trials.sensitivity import analysis
from trials.sensitivity.explore import VARIANCE, Explored, explore, least_points
from trials.sensitivity.ledger import Ledger, opened
from trials.sensitivity.quantity import NOTHING, Output

Function = Callable[[Floats], Floats]
"""Points (P, k) → outputs (P,)."""


def ledger(folder: Path) -> Ledger:
    return opened(folder, {"experiment": "a function"})


def evaluated(kept: Ledger, function: Function, asked: list[str] | None = None) -> Callable[..., None]:
    """Puts the outputs of a function into a ledger, as trials do; `asked`: the stages that had points left to do."""

    def evaluate(stage: str, points: Mapping[int, Floats]) -> None:
        ended = kept.points(stage)
        left = {number: place for number, place in points.items() if number not in ended}
        if asked is not None and left:
            asked.append(stage)
        if left:
            values = function(np.array(list(left.values())))
            kept.add_points(
                stage,
                {
                    number: (place, [Output(float(y), bool(y > 0.0)) if math.isfinite(y) else NOTHING])
                    for (number, place), y in zip(left.items(), values, strict=True)
                },
            )

    return evaluate


def explored(folder: Path, function: Function, reference: list[float], points: int, seed: int = 3) -> Explored:
    kept, own = ledger(folder), np.array(reference)
    start = Output(float(function(own[None])[0]), None)
    found = explore(evaluated(kept, function), kept, own, [start], points, seed)
    kept.close()
    return found


A, B = 7.0, 0.1


def ishigami(unit: Floats) -> Floats:
    """Ishigami and Homma 1990, of factors uniform within ± pi."""
    x = math.pi * (2.0 * unit - 1.0)
    y: Floats = np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])
    return y


def test_the_indices_of_ishigamis_function_are_those_of_its_closed_form(tmp_path: Path) -> None:
    found = explored(tmp_path, ishigami, [0.5, 0.5, 0.5], points=41_100)
    first = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2
    second, both = A**2 / 8.0, B**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    whole = first + second + both
    indices = found.findings[0].indices
    assert found.active == [0, 1, 2]
    assert found.base == 8192
    assert indices is not None
    assert_allclose(indices.first, np.array([first, second, 0.0]) / whole, atol=0.02)  # as the issue asks
    assert_allclose(indices.total, np.array([first + both, second, both]) / whole, atol=0.02)
    for middle, reach, truth in (
        (indices.first, indices.first_reach, np.array([first, second, 0.0]) / whole),
        (indices.total, indices.total_reach, np.array([first + both, second, both]) / whole),
    ):
        assert (np.abs(middle - truth) < 2.0 * reach + 1e-3).all()  # bootstrapped intervals, doubled


def test_what_does_not_matter_is_screened_out_and_kept_at_the_reference(tmp_path: Path) -> None:
    found = explored(tmp_path, lambda x: 4.0 * x[:, 1] - 1.0 + 0.01 * x[:, 2], [0.2, 0.5, 0.9], points=400)
    assert found.active == [1]
    kept = ledger(tmp_path)
    places = np.array([place for place, _ in kept.points(VARIANCE).values()])
    kept.close()
    assert_allclose(places[:, [0, 2]], np.tile([0.2, 0.9], (len(places), 1)))
    (effects,) = (each.effects for each in found.findings)
    assert effects is not None
    assert_allclose(effects.mu_star, [0.0, 4.0, 0.01], atol=1e-9)  # elementary effects of a plane are its slopes


def test_the_share_of_the_space_and_its_interval_hold_the_true_share(tmp_path: Path) -> None:
    found = explored(tmp_path, lambda x: x[:, 0] - 0.3, [0.5, 0.5], points=1500).findings[0]
    assert found.holds.low < 0.7 < found.holds.high
    assert found.holds.measured == pytest.approx(0.7, abs=0.02)  # low-discrepancy points: far below 1/sqrt(n)
    assert found.verdicts[2].measured == 0.0


def test_the_nearest_flip_is_drawn_up_to_the_border(tmp_path: Path) -> None:
    found = explored(tmp_path, lambda x: x[:, 0] - 0.3, [0.5, 0.5], points=1500).findings[0]
    assert found.flip is not None
    assert found.flip.output.slack <= 0.0
    assert found.flip.place[0] == pytest.approx(0.3, abs=0.02)  # 1/64 of a line of at most 0.71
    assert 0.2 <= found.flip.distance < 0.25


def test_nothing_flips_where_the_sign_never_changes(tmp_path: Path) -> None:
    assert explored(tmp_path, lambda x: 1.0 + x[:, 0], [0.5, 0.5], points=200).findings[0].flip is None


def test_points_without_a_quantity_are_left_out_with_all_that_hangs_on_them(tmp_path: Path) -> None:
    def holed(x: Floats) -> Floats:
        return np.where(x[:, 1] > 0.95, np.nan, x[:, 0] - 0.3)

    found = explored(tmp_path, holed, [0.5, 0.5], points=1500).findings[0]
    assert found.empty > 0
    assert found.indices is None or np.isfinite(found.indices.total).all()
    assert found.holds.measured == pytest.approx(0.7, abs=0.05)


def test_a_constant_output_has_no_indices(tmp_path: Path) -> None:
    found = explored(tmp_path, lambda x: np.full(len(x), -1.0), [0.5, 0.5], points=200)
    assert found.active == []
    assert found.findings[0].indices is None
    assert found.findings[0].holds.measured == 0.0


def test_an_analysis_that_was_stopped_goes_on_without_doing_anything_twice(tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    (tmp_path / "parts").mkdir()
    whole = explored(tmp_path / "whole", ishigami, [0.5, 0.5, 0.5], points=400)
    kept, own, asked = ledger(tmp_path / "parts"), np.full(3, 0.5), list[str]()
    start = [Output(float(ishigami(own[None])[0]), None)]

    def stops(stage: str, points: Mapping[int, Floats]) -> None:
        evaluated(kept, ishigami)(stage, dict(list(points.items())[:30]))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        explore(stops, kept, own, start, 400, 3)
    assert len(kept.points("screening")) == 30
    again = explore(evaluated(kept, ishigami, asked), kept, own, start, 400, 3)
    assert repr(again) == repr(whole)
    asked.clear()
    explore(evaluated(kept, ishigami, asked), kept, own, start, 400, 3)
    assert not asked  # all is there
    kept.close()


def test_a_folder_is_not_taken_for_another_analysis(tmp_path: Path) -> None:
    ledger(tmp_path).close()
    with pytest.raises(ValueError, match="was begun with experiment"):
        opened(tmp_path, {"experiment": "another"})


def test_a_screening_of_the_fewest_points_fits_into_them(tmp_path: Path) -> None:
    found = explored(tmp_path, ishigami, [0.5, 0.5, 0.5], points=least_points(3))
    assert found.points == least_points(3)
    assert found.base == 0


STEPS, MEMBERS = 20, 4
START_SPREAD = 0.5
"""Of where a repeat's members start, as against ways of 0.5 to 1.5: noise that all points of a repeat share."""


def led(x: Floats, rng: np.random.Generator, paired: bool) -> Floats:
    """(P,) how far a cheap stochastic herd comes: correlated random walkers from a random start, whose step, turning
    noise and pull to the goal are the factors (P, 3). `paired`: all points draw the same numbers."""
    count = 1 if paired else len(x)
    noise, start = rng.normal(size=(count, STEPS, MEMBERS)), START_SPREAD * rng.normal(size=count)
    heading, way = np.zeros((len(x), MEMBERS)), np.zeros(len(x))
    for step in range(STEPS):
        heading = heading * (1.0 - 0.5 * x[:, 2:]) + (0.1 + 0.2 * x[:, 1:2]) * noise[:, step]
        way += (0.5 + x[:, 0]) * np.cos(heading).mean(axis=1)
    return start + way / STEPS


def test_common_random_numbers_halve_the_standard_error_of_the_indices(capsys: pytest.CaptureFixture[str]) -> None:
    """At the same cost: the deviation of all indices over replications with other designs and other seeds."""
    errors = {}
    for paired in (True, False):
        found = []
        for turn in range(24):
            design = analysis.saltelli_design(3, 64, np.random.default_rng([7, turn]))
            output = led(design, np.random.default_rng([9, turn]), paired)
            made = analysis.indices(3, output, np.random.default_rng([8, turn]))
            assert made is not None
            found.append(np.concatenate([made.first, made.total]))
        errors[paired] = float(np.sqrt(np.mean(np.var(found, axis=0, ddof=1))))
    with capsys.disabled():
        print(f"\nstandard error of an index: paired {errors[True]:.3f}, independent {errors[False]:.3f}")
    assert errors[True] <= 0.5 * errors[False]  # seeded: the same numbers each time, 0.034 and 0.167
