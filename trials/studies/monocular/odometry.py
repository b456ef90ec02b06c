"""A Pioneer's odometry against the truth: straight ways and turns (Kirchner 2006, appendices B and C).

The robot drives until its own odometry says that it has gone a distance, or turned through an angle, as in the
publication's tests; what the odometry says then stands beside where it is. Distances of 1 to 5 m at 0.1 and 0.2 m/s,
of which the publication has seven pairs; turns by 45 to 180 degrees, in place by the wheels of both sides and on the
wheels of one side, since it does not say which: the displacement tells.

Nothing of the odometry is tuned. `herd.law.radius_error` is the part by which the robot takes its wheels for larger
than they are, 0 here; `--sweep herd.law.radius_error=0,0.025,0.065` shows which of them would explain the publication.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.robots.fields import group, trial
from trials.studies.monocular.odometry_claims import (
    ANGLES,
    IN_PLACE,
    ONE_SIDE,
    RATE,
    SPEED,
    STOP_M,
    STOP_RAD,
    TURN_RAD_S,
    claims,
)
from trials.studies.monocular.odometry_figures import figures
from trials.types import Trial, Value

REPEATS = 5
RECORD = "first"
CONDITIONS = {STOP_M: (1.0, 2.0, 2.5, 3.0, 4.0, 5.0), SPEED: (0.1, 0.2), STOP_RAD: ANGLES}
SOURCES = {
    STOP_M: Parameter("m", "Kirchner 2006, appendix B: from its table", published=True),
    STOP_RAD: Parameter("rad", "Kirchner 2006, appendix C: 45, 90, 135 and 180 degrees", published=True),
    SPEED: Parameter("m/s", "Kirchner 2006, appendix B; 0 and 0.0616 of turns: in place and on one side's wheels"),
    RATE: Parameter("rad/s", "a choice: twelve degrees a second, the publication gives none"),
    "herd.body": Parameter("", "Kirchner 2006, section 3.1", published=True),
    "herd.own_motion": Parameter("", "Kirchner 2006, appendices B and C: the robot's own odometry", published=True),
    "duration_s": Parameter("s", "a choice: the longest way takes 52 s"),
}
KEY_MEASURES = ("counted_way", "true_way", "counted_turn", "true_turn", "moved_aside", "lost")


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Each distance at each speed, and each angle both in place and on one side's wheels."""
    ways: list[dict[str, Value]] = [
        {STOP_M: distance, SPEED: speed, STOP_RAD: 0.0, RATE: 0.0}
        for distance in conditions[STOP_M]
        for speed in conditions[SPEED]
    ]
    turns: list[dict[str, Value]] = [
        {STOP_M: 0.0, SPEED: speed, STOP_RAD: angle, RATE: TURN_RAD_S}
        for angle in conditions[STOP_RAD]
        for speed in (IN_PLACE, ONE_SIDE)
    ]
    return ways + turns


def base(repeat: int) -> Trial:
    """One Pioneer on an open floor, at rest."""
    driven = group(
        "drive",
        1,
        body="pioneer",
        pipeline="perfect",
        own_motion="odometry",
        start_moving=False,
        law_parameters={"leg_1_s": 600.0, "leg_1_m_s": 0.1, "stop_m": 1.0},
    )
    return trial("odometry", repeat, [driven], world="open-floor", formation="single-file", duration_s=60.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures"]
