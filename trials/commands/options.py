"""Reads the text of options of the command line: settings, sweeps and selections of trials."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

from flocking.errors import InputError

_KEY = re.compile(r"[A-Za-z_][\w-]*(\.[A-Za-z_][\w-]*)*")
_WORD = re.compile(r"[A-Za-z_.~/][\w./~-]*\+?(\([\w., -]*\))?( *& *[A-Za-z_-]+(\([\w., -]*\))?)*")
_BETWEEN = re.compile(r",(?![^(]*\))")
"""A comma outside of parentheses: those of `distance-based(0, 3)` are of one value."""
_RANGE = re.compile(r"([0-9]{1,12})(?:-([0-9]{1,12}))?")
LONG = 60
"""Characters of a text that an error repeats."""


def settings(texts: Iterable[str]) -> dict[str, Any]:
    """`--set KEY=VALUE …`: the values by key. A value is TOML; a bare word is text."""
    found: dict[str, Any] = {}
    for text in texts:
        key, value = _split("--set", text, "VALUE")
        if key in found:
            raise InputError(f"--set {text}: {key} is set twice")
        found[key] = _value(f"--set {text}", value)
    return found


def sweeps(texts: Iterable[str]) -> dict[str, list[Any]]:
    """`--sweep KEY=A,B,C …`: the lists of values by key. Each value is TOML; a bare word is text."""
    found: dict[str, list[Any]] = {}
    for text in texts:
        key, values = _split("--sweep", text, "A,B,C")
        if key in found:
            raise InputError(f"--sweep {text}: {key} is swept twice")
        found[key] = _values(f"--sweep {text}", values)
    return found


def only(text: str) -> tuple[int, ...]:
    """`--only 1-4,9`: the indices of the trials, in order."""
    from trials.design import MAX_TRIALS  # not with this file: commands without trials start sooner

    indices: set[int] = set()
    for part in text.split(","):
        match = _RANGE.fullmatch(part.strip())
        if match is None:
            raise InputError(f"--only {_short(text)!r}: expected numbers and ranges of trials, as in 1-4,9")
        first, last = int(match[1]), int(match[2] or match[1])
        if first > last:
            raise InputError(f"--only {_short(text)!r}: the range {part.strip()} ends before it begins")
        if last > MAX_TRIALS:
            raise InputError(f"--only {_short(text)!r}: expected trials from 1 to {MAX_TRIALS}")
        indices.update(range(first, last + 1))
    return tuple(sorted(indices))


def _split(option: str, text: str, what: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equals or not _KEY.fullmatch(key) or not value:
        example = "herd.count=10,20" if "," in what else "herd.count=10"
        raise InputError(f"{option} {text!r}: expected KEY={what}, as in {example}")
    return key, value


def _toml(text: str) -> Any:
    """One TOML value. Raises `tomllib.TOMLDecodeError`, also for one that nobody can mean."""
    try:
        found = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        raise
    except (ValueError, RecursionError) as error:  # thousands of digits or of brackets
        raise tomllib.TOMLDecodeError from error
    if list(found) != ["value"]:
        raise tomllib.TOMLDecodeError
    return found["value"]


def _value(given: str, text: str) -> Any:
    try:
        return _toml(text)
    except tomllib.TOMLDecodeError:
        if _WORD.fullmatch(text):
            return text
        raise InputError(
            f"{_short(given)}: {_short(text)!r} is not a TOML value; "
            "expected as in 0.5, true, nearest or, quoted for the shell too, '\"nearest & all\"'"
        ) from None


def _short(text: str) -> str:
    return text if len(text) <= LONG else f"{text[:LONG]}…"


def _values(given: str, text: str) -> list[Any]:
    try:
        values = _toml(f"[{text}]")
    except tomllib.TOMLDecodeError:
        values = [_value(given, part.strip()) for part in _BETWEEN.split(text)]
    for number, value in enumerate(values):
        if any(value == other and type(value) is type(other) for other in values[:number]):
            raise InputError(f"{given}: {value!r} is given twice")
    return list(values)
