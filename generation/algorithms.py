"""Algorithms 3 to 5 of Fine 2015 (section 6.1): candidates of any schema, and those of them that elicit a behaviour.

They are generic: a schema generates, a filter says what is feasible, a behaviour what is wanted of whichever group.
All are lazy: a candidate is made when it is asked for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared, declared
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group, Job
from generation.schema import Schema

MOST_TRIES = 1000
"""Environments in a row of which none passes a filter before generation stops. A choice: a filter that lets 1 in 100
pass is stopped wrongly once in 20,000 times."""
CHUNK = 64
"""Candidates that are simulated together. A choice."""
MOST_CANDIDATES = 10_000_000
"""Largest grid that is enumerated. A choice: a day of validation."""


def geg(
    candidates: Iterable[Environment],
    behaviour: Behaviour,
    group: Group,
    start: Callable[[Environment, int], Job],
    wanted: Any = None,
    chunk: int = CHUNK,
) -> Iterator[Environment]:
    """General environment generation (algorithm 3): the candidates that elicit a behaviour from a group.

    The candidates stand in their workspace already. `start`: the simulation of a candidate, given its number. `wanted`:
    the behaviour's parameters, by default its own. Raises `InputError` for a fitness that is none.
    """
    numbered = enumerate(candidates)
    while several := list(itertools.islice(numbered, chunk)):
        jobs = [start(candidate, number) for number, candidate in several]
        found = group.trajectories(jobs, behaviour.iterations)
        for (_, candidate), positions in zip(several, found, strict=True):
            if behaviour.succeeds(behaviour.judged(positions, candidate, wanted)):
                yield candidate


def gcg(
    schema: Schema,
    parameters: Any,
    workspace: Environment,
    passes: Callable[[Environment], bool],
    count: int,
    rng: np.random.Generator,
    most_tries: int = MOST_TRIES,
) -> Iterator[Environment]:
    """Grammar-based candidate generation (algorithm 4): `count` environments (phi) of a schema that pass a filter.

    Raises `InputError` with the pass rate so far where `most_tries` in a row do not pass; what came before is kept by
    whoever asked for it.
    """
    passed = tried = since = 0
    while passed < count:
        if since >= most_tries:
            raise InputError(
                f"schema {schema.name!r}: the last {since} environments do not pass the filter; passed so far: "
                f"{passed} of {tried} ({passed / tried:.1%}), expected {count}"
            )
        candidate = schema.generate(parameters, workspace, rng)
        tried, since = tried + 1, since + 1
        if passes(candidate):
            passed, since = passed + 1, 0
            yield candidate


def gccg(
    schema: Schema, resolutions: Mapping[str, float], workspace: Environment, seed: Sequence[int] = (0,)
) -> Iterator[tuple[Any, Environment]]:
    """General computational candidate generation (algorithm 5): parameters and environment of each point of a grid.

    `resolutions`: as in `grid`. `seed`: of random numbers, the same for each point, so that only parameters differ.
    """
    for parameters in grid(schema.parameters, resolutions):
        yield parameters, schema.generate(parameters, workspace, np.random.default_rng(list(seed)))


def grid(parameters: type, resolutions: Mapping[str, float]) -> Iterator[Any]:
    """Each point of the grid over a schema's `Parameters`, once; the last parameter changes fastest.

    `resolutions`: the step of each parameter that varies, from its lowest value to its highest; texts and truth values
    take all of their values, and their step is 1. All others keep their default.
    Raises `InputError` as `candidates`.
    """
    total = candidates(parameters, resolutions)
    names = _varied(parameters, resolutions)
    return (_point(parameters, names, resolutions, index) for index in range(total))


def _point(parameters: type, names: Sequence[str], resolutions: Mapping[str, float], index: int) -> Any:
    """The point of a grid with this number: its digits, in a system whose bases are the numbers of values."""
    values = {}
    for name in reversed(names):
        parameter = declared(parameters)[name]
        index, digit = divmod(index, _points(parameter, resolutions[name]))
        values[name] = _value(parameter, resolutions[name], digit)
    return parameters(**values)


def candidates(parameters: type, resolutions: Mapping[str, float]) -> int:
    """The number of points of a grid: the product over its parameters (Fine 2015, appendix B).

    The printed formula has (highest - lowest) / step for each; with both ends it is one more, rounded down.
    Raises `InputError` for an unknown parameter, one without bounds, a step that is none, and a grid that is too large.
    """
    total = 1
    for name in _varied(parameters, resolutions):
        total *= _points(declared(parameters)[name], resolutions[name])
    if total > MOST_CANDIDATES:
        raise InputError(
            f"the grid has {total} candidates; expected at most {MOST_CANDIDATES}, with coarser resolutions"
        )
    return total


def _varied(parameters: type, resolutions: Mapping[str, float]) -> list[str]:
    """The parameters that vary, in their declared order."""
    known = declared(parameters)
    for name in resolutions:
        if name not in known:
            raise unknown_name("parameter", name, known)
    return [name for name in known if name in resolutions]


def _points(parameter: Declared, step: float) -> int:
    """How many values a parameter takes."""
    if parameter.type is bool:
        return 2
    if parameter.type is str:
        if not parameter.about.choices:
            raise InputError(
                f"parameter {parameter.name!r} is a text without choices; expected one that can be enumerated"
            )
        return len(parameter.about.choices)
    low, high = parameter.about.low, parameter.about.high
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(f"parameter {parameter.name!r} has no bounds; expected one with a lowest and a highest value")
    if isinstance(step, bool) or not isinstance(step, int | float) or not (math.isfinite(step) and step > 0.0):
        raise InputError(f"resolution of {parameter.name} = {step!r}: expected a number above 0")
    if parameter.type is int and step != int(step):
        raise InputError(f"resolution of {parameter.name} = {step!r}: expected a whole number")
    return math.floor((high - low) / step * (1.0 + 1e-12)) + 1  # the last point is not lost to rounding


def _value(parameter: Declared, step: float, number: int) -> Any:
    """The value of a parameter with this number."""
    if parameter.type is bool:
        return number == 1
    if parameter.type is str:
        return parameter.about.choices[number]
    if parameter.type is int:
        return int(parameter.about.low) + number * int(step)
    return min(parameter.about.low + number * step, parameter.about.high)
