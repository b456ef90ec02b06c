"""Kirchner 2006, figure 4.5: three robots that all run the software, two side by side and one ahead between them.

The rear robots are six feet apart, the front one 4.5 feet ahead. It sees no cone and goes straight on. The text does
not say for how long they went: a third of a minute at 0.2 m/s takes the front robot as far as section 4.4 has it.
"""

from __future__ import annotations

from trials.simulations.robots.fields import trial
from trials.studies.monocular.claims import three_claims as claims
from trials.studies.monocular.design import BODIES, BODY, FOOT, HERD, KEY_MEASURES, LEAD, SOURCES, finish, seeing
from trials.studies.monocular.figures import figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {BODY: BODIES}
APART_FT, AHEAD_FT = 6.0, 4.5
SECONDS = 20.0


def base(repeat: int) -> Trial:
    """The front robot and the two behind it."""
    front = seeing(1, name=LEAD, start_x_m=AHEAD_FT * FOOT)
    rear = seeing(2, name=HERD, formation="single-group", spacing_m=APART_FT * FOOT)
    return trial("three-robots", repeat, [rear, front], world="open-floor", duration_s=SECONDS)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
