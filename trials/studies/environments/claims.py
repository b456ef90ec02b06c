"""Tables 7.1 and 7.2 of Fine 2015 held against a run of `maebe`, and the uplift over the empty world.

Each trial gives a rate of some fifty environments, and the repeats' rates are independent numbers: a published rate
counts as reproduced where their mean lies within a margin of it (two one-sided tests). The margin is 0.03 for the
filters, which simulate nothing, and 0.05 for the behaviours, a twentieth of what a rate can be; both are choices.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, above, more, near
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.environments import design
from trials.studies.environments.design import OF_BEHAVIOURS, PRESETS, Preset

PASSED_MARGIN, VALID_MARGIN = 0.03, 0.05
NAMES = {"reynolds-boids": "BOIDS", "viscido-snn": "SNN+", "random-motion": "RM+"}
BEHAVIOURS = {"simple-split": "simple split", "balanced-split": "balanced split", "corralling": "corralling"}


def claims(run: Run) -> list[Entry]:
    """Entries for both filters, all nine rates in each preset, their uplift, and the worst and the best case."""
    return answers(run, design.KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    found = [
        Question(
            source="fine2015 table_7_1 (section 7.2)",
            quantity=f"share of {schema} environments that pass",
            claim=f"share of the {schema} environments that pass their filter: {rate:g}",
            judge=all_must_hold(
                f"mean of the trials within ±{PASSED_MARGIN:g} of it (two one-sided tests)",
                partial(_passed, cells, schema, rate),
            ),
            published=rate,
        )
        for schema, rate in published(__package__, "fine2015", "table_7_1").items()
    ]
    present = [preset for preset in PRESETS if _has(cells, preset)]
    for preset in present:
        for behaviour in OF_BEHAVIOURS:
            rates = published(__package__, "fine2015", "table_7_2")[behaviour]
            found += [_rate(cells, behaviour, law, preset, rate) for law, rate in rates.items()]
    everywhere = f"uplift above {VALID_MARGIN:g} for every behaviour, law and preset"
    found.append(_claim(1, "uplift over the empty world", everywhere, partial(_uplifts, cells, present)))
    least = "less than each of the other rates of its preset"
    found.append(_claim(2, "valid environments", least, partial(_extreme, cells, present, True)))
    most = "more than each of the other rates of its preset"
    found.append(_claim(3, "valid environments", most, partial(_extreme, cells, present, False)))
    return found


def _claim(number: int, quantity: str, test: str, outcomes: Callable[[], Sequence[Outcome]]) -> Question:
    judge = all_must_hold(test, outcomes)
    return claim_of(__package__, "fine2015", "maebe_claims", number, quantity, judge)


def _rate(cells: Cells, behaviour: str, law: str, preset: Preset, rate: float) -> Question:
    where = f"{BEHAVIOURS[behaviour]}, {NAMES[law]}, {_told(preset)}"
    return Question(
        source="fine2015 table_7_2 (section 7.2)",
        quantity=where,
        claim=f"share of the environments that passed that elicit {BEHAVIOURS[behaviour]} from {NAMES[law]}: {rate:g}",
        judge=all_must_hold(
            f"mean of the trials within ±{VALID_MARGIN:g} of it (two one-sided tests)",
            partial(_valid, cells, _cell(behaviour, law, preset), rate),
        ),
        published=rate,
    )


def _passed(cells: Cells, schema: str, rate: float) -> list[Outcome]:
    """Of the first cell of the schema: what passes does not depend on what is done with it."""
    for cell in cells.planned():
        if cell[0] == schema:
            return [near("share that passes", cells.array("pass_rate", *cell), rate, PASSED_MARGIN)]
    raise UndecidedError(f"the run has no trials with {design.WORLD} = {schema}")


def _valid(cells: Cells, cell: tuple[Any, ...], rate: float) -> list[Outcome]:
    uplift = above("uplift over the empty world", cells.array("uplift", *cell), 0.0, VALID_MARGIN, decides=False)
    return [near("share that elicits it", cells.array("valid_rate", *cell), rate, VALID_MARGIN), uplift]


def _uplifts(cells: Cells, presets: Sequence[Preset]) -> list[Outcome]:
    return [
        more(f"uplift, {BEHAVIOURS[behaviour]}, {NAMES[law]}, {_told(preset)}",
             cells.array("uplift", *_cell(behaviour, law, preset)), VALID_MARGIN)
        for preset in presets
        for behaviour in OF_BEHAVIOURS
        for law in design.LAWS
    ]  # fmt: skip


def _extreme(cells: Cells, presets: Sequence[Preset], least: bool) -> list[Outcome]:
    """How much more the others have than the least, or the most than the others."""
    named = ("corralling", "viscido-snn") if least else ("balanced-split", "random-motion")
    found = []
    for preset in presets:
        own = _cell(*named, preset)
        for behaviour, law in itertools.product(OF_BEHAVIOURS, design.LAWS):
            other = _cell(behaviour, law, preset)
            if other != own:
                pair = (other, own) if least else (own, other)
                label = f"{_told(preset)}: {'more' if least else 'less'} by {NAMES[law]}, {BEHAVIOURS[behaviour]}"
                found.append(above(label, cells.difference("valid_rate", *pair), 0.0, VALID_MARGIN))
    return found


def _cell(behaviour: str, law: str, preset: Preset) -> tuple[Any, ...]:
    return tuple(design.cell(behaviour, law, preset).values())


def _has(cells: Cells, preset: Preset) -> bool:
    return any(cell[3:] == tuple(preset) for cell in cells.planned())


def _told(preset: Preset) -> str:
    return f"start {preset.size_m:g} m, {preset.speed_m_s:g} m/s"
