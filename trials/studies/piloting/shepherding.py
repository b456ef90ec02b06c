"""Formations along walls beside sheepdogs: six robots, or one, three and six dogs by each of two rules, 320 trials.

Beyond Fine 2015, who leaves other ways of guiding to others: what a user would else take from the field, on the same
tasks with the same herd and the same robots. Dogs start behind the herd and have the next corner of the trajectory for
their goal. Six dogs are as many as a formation has robots.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.studies.piloting import design
from trials.studies.piloting.design import GUIDES, NOTHING, PILOTS, SHEEPDOGS, TASK, TASKS, finish
from trials.studies.piloting.shepherding_claims import COUNT, COUNTS, RULE, RULES, claims
from trials.studies.piloting.shepherding_figures import figures
from trials.types import Trial, Value

REPEATS = 10
RECORD = "first"
CONDITIONS = {TASK: TASKS, GUIDES: (PILOTS, SHEEPDOGS, NOTHING), RULE: RULES, COUNT: COUNTS}
SOURCES = {
    TASK: Parameter("", "Fine 2015, section 8.2; its drawings are lost, the geometry is ours", published=True),
    GUIDES: Parameter("", "robots: Fine 2015, section 8.2; sheepdogs and nothing: ours"),
    COUNT: Parameter("robots", "a choice: one as in both publications, three, and as many as a formation has"),
}
KEY_MEASURES = (design.MEASURE, "astray_share", "pilot_herd_collisions", "pilot_collisions", "pilot_way")


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Of each task its guides: sheepdogs by each rule and in each number, the others once."""
    found: list[dict[str, Value]] = []
    for task, guides in itertools.product(conditions[TASK], conditions[GUIDES]):
        if guides != SHEEPDOGS:
            found.append({TASK: task, GUIDES: guides})
            continue
        for rule, count in itertools.product(conditions[RULE], conditions[COUNT]):
            found.append({TASK: task, GUIDES: guides, RULE: rule, COUNT: count})
    return found


def base(repeat: int) -> Trial:
    """The first task, guided by robots."""
    return design.base("shepherding", repeat)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
