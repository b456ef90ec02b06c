"""The parameters of a trial in which a herd runs, with units and sources; how such trials and their group are made."""

from __future__ import annotations

import importlib.util
import math
from functools import cache
from typing import Annotated, Any, NamedTuple

from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, filled
from robots import body as bodies
from trials.rows import below
from trials.simulations.running import script
from trials.types import Group, Trial, Value

NAME = "running"
WORLD, FORMATION = "open-ground", "ellipse"
"""The names that such a trial has because trials have them."""
PARTICLES = "particles"
PERFECT = "perfect"
DESIRED, ACTUAL = "desired", "actual"
SOURCE = "Hodgins and Brogan 1994"


@cache
def body_names() -> list[str]:
    """Point masses, and the bodies that bring a ground of their own to run on (`robots.BODY.ground`)."""
    found = [name for name in bodies.names() if importlib.util.find_spec(ground_of(name)) is not None]
    return [PARTICLES, *found]


def ground_of(body: str) -> str:
    """The module with the ground that a body runs on."""
    return f"robots.{body.replace('-', '_')}.ground"


class TrialFields(NamedTuple):
    """What the herd runs through, and what is counted."""

    duration_s: Annotated[float, Parameter("s", "a choice: of the whole trial", low=0.01, high=1e5)] = 60.0
    settle_s: Annotated[
        float, Parameter("s", "a choice: the test, its script's times and its measures begin then", low=0.0, high=1e5)
    ] = 0.0
    timestep_s: Annotated[
        float,
        Parameter(
            "s", "a choice: of physics, and of the particles", low=1e-4, high=0.1, plausible=(0.0025, 0.0035, 0.005)
        ),
    ] = 0.005
    refresh_steps: Annotated[
        int,
        Parameter(
            "steps", f"{SOURCE}, section 3: ten, of point masses; robots alike is a choice. Between looks", low=1
        ),
    ] = 10
    script: Annotated[
        str,
        Parameter("", f"{SOURCE}, section 5; of the user's creature (script.py)", reads=script.parse, plausible=()),
    ] = "2, 0"
    obstacle_radius_m: Annotated[
        float, Parameter("m", "a choice: of a disc that stands there from the test's begin on; 0 = none", low=0.0)
    ] = 0.0
    obstacle_ahead_m: Annotated[
        float, Parameter("m", "a choice: of its centre from the herd's centre, where the herd is to run", low=0.0)
    ] = 20.0
    collision_m: Annotated[
        float,
        Parameter(
            "m",
            "a choice: two creatures collide that are nearer, centre to centre; twice the radius of a uniform cylinder "
            "with the mass and the inertia of the published body",
            low=0.0,
            high=10.0,
        ),
    ] = 0.46
    cut_m: Annotated[
        float, Parameter("m", f"creatures farther apart are of different groups; {SOURCE}: D", low=1e-3)
    ] = 2.5
    every_s: Annotated[
        float, Parameter("s", "a choice: from one moment that is kept to the next", low=0.01, high=100.0, plausible=())
    ] = 0.2


class NameFields(NamedTuple):
    """The names of the trial's world and formation."""

    world: Annotated[str, Parameter("", "a choice", choices=(WORLD,))] = WORLD
    formation: Annotated[str, Parameter("", "a choice", choices=(FORMATION,))] = FORMATION


class FormationFields(NamedTuple):
    """Where the herd starts: spread evenly over an ellipse that is longer along x."""

    spacing_m: Annotated[
        float, Parameter("m", "a choice: side of the square that is a creature's share", low=0.01, high=1e3)
    ] = 1.2
    aspect: Annotated[
        float, Parameter("", "a choice: width over length", low=0.05, high=20.0, plausible=(0.4, 0.6, 0.8))
    ] = 0.6
    jitter_m: Annotated[float, Parameter("m", "a choice: shifts are drawn within ± this in x and y", low=0.0)] = 0.2
    speed_m_s: Annotated[float, Parameter("m/s", f"{SOURCE}, section 5: along x", True, low=0.0)] = 2.0
    breakaway: Annotated[
        int, Parameter("creatures", "a choice: so many of the herd start in a group of their own behind it", low=0)
    ] = 0
    breakaway_m: Annotated[
        float, Parameter("m", "a choice: gap between both groups along x", low=0.0, high=1e4, plausible=())
    ] = 10.0


class GroupFields(NamedTuple):
    """The creatures."""

    count: Annotated[int, Parameter("creatures", f"{SOURCE}, section 3.1", True, low=1, high=10_000)] = 105  # type: ignore[assignment]
    body: Annotated[str, Parameter("", "a choice", named=body_names)] = PARTICLES
    pipeline: Annotated[str, Parameter("", f"{SOURCE}, section 3.1", True, choices=(PERFECT,))] = PERFECT
    selection: Annotated[str, Parameter("", "Fine 2015, table 3.1: what the law's set selects from")] = "all"
    law: Annotated[str, Parameter("", "a choice")] = "hodgins-brogan"
    velocities: Annotated[
        str,
        Parameter("", f"{SOURCE}, section 3.2: of neighbours, as a creature is told", True, choices=(DESIRED, ACTUAL)),
    ] = DESIRED
    users: Annotated[
        int, Parameter("creatures", f"{SOURCE}, section 3.2: one, in the middle at the start", True, low=0, high=1)
    ] = 1
    place_error_m: Annotated[
        float, Parameter("m", "a choice: standard deviation of where another is taken to be, x and y", low=0.0)
    ] = 0.0
    velocity_error_m_s: Annotated[
        float, Parameter("m/s", "a choice: likewise of how another is taken to move", low=0.0)
    ] = 0.0


def trial(experiment: str, repeat: int, group: Group, **setup: Value) -> Trial:
    """A trial of one herd; `setup`: of `TrialFields`."""
    return Trial(
        experiment=experiment,
        repeat=repeat,
        simulation=NAME,
        world=WORLD,
        formation=FORMATION,
        groups=(group,),
        setup=setup,
    )


def herd(count: int = 105, *, law_parameters: dict[str, Value] | None = None, **setup: Value) -> Group:
    """The herd; `setup`: of `GroupFields`."""
    return Group(law="hodgins-brogan", count=count, pipeline=PERFECT, law_parameters=law_parameters or {}, setup=setup)


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in. Raises `InputError`."""
    for kind, name, only in (("world", trial.world, WORLD), ("formation", trial.formation, FORMATION)):
        if name != only:
            raise unknown_name(kind, name, [only])
    found: TrialFields = filled(TrialFields, below(trial.setup, ""))
    return found


def formation_of(trial: Trial) -> FormationFields:
    """The formation's parameters, filled in. Raises `InputError`."""
    found: FormationFields = filled(FormationFields, trial.formation_parameters, prefix="formation.")
    return found


def group_of(trial: Trial) -> Group:
    """The herd. Raises `InputError` for a trial with no group, or with more."""
    if len(trial.groups) != 1:
        raise InputError(f"a trial of {NAME!r} has one herd: expected at least one group, and one alone")
    return trial.groups[0]


def of_group(group: Group) -> GroupFields:
    """The group's fields with everything filled in. Raises `InputError`."""
    given: dict[str, Any] = {name: getattr(group, name) for name in ("count", "pipeline", "selection")}
    found: GroupFields = filled(GroupFields, {**given, **below(group.setup, "")}, prefix=f"{group.name}.")
    return found._replace(law=group.law)


def steps_of(trial: Trial) -> int:
    """Steps of the whole trial."""
    given = of_trial(trial)
    return max(1, math.ceil(given.duration_s / given.timestep_s - 1e-9))
