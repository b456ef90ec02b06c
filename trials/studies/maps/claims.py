"""What Fine 2015 says of its maps (sections 7.4.2 and 8.1) held against runs of this study's experiments.

The publication drew each map once and judged it by eye; here maps are repeated with other random numbers, and each
measure has as many independent values as there are repeats. What its words mean in numbers is our reading, and stands
below. The sizes of effects that count are choices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.maps.design import (
    ANCHOR,
    COUNT,
    FEW,
    IN_A_LINE,
    MEMBERS,
    METHOD,
    REFINEMENTS,
    SOLITARY,
    WORLD,
)

ONE = 0.5
"""Half a configuration: the least difference of counts that counts."""
DENSE, SMALL, ABSENT = 0.5, 0.25, 0.1
"""A region is dense from a density of a half; small up to a quarter of the space; absent up to a tenth of the area of
that of seven members."""
RELIABLE, MARGIN = 0.9, 0.1
"""Success inside of the published box, and by how much it must exceed that outside."""
EFFICIENT, TREND = 0.05, 0.1
"""Differences of shares of successful configurations, and rank correlations, that count."""
MOST, ONLY_A_FEW = 0.5, 0.05
"""Shares of configurations: the majority, and only a few."""
DIRT_KEYS = (ANCHOR, COUNT, REFINEMENTS)


def of_dirt(run: Run) -> list[Entry]:
    """The five claims on DIRT's maps."""

    def questions(cells: Cells) -> list[Question]:
        region = "region of anchor 4, seven members"
        return [
            _claim("dirt_maps", 1, "successful configurations, first iteration",
                   "anchor 4 less each other anchor, paired by repeat, above 0", partial(_anchors, cells)),
            _claim("dirt_maps", 2, region,
                   f"density above {DENSE:g}, and above the area by {MARGIN:g}", partial(_dense, cells)),
            _claim("dirt_maps", 3, region,
                   f"success in the box above {RELIABLE:g}, and {MARGIN:g} above that outside", partial(_box, cells)),
            _claim("dirt_maps", 4, region, f"area below {SMALL:g} of the possible parameters", partial(_small, cells)),
            _claim("dirt_maps", 5, "regions of anchor 4 by group size",
                   f"area with one and with three below {ABSENT:g} of that with seven", partial(_absent, cells)),
        ]  # fmt: skip

    return answers(run, DIRT_KEYS, questions)


def of_sampling(run: Run) -> list[Entry]:
    """The claim on random parameter selection."""

    def questions(cells: Cells) -> list[Question]:
        test = f"share of successful configurations, quad-tree less random at equal budget, above {EFFICIENT:g}"
        return [_claim("dirt_maps", 6, "successful configurations", test, partial(_sampling, cells))]

    return answers(run, (METHOD,), questions)


def of_dsdr(run: Run) -> list[Entry]:
    """Both claims on DSDR, which are on ten members."""

    def questions(cells: Cells) -> list[Question]:
        most, few = f"share of the configurations above {MOST:g}", f"share of the configurations below {ONLY_A_FEW:g}"
        deviation = f"deviation along x of {IN_A_LINE} members"
        return [
            _claim("dsdr_map", 1, f"{deviation} from 1.5 to 4.0 m", most, partial(_typical, cells)),
            _claim("dsdr_map", 2, f"{deviation} below 0.5 m", few, partial(_lines, cells)),
        ]

    return answers(run, (COUNT,), questions)


def of_sirt(run: Run) -> list[Entry]:
    """The claim on rule 3, which is on seven members."""

    def questions(cells: Cells) -> list[Question]:
        test = f"rank correlation of success with the probability of rule 3, first iteration, above {TREND:g}"
        return [_claim("sirt_map", 1, "success of seven members and rule 3", test, partial(_third, cells))]

    return answers(run, (COUNT,), questions)


def of_both(run: Run) -> list[Entry]:
    """SIRT, bottom up, against DIRT, top down: by number, and by persistence over group sizes."""

    def questions(cells: Cells) -> list[Question]:
        number = f"successful share, SIRT less DIRT, seven members, above {EFFICIENT:g}"
        persists = f"least share over the sizes as part of that of seven, SIRT less DIRT, above {EFFICIENT:g}"
        return [
            _claim("sirt_map", 2, "successful configurations", number, partial(_number, cells)),
            _claim("sirt_map", 3, "persistence over group sizes", persists, partial(_persistence, cells)),
        ]

    return answers(run, (WORLD, COUNT), questions)


def _claim(table: str, number: int, quantity: str, test: str, outcomes: Callable[[], Sequence[Outcome]]) -> Question:
    return claim_of(__package__, "fine2015", table, number, quantity, all_must_hold(test, outcomes))


def _first(cells: Cells, anchor: int) -> tuple[Any, ...]:
    """The cell of an anchor for seven members at the fewest refinements that a run has."""
    return anchor, MEMBERS, min(cells.levels(REFINEMENTS))


def _refined(cells: Cells, count: int) -> tuple[Any, ...]:
    """The cell of anchor four at the most refinements that a run has for so many members."""
    depths = [depth for anchor, members, depth in cells.planned() if anchor == 4 and members == count and depth]
    if not depths:
        raise UndecidedError(f"the run has no refined map of anchor 4 for {count} members")
    return 4, count, max(depths)


def _anchors(cells: Cells) -> list[Outcome]:
    others = [anchor for anchor in cells.levels(ANCHOR) if anchor != 4]
    if not others:
        raise UndecidedError("the run has no other anchor")
    return [
        more(
            f"anchor 4 less anchor {anchor}",
            cells.difference("first_successful", _first(cells, 4), _first(cells, anchor)),
            ONE,
        )
        for anchor in others
    ]


def _dense(cells: Cells) -> list[Outcome]:
    cell = _refined(cells, MEMBERS)
    density = cells.array("region_density", *cell)
    return [
        above("density", density, DENSE, MARGIN, bounds=(0.0, 1.0)),
        more("density less area", density - cells.array("region_area", *cell), MARGIN),
    ]


def _box(cells: Cells) -> list[Outcome]:
    cell = _refined(cells, MEMBERS)
    inside, outside = cells.array("success_inside", *cell), cells.array("success_outside", *cell)
    return [
        above("share of successful simulations inside", inside, RELIABLE, MARGIN, bounds=(0.0, 1.0)),
        more("inside less outside", inside - outside, MARGIN),
        more("inside less the empty world", cells.array("uplift_inside", *cell), MARGIN, decides=False),
    ]


def _small(cells: Cells) -> list[Outcome]:
    area = cells.array("region_area", *_refined(cells, MEMBERS))
    return [above("share of the parameters outside of the region", 1.0 - area, 1.0 - SMALL, MARGIN, bounds=(0.0, 1.0))]


def _absent(cells: Cells) -> list[Outcome]:
    found = []
    for count in (SOLITARY, FEW):
        area = cells.difference("region_area", _refined(cells, count), _refined(cells, MEMBERS))
        whole = cells.array("region_area", *_refined(cells, MEMBERS))
        left: Floats = ABSENT * whole - (area + whole)
        found.append(above(f"a tenth of the area with seven less that with {count}", left, 0.0, ABSENT))
    return found


def _sampling(cells: Cells) -> list[Outcome]:
    change = cells.difference("successful_share", ("quad-tree",), ("random",))
    return [more("quad-tree less random", change, EFFICIENT)]


def _typical(cells: Cells) -> list[Outcome]:
    share = cells.array("x_deviation_within", IN_A_LINE)
    return [above("share of the configurations", share, MOST, MARGIN, bounds=(0.0, 1.0))]


def _lines(cells: Cells) -> list[Outcome]:
    share = cells.array("x_deviation_below", IN_A_LINE)
    label = "share of the configurations that are not"
    return [above(label, 1.0 - share, 1.0 - ONLY_A_FEW, ONLY_A_FEW, bounds=(0.0, 1.0))]


def _third(cells: Cells) -> list[Outcome]:
    return [more("rank correlation", cells.array("trend_rest", MEMBERS), TREND)]


def _number(cells: Cells) -> list[Outcome]:
    return [more("SIRT less DIRT", cells.difference("successful_share", ("sirt", 7), ("dirt", 7)), EFFICIENT)]


def _persistence(cells: Cells) -> list[Outcome]:
    kept = []
    for schema in ("dirt", "sirt"):
        shares = {count: cells.array("successful_share", schema, count) for count in cells.levels(COUNT)}
        if MEMBERS not in shares or len(shares) < 2:
            raise UndecidedError("the run has no other group size than seven")
        least = np.min(list(shares.values()), axis=0)
        kept.append(np.where(shares[MEMBERS] > 0.0, least / np.maximum(shares[MEMBERS], 1e-12), 0.0))
    return [more("SIRT less DIRT", kept[1] - kept[0], EFFICIENT)]
