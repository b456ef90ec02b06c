"""What Fine 2015 says of Hamilton's simulations (section 2.1.1), held against a run; and where the groups end.

Groups: single linkage at the trial's `cut_m`. "Many small" is read as: more than `MANY` groups at the end, none of
which holds half of the members. "A single compact group": one group, whose members stand nearer to its middle at the
end than at the start.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from flocking.types import Floats
from trials.evidence.claims import Cells, Entry, Outcome, Question, Run, above, answered, arms, more, near, published
from trials.reports import figures as draw
from trials.reports.figures import Figure
from trials.reports.ways import first_result, ways

LAW = "herd.law"
ORIGINAL, MERGING = ("viscido-ha", "hamilton-2d"), "hamilton-merging"
MANY = 5.0
"""Groups of a hundred members; a choice."""
HALF = 0.5
GROUPS_MARGIN, SHARE_MARGIN, SPREAD_MARGIN_M = 0.5, 0.1, 0.5
"""Choices: half a group; a tenth of the members; half a body-length."""


def claims(run: Run) -> list[Entry]:
    """An entry for each rule's small groups and one for the merging, for each arm of the run."""
    told, entries = published(__package__, "fine2015", "hamilton_claims"), []
    for arm, trials in arms(run, (LAW,)):
        cells = Cells(trials, run.rows(), (LAW,))
        for law in ORIGINAL:
            entries.append(
                answered(
                    Question(
                        f"fine2015 hamilton_claims, claim 1 (section {told['sections'][0]})",
                        law,
                        told["claims"][0],
                        f"more than {MANY:g} groups at the end, the largest of less than half of the members",
                        partial(_small, cells, law),
                    ),
                    cells,
                    arm,
                )
            )
        entries.append(
            answered(
                Question(
                    f"fine2015 hamilton_claims, claim 2 (section {told['sections'][1]})",
                    MERGING,
                    told["claims"][1],
                    f"one group within ±{GROUPS_MARGIN:g} (two one-sided tests), nearer together than at the start",
                    partial(_single, cells),
                ),
                cells,
                arm,
            )
        )
    return entries


def _values(cells: Cells, measure: str, law: str) -> Floats:
    return cells.array(measure, law)


def _small(cells: Cells, law: str) -> list[Outcome]:
    free = 1.0 - _values(cells, "largest_share_end", law)
    return [
        above(f"groups at the end, {law}", _values(cells, "groups_end", law), MANY, GROUPS_MARGIN),
        above(f"share of the members outside the largest group, {law}", free, HALF, SHARE_MARGIN),
    ]


def _single(cells: Cells) -> list[Outcome]:
    shrunk = _values(cells, "mmd_start", MERGING) - _values(cells, "mmd_end", MERGING)
    return [
        near("groups at the end", _values(cells, "groups_end", MERGING), 1.0, GROUPS_MARGIN),
        more("MMD at the start less that at the end, m", shrunk, SPREAD_MARGIN_M),
    ]


def figures(run: Run, folder: Path) -> list[Figure]:
    """The ways of the first trial with each rule."""
    panels = [(law, first_result(run, {LAW: law})) for law in (*ORIGINAL, MERGING)]
    caption = "Blue: where members start; green: where they end. The first trial with each rule: same start."
    return [draw.save(ways(panels, columns=3), folder, "ways", "Ways", caption, dots=True)]
