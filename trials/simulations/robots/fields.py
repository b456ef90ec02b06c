"""The parameters of a trial of robots and of its groups, with units and sources; how trials and groups are made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

from flocking import found, lawentry, lawsource, obstacle_selection
from flocking.parameters import Parameter, filled
from generation.environment import Environment
from robots import body as bodies
from sensing.laser import hokuyo
from trials.rows import below
from trials.simulations import judged
from trials.simulations.robots import desires, guided, wire
from trials.simulations.robots.knowledge import SOURCES
from trials.types import Group, Trial, Value
from worlds import formations, known

NAME = "robots"
PIPELINES = "sensing.pipelines"
TWO_SCANS, NO_ASSOCIATION = ASSOCIATIONS = ("two-scans", "none")
AS_LAW, AVOID, VIRTUAL = OBSTACLE_CHOICES = ("as-law", "avoid", "virtual-members")
TOGETHER = "together"
"""The formation of a group that has none of its own and shares the trial's."""
SENSORS, CAMERAS, IMPERFECTIONS, ASSOCIATION = "sensors.", "cameras.", "imperfections.", "association."
AVOIDANCE, FORMATION = "avoidance.", "formation."


def world_names() -> list[str]:
    """The worlds that robots can be put into."""
    return known.names()


def body_names() -> list[str]:
    """The bodies that a robot can have."""
    return list(bodies.names())


def pipeline_names() -> list[str]:
    """The member detections that a robot can have."""
    return sorted(found.modules(PIPELINES))


def formation_names() -> list[str]:
    """The starting formations of robots."""
    return list(formations.FORMATIONS)


def own_formation_names() -> list[str]:
    """The values that a group's formation can have."""
    return [TOGETHER, *formations.FORMATIONS]


class TrialFields(NamedTuple):
    """What a trial has beside its groups."""

    duration_s: Annotated[
        float,
        Parameter(
            "s",
            "at least a minute: the length of the trials was not published",
            low=0.1,
            high=86400.0,
            plausible=(30.0, 90.0),
        ),
    ] = 60.0
    timestep_s: Annotated[
        float,
        Parameter(
            "s",
            "of physics: motion, odometry and scans agree with half of it, contact with 1 ms (test_timestep.py)",
            low=0.001,
            high=0.02,
            plausible=(),
        ),
    ] = 0.01
    world: Annotated[
        str,
        Parameter(
            "", "Fine 2015, section 2.3.1: an obstacle-free corridor", published=True, named=world_names, paths=True
        ),
    ] = "corridor"
    formation: Annotated[
        str, Parameter("", "Fine 2015, figure 2.5, drawn without numbers", named=formation_names, paths=True)
    ] = "single-group"
    behaviour: Annotated[
        str,
        Parameter("", "a choice: what the trial is held against (docs/environments.md)", named=judged.names),
    ] = judged.NONE
    task: Annotated[
        str,
        Parameter(
            "",
            "Fine 2015, section 8.2: what the herd is guided through (docs/piloting.md)",
            named=guided.names,
            paths=True,
        ),
    ] = guided.NONE


class JudgedFields(NamedTuple):
    """What a trial of robots that is held against a behaviour has besides the behaviour's parameters."""

    iteration_s: Annotated[
        float,
        Parameter(
            "s",
            "a choice: of one iteration; 2 units of Fine 2015 at a world.scale of 0.05 and 0.25 m/s",
            low=0.01,
            high=3600.0,
            plausible=(),
        ),
    ] = 0.4


class GroupFields(NamedTuple):
    """What a group of robots has beside the parameters of its law, pipeline and sensors."""

    count: Annotated[int, Parameter("robots", "Fine 2015, section 2.3.1", published=True, low=1, high=1000)] = 6  # type: ignore[assignment]
    body: Annotated[str, Parameter("", "Fine 2015, section 2.3", published=True, named=body_names, paths=True)] = (
        "create"
    )
    body_files: Annotated[
        str, Parameter("", "a hash of the files of a body of the user's own, which stay the same while a run lasts")
    ] = ""
    sensors: Annotated[str, Parameter("", "noise of the laser's data sheet", choices=tuple(hokuyo.SETTINGS))] = (
        "datasheet"
    )
    pipeline: Annotated[str, Parameter("", "Fine 2015, section 2.2", published=True, named=pipeline_names)] = (
        "member-based"
    )
    selection: Annotated[str, Parameter("", "Fine 2015, table 3.1")] = "all"
    law: Annotated[str, Parameter("", "Fine 2015, algorithm 2", published=True)] = "extended-hamilton"
    speed_m_s: Annotated[
        float,
        Parameter(
            "m/s",
            "not published: half of the Create's top speed; at most the body's",
            low=0.001,
            plausible=(0.15, 0.35),
        ),
    ] = 0.25
    rate_hz: Annotated[
        float,
        Parameter(
            "Hz", "not published: the laser's scan rate (data sheet)", low=0.1, high=100.0, plausible=(5.0, 6.25, 10.0)
        ),
    ] = 10.0
    phase: Annotated[
        str,
        Parameter(
            "",
            "Fine 2015, section 9.1.1: asynchronous members",
            published=True,
            choices=("random", "together"),
        ),
    ] = "random"
    latency_s: Annotated[
        float,
        Parameter(
            "s",
            "not published: somewhat less than half a scan from sensing to acting",
            low=0.0,
            high=10.0,
            plausible=(0.0, 0.02, 0.04, 0.06, 0.08, 0.1),
        ),
    ] = 0.04
    start_moving: Annotated[
        bool,
        Parameter(
            "",
            "not published: what a member keeps that has seen nobody yet is to drive straight on",
            plausible=(False, True),
        ),
    ] = True
    role: Annotated[
        int,
        Parameter(
            "", "what laws that know of roles are told: 0 ordinary, 1 leader or strong", low=0, high=1, plausible=()
        ),
    ] = 0
    informed: Annotated[
        int, Parameter("robots", "the first so many are given the goal, and role 1", low=0, high=1000)
    ] = 0
    goal_x_m: Annotated[
        float, Parameter("m", "of the goal, in the world; far away it is a preferred direction", plausible=())
    ] = 0.0
    goal_y_m: Annotated[float, Parameter("m", "likewise", plausible=())] = 0.0
    own_motion: Annotated[
        str,
        Parameter(
            "",
            "choice: the Create's odometry loses slow turns (trials/simulations/robots/knowledge.py)",
            choices=SOURCES,
        ),
    ] = "commands"
    association: Annotated[
        str,
        Parameter("", "Fine 2015, section 3.6.3; at work where the law needs it", choices=ASSOCIATIONS),
    ] = TWO_SCANS
    velocities: Annotated[
        str,
        Parameter(
            "",
            "a choice: what perfect detection tells of neighbours (Hodgins and Brogan 1994, section 3.2, has desired)",
            choices=desires.VELOCITIES,
        ),
    ] = desires.ACTUAL
    obstacles: Annotated[
        str,
        Parameter(
            "", "Fine 2015, figure 3.3: left to the law, avoided, or made virtual members", choices=OBSTACLE_CHOICES
        ),
    ] = "as-law"
    obstacle_selection: Annotated[
        str, Parameter("", "Fine 2015, figure 3.3, which leaves it open", reads=obstacle_selection.parse)
    ] = "all"
    link: Annotated[
        str,
        Parameter("", "Kirchner 2006, section 3.6.7: from image process to controller; a choice", choices=wire.LINKS),
    ] = wire.IN_PROCESS
    link_address: Annotated[
        str, Parameter("", "a choice: where controllers listen, of this machine", reads=wire.address)
    ] = "127.0.0.1"
    link_beyond_loopback: Annotated[
        bool, Parameter("", "a choice: whether that may be an address that other machines reach")
    ] = False
    formation: Annotated[
        str,
        Parameter(
            "",
            "a choice: `together` with the other groups in the trial's formation, or one of its own",
            named=own_formation_names,
        ),
    ] = TOGETHER
    start_x_m: Annotated[float, Parameter("m", "a choice: of the middle of a formation of its own", plausible=())] = 0.0
    start_y_m: Annotated[float, Parameter("m", "likewise", plausible=())] = 0.0
    start_heading_deg: Annotated[
        float, Parameter("deg", "likewise: by how much it is turned", low=-360.0, high=360.0, plausible=())
    ] = 0.0


def trial(
    experiment: str,
    repeat: int,
    groups: Sequence[Group],
    *,
    world: str = TrialFields().world,
    formation: str = TrialFields().formation,
    world_parameters: Mapping[str, Value] | None = None,
    formation_parameters: Mapping[str, Value] | None = None,
    **setup: Value,
) -> Trial:
    """A trial of robots; `setup`: of `TrialFields`."""
    return Trial(
        experiment,
        repeat,
        NAME,
        world,
        formation,
        tuple(groups),
        world_parameters=world_parameters or {},
        formation_parameters=formation_parameters or {},
        setup=setup,
    )


def group(
    law: str = GroupFields().law,
    count: int = GroupFields().count,
    *,
    name: str = "herd",
    pipeline: str = GroupFields().pipeline,
    selection: str = GroupFields().selection,
    law_parameters: Mapping[str, Value] | None = None,
    pipeline_parameters: Mapping[str, Value] | None = None,
    spread: Mapping[str, float] | None = None,
    **setup: Value,
) -> Group:
    """A group of robots; `setup`: of `GroupFields`, below `sensors.`, `cameras.`, `imperfections.`, `association.`,
    `avoidance.` and `formation.`.

    `law`: a law's name, or the path of a file, whose text is read. Raises `InputError` where it cannot be.
    """
    return Group(
        law=law,
        count=count,
        pipeline=pipeline,
        name=name,
        selection=selection,
        law_source=lawsource.read_source(law) if lawentry.is_path(law) else "",
        law_parameters=law_parameters or {},
        pipeline_parameters=pipeline_parameters or {},
        spread=spread or {},
        setup=setup,
    )


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in. Raises `InputError`."""
    own = {"world": trial.world, "formation": trial.formation}
    filled_in: TrialFields = filled(TrialFields, {**own, **below(trial.setup, "")})
    return filled_in


def iteration_s(trial: Trial) -> float:
    """How long an iteration of a trial's behaviour takes, s. Raises `InputError`."""
    own = below(trial.setup, judged.BEHAVIOUR)
    given: JudgedFields = filled(
        JudgedFields, {k: v for k, v in own.items() if k in JudgedFields._fields}, prefix=judged.BEHAVIOUR
    )
    return given.iteration_s


def of_group(group: Group) -> GroupFields:
    """A group's fields with everything filled in. Raises `InputError`."""
    own = {name: getattr(group, name) for name in ("count", "pipeline", "selection", "law")}
    filled_in: GroupFields = filled(GroupFields, {**own, **below(group.setup, "")}, prefix=f"{group.name}.")
    return filled_in


def world_of(trial: Trial) -> known.Known:
    """A trial's world. Raises `InputError`."""
    return known.load(trial.world, trial.world_source)


def environment_of(trial: Trial) -> Environment:
    """What stands in a trial's world. Raises `InputError`."""
    return known.environment_of(trial.world, trial.world_source, trial.world_parameters)
