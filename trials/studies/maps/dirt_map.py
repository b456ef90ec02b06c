"""Parameter-space maps of DIRT: four anchors for seven members, and anchor four refined for one, three and seven.

Fine 2015, section 7.4.2, figures 7.10 to 7.13: the wall's angle and length. A configuration is successful if the herd
turns right in at least 90 % of twenty simulations, from ten starts and their mirror images. A repeat is another set of
maps, with other starts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.studies.maps import design
from trials.studies.maps.claims import of_dirt as claims
from trials.studies.maps.design import ANCHOR, COUNT, MEMBERS, PUBLISHED_BOX, REFINEMENTS
from trials.studies.maps.figures import of_dirt as figures
from trials.types import Trial, Value, with_setup

REPEATS = 1
RECORD = "first"
CONDITIONS = {ANCHOR: (1, 2, 3, 4), COUNT: (1, 3, 7), REFINEMENTS: (0, 6)}
SOURCES = {
    COUNT: Parameter("members", "Fine 2015, section 7.4.2", published=True),
    ANCHOR: Parameter("", "Fine 2015, section 7.4.2", published=True),
    REFINEMENTS: Parameter("", "Fine 2015, section 7.4.2: six for anchor four", published=True),
}
KEY_MEASURES = ("configurations", "successful", "region_area", "region_density", "success_inside", "success_outside")


def base(repeat: int) -> Trial:
    """Seven members and a wall at anchor four."""
    return with_setup(design.base("dirt-map", repeat, "dirt"), PUBLISHED_BOX)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """The first iteration at each anchor for seven members; the refined map of anchor four for each group size."""
    shallow, deep = min(conditions[REFINEMENTS]), max(conditions[REFINEMENTS])
    found: list[dict[str, Value]] = [
        {ANCHOR: anchor, COUNT: MEMBERS, REFINEMENTS: shallow}
        for anchor in conditions[ANCHOR]
        if MEMBERS in conditions[COUNT]
    ]
    refined = [{ANCHOR: 4, COUNT: count, REFINEMENTS: deep} for count in conditions[COUNT] if 4 in conditions[ANCHOR]]
    return found + [cell for cell in refined if cell not in found]


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures"]
