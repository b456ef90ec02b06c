"""The figures of the LCH experiments: figures 4.4 and 4.5 of Fine 2015 redrawn."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways
from trials.studies.crowded_horizon.claims import FAR, KEYS, NEAR

VARIATIONS = ("lch-group-pose", "lch-group-bearing", "lch-member-pose", "lch-member-bearing")


def figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 4.5: a typical trial of each variation, from a single group at range 3000 and a split one at range 3."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    starts = (("single-group", FAR, "range 3000"), ("split-group", NEAR, "range 3"))
    published = [
        (f"{law}\n{formation}, {name}", {"formation": formation, "herd.law": law, "herd.selection": selection})
        for law in VARIATIONS
        for formation, selection, name in starts
    ]
    caption = (
        "Blue: where members start; green: where they end; the first trial of each variation, from a single group at "
        "range 3000 and a split one at range 3, as figure 4.5 of Fine 2015, or of each other cell."
    )
    return [draw.save(ways(panels(run, published)), place, "ways", "Ways", caption, dots=True)]
