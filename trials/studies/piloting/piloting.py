"""Table 8.1 of Fine 2015: four Creates guided through four tasks, by walls or by six robots in formations, 80 trials.

In task 3 no walls that stand all the time guide a herd (`herd plan task-3 --exhaust` shows it for a grid), so that
walls rise and vanish there too, when the herd has cleared them.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.studies.piloting import design
from trials.studies.piloting.claims import claims
from trials.studies.piloting.design import GUIDES, KEYS, PILOTS, TASK, TASKS, WALLS, finish
from trials.studies.piloting.figures import figures
from trials.types import Trial

REPEATS = 10
RECORD = "first"
CONDITIONS = {TASK: TASKS, GUIDES: (WALLS, PILOTS)}
SOURCES = {
    TASK: Parameter("", "Fine 2015, section 8.2; its drawings are lost, the geometry is ours", published=True),
    GUIDES: Parameter("", "Fine 2015, section 8.2", published=True),
}
KEY_MEASURES = (design.MEASURE, "walls_cleared", "change_s", "pilot_herd_collisions", "pilot_collisions")


def base(repeat: int) -> Trial:
    """The first task, guided by robots."""
    return design.base("piloting", repeat)


__all__ = ["CONDITIONS", "KEYS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
