"""The paths of a trial's members, cut where they cross the border of a periodic world."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints
from trials.types import TrialResult


def period_of(result: TrialResult) -> float | None:
    """The side of a trial's periodic world, m; None where it is not periodic."""
    return result.period_m if math.isfinite(result.period_m) else None


def strips(positions: Floats, period: float | None) -> tuple[NDArray[np.float32], Ints]:
    """Positions (T, N, 2) as straight pieces (K, 2, 2) from moment to moment, and how many belong to each of the T − 1.

    In periodic space the pieces that cross the border are left out.
    """
    pairs = np.stack([positions[:-1], positions[1:]], axis=2)
    kept: Bools = np.ones(pairs.shape[:2], dtype=np.bool_)
    if period is not None:
        kept &= (np.abs(pairs[:, :, 1] - pairs[:, :, 0]) < period / 2.0).all(axis=-1)
    return pairs[kept].astype(np.float32), kept.sum(axis=1)
