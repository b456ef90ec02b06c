"""Grammars: shapes, rules with probabilities, a start, a limit (Stiny 1980, section 4; Fine 2015, section 6.1.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from flocking.errors import InputError
from flocking.types import Floats
from generation.grammar.lines import SHORTEST_M
from generation.grammar.matching import Allowed, Plan, matches, plan
from generation.grammar.shapes import Shape, added, moved, same, shortest
from generation.primitives import MOST_M

STEPS, LINES = COUNTED = ("steps", "lines")
"""What a limit can count: steps of a derivation, or lines of terminal kinds."""
ADDITION, SUBSTITUTION, MODIFICATION = "addition", "substitution", "modification"
MOST_STEPS = 10_000
"""No derivation takes more steps, whatever its grammar says. A choice."""
EVERYTHING = Allowed(True, True, True, True)


class Rule(NamedTuple):
    """Where the left side of the rule is found, the right side takes its place."""

    name: str
    right: Shape
    probability: float
    """Of this rule among those with the same left side."""


@dataclass(frozen=True)
class LeftSide:
    """A left side, where it may match, and the rules that have it."""

    name: str
    shape: Shape
    allowed: Allowed
    plan: Plan
    rules: tuple[Rule, ...]
    least: float
    """Least scale, so that no right side has a line below `SHORTEST_M`."""

    def matches(self, host: Shape) -> Floats:
        """(M, 5) all similarities under which it is a sub-shape of `host`."""
        found: Floats = matches(self.shape, host, self.plan, self.allowed, self.least, MOST_M / 2)
        return found


class Limit(NamedTuple):
    """Where a derivation stops at the latest: at a number that is drawn evenly from the least to the most."""

    counted: str
    """`STEPS` or `LINES`."""
    least: int
    most: int
    stated: bool = True
    """False where a file says nothing: the grammar is known to end by itself."""


@dataclass(frozen=True)
class Grammar:
    """A shape grammar. Lines and labels are numbered by the lists of their names."""

    name: str
    about: str
    source: str
    terminals: tuple[str, ...]
    """Kinds of lines that are built."""
    nonterminals: tuple[str, ...]
    """Kinds of lines that are needed for the derivation alone; numbered after the terminals."""
    markers: tuple[str, ...]
    """Labels that an environment keeps as its markers."""
    labels: tuple[str, ...]
    """Labels that are needed for the derivation alone; numbered after the markers."""
    start: Shape
    lefts: tuple[LeftSide, ...]
    limit: Limit
    free: bool = False
    """Whether the rules' probabilities are parameters of the schema."""
    anchor: str = ""
    """The marker of a workspace at which the start is put; empty: at the world's origin."""
    workspace: str = ""
    """The schema whose workspace it builds in; empty: none."""
    filter: str = ""
    behaviour: str = ""

    @property
    def rules(self) -> tuple[tuple[LeftSide, Rule], ...]:
        """All rules, with their left sides."""
        return tuple((left, rule) for left in self.lefts for rule in left.rules)

    def built(self, shape: Shape) -> int:
        """The number of lines of a shape that are built."""
        return int((shape.kinds < len(self.terminals)).sum())


def left_side(name: str, shape: Shape, allowed: Allowed, rules: tuple[Rule, ...]) -> LeftSide:
    """A left side. Raises `InputError` where nothing can match it, or too much."""
    if not shape.kinds.size and not shape.labels.size:
        raise InputError(f"left side {name!r} has no line and no label; expected one at least, so that it can be found")
    least = max((SHORTEST_M / shortest(rule.right) for rule in rules), default=0.0)
    return LeftSide(name, shape, allowed, plan(shape, allowed, name), rules, max(least, 1e-9))


def kind(left: Shape, right: Shape) -> str:
    """Which of the three rules of Fine 2015, figure 6.2, it is.

    An addition keeps the left side; a modification moves, turns, mirrors or scales it; all else is a substitution.
    """
    if same(added(left, right), right):
        return ADDITION
    for allowed in (EVERYTHING, EVERYTHING._replace(scale=False)):
        try:
            places = plan(left, allowed, "")
        except InputError:  # labels alone: a turn or a size is left open
            continue
        if any(same(moved(left, row), right) for row in matches(left, right, places, allowed, 1e-9, MOST_M)):
            return MODIFICATION
    return SUBSTITUTION


def chances(left: LeftSide, weights: dict[str, float] | None) -> list[float]:
    """The probabilities of a left side's rules: the file's, or these weights by rule over their sum."""
    given = [rule.probability if weights is None else weights[rule.name] for rule in left.rules]
    total = math.fsum(given)
    if not total > 0.0:
        names = ", ".join(rule.name for rule in left.rules)
        raise InputError(f"rules of {left.name!r}: all probabilities are 0; expected one above 0 at least of {names}")
    return [weight / total for weight in given]
