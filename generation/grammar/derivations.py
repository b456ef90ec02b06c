"""Derivations: a start shape, and rules applied to it one by one (Stiny 1980, section 4; Fine 2015, figure 6.4)."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from generation.grammar.rules import LINES, MOST_STEPS, STEPS, Grammar, LeftSide, Rule, chances
from generation.grammar.shapes import Shape, Similarity, applied, moved, of_row, part_of

START = "start"


class Step(NamedTuple):
    """A step of a derivation."""

    rule: str
    """Name of the rule that was applied; `START` of step 0."""
    under: Similarity
    """The transformation of the rule's left side to where it was found."""
    shape: Shape
    """After the step."""


@dataclass(frozen=True)
class Derivation:
    """What became of a start, step by step, and why it ended."""

    grammar: Grammar
    steps: tuple[Step, ...]
    """Step 0 is the start."""
    ended: str
    """In words."""

    @property
    def shape(self) -> Shape:
        """The last shape."""
        return self.steps[-1].shape

    @property
    def moves(self) -> list[tuple[str, Similarity]]:
        """What is needed to do it again: rule and transformation of each step after the start."""
        return [(step.rule, step.under) for step in self.steps[1:]]


def derive(
    grammar: Grammar,
    rng: np.random.Generator,
    least: int | None = None,
    most: int | None = None,
    weights: dict[str, float] | None = None,
    at: Similarity | None = None,
) -> Derivation:
    """A derivation: at each step one of all matches, each as likely, then one of the rules with that left side.

    It ends where no left side matches, or where the next step would go beyond the limit. `least` and `most`: of the
    limit, which is drawn first if they differ; by default the grammar's. `weights`: of the rules, by name; by default
    the grammar's probabilities. `at`: where the start is put. Two numbers are drawn for each step.
    Raises `InputError` where all weights of a left side are 0.
    """
    least, most = grammar.limit.least if least is None else least, grammar.limit.most if most is None else most
    limit = most if least == most else int(rng.integers(least, most + 1))
    cumulated = [list(accumulate(chances(left, weights))) for left in grammar.lefts]
    shape = grammar.start if at is None else moved(grammar.start, at.row())
    steps = [Step(START, at or Similarity(), shape)]
    most_steps = min(limit, MOST_STEPS) if grammar.limit.counted == STEPS else MOST_STEPS
    while True:
        found = [left.matches(shape) for left in grammar.lefts]
        count = sum(map(len, found))
        if not count:
            return Derivation(grammar, tuple(steps), "no rule applies")
        if len(steps) > most_steps:
            return Derivation(grammar, tuple(steps), f"limit of {most_steps} steps")
        where, which = rng.random(2).tolist()
        index = int(where * count)
        side = 0
        while index >= len(found[side]):
            index -= len(found[side])
            side += 1
        left, row = grammar.lefts[side], found[side][index]
        chosen = min(bisect_right(cumulated[side], which), len(left.rules) - 1)
        shape = applied(shape, left.shape, left.rules[chosen].right, row)
        if grammar.limit.counted == LINES and grammar.built(shape) > limit:
            return Derivation(grammar, tuple(steps), f"limit of {limit} lines")
        steps.append(Step(left.rules[chosen].name, of_row(row), shape))


def replay(grammar: Grammar, moves: Iterable[tuple[str, Similarity]], at: Similarity | None = None) -> Derivation:
    """The derivation with these moves. Raises `InputError` for an unknown rule, and for one that does not apply."""
    rules = {rule.name: (left, rule) for left, rule in grammar.rules}
    shape = grammar.start if at is None else moved(grammar.start, at.row())
    steps = [Step(START, at or Similarity(), shape)]
    for number, (name, under) in enumerate(moves, 1):
        if name not in rules:
            raise unknown_name("rule", name, rules)
        left, rule = rules[name]
        _check(number, left, rule, shape, under)
        shape = applied(shape, left.shape, rule.right, under.row())
        steps.append(Step(name, under, shape))
    return Derivation(grammar, tuple(steps), "replayed")


def _check(number: int, left: LeftSide, rule: Rule, shape: Shape, under: Similarity) -> None:
    if not part_of(moved(left.shape, under.row()), shape):
        raise InputError(f"step {number}: rule {rule.name!r} does not apply: its left side {left.name!r} is not there")
