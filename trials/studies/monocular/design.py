"""What the tests with robots of Kirchner 2006 have in common (sections 4.1 and 4.2): who sees, who leads and how.

The text gives where robots start, where the lead robot turns and where all of them end; its figures are lost. The lead
robot's way is the simplest that says the same: straights and arcs that are tangent to one another. The places of
section 4.4 are taken as where robots end; which robot is which is read from the words. Robots are put down by hand:
places and headings differ a little from repeat to repeat.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

from flocking.parameters import Parameter
from sensing.camera.looking import MIDDLE
from trials.simulations.robots.fields import group, of_group, trial
from trials.simulations.robots.resolved import Resolved
from trials.types import Group, Trial, Value, with_setup

FOOT = 0.3048
LEAD, HERD = "lead", "herd"
BODY = "herd.body"
BODIES = ("pioneer", "create-with-cameras")
LEAD_M_S = 0.2
"""Speed of the lead robot: a choice, the faster one of appendix B."""
RATE_HZ = 10.0
"""Of images and commands: a choice; the cameras' bound is 60 (section 3.1)."""
PLACED: dict[str, Value] = {"formation.jitter_m": 0.02, "formation.heading_spread_deg": 2.0}
"""How well a robot is put down: a choice."""
LAW: dict[str, Value] = {
    "range_m": 100.0, "ideal_m": 36 * 0.0254, "danger_m": 10 * 0.0254, "start_m_s": 0.2, "least_m_s": 0.1,
    "top_m_s": 0.5,
}  # fmt: skip
"""Of the thesis, where it gives them. Whoever an image shows is seen (section 3.6.5; the eight feet of section 3.3 are
of its simulation); speeds are choices: at first the lead robot's, at the least half of it, at the most what both bodies
reach."""
FROM_IMAGE_TO_IMAGE: dict[str, Value] = {
    "association.gate_m": 1.0, "association.top_speed_m_s": 1.0, "association.same_body_m": 0.05,
}  # fmt: skip
"""Two images of one cone are paired whatever pixels make of its distance: a column is 0.23 m at eight feet. The
nearest cone is the only one that is told of. That its velocity is smoothed over three images, as all inferred ones
are, is a choice: the thesis takes plain differences (equation 3.6), `herd.association.smoothing=none`."""
SOURCES = {
    BODY: Parameter("", "Kirchner 2006, section 3.1: the Pioneer; the Create is ours", published=True),
    "world": Parameter("", "Kirchner 2006, section 4.5: an open environment", published=True),
    f"{HERD}.rate_hz": Parameter("Hz", "a choice: the cameras' bound is 60"),
    f"{HERD}.law": Parameter("", "Kirchner 2006, section 3.6", published=True),
    f"{HERD}.pipeline": Parameter("", "Kirchner 2006, sections 3.6.4 to 3.6.6", published=True),
}
KEY_MEASURES = ("final_distance", "closest", "member_collisions", "distance_error", "bearing_error", "unseen_share")


class Leg(NamedTuple):
    """A straight or an arc of the lead robot's way."""

    length_ft: float
    turn_rad: float = 0.0
    """Counter-clockwise."""


def arc_to(x_ft: float, y_ft: float) -> Leg:
    """The arc that begins straight ahead and leads to a place in the robot's frame."""
    radius = (x_ft * x_ft + y_ft * y_ft) / (2.0 * y_ft)
    turn = 2.0 * math.atan2(y_ft, x_ft)
    return Leg(abs(radius * turn), turn)


def seconds(legs: Sequence[Leg]) -> float:
    """How long the lead robot is under way, s, in whole tenths."""
    return round(sum(leg.length_ft for leg in legs) * FOOT / LEAD_M_S, 1)


def driven(legs: Sequence[Leg]) -> dict[str, Value]:
    """The parameters of the law `drive` that lead along these legs."""
    given: dict[str, Value] = {}
    for number, leg in enumerate(legs, 1):
        time = leg.length_ft * FOOT / LEAD_M_S
        given |= {f"leg_{number}_s": time, f"leg_{number}_m_s": LEAD_M_S, f"leg_{number}_rad_s": leg.turn_rad / time}
    return given


def lead(legs: Sequence[Leg], x_ft: float, body: str = BODIES[0]) -> Group:
    """The robot that a person drives, so far ahead of the follower's start, centre to centre; it sees nothing."""
    made = group("drive", 1, name=LEAD, pipeline="perfect", law_parameters=driven(legs))
    own: dict[str, Value] = {"body": body, "formation": "single-file", "rate_hz": RATE_HZ, "start_moving": False}
    return with_setup(made, {**own, **PLACED, "start_x_m": x_ft * FOOT})


def seeing(count: int, *, name: str = HERD, spacing_m: float = 1.0, **given: Value) -> Group:
    """Robots that run Kirchner's software. `spacing_m`: of their formation."""
    made = group("moshtagh-kirchner", count, name=name, pipeline="cone-member-based", law_parameters=LAW)
    own: dict[str, Value] = {"body": BODIES[0], "formation": "single-file", "rate_hz": RATE_HZ, "speed_m_s": 0.2}
    own |= FROM_IMAGE_TO_IMAGE
    return with_setup(made, {**own, **PLACED, "formation.spacing_m": spacing_m, **given})


def following(experiment: str, repeat: int, legs: Sequence[Leg], x_ft: float) -> Trial:
    """A lead robot so many feet ahead of the one that follows it."""
    return trial(experiment, repeat, [seeing(1), lead(legs, x_ft)], world="open-floor", duration_s=seconds(legs))


def from_the_lens(group: Group) -> Group:
    """The group with distances as the thesis has them: from lens to the cone's near side (equation 3.5).

    Places are told from the middle between both lenses, so that a bearing does not jump where a cone goes over from one
    image to the other. Detections that read no images measure from centre to centre, and whoever sets `offset` has it
    as set.
    """
    if "offset" not in Resolved(group).pipeline.Parameters._fields:
        return group
    return dataclasses.replace(group, pipeline_parameters={"offset": MIDDLE, **group.pipeline_parameters})


def finish(trial: Trial) -> Trial:
    """All robots of a trial have one body, that of those that see."""
    body = next(of_group(each).body for each in trial.groups if each.name == HERD)
    groups = tuple(with_setup(from_the_lens(each), {"body": body}) for each in trial.groups)
    return dataclasses.replace(trial, groups=groups)
