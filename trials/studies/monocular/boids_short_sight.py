"""Twenty boids with short sight and a predator for twenty minutes: the number of their flocks goes up and down.

As in `boids-predator`, with 50 px of sight. The publication ran it, but does not say how often: "the number of distinct
flocks fluctuates throughout that time, but never approaches the success seen in the earlier configuration". Beside it
the earlier configuration, with 201 px, as long.
"""

from __future__ import annotations

from trials.studies.monocular.boids import NORMAL_M, SHORT_M, SOURCES, VIEW, boids
from trials.studies.monocular.boids import filled_in as finish
from trials.studies.monocular.boids_claims import sight_claims as claims
from trials.studies.monocular.boids_figures import sight_figures as figures
from trials.types import Trial

REPEATS = 100
RECORD = "none"
CONDITIONS = {VIEW: (SHORT_M, NORMAL_M)}
KEY_MEASURES = ("flocks_end", "flocks_later", "flocks_least", "flocks_most")


def base(repeat: int) -> Trial:
    """Twenty boids and a predator for twenty minutes."""
    return boids("boids-short-sight", repeat, 20 * 60)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
