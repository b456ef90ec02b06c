"""The figures of the LCH experiments: figures 4.4 and 4.5 of Fine 2015 redrawn."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.figures import Figure
from trials.reports.ways import first_result, ways
from trials.studies.crowded_horizon.claims import FAR, NEAR

VARIATIONS = ("lch-group-pose", "lch-group-bearing", "lch-member-pose", "lch-member-bearing")


def figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 4.5: a typical trial of each variation, from a single group at range 3000 and a split one at range 3."""
    panels = []
    for law in VARIATIONS:
        for formation, selection, name in (("single-group", FAR, "range 3000"), ("split-group", NEAR, "range 3")):
            cell = {"formation": formation, "herd.law": law, "herd.selection": selection}
            panels.append((f"{law}\n{formation}, {name}", first_result(run, cell)))
    caption = (
        "Blue: where members start; green: where they end; the first trial of each variation, from a single group at "
        "range 3000 and a split one at range 3. As figure 4.5 of Fine 2015."
    )
    return [draw.save(ways(panels), folder, "ways", "Ways", caption, dots=True)]
