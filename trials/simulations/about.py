"""What a measure's number means; which measures there are is said where they are computed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from trials.types import Trial


class Measure(NamedTuple):
    """Unit and meaning of one measure."""

    unit: str
    text: str


def about(trials: Sequence[Trial]) -> dict[str, Measure]:
    """The measures of trials of one kind, in the order in which they are shown."""
    from trials.simulations import is_kinematic

    if trials and is_kinematic(trials[0]):
        from trials.simulations.kinematic.links import ABOUT as LINKS
        from trials.simulations.kinematic.measures import ABOUT as KINEMATIC

        return KINEMATIC | LINKS
    from trials.simulations.robots.measures import ABOUT as PHYSICAL

    return PHYSICAL
