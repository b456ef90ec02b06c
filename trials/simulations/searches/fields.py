"""The parameters of a trial that searches a schema's parameters, or decomposes a construct; how such trials are made.

Its world is a schema, whose parameters have the prefix `world.`: those that are searched vary, the others are the
trial's. Its group is one of the kinematic herd. An iteration is one time step.
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
from generation.maps.spaces import names, whole_numbers
from generation.primitives import Polygon
from generation.schema import Schema
from generation.searches import descriptors
from generation.searches.methods import METHODS
from generation.searches.spaces import Space, searchable, space_of, usual
from generation.validation.starts import Starts
from trials.rows import below
from trials.simulations.schemas import schema_of
from trials.types import Group, Trial, Value

NAME = "searches"
FORMATION = "square"
OWN = "own"
"""The behaviour that a schema is meant for, its searched parameters, or the group's own count."""
BEHAVIOUR, SEARCH, PIECES = "behaviour.", "search.", "pieces."
"""Prefixes of keys: of the behaviour's parameters, of a search, of a decomposition."""
DECOMPOSITION = "decomposition"
METHOD_NAMES = (*METHODS, DECOMPOSITION)
MOST_POINTS = 1_000_000
_CHOICE = "a choice"


def behaviour_names() -> list[str]:
    """The behaviours that environments can be sought for."""
    return [OWN, *behaviours.names()]


class NameFields(NamedTuple):
    """The names of a trial's schema and formation."""

    world: Annotated[
        str, Parameter("", "a choice: the schema that is searched, or whose construct is decomposed", named=schemas,
                       paths=True)
    ] = "dirt"  # fmt: skip
    formation: Annotated[str, Parameter("", "a choice: the only one", choices=(FORMATION,))] = FORMATION


class TrialFields(NamedTuple):
    """What a trial has beside its names and groups."""

    method: Annotated[
        str,
        Parameter("", "Fine 2015, section 7.4.3, names parameter optimisation and none; 8.1.1: decomposition",
                  choices=METHOD_NAMES, plausible=()),
    ] = "cma-es"  # fmt: skip
    behaviour: Annotated[
        str, Parameter("", f"Fine 2015, section 7.4.2; {OWN}: the schema's", named=behaviour_names, paths=True)
    ] = OWN
    iterations: Annotated[int, Parameter("", "0: those of the behaviour", low=0, high=1_000_000, plausible=())] = 0
    timestep_s: Annotated[
        float, Parameter("s", "of an iteration; a choice: speeds are then in metres an iteration", low=1e-6, high=1e3)
    ] = 1.0


class SearchFields(NamedTuple):
    """Of a search."""

    budget: Annotated[
        int, Parameter("simulations", "a choice: of the search; what is estimated anew afterwards comes on top",
                       low=2, high=100_000_000, plausible=())
    ] = 1200  # fmt: skip
    pairs: Annotated[
        int, Parameter("", "a choice: starts of each point, each with its mirror image", low=1, high=10_000)
    ] = 6
    parameters: Annotated[
        str, Parameter("", f"those that are searched, joined by commas; {OWN}: all numbers that are not whole",
                       plausible=())
    ] = OWN  # fmt: skip
    ends_m: Annotated[
        float, Parameter("m", "a choice: how far ends of the construct are moved at the most", low=0.0)
    ] = 0.1
    counts: Annotated[
        str, Parameter("", f"group sizes, joined by commas, which simulations have in turn; {OWN}: the group's count",
                       plausible=())
    ] = OWN  # fmt: skip
    descriptors: Annotated[
        str, Parameter("", "a choice: what the archive's cells differ by, joined by commas", plausible=())
    ] = "fence_m, angle_deg"
    cells: Annotated[
        str, Parameter("", "a choice: of the archive along each descriptor, joined by commas", plausible=())
    ] = "8, 12"
    best_pairs: Annotated[
        int,
        Parameter("", "a choice: new starts by which each best point so far is estimated anew", low=1, high=10_000),
    ] = 30
    elite_pairs: Annotated[
        int, Parameter("", "a choice: new starts by which each elite is estimated anew", low=1, high=10_000)
    ] = 6
    robust_share: Annotated[
        float, Parameter("", "a choice: robustness from which an environment counts as robust", low=0.0, high=1.0,
                         plausible=(0.6, 0.95))
    ] = 0.9  # fmt: skip


class PiecesFields(NamedTuple):
    """Of a decomposition."""

    window_m: Annotated[float, Parameter("m", f"{_CHOICE}: length of a piece", low=1e-3, high=1e6)] = 1.0
    stride_m: Annotated[float, Parameter("m", f"{_CHOICE}: from one piece to the next", low=1e-3, high=1e6)] = 0.5
    regions: Annotated[
        str,
        Parameter("", "of a directed decomposition: NAME: x0, y0, x1, y1 in m, joined by semicolons; none: undirected",
                  plausible=()),
    ] = ""  # fmt: skip
    pairs: Annotated[
        int, Parameter("", "a choice: starts of each piece, each with its mirror image", low=1, high=10_000)
    ] = 10
    cut_m: Annotated[float, Parameter("m", f"{_CHOICE}: members farther apart are of different groups", low=0.0)] = 2.0


class FormationParameters(NamedTuple):
    """Uniformly over a square about the marker `start`, headings about its direction; and the mirror image of that."""

    size_m: Annotated[float, Parameter("m", "a choice: side of the square", low=0.0)] = 1.3
    heading_spread_deg: Annotated[
        float, Parameter("deg", "a choice: headings are drawn within ± this", low=0.0, high=180.0)
    ] = 20.0


class Chosen(NamedTuple):
    """What a trial's names stand for, with their parameters filled in."""

    schema: Schema
    of_schema: Any
    behaviour: Behaviour
    of_behaviour: Any
    iterations: int
    starts: Starts


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
    """A trial that searches a schema or decomposes its construct; `setup`: of `TrialFields`, and by dotted keys."""
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


def of_trial(trial: Trial) -> TrialFields:
    """A trial's fields with everything filled in. Raises `InputError`."""
    found: TrialFields = filled(TrialFields, below(trial.setup, ""))
    return found


def of_search(trial: Trial) -> SearchFields:
    """Those of its search. Raises `InputError`."""
    found: SearchFields = filled(SearchFields, below(trial.setup, SEARCH), prefix=SEARCH)
    return found


def of_pieces(trial: Trial) -> PiecesFields:
    """Those of its decomposition. Raises `InputError`."""
    found: PiecesFields = filled(PiecesFields, below(trial.setup, PIECES), prefix=PIECES)
    return found


def check_formation(trial: Trial) -> None:
    """Refuses a formation that there is not: `InputError`."""
    if trial.formation != FORMATION:
        raise unknown_name("formation", trial.formation, [FORMATION])


def behaviour_of(trial: Trial) -> Behaviour:
    """The behaviour that environments are sought for. Raises `InputError`."""
    name = of_trial(trial).behaviour
    return behaviours.load(schema_of(trial).behaviour if name == OWN else name)


def chosen_by(trial: Trial) -> Chosen:
    """What a trial's names stand for. Raises `InputError` for names and numbers that do not exist or fit."""
    schema, behaviour, given = schema_of(trial), behaviour_of(trial), of_trial(trial)
    placed = filled(FormationParameters, trial.formation_parameters, prefix="formation.")
    return Chosen(
        schema,
        filled(schema.parameters, trial.world_parameters, prefix="world."),
        behaviour,
        filled(behaviour.parameters, below(trial.setup, BEHAVIOUR), prefix=BEHAVIOUR),
        given.iterations or behaviour.iterations,
        Starts(placed.size_m, math.radians(placed.heading_spread_deg)),
    )


def searched_of(trial: Trial) -> list[str]:
    """The names of the parameters that are searched. Raises `InputError` where there is none to search."""
    text, parameters = of_search(trial).parameters, schema_of(trial).parameters
    found = usual(parameters) if text == OWN else names(text)
    if not found:
        told = ", ".join(searchable(parameters)) or "none of this schema's"
        raise InputError(f"{SEARCH}parameters = {text!r}: expected numbers between finite bounds ({told})")
    return found


def space_searched(trial: Trial, chosen: Chosen) -> Space:
    """The space that a trial searches. Raises `InputError`."""
    return space_of(chosen.of_schema, searched_of(trial))


def points_of(trial: Trial) -> int:
    """Points that the budget reaches for. Raises `InputError` where it reaches for none, or for too many."""
    given = of_search(trial)
    each = 2 * given.pairs
    if not each <= given.budget <= MOST_POINTS * each:
        raise InputError(
            f"{SEARCH}budget = {given.budget}: expected from {each} simulations, those of one point, to {MOST_POINTS} "
            "times as many"
        )
    return given.budget // each


def counts_of(trial: Trial) -> list[int]:
    """The group sizes of a search. Raises `InputError`."""
    text = of_search(trial).counts
    if text == OWN:
        return [trial.groups[0].count]
    found = whole_numbers(text, f"{SEARCH}counts")
    if min(found) < 1 or max(found) > 100_000:
        raise InputError(f"{SEARCH}counts = {text!r}: expected sizes from 1 to 100000, as in 5, 7, 9")
    return found


def archive_of(trial: Trial) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """The archive's descriptors and its cells along each. Raises `InputError`."""
    given = of_search(trial)
    described = descriptors.checked(names(given.descriptors))
    cells = whole_numbers(given.cells, f"{SEARCH}cells")
    if len(cells) != len(described) or min(cells) < 1 or math.prod(cells) > MOST_POINTS:
        raise InputError(
            f"{SEARCH}cells = {given.cells!r}: expected a number of at least 1 for each of {', '.join(described)}, "
            f"and at most {MOST_POINTS} cells"
        )
    return described, tuple(cells)


def regions_of(trial: Trial) -> dict[str, Polygon]:
    """The regions of a directed decomposition by their names. Raises `InputError`."""
    found = {}
    for part in names(of_pieces(trial).regions.replace(",", "\0").replace(";", ",")):
        name, colon, numbers = part.replace("\0", ",").partition(":")
        try:
            x0, y0, x1, y1 = (float(number) for number in names(numbers))
        except ValueError:
            x0 = y0 = x1 = y1 = math.nan
        if not colon or not name.strip() or name.strip() in found or not (x0 < x1 and y0 < y1):
            raise InputError(
                f"{PIECES}regions: {part.replace(chr(0), ',')!r}; expected NAME: x0, y0, x1, y1 in m with x0 below x1 "
                "and y0 below y1, each name once, joined by semicolons"
            )
        found[name.strip()] = Polygon(((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
    return found
