"""Stage 3, neighbour selection: plain functions from the detected members to a mask (M,) of the selected ones.

Source: Fine 2015, table 3.1, and two limits of sensing that the document wants apart from the law (section 9.1.1).

In a trial a selection is text: names, with numbers where they take them, as in `nearest` or `k-nearest(3)`. `&` applies
several in succession, each seeing only what the last one kept. A law names its sets and selects each by such a text, in
which the name of one of its parameters stands for its value: `distance-based(0, range_m)`. Sets are put in another way
side by side: `repulsion: nearest; attraction: distance-based(1, 3)`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking import perception
from flocking.errors import InputError, unknown_name
from flocking.perception import ARGUMENTS, Step
from flocking.tessellation import tessellated
from flocking.types import Bools, Floats, Ints, Members, only


class Chosen(NamedTuple):
    """One step of a selection; an argument is a number or the name of a law's parameter."""

    step: Step
    given: tuple[float | str, ...] = ()


def everyone(members: Members) -> Bools:
    """All(): every detected member."""
    return np.ones(len(members.ids), dtype=np.bool_)


def fixed_set(members: Members, *ids: float) -> Bools:
    """FixedSet(): members with these ids."""
    mask = everyone(members)
    perception.keep_ids(members.ids, np.array(ids, dtype=np.float64), mask)
    return mask


def distance_based(members: Members, low_m: float, high_m: float) -> Bools:
    """DistanceBased(): members at a distance in [low, high)."""
    mask = everyone(members)
    perception.keep_within(members.positions, low_m, high_m, mask)
    return mask


def nearest(members: Members) -> Bools:
    """Nearest(): the nearest member only."""
    return k_nearest(members, 1)


def k_nearest(members: Members, k: float) -> Bools:
    """k-Nearest(): the k nearest members; of equally near ones the one with the smaller position first."""
    mask = everyone(members)
    perception.keep_nearest(members.positions, int(min(k, len(mask))), mask)
    return mask


def voronoi(members: Members) -> Bools:
    """VoronoiBased(): members whose Voronoi cell touches the focal member's, among all of them and it."""
    return tessellated(np.vstack([np.zeros((1, 2)), members.positions]))[0, 1:]


def bounding_box(members: Members, x0_m: float, y0_m: float, x1_m: float, y1_m: float) -> Bools:
    """BoundingBox(): members in a rectangle of the body frame, its border included."""
    mask = everyone(members)
    perception.keep_in_box(members.positions, x0_m, y0_m, x1_m, y1_m, mask)
    return mask


def angle(members: Members, angle_deg: float) -> Bools:
    """Angle(): members with a bearing of less than the angle to either side."""
    mask = everyone(members)
    perception.keep_angle(members.bearings, math.radians(angle_deg), mask)
    return mask


def sector(members: Members, from_deg: float, to_deg: float) -> Bools:
    """Members with a bearing from the first angle counter-clockwise to the second; (-180, 180) is everybody."""
    mask = everyone(members)
    perception.keep_sector(members.bearings, math.radians(from_deg), math.radians(to_deg), mask)
    return mask


def field_of_view(members: Members, width_deg: float) -> Bools:
    """Members within a field of view of that width about the nose (Fine 2015, section 4.2.1)."""
    mask = everyone(members)
    perception.keep_view(members.bearings, math.radians(width_deg), mask)
    return mask


def unoccluded(members: Members, radius_m: float) -> Bools:
    """Members whose centre no nearer member's disc hides (Fine 2015, section 3.5.2: occlusions)."""
    mask = everyone(members)
    perception.keep_unoccluded(members.positions, radius_m, mask)
    return mask


def densest_distance(members: Members, threshold_m: float) -> Bools:
    """The largest group of members linked by gaps up to the threshold: group-centric information (section 4.1)."""
    mask = everyone(members)
    perception.keep_densest(members.positions, members.bearings, threshold_m, False, mask)
    return mask


def densest_angle(members: Members, threshold_deg: float) -> Bools:
    """The largest group of members linked by differences of bearing up to the threshold (LCH variation 3)."""
    mask = everyone(members)
    perception.keep_densest(members.positions, members.bearings, math.radians(threshold_deg), True, mask)
    return mask


class _Function(NamedTuple):
    step: Step
    function: Callable[..., Bools]
    arguments: int
    """−1: any number of them."""
    needs: frozenset[str]
    expected: str = ""
    """What its numbers must be, in words."""
    right: Callable[..., bool] = lambda *numbers: True
    """Whether they are."""


def _needs(*names: str) -> frozenset[str]:
    return frozenset(names)


SELECTIONS: dict[str, _Function] = {
    "all": _Function(Step.ALL, everyone, 0, _needs()),
    "fixed-set": _Function(
        Step.FIXED_SET, fixed_set, -1, _needs("ids"), "whole ids from 0", lambda *ids: all(i >= 0 == i % 1 for i in ids)
    ),
    "distance-based": _Function(
        Step.DISTANCE_BASED,
        distance_based,
        2,
        _needs("positions"),
        "0 <= low <= high, in m",
        lambda low, high: 0 <= low <= high,
    ),
    "nearest": _Function(Step.NEAREST, nearest, 0, _needs("positions")),
    "voronoi": _Function(Step.VORONOI, voronoi, 0, _needs("positions")),
    "k-nearest": _Function(
        Step.K_NEAREST,
        k_nearest,
        1,
        _needs("positions"),
        "a whole number of at least 1",
        lambda k: k >= 1 and k % 1 == 0,
    ),
    "bounding-box": _Function(
        Step.BOUNDING_BOX,
        bounding_box,
        4,
        _needs("positions"),
        "x0 <= x1 and y0 <= y1, as x0, y0, x1, y1 in m",
        lambda x0, y0, x1, y1: x0 <= x1 and y0 <= y1,
    ),
    "angle": _Function(Step.ANGLE, angle, 1, _needs("bearings"), "0 to 180 degrees", lambda a: 0 <= a <= 180),
    "sector": _Function(
        Step.SECTOR,
        sector,
        2,
        _needs("bearings"),
        "degrees from -360 to 360",
        lambda *ends: all(abs(end) <= 360 for end in ends),
    ),
    "field-of-view": _Function(
        Step.FIELD_OF_VIEW, field_of_view, 1, _needs("bearings"), "0 to 360 degrees", lambda width: 0 <= width <= 360
    ),
    "unoccluded": _Function(
        Step.UNOCCLUDED, unoccluded, 1, _needs("positions"), "a radius of at least 0 m", lambda radius: radius >= 0
    ),
    "densest-distance": _Function(
        Step.DENSEST_DISTANCE,
        densest_distance,
        1,
        _needs("positions"),
        "a distance of at least 0 m",
        lambda threshold: threshold >= 0,
    ),
    "densest-angle": _Function(
        Step.DENSEST_ANGLE,
        densest_angle,
        1,
        _needs("bearings"),
        "0 to 180 degrees",
        lambda threshold: 0 <= threshold <= 180,
    ),
}
"""Name in a selection's text → what it stands for."""

_NAMES = {about.step: name for name, about in SELECTIONS.items()}
_BY_STEP = {about.step: about for about in SELECTIONS.values()}
_CALL = re.compile(r"^\s*([a-z_-]+)\s*(?:\(([^()]*)\))?\s*$")


def parse(text: str, parameters: Iterable[str] = ()) -> list[Chosen]:
    """The steps that a selection's text names; `InputError` if it names none.

    `parameters`: names that may stand for numbers.
    """
    known, steps = tuple(parameters), []
    for part in text.split("&"):
        match = _CALL.match(part)
        if match is None:
            raise InputError(f"selection {text!r}: expected names such as all or k-nearest(3), joined by &")
        name = match.group(1).replace("_", "-")
        if name not in SELECTIONS:
            raise unknown_name("selection", name, SELECTIONS)
        about = SELECTIONS[name]
        pieces = [piece.strip() for piece in (match.group(2) or "").split(",") if piece.strip()]
        for piece in pieces:
            if known and piece.isidentifier() and piece not in known and math.isnan(_number(piece)) and piece != "nan":
                raise unknown_name("parameter of the law", piece, known)
        given = tuple(piece if piece in known else _number(piece) for piece in pieces)
        numbers = [value for value in given if not isinstance(value, str)]
        right = len(given) <= ARGUMENTS if about.arguments < 0 else len(given) == about.arguments
        if not right or not all(map(math.isfinite, numbers)):
            count = f"up to {ARGUMENTS}" if about.arguments < 0 else about.arguments
            raise InputError(f"selection {part.strip()!r}: {name} takes {count} finite number{'s' * (count != 1)}")
        if len(numbers) == len(given):
            _check(about.step, numbers)
        if about.step is Step.FIXED_SET and not given:
            steps.append(Chosen(Step.GRAPH))
        elif about.step is not Step.ALL:
            steps.append(Chosen(about.step, given))
    return steps


def parse_sets(text: str, sets: Mapping[str, str], parameters: Iterable[str] = ()) -> list[list[Chosen]]:
    """The steps for each of a law's sets, in their order.

    `text` limits what all sets select from, or, as `name: selection; …`, takes the place of the sets so named.
    """
    known = tuple(parameters)
    if ":" not in text:
        first = parse(text, known)
        return [first + parse(own, known) for own in sets.values()]
    chosen = dict(sets)
    for part in filter(str.strip, text.split(";")):
        name, _, own = part.partition(":")
        if name.strip() not in sets:
            raise unknown_name("set of the law", name.strip(), sets)
        chosen[name.strip()] = own
    return [parse(own, known) for own in chosen.values()]


def resolved(steps: Sequence[Chosen], values: Mapping[str, Any]) -> list[Chosen]:
    """The steps with numbers in place of parameters' names. Raises `InputError` for numbers that cannot be.

    A parameter that says how many are nearest may be 0: then there is nobody.
    """
    made = []
    for step, given in steps:
        numbers = tuple(float(values[value]) if isinstance(value, str) else value for value in given)
        if any(isinstance(value, str) for value in given) and (step, numbers) != (Step.K_NEAREST, (0.0,)):
            _check(step, numbers)
        made.append(Chosen(step, numbers))
    return made


def _check(step: Step, numbers: Sequence[float]) -> None:
    """Raises `InputError` if a step cannot have these numbers."""
    if step is Step.GRAPH or _BY_STEP[step].right(*numbers):
        return
    name = _NAMES[step]
    raise InputError(
        f"selection '{name}({', '.join(f'{value:g}' for value in numbers)})': expected {_BY_STEP[step].expected}"
    )


def needs(steps: Iterable[Chosen]) -> frozenset[str]:
    """What the steps read of each member."""
    found: frozenset[str] = frozenset()
    for chosen in steps:
        found |= _needs("ids") if chosen.step is Step.GRAPH else _BY_STEP[chosen.step].needs
    return found


def select(steps: Sequence[Chosen], members: Members, linked: Bools | None = None) -> Bools:
    """The mask (M,) of the members that every step keeps, each step seeing only what the last one kept.

    `linked` (M,): which members the group's graph joins to the focal one, for `fixed-set` without numbers.
    """
    mask = everyone(members)
    for number, (step, given) in enumerate(steps):
        if number == 0 and step is not Step.GRAPH:  # sees everybody: nobody is left out yet
            mask = _BY_STEP[step].function(members, *given)
            continue
        kept = np.flatnonzero(mask)
        if step is Step.GRAPH:
            if linked is None:
                raise InputError("selection 'fixed-set' without ids: this group has no graph; expected fixed-set(0, 3)")
            chosen = linked[kept]
        else:
            chosen = _BY_STEP[step].function(only(members, kept), *given)
        mask = np.zeros_like(mask)
        mask[kept[chosen]] = True
    return mask


class Program(NamedTuple):
    """The selections of all of a law's sets, as the kinematic herd's compiled code takes them."""

    steps: Ints
    """(S, K) `Step`s, filled up with ALL."""
    given: Floats
    """(S, K, ARGUMENTS) numbers; nan where none."""
    named: Ints
    """(S, K, ARGUMENTS) index of the parameter that stands for the number, −1 = the number itself."""


def program(sets: Sequence[Sequence[Chosen]], parameters: Sequence[str]) -> Program:
    """The selections of all sets as arrays; `parameters` are the law's, in their order."""
    longest = max([1, *(len(steps) for steps in sets)])
    codes = np.zeros((len(sets), longest), dtype=np.int64)
    given = np.full((len(sets), longest, ARGUMENTS), np.nan)
    named = np.full((len(sets), longest, ARGUMENTS), -1, dtype=np.int64)
    for s, steps in enumerate(sets):
        for k, chosen in enumerate(steps):
            codes[s, k] = chosen.step
            for a, value in enumerate(chosen.given):
                if isinstance(value, str):
                    named[s, k, a] = parameters.index(value)
                else:
                    given[s, k, a] = value
    return Program(codes, given, named)


def reach(steps: Sequence[Chosen], values: Mapping[str, Any]) -> float:
    """Distance (m) beyond which no member can matter to these steps; inf where there is no such limit."""
    limit = math.inf
    for step, given in resolved(steps, values):
        if step in (Step.DENSEST_DISTANCE, Step.DENSEST_ANGLE):
            break
        if step is Step.DISTANCE_BASED:
            limit = min(limit, float(given[1]))
    return limit


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
