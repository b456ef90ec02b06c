"""Grammars as files (docs/grammars.md): TOML that is read, checked and refused in one line."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError, unknown_name
from generation.grammar.ending import check_ends
from generation.grammar.lines import SHORTEST_M
from generation.grammar.matching import Allowed
from generation.grammar.rules import COUNTED, MOST_STEPS, STEPS, Grammar, LeftSide, Limit, Rule, left_side
from generation.grammar.shapes import EMPTY, Shape, Similarity, added, moved, same, shape
from generation.primitives import MOST_M

LARGEST_BYTES = 1_000_000
"""Of a file. A choice: a thousand rules fit."""
MOST_LINES = 1000
"""Of one shape of a grammar, labels counted as well. A choice."""
SUM_TOLERANCE = 1e-6
"""How far probabilities may be from adding up to 1. A choice: six decimals, as in 0.333333."""
_KEYS = (
    "about", "source", "terminals", "nonterminals", "markers", "labels", "start", "limit", "under",
    "free_probabilities", "anchor", "workspace", "filter", "behaviour", "shapes", "rules",
)  # fmt: skip
_TRANSFORMATIONS = Allowed._fields


def read(path: str | os.PathLike[str]) -> Grammar:
    """The grammar of a TOML file. Raises `InputError` in one line."""
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_BYTES + 1)
        text = data.decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"grammar file {str(path)!r} does not exist; expected a TOML file") from None
    except UnicodeDecodeError:
        raise InputError(f"grammar file {str(path)!r} is no text; expected TOML in UTF-8") from None
    except OSError as error:
        raise InputError(f"grammar file {str(path)!r} cannot be read: {error.strerror or error}") from None
    if len(data) > LARGEST_BYTES:
        raise InputError(f"grammar file {str(path)!r} is larger than {LARGEST_BYTES // 1_000_000} MB")
    return from_text(text, str(path))


def from_text(text: str, where: str = "grammar") -> Grammar:
    """The grammar of a file's text. Raises `InputError` that begins with `where`."""
    try:
        given = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{where}: no TOML: {' '.join(str(error).split())}") from None
    try:
        grammar = _grammar(given, Path(where).stem.replace("_", "-"))
        check_ends(grammar)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return grammar


def _grammar(given: Mapping[str, Any], name: str) -> Grammar:
    _known(given, _KEYS, "entry")
    for needed in ("about", "shapes", "start", "rules"):
        if needed not in given:
            raise InputError(f"{needed} is missing; expected about, shapes, start and rules at least")
    names = {key: _names(given, key) for key in ("terminals", "nonterminals", "markers", "labels")}
    for pair in (("terminals", "nonterminals"), ("markers", "labels")):
        twice = set(names[pair[0]]) & set(names[pair[1]])
        if twice:
            raise InputError(f"{sorted(twice)[0]!r} stands in {pair[0]} and in {pair[1]}; expected it in one of them")
    if not names["terminals"]:
        raise InputError("terminals is empty; expected one kind of lines at least that are built")
    shapes = _Shapes(
        _table(given["shapes"], "shapes"),
        (*names["terminals"], *names["nonterminals"]),
        (*names["markers"], *names["labels"]),
    )
    for each in shapes.given:
        shapes.named(each)
    limit = _limit(given.get("limit"))
    under = _under(given.get("under", list(_TRANSFORMATIONS)), "under")
    return Grammar(
        name=name,
        about=_text(given, "about"),
        source=_text(given, "source"),
        start=shapes.placed(given["start"], "start"),
        lefts=_lefts(given["rules"], shapes, under),
        limit=limit,
        free=_flag(given, "free_probabilities"),
        anchor=_text(given, "anchor"),
        workspace=_text(given, "workspace"),
        filter=_text(given, "filter"),
        behaviour=_text(given, "behaviour"),
        **names,
    )


class _Shapes:
    """The shapes of a file, each made where it is first needed."""

    def __init__(self, given: Mapping[str, Any], kinds: tuple[str, ...], labels: tuple[str, ...]) -> None:
        self.given, self.kinds, self.labels = given, kinds, labels
        self.made: dict[str, Shape] = {}
        self.open: list[str] = []

    def named(self, name: Any) -> Shape:
        """The shape of this name. Raises `InputError` where there is none, or where it is made of itself."""
        if name not in self.given:
            raise unknown_name("shape", name, self.given)
        if name in self.open:
            raise InputError(f"shape {name!r} is made of itself: {' -> '.join([*self.open, name])}")
        if name not in self.made:
            self.open.append(name)
            self.made[name] = self._shape(_table(self.given[name], f"shapes.{name}"), f"shapes.{name}")
            self.open.pop()
        return self.made[name]

    def placed(self, given: Any, where: str) -> Shape:
        """The sum of shapes, each by its name or as a table that says where it is put."""
        whole = EMPTY
        for part in given if isinstance(given, list) else [given]:
            if isinstance(part, str):
                more = self.named(part)
            else:
                _known(_table(part, where), ("shape", "at", "turn_deg", "scale", "mirror"), f"entry of {where}")
                if "shape" not in part:
                    raise InputError(f'{where} = {part!r}: expected the name of a shape in it, as in shape = "line"')
                x, y = _numbers(part.get("at", [0.0, 0.0]), 2, f"at in {where}")
                (turn,) = _numbers([part.get("turn_deg", 0.0)], 1, f"turn_deg in {where}")
                (scale,) = _numbers([part.get("scale", 1.0)], 1, f"scale in {where}")
                if not 1e-3 <= scale <= 1e3:
                    raise InputError(f"scale = {scale:g} in {where}: expected a number from 0.001 to 1000")
                similarity = Similarity(scale, math.radians(turn), _flag(part, "mirror"), x, y)
                more = moved(self.named(part["shape"]), similarity.row())
            whole = self._checked(added(whole, more), where)
        return whole

    def _shape(self, given: Mapping[str, Any], where: str) -> Shape:
        _known(given, ("lines", "labels", "parts"), f"entry of {where}")
        lines, kinds = [], []
        for kind, drawn in _table(given.get("lines", {}), f"{where}.lines").items():
            if kind not in self.kinds:
                raise unknown_name(f"kind of line in {where}", kind, self.kinds)
            for polyline in _list(drawn, f"{where}.lines.{kind}"):
                corners = [
                    _numbers(corner, 2, f"{where}.lines.{kind}") for corner in _list(polyline, f"{where}.lines.{kind}")
                ]
                if len(corners) < 2:
                    raise InputError(f"{where}.lines.{kind} = {polyline!r}: expected two places [x, y] at least")
                for start, end in pairwise(corners):
                    if math.dist(start, end) < SHORTEST_M:
                        raise InputError(
                            f"{where}.lines.{kind}: from {start} to {end} is shorter than {SHORTEST_M:g} m"
                        )
                    lines.append([*start, *end])
                    kinds.append(self.kinds.index(kind))
        labels, places = [], []
        for label, at in _table(given.get("labels", {}), f"{where}.labels").items():
            if label not in self.labels:
                raise unknown_name(f"label in {where}", label, self.labels)
            for place in _list(at, f"{where}.labels.{label}"):
                numbers = _numbers(place, (2, 3), f"{where}.labels.{label}")
                labels.append(self.labels.index(label))
                places.append([*numbers[:2], math.radians(numbers[2]) if len(numbers) == 3 else math.nan])
        if len(lines) + len(labels) > MOST_LINES:
            raise InputError(f"{where} has {len(lines) + len(labels)} lines and labels; expected at most {MOST_LINES}")
        own = shape(
            np.array(lines, np.float64).reshape(-1, 4), np.array(kinds, np.int64),
            np.array(labels, np.int64), np.array(places, np.float64).reshape(-1, 3),
        )  # fmt: skip
        return self._checked(added(own, self.placed(given.get("parts", []), f"{where}.parts")), where)

    @staticmethod
    def _checked(made: Shape, where: str) -> Shape:
        if len(made.kinds) + len(made.labels) > MOST_LINES:
            raise InputError(f"{where} has more than {MOST_LINES} lines and labels")
        if max(np.abs(made.lines).max(initial=0.0), np.abs(made.places[:, :2]).max(initial=0.0)) > MOST_M:
            raise InputError(f"{where} reaches farther than {MOST_M:g} m from its origin")
        return made


def _lefts(given: Any, shapes: _Shapes, default: Allowed) -> tuple[LeftSide, ...]:
    """The left sides with their rules, in the file's order."""
    found: dict[str, list[Rule]] = {}
    stated: dict[str, list[bool]] = {}
    under: dict[str, Allowed] = {}
    names: set[str] = set()
    rules = _list(given, "rules")
    for number, rule in enumerate(rules, 1):
        where = f"rule {number}"
        _known(_table(rule, where), ("name", "left", "right", "probability", "under"), f"entry of {where}")
        for needed in ("left", "right"):
            if needed not in rule:
                raise InputError(f"{where} lacks {needed}; expected left and right")
        name = _text(rule, "name") or f"rule-{number}"
        where = f"rule {name!r}"
        if name in names:
            raise InputError(f"{where} stands there twice; expected names of their own")
        names.add(name)
        left = rule["left"]
        if not isinstance(left, str):
            raise InputError(f"{where}: left = {left!r}; expected the name of a shape")
        if same(shapes.named(left), right := shapes.placed(rule["right"], f"right side of {where}")):
            raise InputError(f"{where} changes nothing: its right side is its left side")
        allowed = _under(rule["under"], f"under of {where}") if "under" in rule else default
        if under.setdefault(left, allowed) != allowed:
            raise InputError(
                f"{where}: under differs from that of another rule with the left side {left!r}; expected the same, "
                "or a second shape for one of them"
            )
        (chance,) = _numbers([rule.get("probability", 1.0)], 1, f"probability of {where}")
        if not 0.0 <= chance <= 1.0:
            raise InputError(f"probability of {where} = {chance:g}: expected a number from 0 to 1")
        found.setdefault(left, []).append(Rule(name, right, chance))
        stated.setdefault(left, []).append("probability" in rule)
    if not rules:
        raise InputError("rules is empty; expected one rule at least")
    lefts = []
    for left, several in found.items():
        if any(stated[left]) and not all(stated[left]):
            raise InputError(
                f"rules of {left!r}: some have a probability and some have none; expected all or none of them"
            )
        if not any(stated[left]):
            several = [rule._replace(probability=1.0 / len(several)) for rule in several]
        total = math.fsum(rule.probability for rule in several)
        if abs(total - 1.0) > SUM_TOLERANCE:
            told = " + ".join(f"{rule.probability:g}" for rule in several)
            raise InputError(f"rules of {left!r}: probabilities {told} = {total:g}; expected a sum of 1")
        lefts.append(left_side(left, shapes.named(left), under[left], tuple(several)))
    return tuple(lefts)


def _limit(given: Any) -> Limit:
    if given is None:
        return Limit(STEPS, MOST_STEPS, MOST_STEPS, stated=False)
    example = "as in limit = { steps = 20 } or { lines = [3, 8] }"
    if not isinstance(given, dict) or len(given) != 1:
        raise InputError(f"limit = {given!r}: expected {' or '.join(COUNTED)}, {example}")
    ((counted, value),) = given.items()
    if counted not in COUNTED:
        raise unknown_name("limit", counted, COUNTED)
    ends = value if isinstance(value, list) else [value, value]
    whole = len(ends) == 2 and all(isinstance(end, int) and not isinstance(end, bool) for end in ends)
    if not whole or not 1 <= ends[0] <= ends[1] <= MOST_STEPS:
        raise InputError(f"limit.{counted} = {value!r}: expected whole numbers from 1 to {MOST_STEPS}, {example}")
    return Limit(counted, ends[0], ends[1])


def _under(given: Any, where: str) -> Allowed:
    names = _list(given, where)
    for name in names:
        if name not in _TRANSFORMATIONS:
            raise unknown_name(f"transformation in {where}", name, _TRANSFORMATIONS)
    return Allowed(*(name in names for name in _TRANSFORMATIONS))


def _known(given: Mapping[str, Any], valid: Iterable[str], kind: str) -> None:
    for key in given:
        if key not in valid:
            raise unknown_name(kind, key, valid)


def _typed(given: Any, kind: type, where: str, expected: str) -> Any:
    if not isinstance(given, kind):
        raise InputError(f"{where} = {given!r}: expected {expected}")
    return given


def _table(given: Any, where: str) -> Any:
    return _typed(given, dict, where, "a table")


def _list(given: Any, where: str) -> Any:
    return _typed(given, list, where, "a list")


def _text(given: Mapping[str, Any], key: str) -> str:
    text: str = _typed(given.get(key, ""), str, key, "text")
    return text.strip()


def _flag(given: Mapping[str, Any], key: str) -> bool:
    flag: bool = _typed(given.get(key, False), bool, key, "true or false")
    return flag


def _names(given: Mapping[str, Any], key: str) -> tuple[str, ...]:
    names = _list(given.get(key, []), key)
    usable: Callable[[Any], bool] = lambda name: isinstance(name, str) and name.replace("-", "_").isidentifier()  # noqa: E731
    for name in names:
        if not usable(name):
            raise InputError(f"{key}: {name!r} is no name; expected letters, digits and hyphens")
    if len(set(names)) < len(names):
        raise InputError(f"{key} = {names!r}: expected each name once")
    return tuple(names)


def _numbers(given: Any, count: int | tuple[int, ...], where: str) -> list[float]:
    counts = count if isinstance(count, tuple) else (count,)
    numbers = given if isinstance(given, list) else [given]
    fine = all(isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in numbers)
    if len(numbers) not in counts or not fine:
        expected = {1: "a finite number", 2: "a place [x, y]", 3: "a place [x, y] or [x, y, heading_deg]"}[max(counts)]
        raise InputError(f"{where}: {given if max(counts) > 1 else numbers[0]!r}: expected {expected}")
    return [float(n) for n in numbers]
