"""How many robots fell, and when the first did; of trials with a body that can fall."""

from __future__ import annotations

import numpy as np

from flocking.types import Floats
from trials.types import Measure

ABOUT = {
    "fallen": Measure("robots", "how many robots lie at the end"),
    "first_fall": Measure("s", "when the first robot fell"),
}


def falls(fallen_at: Floats | None) -> dict[str, float]:
    """The measures of this file. fallen_at (N,): when each robot fell, s, nan = it stands; None where none can fall."""
    if fallen_at is None:
        return {}
    lie = np.isfinite(fallen_at)
    return {"fallen": float(lie.sum()), "first_fall": float(fallen_at[lie].min()) if lie.any() else np.nan}
