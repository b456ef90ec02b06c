"""Galton boards: what must be binomial is, and what falls is symmetric."""

import numpy as np
import pytest

from flocking.errors import InputError
from generation.bins import NOWHERE, Grains, bins_of, compared, fallen, sunk
from generation.environment import Environment
from generation.schemas import galton


def board(**given):
    return galton.generate(galton.Parameters(**given), galton.workspace(), np.random.default_rng(0))


@pytest.mark.parametrize("rows", [1, 3, 6, 12])
def test_grains_that_sink_end_binomially_on_any_number_of_rows(rows):
    found = compared(sunk(board(rows=rows), 4000, np.random.default_rng(rows)), rows + 1)
    assert found.counts.sum() == 4000
    assert found.p > 1e-3  # of four such tests with fixed seeds


def test_grains_too_small_to_meet_a_peg_a_row_do_not():
    """Pegs of 6 m every 40 m: a grain beside one falls between the next two."""
    found = compared(sunk(board(), 2000, np.random.default_rng(1), radius_m=0.0), 7)
    assert found.p < 1e-9


def test_grains_that_bounce_fall_through_and_to_both_sides_alike():
    bins = fallen(board(rows=3), 1000, np.random.default_rng(1), Grains(radius_m=0.0, most_s=60.0))
    through = bins[bins != NOWHERE]
    assert len(through) > 990
    left = int((through < 2).sum())
    assert abs(left - len(through) / 2) < 4.0 * np.sqrt(len(through) / 4)  # four standard errors


def test_the_test_knows_the_binomial_and_what_is_not():
    rng = np.random.default_rng(1)
    assert compared(rng.binomial(6, 0.5, 5000), 7).p > 0.01
    assert compared(rng.binomial(6, 0.55, 5000), 7).p < 1e-6
    assert compared(np.array([1, 2, 2, 3] * 100), 5).distance == pytest.approx(1.0 / 8.0)  # (0, 4, 8, 4, 0)/16 of 16
    nobody = compared(np.full(3, NOWHERE), 4)
    assert nobody.nowhere == 3
    assert np.isnan(nobody.p)


def test_members_are_counted_in_the_bin_that_they_are_in():
    environment = board(rows=2)
    middles = [np.mean(environment.markers[f"bin-{n}"].corners_m, axis=0) for n in (1, 2, 3)]
    places = np.array([*middles, (0.0, 0.0), (1e4, -1e4)])
    assert bins_of(environment, places).tolist() == [0, 1, 2, NOWHERE, NOWHERE]


@pytest.mark.parametrize("environment", [Environment(), Environment(markers=board().markers)])
def test_what_is_no_board_is_refused(environment):
    with pytest.raises(InputError, match="of the schema galton"):
        fallen(environment, 3, np.random.default_rng(1))


def test_grains_that_do_not_fit_the_funnel_are_refused():
    for fall in (lambda rng: fallen(board(), 3, rng, Grains(radius_m=10.0)), lambda rng: sunk(board(), 3, rng, 10.0)):
        with pytest.raises(InputError, match="do not fit"):
            fall(np.random.default_rng(1))
