"""The parameters of a trial that maps a schema's parameters; how such trials are made.

Its world is a schema, whose parameters have the prefix `world.`: those that are refined vary, the others are the
trial's. Its groups are those of the kinematic herd. Source: Fine 2015, section 7.4.2, whose kinematic unit is one metre
and whose iteration is one time step here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple

from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, filled
from generation import behaviours
from generation.behaviours import Behaviour
from generation.found import schemas
from generation.maps.spaces import Box, box_of, mappable, names, whole_numbers
from generation.maps.trees import EDGES, SPLITS
from generation.schema import Schema
from generation.validation.starts import Starts
from trials.rows import below
from trials.simulations.kinematic.fields import group
from trials.simulations.schemas import schema_of
from trials.types import Group, Trial, Value

NAME = "maps"
FORMATION = "square"
OWN = "own"
"""The behaviour that a schema is meant for, and its first two parameters that can be refined."""
BEHAVIOUR = "behaviour."
"""Prefix of the keys of its parameters."""
QUAD_TREE, RANDOM = METHODS = ("quad-tree", "random")


def behaviour_names() -> list[str]:
    """The behaviours that a schema can be mapped for."""
    return [OWN, *behaviours.names()]


class NameFields(NamedTuple):
    """The names of a trial's schema and formation."""

    world: Annotated[
        str, Parameter("", "Fine 2015, section 7.4: the schema that is mapped", named=schemas, paths=True)
    ] = "dirt"
    formation: Annotated[str, Parameter("", "a choice: the only one", choices=(FORMATION,))] = FORMATION


class TrialFields(NamedTuple):
    """What a trial has beside its names and groups."""

    method: Annotated[
        str, Parameter("", "Fine 2015, section 7.4.2; random is the comparison", choices=METHODS, plausible=())
    ] = QUAD_TREE
    refined: Annotated[
        str, Parameter("", f"parameters that vary, joined by commas; {OWN}: the schema's first two", plausible=())
    ] = OWN
    grid: Annotated[
        str, Parameter("", "a choice: cells of the first iteration along each of them, one number or one for each")
    ] = "8"
    refinements: Annotated[
        int, Parameter("", "Fine 2015, section 7.4.2: six for anchor four", low=0, high=12, plausible=())
    ] = 0
    splits: Annotated[
        str,
        Parameter("", "Fine 2015, section 7.4.2, leaves it open: successful cells at edges, or all", choices=SPLITS),
    ] = EDGES
    budget: Annotated[
        int,
        Parameter("configurations", "a choice: most of them; 0 = any number, of random none", low=0, high=10_000_000),
    ] = 0
    pairs: Annotated[
        int, Parameter("", "a choice: starts a configuration, each with its mirror image", low=1, high=10_000)
    ] = 10
    reliable_share: Annotated[
        float,
        Parameter("", "a choice: share of the simulations that make a configuration successful", low=0.0, high=1.0,
                  plausible=(0.6, 0.95)),
    ] = 0.9  # fmt: skip
    behaviour: Annotated[
        str, Parameter("", f"Fine 2015, section 7.4.2; {OWN}: the schema's", named=behaviour_names, paths=True)
    ] = OWN  # fmt: skip
    iterations: Annotated[int, Parameter("", "0: those of the behaviour", low=0, high=1_000_000, plausible=())] = 0
    timestep_s: Annotated[
        float, Parameter("s", "of an iteration; a choice: speeds are then in metres an iteration", low=1e-6, high=1e3)
    ] = 1.0


class BoxFields(NamedTuple):
    """A box of the first two refined parameters, inside and outside of which success is told. nan = no bound."""

    first_low: Annotated[float, Parameter("", "no box by default", plausible=())] = math.nan
    first_high: Annotated[float, Parameter("", "no box by default", plausible=())] = math.nan
    second_low: Annotated[float, Parameter("", "no box by default", plausible=())] = math.nan
    second_high: Annotated[float, Parameter("", "no box by default", plausible=())] = math.nan


BOX = "box."


class FormationParameters(NamedTuple):
    """Uniformly over a square about the marker `start`, headings about its direction; and the mirror image of that."""

    size_m: Annotated[float, Parameter("m", "a choice: side of the square", low=0.0)] = 1.3
    heading_spread_deg: Annotated[
        float, Parameter("deg", "a choice: headings are drawn within ± this", low=0.0, high=180.0)
    ] = 20.0


BOIDS = "reynolds-boids"
OF_BOIDS: Mapping[str, Value] = {"range_m": 3.0, "separation_m": 1.0}
"""Radii of BOIDS in corridors of 2 m."""
SPEED_M_S = 0.1
"""A tenth of a metre a step of one second."""
LOOK_AHEAD_M, MARGIN_M = 0.75, 0.28
"""Of the shared avoidance: what it has by itself."""
SIGHT_M = 1.1
"""Of walls: what is farther away than look-ahead and margin together changes no motion, and costs time."""


class Chosen(NamedTuple):
    """What a trial's names stand for, with their parameters filled in."""

    schema: Schema
    of_schema: Any
    box: Box
    within: Mapping[str, tuple[float, float]] | None
    """The box inside of which success is told, by the names of its parameters."""
    behaviour: Behaviour
    of_behaviour: Any
    iterations: int


def trial(
    experiment: str,
    repeat: int,
    groups: Sequence[Group],
    schema: str,
    *,
    world_parameters: Mapping[str, Value] | None = None,
    formation_parameters: Mapping[str, Value] | None = None,
    **setup: Value,
) -> Trial:
    """A trial that maps a schema; `setup`: of `TrialFields`."""
    return Trial(
        experiment=experiment,
        repeat=repeat,
        simulation=NAME,
        world=schema,
        formation=FORMATION,
        groups=tuple(groups),
        world_parameters=world_parameters or {},
        formation_parameters=formation_parameters or {},
        setup=setup,
    )


def herd(count: int, law: str = BOIDS) -> Group:
    """Members for the T-junction, whose numbers Fine 2015 does not give: by default BOIDS.

    Only the nearest wall repels, and walls hide what is behind them: a repulsion that sums over walls lets a construct
    act through the wall of a corridor.
    """
    return group(
        law,
        count,
        law_parameters={**OF_BOIDS, "speed_m_s": SPEED_M_S} if law == BOIDS else {},
        speed_m_s=SPEED_M_S,
        cruise_m_s=SPEED_M_S,
        max_speed_m_s=SPEED_M_S,
        max_turn_rate_rad_s=0.5,
        obstacles="avoid",
        obstacle_selection="nearest",
        look_ahead_m=LOOK_AHEAD_M,
        margin_m=MARGIN_M,
        sight_m=SIGHT_M,
    )


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in. Raises `InputError`."""
    fields: TrialFields = filled(TrialFields, below(trial.setup, ""))
    return fields


def check_formation(trial: Trial) -> None:
    """Refuses a formation that there is not: `InputError`."""
    if trial.formation != FORMATION:
        raise unknown_name("formation", trial.formation, [FORMATION])


def behaviour_of(trial: Trial) -> Behaviour:
    """The behaviour that is mapped. Raises `InputError`."""
    name = of_trial(trial).behaviour
    return behaviours.load(schema_of(trial).behaviour if name == OWN else name)


def starts_of(trial: Trial) -> Starts:
    """How starts are drawn. Raises `InputError`."""
    given = filled(FormationParameters, trial.formation_parameters, prefix="formation.")
    return Starts(given.size_m, math.radians(given.heading_spread_deg))


def box_fields(trial: Trial) -> BoxFields:
    """The box of a trial, filled in; what is left open is nan. Raises `InputError`."""
    given = {name: value for name, value in below(trial.setup, BOX).items() if value == value}
    found: BoxFields = filled(BoxFields, given, prefix=BOX)
    return found


def refined_of(trial: Trial) -> list[str]:
    """The names of the parameters that vary. Raises `InputError`."""
    parameters, text = schema_of(trial).parameters, of_trial(trial).refined
    found = mappable(parameters)[:2] if text == OWN else names(text)
    if not found:
        raise InputError(f"schema {trial.world!r} has no parameter that can be refined: expected one between bounds")
    return found


def chosen_by(trial: Trial) -> Chosen:
    """What a trial's names stand for. Raises `InputError` for names and numbers that do not exist or fit."""
    schema, behaviour, given = schema_of(trial), behaviour_of(trial), of_trial(trial)
    box = box_of(schema.parameters, refined_of(trial), whole_numbers(given.grid, "grid"))
    box.shape(given.refinements if given.method == QUAD_TREE else 0)
    if given.method == RANDOM and not given.budget:
        raise InputError("method = random: expected --set budget=N, the number of configurations")
    return Chosen(
        schema,
        filled(schema.parameters, trial.world_parameters, prefix="world."),
        box,
        _within(box, box_fields(trial)),
        behaviour,
        filled(behaviour.parameters, below(trial.setup, BEHAVIOUR), prefix=BEHAVIOUR),
        given.iterations or behaviour.iterations,
    )


def _within(box: Box, given: BoxFields) -> dict[str, tuple[float, float]] | None:
    pairs = ((given.first_low, given.first_high), (given.second_low, given.second_high))
    found = {}
    for axis, (low, high) in zip(box.axes, pairs, strict=False):
        low, high = (axis.low if math.isnan(low) else low), (axis.high if math.isnan(high) else high)
        if not axis.low <= low < high <= axis.high:
            raise InputError(
                f"box of {axis.name} from {low:g} to {high:g}: expected it within {axis.low:g} to {axis.high:g}"
            )
        found[axis.name] = (low, high)
    return None if all(math.isnan(value) for value in given) else found
