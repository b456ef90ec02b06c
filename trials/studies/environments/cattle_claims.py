"""The stages of cattle held against what Fine 2015, section 6.1.3, expects of schemas that combine others.

Each trial gives the mean fitness of its environments in each stage, with the construct and without it. A stage is
elicited where the difference exceeds `MARGIN`, a choice, a twentieth of what a fitness can be.
"""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run

KEYS = ("varied",)
WALLS = {"": "the schema's own walls", "all": "walls drawn at random"}
STAGES = ("corralled", "lined up", "sorted")
MARGIN = 0.05


def claims(run: Run) -> list[Entry]:
    """For each kind of walls an entry a stage and one of all stages, for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    found = []
    for (varied,) in cells.planned():
        walls = WALLS.get(varied, f"{varied} drawn at random")
        every = range(1, len(STAGES) + 1)
        for name, stages in (*((STAGES[k - 1], [k]) for k in every), ("all three", list(every))):
            judge = all_must_hold(
                f"fitness with the construct less without above {MARGIN:g}", partial(_stages, cells, varied, stages)
            )
            found.append(claim_of(__package__, "fine2015", "cattle_claims", 1, f"{name}, {walls}", judge))
    return found


def _stages(cells: Cells, varied: str, stages: list[int]) -> list[Outcome]:
    found = []
    for stage in stages:
        with_it, without = cells.array(f"stage_{stage}", varied), cells.array(f"control_stage_{stage}", varied)
        label = f"{STAGES[stage - 1]} {with_it.mean():.3f}, {without.mean():.3f} in the empty world, difference"
        found.append(more(label, with_it - without, MARGIN))
    return found
