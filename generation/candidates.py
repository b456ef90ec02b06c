"""Environments of a schema, candidate by candidate: each has random numbers of its own, so that it can be made alone.

Candidate k (from 1) of a seed is the same however many there are, whatever the filter: a schema's other choices aside,
its random numbers are those of `numpy.random.SeedSequence(seed, spawn_key=(k,))`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared, declared
from generation.algorithms import MOST_TRIES, gcg
from generation.environment import Environment
from generation.schema import Schema

MOST_REDRAWN = 1000
"""Draws of parameters in a row of which a schema can build none, before that is an error. A choice."""


class Tally(NamedTuple):
    """How many candidates there were."""

    tried: int
    passed: int

    def __str__(self) -> str:
        rate = f" ({self.passed / self.tried:.1%})" if self.tried else ""
        return f"{self.passed} of {self.tried} candidates passed{rate}"


def candidate(
    schema: Schema,
    parameters: Any,
    workspace: Environment,
    seed: int,
    number: int,
    varied: Sequence[str] = (),
    within: Mapping[str, tuple[float, float]] = {},
) -> Environment:
    """Candidate `number` of a seed; its origin tells how it was made.

    `varied`: parameters that are drawn evenly between their bounds, or between those of `within` where it has some,
    again where the schema cannot build with them. Raises `InputError` where it cannot build, with none of
    `MOST_REDRAWN` draws.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
    for left in range(MOST_REDRAWN if varied else 1, 0, -1):
        values = {name: _drawn(schema.parameters, name, rng, within.get(name)) for name in varied}
        drawn = parameters._replace(**values)
        try:
            found = schema.generate(drawn, workspace, rng)
            break
        except InputError as error:
            if left == 1:
                raise InputError(f"schema {schema.name}: {error}") from None
    told = {"schema": schema.name, "parameters": drawn._asdict(), "seed": seed, "candidate": number}
    return dataclasses.replace(found, origin={**found.origin, **told})


def passing(
    schema: Schema,
    parameters: Any,
    workspace: Environment,
    accepts: Callable[[Environment], bool],
    count: int,
    seed: int,
    varied: Sequence[str] = (),
    most_tries: int = MOST_TRIES,
) -> Iterator[tuple[Environment, Tally]]:
    """The first `count` candidates of a seed that pass a filter, and the tally so far (Fine 2015, algorithm 4).

    Raises `InputError` with the pass rate so far where `most_tries` in a row do not pass.
    """
    tried = 0

    def generate(parameters: Any, workspace: Environment, rng: np.random.Generator) -> Environment:
        nonlocal tried
        tried += 1
        return candidate(schema, parameters, workspace, seed, tried, varied)

    own = dataclasses.replace(schema, generate=generate)
    found = gcg(own, parameters, workspace, accepts, count, np.random.default_rng(0), most_tries)
    for passed, environment in enumerate(found, 1):
        yield environment, Tally(tried, passed)


def check_varied(schema: Schema, varied: Sequence[str]) -> None:
    """Raises `InputError` for parameters that a schema lacks, or that have no bounds to be drawn between."""
    known = declared(schema.parameters)
    for name in varied:
        if name not in known:
            raise unknown_name(f"parameter of {schema.name}", name, known)
        if not _can_be_drawn(known[name]):
            raise InputError(f"parameter {name} of {schema.name} has no bounds to be drawn between")


def draws_nothing(schema: Schema, parameters: Any, workspace: Environment) -> bool:
    """Whether a schema is deterministic: it takes no random number to build this environment."""
    rng = np.random.default_rng(0)
    before = rng.bit_generator.state
    schema.generate(parameters, workspace, rng)
    return bool(rng.bit_generator.state == before)


def bounded(schema: Schema) -> list[str]:
    """The parameters of a schema that can be drawn between bounds, in the order of declaration."""
    return [name for name, parameter in declared(schema.parameters).items() if _can_be_drawn(parameter)]


def _can_be_drawn(parameter: Declared) -> bool:
    about = parameter.about
    numbers = parameter.type in (int, float) and bool(np.isfinite([about.low, about.high]).all())
    return numbers or parameter.type is bool or bool(about.choices)


def _drawn(parameters: type, name: str, rng: np.random.Generator, within: tuple[float, float] | None = None) -> Any:
    parameter = declared(parameters)[name]
    about = parameter.about
    if parameter.type is bool:
        return bool(rng.integers(2))
    if about.choices:
        return about.choices[rng.integers(len(about.choices))]
    low, high = within or (about.low, about.high)
    if parameter.type is int:
        return int(rng.integers(int(low), int(high) + 1))
    return float(rng.uniform(low, high))
