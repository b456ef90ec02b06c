"""Whether a grammar without a limit ends: decided as for context-free grammars, where that decides it.

Each left side is a type. What a rule's right side brings of a type is the number of places of it where that left side
matches. A derivation is then a branching process of several types (Harris 1963, chapter 2): it ends if each type that
is reached can end, and its mean number of steps is finite if the largest eigenvalue of the mean offspring is below 1.
What left sides find only where several right sides lie beside one another is not seen; no derivation goes beyond
`MOST_STEPS`.
"""

from __future__ import annotations

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.grammar.rules import Grammar, LeftSide
from generation.grammar.shapes import Shape, moved, same

CRITICAL = 1.0 - 1e-9
"""Mean offspring from which on the mean number of steps is infinite; what is missing to 1 is for rounding."""


def check_ends(grammar: Grammar) -> None:
    """Raises `InputError` for a grammar without a limit whose derivations never end, or are too long on average."""
    if grammar.limit.stated:
        return
    advice = "expected a limit, as in limit = { steps = 20 }"
    reached = _reached(grammar)
    ending: set[str] = set()
    for _ in grammar.lefts:
        ending |= {left.name for left in grammar.lefts if _can_end(left, grammar, ending)}
    for left in grammar.lefts:
        if left.name in reached and left.name not in ending:
            raise InputError(f"the rules of {left.name!r} never end: each leads to a left side that leads on; {advice}")
    names = [k for k, left in enumerate(grammar.lefts) if left.name in reached]
    mean = offspring(grammar)[np.ix_(names, names)]
    largest = float(np.abs(np.linalg.eigvals(mean)).max(initial=0.0))
    if largest >= CRITICAL:
        raise InputError(
            f"derivations have no mean length: a left side brings {largest:.3g} others on average; {advice}, "
            "or probabilities with which it is below 1"
        )


def offspring(grammar: Grammar) -> Floats:
    """(K, K) how many matches of left side j a rule of left side i brings on average."""
    return np.array(
        [
            [sum(rule.probability * places(j, rule.right) for rule in i.rules) for j in grammar.lefts]
            for i in grammar.lefts
        ]
    ).reshape(len(grammar.lefts), len(grammar.lefts))


def places(left: LeftSide, host: Shape) -> int:
    """At how many places a left side is found in a shape, whatever its turn there."""
    images: list[Shape] = []
    for row in left.matches(host):
        image = moved(left.shape, row)
        if not any(same(image, other) for other in images):
            images.append(image)
    return len(images)


def _can_end(left: LeftSide, grammar: Grammar, ending: set[str]) -> bool:
    """Whether a rule of a left side leads to nothing but left sides that can end."""
    return any(
        rule.probability > 0.0 and all(each.name in ending or not places(each, rule.right) for each in grammar.lefts)
        for rule in left.rules
    )


def _reached(grammar: Grammar) -> set[str]:
    """The left sides that a derivation can come to."""
    reached = {left.name for left in grammar.lefts if places(left, grammar.start)}
    for _ in grammar.lefts:
        for left in grammar.lefts:
            for rule in left.rules if left.name in reached else ():
                if rule.probability > 0.0:
                    reached |= {each.name for each in grammar.lefts if places(each, rule.right)}
    return reached
