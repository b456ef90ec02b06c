"""The parameters of a trial in which cameras look at a cone; how such trials are made.

Its one group is the robot that looks: its detection, its cameras and their imperfections. It has a law only because
groups have one; nothing moves. Distances are the thesis's |d|: from the lens to the cone's near side (equation 3.5).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from flocking import found
from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, filled
from robots import body as bodies
from sensing.camera import imperfections, setting
from trials.rows import below
from trials.types import Group, Trial, Value

NAME = "cones"
PIPELINES = "sensing.pipelines"
CAMERAS, IMPERFECTIONS = "cameras.", "imperfections."
EYES = "eyes"
IDLE = {
    f"{CAMERAS}colours": "its one cone is orange",
    f"{CAMERAS}judged": "its looks are always held against what stands there",
    f"{IMPERFECTIONS}capture_offset_s": "nothing moves between both images of a look",
    f"{IMPERFECTIONS}frame_rate_hz": "each look is a pair of its own",
}
"""Keys of cameras that do nothing here, and why."""
_TESTS = "Kirchner 2006, appendix A"


def pipeline_names() -> list[str]:
    """The detections that read images."""
    return [name for name in sorted(found.modules(PIPELINES)) if reads_images(name)]


def reads_images(name: str) -> bool:
    """Whether a detection does."""
    return "images" in found.load(PIPELINES, name, "pipeline").READS


def body_names() -> list[str]:
    """The bodies that carry cameras."""
    return list(bodies.carrying("cameras"))


class TrialFields(NamedTuple):
    """What stands before the cameras, and how often they look."""

    distance_m: Annotated[
        float, Parameter("m", f"{_TESTS}: half a foot to six", published=True, low=0.02, high=30.0)
    ] = 0.9144
    """From the left lens to the cone's near side."""
    bearing_deg: Annotated[
        float, Parameter("deg", "a choice: before the left camera", low=-15.0, high=110.0, plausible=(-10.0, 105.0))
    ] = 47.5
    """Of the cone from the left lens, from the robot's straight ahead."""
    cone: Annotated[bool, Parameter("", "a choice: whether there is one")] = True
    looks: Annotated[int, Parameter("", f"{_TESTS}: five tests at each distance", published=True, low=1, high=1000)] = 5
    placed_m: Annotated[
        float, Parameter("m", "a choice: standard deviation of where the cone is put down", low=0.0, high=1.0)
    ] = 0.003
    light: Annotated[
        float, Parameter("", "a choice: of the light of the calibration", low=0.0, high=3.0, plausible=(0.7, 1.3))
    ] = 1.0
    hidden: Annotated[
        float, Parameter("", "a choice: share of the cone's width that a board hides", low=0.0, high=1.0)
    ] = 0.0
    speed_m_s: Annotated[
        float, Parameter("m/s", "a choice: of the cone across the view", low=0.0, high=10.0, plausible=(0.0, 0.8))
    ] = 0.0
    exposure_s: Annotated[
        float, Parameter("s", "a choice: the longest of the cameras' 60 images a second", low=0.0, high=1.0)
    ] = 1.0 / 60.0
    distractors: Annotated[
        int, Parameter("", "a choice: red, salmon, yellow and brown posts by turns, strewn", low=0, high=40)
    ] = 0


class GroupFields(NamedTuple):
    """The robot that looks."""

    body: Annotated[str, Parameter("", "a choice: on which the cameras are", named=body_names)] = "create-with-cameras"
    pipeline: Annotated[str, Parameter("", "Kirchner 2006, section 3.6.4", published=True, named=pipeline_names)] = (
        "cone-member-based"
    )


def trial(experiment: str, repeat: int, *, pipeline: str = GroupFields().pipeline, **setup: Value) -> Trial:
    """Cameras that look at a cone; `setup`: of `TrialFields`."""
    group = Group(law="bumper-only", count=1, pipeline=pipeline, name=EYES)
    return Trial(experiment, repeat, NAME, WORLD, FORMATION, (group,), setup=setup)


WORLD, FORMATION = "open-floor", "single-file"
"""The names that such a trial has because trials have them: there is no other world and no start."""


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in. Raises `InputError`."""
    for kind, name, only in (("world", trial.world, WORLD), ("formation", trial.formation, FORMATION)):
        if name != only:
            raise unknown_name(kind, name, [only])
    filled_in: TrialFields = filled(TrialFields, below(trial.setup, ""))
    if filled_in.speed_m_s > 0.0 and filled_in.exposure_s == 0.0:
        raise InputError(
            f"speed_m_s = {filled_in.speed_m_s:g} with exposure_s = 0: a cone that moves is as one that stands; "
            "expected an exposure above 0 s, or speed_m_s = 0"
        )
    return filled_in


def group_of(trial: Trial) -> Group:
    """The robot that looks. Raises `InputError` for a trial with none, or with more."""
    if len(trial.groups) != 1 or trial.groups[0].count != 1:
        raise InputError(f"a trial of {NAME!r} has one robot: expected one group of one")
    return trial.groups[0]


def of_group(group: Group) -> GroupFields:
    """The group's fields with everything filled in. Raises `InputError`."""
    given: dict[str, Value] = {"pipeline": group.pipeline, **below(group.setup, "")}
    filled_in: GroupFields = filled(GroupFields, given, prefix=f"{group.name}.")
    return filled_in


def check_idle(group: Group) -> None:
    """Refuses a group that sets what does nothing here: `InputError`."""
    for key in sorted(IDLE.keys() & group.setup.keys()):
        raise InputError(f"{group.name}.{key}: it does nothing in a cone test, for {IDLE[key]}; expected it unset")


def without_idle(prefix: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Of the values of the parameters with this prefix, by name, those that do something."""
    return {name: value for name, value in values.items() if f"{prefix}{name}" not in IDLE}


def cameras_of(group: Group) -> setting.Parameters:
    """Its cameras. Raises `InputError`."""
    cameras: setting.Parameters = filled(
        setting.Parameters, below(group.setup, CAMERAS), prefix=f"{group.name}.{CAMERAS}"
    )
    return cameras


def imperfections_of(group: Group) -> imperfections.Parameters:
    """What is imperfect about them: the named setting with the group's own values in place. Raises `InputError`."""
    own: Mapping[str, Value] = below(group.setup, IMPERFECTIONS)
    changed = filled(imperfections.Parameters, own, prefix=f"{group.name}.{IMPERFECTIONS}")
    named = imperfections.SETTINGS[cameras_of(group).setting]
    return named._replace(**{name: getattr(changed, name) for name in own})
