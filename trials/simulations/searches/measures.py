"""What is measured of one search, and of one decomposition."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats
from generation.decomposition import Clusters, Elicited
from generation.searches.methods import Grid
from generation.searches.searching import Search, coverage, qd_score
from trials.types import Measure

OF_SEARCH: dict[str, Measure] = {
    "points": Measure("", "points of the parameter space that were judged"),
    "simulations": Measure("", "simulations of the search: points times those of each"),
    "best": Measure("", "robustness of the best point, estimated on new starts, so that its luck does not count"),
    "best_seen": Measure("", "the same as the search saw it"),
    "control": Measure("", "robustness of the workspace without a construct, on the new starts"),
    "uplift": Measure("", "best less control"),
    "mean_best": Measure("", "area under the curve: mean over the search of the best point so far, on new starts"),
    "robust_points": Measure("", "share of the points that were robust as the search saw them"),
    "coverage": Measure("", "share of the archive's cells that hold a point"),
    "qd_score": Measure("", "sum over the cells of their elites' robustness, on new starts"),
    "robust_cells": Measure("", "cells whose elite is robust, on new starts: different robust environments"),
    "fence": Measure("m", "length of the best construct"),
}
OF_PIECES: dict[str, Measure] = {
    "pieces": Measure("", "pieces that the construct was cut into"),
    "clusters": Measure("", "groups of pieces that elicit alike"),
    "silhouette": Measure("", "largest mean silhouette over the numbers of clusters: below 0.5 all pieces are one"),
    "active_share": Measure("", "share of the pieces that change what the herd does without a construct"),
    "strongest": Measure("m", "farthest that a piece moves the place where the herd's centre ends"),
}
ABOUT = {**OF_SEARCH, **OF_PIECES}
"""Every measure, in the order in which they are shown; a trial has those of a search or of a decomposition."""
KEY_MEASURES = ("best", "mean_best", "coverage", "qd_score", "pieces", "clusters")
ACTIVE_Z = 4.0
"""Standard errors by which a piece's effect differs from none, in any of its features. A choice: six features of some
twenty pieces exceed it by chance in less than 1 % of the decompositions."""


class Fresh(NamedTuple):
    """Robustness on new starts."""

    incumbents: Floats
    """(I,) of the points that were the best so far."""
    elites: Floats
    """(F,) of the archive's elites."""
    control: float
    """Of the workspace without a construct."""


def of_search(found: Search, grid: Grid, fresh: Fresh, each: int, robust: float, fence_m: float) -> dict[str, float]:
    """The measures of a search of `each` simulations a point."""
    filled, _ = found.elites(grid)
    best = float(fresh.incumbents[-1])
    values = {
        "points": len(found.values),
        "simulations": each * len(found.values),
        "best": best,
        "best_seen": found.values.max(),
        "control": fresh.control,
        "uplift": best - fresh.control,
        "mean_best": fresh.incumbents[found.holders()].mean(),
        "robust_points": (found.values >= robust - 1e-9).mean(),
        "coverage": coverage(filled, grid),
        "qd_score": qd_score(fresh.elites),
        "robust_cells": (fresh.elites >= robust - 1e-9).sum(),
        "fence": fence_m,
    }
    return {name: float(values[name]) for name in OF_SEARCH}


def of_pieces(done: Elicited, found: Clusters) -> dict[str, float]:
    """The measures of a decomposition."""
    effects = done.effects
    values = {
        "pieces": len(found.labels),
        "clusters": len(found.medoids),
        "silhouette": found.silhouettes.max() if len(found.silhouettes) else math.nan,
        "active_share": active(done).mean(),
        "strongest": np.hypot(effects[:, 0], effects[:, 1]).max(),
    }
    return {name: float(values[name]) for name in OF_PIECES}


def active(done: Elicited) -> Bools:
    """(n,) which pieces change what the herd does without a construct, in any feature, on the same starts."""
    paired = done.each - done.empty
    count = paired.shape[1]
    spread = paired.std(axis=1, ddof=1) / math.sqrt(count) if count > 1 else np.zeros(done.effects.shape)
    least = np.maximum(ACTIVE_Z * spread, done.finest)
    return np.asarray((np.abs(done.effects) > least).any(axis=1), np.bool_)
