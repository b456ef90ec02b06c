"""A grammar as a schema: its limit, and where its file says so its rules' probabilities, are its parameters."""

from __future__ import annotations

import dataclasses
import math
from collections import namedtuple
from collections.abc import Callable
from functools import cache
from typing import Annotated, Any

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter
from generation.environment import Environment
from generation.grammar.derivations import Derivation, derive
from generation.grammar.rules import MOST_STEPS, Grammar
from generation.grammar.shapes import Similarity
from generation.primitives import Point, Segment
from generation.schema import Schema


def schema_of(grammar: Grammar, workspace: Callable[[], Environment]) -> Schema:
    """The schema of a grammar. `workspace`: what it builds in by itself."""

    def generate(parameters: Any, workspace: Environment, rng: np.random.Generator) -> Environment:
        return environment(derivation(grammar, parameters, workspace, rng), workspace)

    return Schema(
        grammar.name, grammar.about, parameters_of(grammar), workspace, generate, grammar.filter, grammar.behaviour
    )


def parameters_of(grammar: Grammar) -> type:
    """The `Parameters` of a grammar.

    `most_steps` or `most_lines`; `least_steps` or `least_lines` where the limit is drawn; and where the probabilities
    are free `probability_RULE` of each rule.
    """
    limit = grammar.limit
    weights = [(rule.name, rule.probability) for _, rule in grammar.rules] if grammar.free else []
    return _parameters(grammar.name, limit.counted, limit.least, limit.most, tuple(weights), grammar.source)


@cache
def _parameters(
    name: str, counted: str, least: int, most: int, weights: tuple[tuple[str, float], ...], source: str
) -> type:
    whole = Parameter(counted, f"{source or 'its file'}; the value is a choice", low=1, high=MOST_STEPS)
    share = Parameter("", "its file: weight among the rules with the same left side", low=0.0, high=1.0)
    fields: dict[str, tuple[Any, Any]] = {}
    if least < most:
        fields[f"least_{counted}"] = Annotated[int, whole], least
    fields[f"most_{counted}"] = Annotated[int, whole], most
    for rule, probability in weights:
        fields[f"probability_{rule.replace('-', '_')}"] = Annotated[float, share], probability
    made: Any = namedtuple("Parameters", list(fields), defaults=[default for _, default in fields.values()])  # type: ignore[misc]
    made.__annotations__ = {field: hint for field, (hint, _) in fields.items()}
    made.__module__, made.__doc__ = __name__, f"Of the grammar {name}."
    arguments = (name, counted, least, most, weights, source)

    def reduced(self: Any) -> tuple[Any, ...]:
        return _remade, (arguments, tuple(self))

    made.__reduce__ = reduced  # type: ignore[method-assign]
    return made


def _remade(arguments: tuple[Any, ...], values: tuple[Any, ...]) -> Any:
    """Parameters that were sent to another process, whose class no module holds."""
    return _parameters(*arguments)(*values)


def derivation(grammar: Grammar, parameters: Any, workspace: Environment, rng: np.random.Generator) -> Derivation:
    """A derivation with these parameters, from the workspace's marker on that the grammar names.

    Raises `InputError` where the least limit is above the most, where the probabilities of a left side are all 0, and
    where the workspace lacks the marker.
    """
    most = getattr(parameters, f"most_{grammar.limit.counted}")
    least = getattr(parameters, f"least_{grammar.limit.counted}", most)
    if least > most:
        counted = grammar.limit.counted
        raise InputError(f"least_{counted} = {least}: expected at most most_{counted} = {most}")
    weights = None
    if grammar.free:
        weights = {
            rule.name: getattr(parameters, f"probability_{rule.name.replace('-', '_')}") for _, rule in grammar.rules
        }
    return derive(grammar, rng, least, most, weights, _at(grammar, workspace))


def _at(grammar: Grammar, workspace: Environment) -> Similarity | None:
    if not grammar.anchor:
        return None
    mark = workspace.markers.get(grammar.anchor)
    if not isinstance(mark, Point):
        has = ", ".join(sorted(name for name, mark in workspace.markers.items() if isinstance(mark, Point))) or "none"
        raise InputError(
            f"grammar {grammar.name!r} starts at the marker {grammar.anchor!r}; the workspace has the points: {has}"
        )
    return Similarity(turn_rad=mark.heading_rad, x_m=mark.x_m, y_m=mark.y_m)


def environment(derivation: Derivation, workspace: Environment) -> Environment:
    """The workspace with the terminals of a derivation as its construct, and with its markers.

    Non-terminals and labels are left out (Fine 2015, section 6.3.1). Of a marker that stands at several places the
    first has its name, the others are numbered from 2.
    """
    grammar, shape = derivation.grammar, derivation.shape
    built = shape.lines[shape.kinds < len(grammar.terminals)]
    markers: dict[str, Point] = {}
    for label, (x, y, heading) in zip(shape.labels.tolist(), shape.places.tolist(), strict=True):
        if label < len(grammar.markers):
            name, number = grammar.markers[label], 1
            while (name if number == 1 else f"{name}-{number}") in markers:
                number += 1
            markers[name if number == 1 else f"{name}-{number}"] = Point(x, y, 0.0 if math.isnan(heading) else heading)
    return dataclasses.replace(
        workspace,
        construct=(*workspace.construct, *(Segment(*line) for line in built.tolist())),
        markers={**workspace.markers, **markers},
        origin={
            **workspace.origin,
            "steps": len(derivation.steps) - 1,
            "ended": derivation.ended,
        },
    )
