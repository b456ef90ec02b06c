"""What decompositions are held against: section 8.1.1 of Fine 2015, which has no numbers, and our own claims."""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more
from trials.evidence.runs import Cells, Run

REGIONS = "pieces.regions"
WAYS = {
    "undirected": "",
    "directed": "left wing: -3, 1, -0.9, 4.4; right wing: 0.9, 1, 3, 4.4; lane: -2, 4.51, 2, 6; bend: -2, 6.01, 9, 12",
}
"""By kind of decomposition, the regions: m, of the race with the parameters that it has by default."""
ACTIVE_MARGIN = 0.01
"""Share of the pieces that may change something by chance (`ACTIVE_Z` of the measures): a choice."""


def claims(run: Run) -> list[Entry]:
    """An entry for each kind of decomposition, for each arm of the run."""
    return answers(run, (REGIONS,), _questions)


def _questions(cells: Cells) -> list[Question]:
    present = {regions for (regions,) in cells.planned()}
    found = []
    if WAYS["undirected"] in present:
        judge = all_must_hold("more clusters than one", partial(_clusters, cells))
        found.append(claim_of(__package__, "fine2015", "proposals", 2, "clusters of the window's pieces", judge))
    if WAYS["directed"] in present:
        judge = all_must_hold("share of the regions that change something above chance", partial(_active, cells))
        found.append(claim_of(__package__, "ours", "pieces", 1, "regions that act alone", judge))
    return found


def _clusters(cells: Cells) -> list[Outcome]:
    return [above("clusters", cells.array("clusters", WAYS["undirected"]), 1.0, 1.0)]


def _active(cells: Cells) -> list[Outcome]:
    return [more("share of active regions", cells.array("active_share", WAYS["directed"]), ACTIVE_MARGIN)]
