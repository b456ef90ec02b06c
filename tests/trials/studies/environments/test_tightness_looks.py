"""Tightness and uplift at the very bound of their claims: how often repeated looks at pooled shares decide wrongly."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy import special

from flocking.types import Bools, Floats
from trials.evidence.looks import among, nominal, planned_looks
from trials.evidence.statistics import ALPHA
from trials.studies.environments import tightness
from trials.studies.environments.tightness_claims import LEAST, Counts, _tightness, _uplift

LOOKS = planned_looks(tightness.REPEATS)
BATCHES = 20_000
LIMIT = ALPHA + 2.0 * math.sqrt(ALPHA * (1.0 - ALPHA) / BATCHES)
"""Wrong decisions among `BATCHES` that an error rate of 5 % may give: two standard errors more."""


class Null(NamedTuple):
    """A truth at which it is wrong to say either: the share, or the uplift, is `LEAST`."""

    of_a_repeat: int
    """Environments."""
    shares: tuple[float, ...]
    """Of those that succeed with both, with the construct alone, without it alone, and with neither."""
    of_all: bool
    """Whether the tightness is judged, or else the uplift."""


TIGHT = (0.0, LEAST, 0.0, 1.0 - LEAST)
NULLS = {
    "tightness, a hundred a repeat": Null(100, TIGHT, True),
    "tightness, twenty a repeat": Null(20, TIGHT, True),
    "tightness, ten a repeat": Null(10, TIGHT, True),
    "uplift over an empty world in which nothing succeeds": Null(100, TIGHT, False),
    "uplift over an empty world in which all that is not gained is alike": Null(100, (0.2, LEAST, 0.0, 0.79), False),
    "uplift, a few gained and a few lost": Null(100, (0.4, 0.05, 0.04, 0.51), False),
    "uplift, many gained and many lost": Null(100, (0.0, 0.26, 0.25, 0.49), False),
    "uplift, ten a repeat": Null(10, (0.0, 0.26, 0.25, 0.49), False),
}


def wilson(k: Floats, n: Floats, z: float) -> tuple[Floats, Floats]:
    """Wilson's intervals of k (…) of n (…)."""
    centre, reach = (k + z * z / 2.0), z * np.sqrt(k * (n - k) / n + z * z / 4.0)
    low, high = (centre - reach) / (n + z * z), (centre + reach) / (n + z * z)
    return np.where(k > 0.0, np.maximum(low, 0.0), 0.0), np.where(k < n, np.minimum(high, 1.0), 1.0)


def newcombe(counts: Floats, z: float) -> tuple[Floats, Floats]:
    """Newcombe's intervals (…) of paired differences, method 10, of counts (…, 4) as in `Null.shares`."""
    both, gained, lost, neither = np.moveaxis(counts, -1, 0)
    n = counts.sum(axis=-1)
    one, other = both + gained, both + lost
    (low_1, high_1), (low_2, high_2) = wilson(one, n, z), wilson(other, n, z)
    product, excess = one * (n - one) * other * (n - other), both * neither - gained * lost
    excess = np.where(excess > 0.0, np.maximum(excess - n / 2.0, 0.0), excess)
    phi = np.where(product > 0.0, excess / np.sqrt(np.maximum(product, 1.0)), 0.0)

    def joined(a: Floats, b: Floats) -> Floats:
        return np.sqrt(np.maximum(a * a - 2.0 * phi * a * b + b * b, 0.0))

    uplift = (one - other) / n
    return uplift - joined(one / n - low_1, high_2 - other / n), uplift + joined(high_1 - one / n, other / n - low_2)


def at_the_bound(counts: Floats) -> Bools:
    """(…) whether the measured uplift is `LEAST` itself: of whole numbers, and so beyond any rounding if it is not."""
    difference: Bools = np.abs(counts[..., 1] - counts[..., 2] - LEAST * counts.sum(axis=-1)) < 1e-6
    return difference


def verdicts(null: Null, counts: Floats) -> tuple[Bools, Bools]:
    """(…) whether the claim is found to hold, and not to hold, by counts (…, 4): by intervals at one look's level."""
    z = float(special.ndtri(1.0 - nominal(ALPHA / 2.0)))
    n = counts.sum(axis=-1)
    low, high = wilson(counts[..., 0] + counts[..., 1], n, z) if null.of_all else newcombe(counts, z)
    return low > LEAST, high < LEAST


def judged(null: Null, counts: Floats) -> bool | None:
    """What the claim itself says of counts (4,)."""
    both, gained, lost, neither = map(int, counts)
    outcome = (_tightness if null.of_all else _uplift)(Counts(int(counts.sum()), both, gained, lost, neither))
    return outcome.decision.agrees


def drawn(null: Null) -> Floats:
    """(BATCHES, looks, 4) counts at each look."""
    repeats = np.diff((0, *LOOKS))
    added = np.random.default_rng(17).multinomial(null.of_a_repeat * repeats, null.shares, (BATCHES, len(LOOKS)))
    counts: Floats = added.cumsum(axis=1).astype(np.float64)
    return counts


@pytest.mark.parametrize("name", NULLS)
def test_wrong_decisions_are_at_most_five_in_a_hundred(name: str) -> None:
    with among(LOOKS):
        holds, fails = verdicts(NULLS[name], drawn(NULLS[name]))
    wrong = (holds | fails).any(axis=1).mean()
    print(f"{name}: wrong in {100 * wrong:.2f} % of {BATCHES} batches at {len(LOOKS)} looks")
    assert wrong <= LIMIT


@pytest.mark.parametrize("name", NULLS)
def test_the_rule_for_all_batches_at_once_is_what_the_claim_says(name: str) -> None:
    null, counts = NULLS[name], drawn(NULLS[name])
    with among(LOOKS):
        holds, fails = verdicts(null, counts)
        decided = np.argwhere(holds | fails)[:20]
        for at in map(tuple, (*decided, *np.ndindex(10, len(LOOKS)))):
            if null.of_all or not at_the_bound(counts[at]):
                assert judged(null, counts[at]) is (True if holds[at] else False if fails[at] else None)


@pytest.mark.parametrize("of_a_repeat", [10, 100])
def test_an_uplift_that_is_measured_at_the_bound_itself_shows_nothing(of_a_repeat: int) -> None:
    null = Null(of_a_repeat, (0.2, 0.06, 0.05, 0.69), False)
    counts = drawn(null).reshape(-1, 4)
    with among(LOOKS):
        assert {judged(null, each) for each in counts[at_the_bound(counts)][:50]} == {None}
