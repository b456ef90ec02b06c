"""Figure 4.4 of Fine 2015 as numbers: how directional LCH becomes when members see 240 degrees.

Directional motion is the net displacement of the group's centre from start to end. It counts as more with the limited
view where the paired difference exceeds a margin, the size of a step times the root of the number of steps (what a
random walk of the centre would reach).
"""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

from flocking import lawentry
from flocking.parameters import filled
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways
from trials.simulations.kinematic import fields
from trials.types import Trial

SELECTION = "herd.selection"
FULL, LIMITED = "all", "field-of-view(240)"
DIRECTED_MARGIN = 0.1
"""A tenth of the members' way; a choice."""


def claims(run: Run) -> list[Entry]:
    """One entry for each arm of the run."""
    return answers(run, (SELECTION,), _questions)


def _questions(cells: Cells) -> list[Question]:
    margin = random_walk_m(cells.trials[0])
    judge = all_must_hold(
        f"paired differences above {margin:.2f} m and {DIRECTED_MARGIN:g}",
        partial(_directional, cells, margin),
    )
    return [claim_of(__package__, "fine2015", "lch_claims", 3, "240 degrees less all around", judge)]


def random_walk_m(trial: Trial) -> float:
    """What a random walk of a trial's step and length reaches; without a step of its own, one at cruising speed."""
    (group,), given = trial.groups, fields.of_trial(trial)
    module = lawentry.module_of(group.law, group.law_source)
    law = filled(module.Parameters, group.law_parameters)
    step = getattr(law, "step_m", fields.of_group(group).cruise_m_s * given.timestep_s)
    return float(step) * math.sqrt(given.steps)


def _directional(cells: Cells, margin: float) -> list[Outcome]:
    return [
        more(
            "net displacement of the centre, m",
            cells.difference("net_displacement", (LIMITED,), (FULL,)),
            margin,
        ),
        more("the same over the members' way", cells.difference("directedness", (LIMITED,), (FULL,)), DIRECTED_MARGIN),
    ]


def figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 4.4: the ways with either view."""
    return by_arm(run, folder, (SELECTION,), _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    shown = panels(run, [(name, {SELECTION: name}) for name in (FULL, LIMITED)])
    caption = "Blue: where members start; green: where they end; first trial of each. As figure 4.4 of Fine 2015."
    return [draw.save(ways(shown, columns=2), place, "ways", "Ways", caption, dots=True)]
