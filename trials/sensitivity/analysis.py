"""Designs of points in the unit cube, and what their outputs say of each factor, by SALib.

Sources: elementary effects, Morris 1991; their mean absolute value mu*, Campolongo, Cariboni and Saltelli 2007; first
and total indices, Sobol 2001, from the design and by the estimators of Saltelli et al. 2010, on Sobol's sequence,
scrambled; Herman and Usher 2017 for the library. Intervals are bootstrapped, at 95 %.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from SALib.analyze import morris as effects
from SALib.analyze import sobol as variances
from SALib.sample import sobol as saltelli
from SALib.sample.morris import sample as trajectories
from scipy import stats

from flocking.types import Bools, Floats

LEVELS = 4
"""Of the grid of a screening (Morris 1991: even; Campolongo et al. 2007 take 4)."""
RESAMPLES = 1000
"""Of a bootstrap."""
CONFIDENCE = 0.95


class Effects(NamedTuple):
    """Of a screening, for each of k factors, in the unit of the output over the whole range of the factor."""

    mu_star: Floats
    """(k,) mean of the elementary effects' absolute values."""
    mu_star_reach: Floats
    """(k,) half of its interval."""
    sigma: Floats
    """(k,) their standard deviation: large beside mu* where the factor interacts or acts non-linearly."""
    n: int
    """Trajectories."""


class Indices(NamedTuple):
    """Of a variance-based analysis, for each of d factors."""

    first: Floats
    first_reach: Floats
    total: Floats
    total_reach: Floats
    """(d,) each, the reaches half of the intervals."""
    n: int
    """Points of the base sample."""


class Share(NamedTuple):
    """A share with its binomial interval (Wilson's)."""

    measured: float
    low: float
    high: float
    n: int


def screening(factors: int, count: int, rng: np.random.Generator) -> Floats:
    """(count (k + 1), k) points of `count` trajectories through a grid, in each of which every factor moves once."""
    return np.asarray(trajectories(_problem(factors), count, num_levels=LEVELS, seed=rng), dtype=np.float64)


def screened(design: Floats, output: Floats, rng: np.random.Generator) -> Effects | None:
    """What a screening says; trajectories in which an output (P,) is not finite are left out. None if under two are
    left."""
    factors = design.shape[1]
    runs = output.reshape(-1, factors + 1)
    kept = np.isfinite(runs).all(axis=1)
    if kept.sum() < 2:
        return None
    left = design.reshape(-1, factors + 1, factors)[kept].reshape(-1, factors)
    found = effects.analyze(
        _problem(factors),
        left,
        runs[kept].ravel(),
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        num_levels=LEVELS,
        seed=rng,
    )
    mu_star, reach, sigma = (np.ma.filled(found[name], np.nan) for name in ("mu_star", "mu_star_conf", "sigma"))
    return Effects(mu_star, reach, sigma, int(kept.sum()))


def saltelli_design(factors: int, count: int, rng: np.random.Generator) -> Floats:
    """(count (d + 2), d) points: each of a base sample A, with one factor after the other from B, and that of B.

    `count`: a power of 2.
    """
    made = saltelli.sample(_problem(factors), count, calc_second_order=False, seed=rng)
    return np.asarray(made, dtype=np.float64)


def indices(factors: int, output: Floats, rng: np.random.Generator) -> Indices | None:
    """First and total indices from the outputs (P,) of such a design; a point of the base sample is left out with all
    of its own where one of their outputs is not finite.

    None where fewer than two are left, or where the output does not vary.
    """
    runs = output.reshape(-1, factors + 2)
    runs = runs[np.isfinite(runs).all(axis=1)]
    if len(runs) < 2 or not np.ptp(runs) > 1e-12 * max(1.0, float(np.abs(runs).max())):
        return None
    found = variances.analyze(
        _problem(factors),
        runs.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=rng,
    )
    return Indices(found["S1"], found["S1_conf"], found["ST"], found["ST_conf"], len(runs))


def base_points(factors: int, count: int) -> Bools:
    """(count,) which points of a Saltelli design of `count` are of its base samples A and B, uniform in the cube."""
    turn = np.arange(count) % (factors + 2)
    return (turn == 0) | (turn == factors + 1)


def share(held: Bools) -> Share:
    """Of points that are drawn uniformly (n,), those in which something holds."""
    n = len(held)
    if n == 0:
        return Share(math.nan, math.nan, math.nan, 0)
    interval = stats.binomtest(int(held.sum()), n).proportion_ci(CONFIDENCE, method="wilson")
    return Share(float(held.mean()), float(interval.low), float(interval.high), n)


def _problem(factors: int) -> dict[str, Any]:
    return {
        "num_vars": factors,
        "names": [f"x{k:04d}" for k in range(factors)],
        "bounds": [[0.0, 1.0]] * factors,
    }
