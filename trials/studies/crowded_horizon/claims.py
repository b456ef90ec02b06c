"""Table 4.1 of Fine 2015 held against a run of its 160 simulations, and the claim that the range changes nothing.

A cell of the table counts as reproduced where the mean of the trials' MMD at the end lies within a margin of the
printed number (two one-sided tests at 5 %): 0.005 for a single group, half a unit of the table's last digit; 0.15 for
a split one, some three standard errors of a mean of ten trials. The same margins say what counts as no difference
between the two ranges, of which trials of one repeat share their start.
"""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, near, same
from trials.evidence.runs import Cells, Run

KEYS = ("formation", "herd.law", "herd.selection")
MEASURE = "mmd_end"
MARGINS = {"single-group": 0.005, "split-group": 0.15}
"""m. Choices."""
NEAR, FAR = "distance-based(0, 3)", "distance-based(0, 3000)"
SOURCE = "fine2015 table_4_1"


def claims(run: Run) -> list[Entry]:
    """An entry for each of the table's eight cells and one for the ranges, for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    table = published(__package__, "fine2015", "table_4_1")
    found = []
    for formation, margin in MARGINS.items():
        for variation, value in table[formation.replace("-", "_")].items():
            name = variation.replace("_", "-")
            found.append(
                Question(
                    source=f"{SOURCE} (section 4.3)",
                    quantity=f"{formation}, {name}",
                    claim=f"MMD of {name} from a {formation} start, range {table['sensing_ranges'][0]:g}: {value:g}",
                    judge=all_must_hold(
                        f"mean of the trials within ±{margin:g} of it (two one-sided tests)",
                        partial(_cell, cells, formation, f"lch-{name}", value, margin),
                    ),
                    published=value,
                )
            )
    judge = all_must_hold(
        "every paired difference within its margin (two one-sided tests); all eight must be",
        partial(_ranges, cells, list(table["single_group"])),
    )
    return [*found, claim_of(__package__, "fine2015", "lch_claims", 1, "range 3000 less range 3", judge)]


def _cell(cells: Cells, formation: str, law: str, value: float, margin: float) -> list[Outcome]:
    found = cells.array(MEASURE, formation, law, NEAR)
    return [near("MMD at the end, m", found, value, margin)]


def _ranges(cells: Cells, variations: list[str]) -> list[Outcome]:
    found = []
    for formation, margin in MARGINS.items():
        for variation in variations:
            law = f"lch-{variation.replace('_', '-')}"
            differences = cells.difference(MEASURE, (formation, law, FAR), (formation, law, NEAR))
            found.append(same(f"MMD, {formation}, {law}, m", differences, margin))
    return found
