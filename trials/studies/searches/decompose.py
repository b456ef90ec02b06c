"""A livestock race decomposed: pieces of its fences, each alone, clustered by what they make a herd do.

Source: Fine 2015, section 8.1.1, which proposes both ways and does neither: undirected, by a window that slides along
the construct, and directed, by regions that an expert names: here both wings, the lane and its bend.
"""

from __future__ import annotations

from trials.simulations.searches.fields import DECOMPOSITION, trial
from trials.studies.searches.design import herd
from trials.studies.searches.pieces_claims import REGIONS, WAYS, claims
from trials.studies.searches.pieces_figures import figures
from trials.types import Trial, Value, with_setup

REPEATS = 8
RECORD = "first"
CONDITIONS = {REGIONS: tuple(WAYS.values())}
KEY_MEASURES = ("pieces", "clusters", "silhouette", "active_share", "strongest")


def base(repeat: int) -> Trial:
    """Pieces of a metre and a half, every three quarters of a metre; a herd that is spread as it likes to be."""
    placed: dict[str, Value] = {"size_m": 2.5, "heading_spread_deg": 10.0}
    chosen = trial("decompose", repeat, [herd()], "race", formation_parameters=placed, method=DECOMPOSITION)
    return with_setup(chosen, {"pieces.window_m": 1.5, "pieces.stride_m": 0.75, "pieces.pairs": 40})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures"]
