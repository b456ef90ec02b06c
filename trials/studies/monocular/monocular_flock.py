"""Flocking by two cameras: 3, 6 and 12 Creates and three Pioneers for a minute, and the same law with perfect sensing.

Kirchner 2006 has three Pioneers and the nearest neighbour alone; its first extension is all neighbours (section 5.1).
Robots start scattered, each in sight of some other; a flock is what no gap of more than four feet divides (section
3.3), and nobody heeds who is more than eight feet away, as in its simulation. Perfect sensing has the cameras' view,
220 degrees and eight feet, with robots hiding one another and without, and measures from centre to centre where images
give the way from the lens to the cone's near side.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.robots.fields import trial
from trials.studies.monocular.design import BODIES, BODY, FOOT, HERD, LAW, RATE_HZ, from_the_lens, seeing
from trials.studies.monocular.flock_claims import COUNT, NEAREST, OCCLUSION, ONE, PERFECT, PIPELINE, SEVERAL, claims
from trials.studies.monocular.flock_figures import figures
from trials.types import Trial, Value, with_setup

REPEATS = 3
RECORD = "first"
CONDITIONS = {COUNT: (3, 6, 12), PIPELINE: (ONE, SEVERAL, PERFECT)}
PIONEERS = 3
SOURCES = {
    COUNT: Parameter("robots", "Kirchner 2006 has three; more are ours", published=True),
    NEAREST: Parameter("", "Kirchner 2006, section 3.6.1.1, and all neighbours as of section 5.1", published=True),
    PIPELINE: Parameter("", "Kirchner 2006, sections 3.6.4 to 3.6.6; several cones and perfect sensing are ours"),
    "duration_s": Parameter("s", "Kirchner 2006, section 3.3: one minute", published=True),
    f"{HERD}.rate_hz": Parameter("Hz", "a choice: the cameras' bound is 60"),
    "formation": Parameter("", "a choice: each in sight of some other"),
}
KEY_MEASURES = ("flocks", "one_flock_share", "polarization", "largest_share", "member_collisions", "closest")
SECONDS = 60.0
SCATTERED: dict[str, Value] = {"gap_m": 0.9, "length_m": 4.0, "half_width_m": 1.2, "heading_spread_deg": 60.0}
VIEW: dict[str, Value] = {"field_of_view_rad": math.radians(220.0), "range_m": 8 * FOOT}
"""Of perfect sensing: Kirchner 2006, sections 3.1 and 3.3."""


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Creates of all counts and three Pioneers, by each way of seeing.

    One run of pixels is one neighbour, the nearest; a detection of several has the nearest of them, or all.
    """
    herds: list[dict[str, Value]] = [{COUNT: count} for count in conditions[COUNT]]
    herds.append({COUNT: PIONEERS, BODY: BODIES[0]})
    ways = [way for pipeline in conditions[PIPELINE] for way in _ways(pipeline)]
    return [{**herd, **way} for herd in herds for way in ways]


def _ways(pipeline: str) -> list[dict[str, Value]]:
    """One run of pixels is one neighbour; others have one or all, by perfect sensing hidden by others or not."""
    if pipeline == ONE:
        return [{PIPELINE: pipeline, NEAREST: True}]
    if pipeline != PERFECT:
        return [{PIPELINE: pipeline, NEAREST: near} for near in (True, False)]
    return [{PIPELINE: pipeline, NEAREST: near, OCCLUSION: hides} for near in (True, False) for hides in (True, False)]


def base(repeat: int) -> Trial:
    """Creates with eyes, scattered."""
    herd = with_setup(seeing(3), {"body": BODIES[1], "formation": "together", "rate_hz": RATE_HZ})
    kept = {key: value for key, value in herd.setup.items() if not key.startswith("formation.")}
    herd = dataclasses.replace(
        herd, setup={**kept, "cameras.judged": False}, law_parameters={**LAW, "range_m": 8 * FOOT, "nearest_only": True}
    )
    return trial(
        "monocular-flock", repeat, [herd], world="open-floor", formation="scattered",
        formation_parameters=SCATTERED, duration_s=SECONDS,
    )  # fmt: skip


def finish(trial: Trial) -> Trial:
    """Perfect sensing has the cameras' view; images have distances from the lens."""
    (herd,) = trial.groups
    view = VIEW if herd.pipeline == PERFECT else {}
    herd = from_the_lens(dataclasses.replace(herd, pipeline_parameters={**view, **herd.pipeline_parameters}))
    return dataclasses.replace(trial, groups=(herd,))


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
