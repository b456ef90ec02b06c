"""How much each of what the publication leaves open explains, against closed forms."""

from __future__ import annotations

import itertools
import math

import pytest

from trials.studies.environments.design import SIZE, SPEED, TURN
from trials.studies.environments.presets_figures import main_effects

GRID = list(itertools.product((20.0, 30.0, 40.0), (1.0, 2.0), (0.25, 0.5)))


def test_what_alone_decides_explains_all() -> None:
    shares = main_effects({point: point[0] / 40.0 for point in GRID})
    assert shares == pytest.approx({SIZE: 1.0, SPEED: 0.0, TURN: 0.0})


def test_shares_of_a_sum_are_those_of_its_variances() -> None:
    # variances of the terms: 2/3 of a size's step of 1, 1/4 of a speed's
    shares = main_effects({point: point[0] / 10.0 + point[1] for point in GRID})
    whole = 2.0 / 3.0 + 1.0 / 4.0
    assert shares == pytest.approx({SIZE: 2.0 / 3.0 / whole, SPEED: 0.25 / whole, TURN: 0.0})


def test_an_interaction_is_no_main_effect() -> None:
    shares = main_effects({p: (1.0 if p[1] == 1.0 else -1.0) * (1.0 if p[2] == 0.5 else -1.0) for p in GRID})
    assert shares == pytest.approx({SIZE: 0.0, SPEED: 0.0, TURN: 0.0})


def test_rates_that_are_all_alike_leave_nothing_to_explain() -> None:
    assert all(math.isnan(share) for share in main_effects(dict.fromkeys(GRID, 0.5)).values())
    assert all(math.isnan(share) for share in main_effects({}).values())
