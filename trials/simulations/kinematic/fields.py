"""The parameters of a kinematic trial and of its groups, with units and sources; how trials and groups are made.

A value of nan, `own`, or −1 leaders, is left open: it is then that of the herd which the law declares (`HERD` in its
file).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any, NamedTuple

from flocking import lawentry
from flocking import obstacle_selection as selection_of_obstacles
from flocking.errors import InputError, unknown_name
from flocking.kinematic.bands import MOST_M
from flocking.parameters import Parameter, declared, filled
from flocking.taxonomy import USUAL_HERD, Herd
from generation.environment import Environment
from trials.rows import below
from trials.simulations import judged
from trials.simulations.kinematic import flocks, lattice_starts, links
from trials.simulations.kinematic.places import FORMATION_PARAMETERS, OF_LAW, OPEN, WORLD_PARAMETERS
from trials.types import Group, Trial, Value
from worlds import known, start_poses

NAME = "kinematic"
OWN = "own"
"""A text that is left to the law's own herd."""
OWN_LEADERS = -1
"""A number of leaders that is left to the law's own herd."""
NEVER = -1.0
"""A time that does not come."""
LEADER = 1
"""The role of a leader or of a strong member."""
NO_LIMIT = 0.0
"""A speed, turn rate or range without a limit."""
DETECTIONS = ("perfect", "member-based", "member-extrapolated", "sensor-based")
OWN_SPACE = OWN
"""Names the world of the law's own herd."""
SPACES = (OWN_SPACE, "unbounded", "bounded", "periodic", "obstacles")
FORMATIONS = ("uniform", "single-group", "split-group", "triangular-lattice", "square-lattice", *lattice_starts.NAMES)
AS_LAW = "as-law"
OF_AVOIDANCE = ("look_ahead_m", "margin_m", "virtual_range_m")
"""What is at work only where obstacles are avoided, or made virtual members."""
LINKS, FLOCKS = "links.", "flocks."
"""Prefixes of the keys of the links and of the flocks that a trial measures."""
_NO_HERD = (
    f"a choice, for the law's file has no HERD: {USUAL_HERD.spacing_m:g} m, {USUAL_HERD.speed_m_s:g} m/s, "
    f"{USUAL_HERD.dt_s:g} s"
)


def world_names() -> list[str]:
    """The worlds of a kinematic trial: spaces, and the worlds that robots have as well."""
    return [*SPACES, *known.names()]


def formation_names() -> list[str]:
    """The starting formations of kinematic members."""
    return list(FORMATIONS)


class TrialFields(NamedTuple):
    """What a kinematic trial has beside its names and groups."""

    steps: Annotated[int, Parameter("", "a choice", low=1, high=10_000_000)] = 500
    timestep_s: Annotated[float, Parameter("s", OF_LAW, low=1e-6, high=1e3)] = OPEN
    synchronous: Annotated[
        bool,
        Parameter(
            "",
            "false: one after the other within a step, in an order drawn anew (section 9.1.1)",
            plausible=(False, True),
        ),
    ] = True
    updating: Annotated[
        str,
        Parameter(
            "",
            f"backward: velocities change, then positions by them; forward: positions by the old velocities; {OF_LAW}",
            choices=(OWN, "backward", "forward"),
            plausible=("backward", "forward"),
        ),
    ] = OWN
    keeps_way: Annotated[
        bool,
        Parameter(
            "", "a choice; false: once all is measured, only the first and the last moment are kept", plausible=()
        ),
    ] = True
    every: Annotated[
        int, Parameter("steps", "a choice: from one moment that is kept to the next", low=1, plausible=())
    ] = 1
    graph: Annotated[
        str,
        Parameter(
            "",
            "a choice: who is in whose fixed set, for laws that select by one",
            choices=("ring", "complete"),
            plausible=(),
        ),
    ] = "ring"
    cut_m: Annotated[
        float, Parameter("m", f"members farther apart are of different groups; {OF_LAW}, its spacing", low=0.0)
    ] = OPEN
    measured_share: Annotated[
        float, Parameter("", "a choice: the last part of the trial over which measures are averaged", low=0.0, high=1.0)
    ] = 0.5
    behaviour: Annotated[
        str,
        Parameter("", "a choice: what the trial is held against (docs/environments.md)", named=judged.names),
    ] = judged.NONE


class NameFields(NamedTuple):
    """The names of a kinematic trial's world and formation."""

    world: Annotated[str, Parameter("", OF_LAW, named=world_names, paths=True)] = OWN_SPACE
    formation: Annotated[str, Parameter("", "a choice", named=formation_names, paths=True)] = "uniform"


class GroupNames(NamedTuple):
    """What a kinematic group has that a group of robots has as well."""

    count: Annotated[int, Parameter("members", "a choice", low=0, high=1_000_000)] = 50  # type: ignore[assignment]
    """0 = there is no such group."""
    pipeline: Annotated[str, Parameter("", "Fine 2015, section 2.2, without noise", choices=DETECTIONS)] = "perfect"
    selection: Annotated[str, Parameter("", "Fine 2015, table 3.1: what the law's sets select from")] = "all"
    law: Annotated[str, Parameter("", "a choice")] = "random-motion"


class GroupFields(NamedTuple):
    """What else a kinematic group has."""

    speed_m_s: Annotated[float, Parameter("m/s", f"at the start, along the heading; {OF_LAW}", low=0.0)] = OPEN
    cruise_m_s: Annotated[
        float, Parameter("m/s", f"towards a way-point, 0 = reached in one step; {OF_LAW}, its speed", low=0.0)
    ] = OPEN
    max_speed_m_s: Annotated[float, Parameter("m/s", "a choice: 0 = no limit", low=0.0)] = NO_LIMIT
    max_turn_rate_rad_s: Annotated[float, Parameter("rad/s", "a choice: 0 = no limit", low=0.0)] = NO_LIMIT
    radius_m: Annotated[float, Parameter("m", "a choice: 0 = points that nothing touches", low=0.0, high=MOST_M)] = 0.0
    information: Annotated[
        str,
        Parameter("", "Fine 2015, section 4.1: what is known of neighbours", choices=("poses", "bearings")),
    ] = "poses"
    assumed_distance_m: Annotated[
        float, Parameter("m", "a choice: where members stand of which only the bearing is known", low=1e-6, high=MOST_M)
    ] = 1.0
    silhouette_m: Annotated[
        float, Parameter("m", "radius of a Create, as the detections see it", low=1e-6, high=MOST_M)
    ] = 0.165
    sight_m: Annotated[
        float, Parameter("m", "range of detections (other than perfect) and obstacles; 0 = no limit", low=0.0)
    ] = NO_LIMIT
    obstacles: Annotated[
        str,
        Parameter(
            "",
            "Fine 2015, figure 3.3: left to the law, avoided by the shared rule, or made virtual members",
            choices=(AS_LAW, "avoid", "virtual-members"),
        ),
    ] = AS_LAW
    obstacle_selection: Annotated[
        str, Parameter("", "Fine 2015, figure 3.3, which leaves it open", reads=selection_of_obstacles.parse)
    ] = "all"
    look_ahead_m: Annotated[
        float, Parameter("m", f"of the shared avoidance; three quarters of a spacing, or a step: {OF_LAW}", low=0.0)
    ] = OPEN
    margin_m: Annotated[float, Parameter("m", f"likewise; 0.28 of a spacing: {OF_LAW}", low=0.0)] = OPEN
    virtual_range_m: Annotated[
        float, Parameter("m", f"of obstacles that become virtual members; one spacing: {OF_LAW}", low=0.0)
    ] = OPEN
    informed_share: Annotated[
        float, Parameter("", "share of the members that know the goal, rounded", low=0.0, high=1.0)
    ] = 0.0
    goal_x_m: Annotated[float, Parameter("m", "of the goal, from the herd's centre at the start", plausible=())] = 1e9
    goal_y_m: Annotated[float, Parameter("m", "likewise; far away it is a preferred direction", plausible=())] = 0.0
    role: Annotated[
        int, Parameter("", "0 ordinary, 1 leader or strong, for the laws that tell", low=0, high=1, plausible=())
    ] = 0
    leaders: Annotated[
        int, Parameter("members", f"the first so many have role 1, −1 = as many as: {OF_LAW}", low=OWN_LEADERS)
    ] = OWN_LEADERS
    failure_probability: Annotated[
        float, Parameter("", "a choice: a step, of a member to stop for good; others still see it", low=0.0, high=1.0)
    ] = 0.0
    failure_time_s: Annotated[
        float,
        Parameter("s", "a choice: when the member in the middle of its group fails likewise; −1 = never", low=-1.0),
    ] = NEVER


def trial(
    experiment: str,
    repeat: int,
    groups: Sequence[Group],
    *,
    world: str = OWN_SPACE,
    world_parameters: dict[str, Value] | None = None,
    formation: str = "uniform",
    formation_parameters: dict[str, Value] | None = None,
    **setup: Value,
) -> Trial:
    """A kinematic trial; `setup`: of `TrialFields`."""
    return Trial(
        experiment=experiment,
        repeat=repeat,
        simulation=NAME,
        world=world,
        formation=formation,
        groups=tuple(groups),
        world_parameters=world_parameters or {},
        formation_parameters=formation_parameters or {},
        setup=setup,
    )


def group(
    law: str,
    count: int,
    *,
    name: str = "herd",
    selection: str = "all",
    pipeline: str = "perfect",
    law_parameters: dict[str, Value] | None = None,
    **setup: Value,
) -> Group:
    """A kinematic group; `setup`: of `GroupFields`."""
    return Group(
        name=name,
        count=count,
        pipeline=pipeline,
        selection=selection,
        law=law,
        law_parameters=law_parameters or {},
        setup=setup,
    )


def own_herd(group: Group) -> Herd:
    """The herd that a group's law declares."""
    return _declared(group.law, group.law_source)


def words_of(parameters: type, group: Group) -> dict[str, Parameter]:
    """By name, the sources to show for the values that a group's law leaves open; none where its file has a HERD."""
    if hasattr(lawentry.module_of(group.law, group.law_source), "HERD"):
        return {}
    return {
        name: dataclasses.replace(parameter.about, source=parameter.about.source.replace(OF_LAW, _NO_HERD))
        for name, parameter in declared(parameters).items()
        if OF_LAW in parameter.about.source
    }


@cache
def _declared(law: str, source: str) -> Herd:
    found: Herd = getattr(lawentry.module_of(law, source), "HERD", USUAL_HERD)
    return found


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in; open values are those of the first group's law."""
    fields: TrialFields = filled(TrialFields, below(trial.setup, ""))
    own = own_herd(trial.groups[0])
    return fields._replace(
        timestep_s=_closed(fields.timestep_s, own.dt_s),
        cut_m=_closed(fields.cut_m, own.spacing_m),
        updating=own.updating if fields.updating == OWN else fields.updating,
    )


def of_group(group: Group) -> GroupFields:
    """A group's fields with everything filled in."""
    fields: GroupFields = filled(GroupFields, below(group.setup, ""), prefix=f"{group.name}.")
    own = own_herd(group)
    return fields._replace(
        speed_m_s=_closed(fields.speed_m_s, own.speed_m_s),
        cruise_m_s=_closed(fields.cruise_m_s, own.speed_m_s),
        look_ahead_m=_closed(fields.look_ahead_m, max(0.75 * own.spacing_m, own.speed_m_s * own.dt_s)),
        margin_m=_closed(fields.margin_m, 0.28 * own.spacing_m),
        virtual_range_m=_closed(fields.virtual_range_m, own.spacing_m),
        leaders=min(own.leaders, group.count) if fields.leaders == OWN_LEADERS else fields.leaders,
    )


def space_of(trial: Trial) -> str:
    """The name of a trial's space, which may be that of the law's own herd. Raises `InputError` without groups.

    An environment stands in the unbounded plane.
    """
    if not trial.groups:
        raise InputError("the trial has no members: expected at least one group")
    if trial.world == OWN_SPACE:
        return own_herd(trial.groups[0]).space
    return trial.world if trial.world in SPACES else "unbounded"


def environment_of(trial: Trial) -> Environment | None:
    """What stands in a trial's world; None for a space without an environment. Raises `InputError`."""
    if trial.world in SPACES:
        return None
    return known.environment_of(trial.world, trial.world_source, trial.world_parameters)


def world_parameters(trial: Trial) -> type:
    """What the trial's world can be given. Raises `InputError` for a world that there is not."""
    if trial.world in SPACES:
        return WORLD_PARAMETERS[space_of(trial)]
    if not known.is_file(trial.world) and trial.world not in known.names():
        raise unknown_name("world", trial.world, world_names())
    return known.load(trial.world, trial.world_source).parameters


def formation_parameters(trial: Trial) -> type:
    """What the trial's formation can be given. Raises `InputError` for a formation that there is not."""
    if start_poses.is_file(trial.formation):
        return start_poses.Parameters
    if trial.formation not in FORMATIONS:
        raise unknown_name("formation", trial.formation, FORMATIONS)
    return FORMATION_PARAMETERS[trial.formation]


def world_of(trial: Trial) -> Any:
    """The world's parameters, filled in."""
    fields = filled(world_parameters(trial), trial.world_parameters, prefix="world.")
    if trial.world not in SPACES:
        its = known.load(trial.world, trial.world_source)
        return its.parameters(**its.values(fields._asdict()))
    if not hasattr(fields, "size_m"):
        return fields
    count = sum(group.count for group in trial.groups)
    fields = fields._replace(size_m=_closed(fields.size_m, spacing_of(trial) * math.sqrt(count)))
    if hasattr(fields, "length_m"):
        fields = fields._replace(length_m=_closed(fields.length_m, fields.size_m / 10.0))
    return fields


def formation_of(trial: Trial) -> Any:
    """The formation's parameters, filled in."""
    fields = filled(formation_parameters(trial), trial.formation_parameters, prefix="formation.")
    if start_poses.is_file(trial.formation):
        return fields
    own = own_herd(trial.groups[0])
    if trial.formation in lattice_starts.NAMES:
        usual = own.spacing_m if trial.formation == lattice_starts.POSITION else own.speed_m_s
        fields = fields._replace(strength=_closed(fields.strength, usual))
    return fields._replace(spacing_m=_closed(fields.spacing_m, own.spacing_m))


def spacing_of(trial: Trial) -> float:
    """The spacing of a trial's formation, or of its law's herd where its poses come from a file, m."""
    given = formation_of(trial)
    return float(given.spacing_m if hasattr(given, "spacing_m") else own_herd(trial.groups[0]).spacing_m)


def every_step(trial: Trial) -> bool:
    """Whether all steps of a trial are measured, whichever of them are kept."""
    return links_of(trial) is not None or of_trial(trial).behaviour != judged.NONE


def links_of(trial: Trial) -> links.Parameters | None:
    """The parameters by which a trial's links are measured; None if they are not measured."""
    given = below(trial.setup, LINKS)
    return filled(links.Parameters, given, prefix=LINKS) if given else None


def flocks_of(trial: Trial) -> flocks.Parameters | None:
    """The parameters by which a trial's flocks are measured; None if they are not measured."""
    given = below(trial.setup, FLOCKS)
    return filled(flocks.Parameters, given, prefix=FLOCKS) if given else None


def _closed(value: float, own: float) -> float:
    """`value`, or `own` where it is left open."""
    return own if math.isnan(value) else value
