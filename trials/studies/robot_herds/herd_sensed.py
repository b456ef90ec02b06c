"""Robot herds by sensors: the herding algorithm on Creates with lasers and Pioneers with cameras, and told all.

Hodgins and Brogan 1994, section 3.2: the algorithm reads its neighbours' desired velocities, of which the publication
says that a sensor could not measure them. A sensor gives places, and by following them actual velocities. Perfect
detection tells of desired or of actual ones; what is sensed comes from the three laser detections and two of cones.

Small herds on the open floor, behind a robot whose goal is far away, 45 degrees to the left of where all look at first:
a leg of the publication's zigzag. The law is scaled to each body so that its numbers without units stay as published.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from flocking.laws import hodgins_brogan
from flocking.parameters import Parameter
from robots import body as bodies
from trials.simulations.robots import desires
from trials.simulations.robots.fields import group, of_group, trial
from trials.studies.robot_herds.design import BODY, SOURCE, VELOCITIES
from trials.types import Group, Trial, Value, with_setup

REPEATS = 10
RECORD = "none"
PIPELINE = "herd.pipeline"
CREATE, PIONEER = BODIES = ("create", "pioneer")
PERFECT = "perfect"
LASER = ("member-based", "member-extrapolated", "sensor-based")
EYES = ("cone-member-extrapolated", "cone-blobs")
CONDITIONS = {BODY: BODIES, PIPELINE: (PERFECT, *LASER, *EYES), VELOCITIES: (desires.DESIRED, desires.ACTUAL)}
SOURCES = {
    BODY: Parameter("", "a choice: the bodies with sensors of the other publications"),
    PIPELINE: Parameter("", "Fine 2015, section 2.2, Kirchner 2006, sections 3.6.4 to 3.6.6, and global knowledge"),
    VELOCITIES: Parameter("", f"{SOURCE}, section 3.2: desired; a sensor has actual ones", published=True),
    "herd.law": Parameter("", f"{SOURCE}, sections 3.1 and 3.2", published=True),
    "herd.count": Parameter("robots", "a choice: a small herd"),
    "world": Parameter("", "a choice: the publication's plane"),
}
KEY_MEASURES = (
    "told_off_actual", "told_off_desired", "actual_off_desired", "no_velocity_share", "fn_share", "group_speed",
    "polarization", "mmd", "member_collisions",
)  # fmt: skip
SECONDS = 40.0
COUNT = 6
SPACING_DIAMETERS = hodgins_brogan.CREATE["spacing_m"] / 0.33
"""D in diameters of the body: the 0.8 m of the law's own set for Creates."""
SPEED = 0.5
"""Nominal speed over the body's top speed: a Create's 0.25 m/s; those behind can catch up."""
START = 1.25
"""Spacing at the start over D: as the Creates' usual 1 m."""
FAR_M = 1000.0
PAIRED: dict[str, Value] = {"association.gate_m": 0.5}
"""Of images: two columns of pixels at eight feet, where one is 0.23 m."""


class Scaled(NamedTuple):
    """The law of a body, m and s."""

    spacing_m: float
    nominal_m_s: float
    limit_m_s: float
    range_m: float
    kp_per_s: float


def scaled(body: str) -> Scaled:
    """The published law with D and the nominal speed v of a body: r / D, k_p D / v and k_v stay as published.

    No robot is told to go faster than its body can; the publication has no such limit.
    """
    of, told = bodies.load(body), hodgins_brogan.Parameters()
    spacing, nominal = round(SPACING_DIAMETERS * 2.0 * of.radius, 2), SPEED * of.top_speed
    return Scaled(
        spacing_m=spacing,
        nominal_m_s=nominal,
        limit_m_s=of.top_speed,
        range_m=round(spacing * told.range_m / told.spacing_m, 2),
        kp_per_s=round(told.kp_per_s * (told.spacing_m / told.nominal_m_s) / (spacing / nominal), 3),
    )


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Each body with perfect detection of desired and of actual velocities, and with what its sensors give."""
    return [
        {BODY: body, PIPELINE: pipeline, VELOCITIES: velocities}
        for body in conditions[BODY]
        for pipeline in conditions[PIPELINE]
        for velocities in conditions[VELOCITIES]
        if pipeline == PERFECT or (velocities == desires.ACTUAL and pipeline in (EYES if body == PIONEER else LASER))
    ]


def base(repeat: int) -> Trial:
    """Creates, of which the first has the goal."""
    herd = group("hodgins-brogan", COUNT, pipeline=PERFECT, informed=1, goal_x_m=FAR_M, goal_y_m=FAR_M)
    return trial("herd-sensed", repeat, [herd], world="open-floor", duration_s=SECONDS)


def finish(trial: Trial) -> Trial:
    """The law and the start follow from the body."""
    (herd,) = trial.groups
    law = scaled(of_group(herd).body)
    return dataclasses.replace(
        trial,
        groups=(_fitted(herd, law),),
        formation_parameters={"spacing_m": START * law.spacing_m, **trial.formation_parameters},
    )


def _fitted(herd: Group, law: Scaled) -> Group:
    own: dict[str, Value] = {"speed_m_s": law.nominal_m_s, "association.top_speed_m_s": law.limit_m_s}
    if herd.pipeline in EYES:
        own |= PAIRED
    herd = with_setup(herd, {**own, **herd.setup})
    return dataclasses.replace(herd, law_parameters={**law._asdict(), **herd.law_parameters})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "finish"]
