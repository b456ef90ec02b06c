"""Parameters that know their unit, their source and their bounds.

A law, a pipeline, a sensor or an experiment declares its parameters as a `NamedTuple` named `Parameters`, whose
fields are annotated with a `Parameter`. The default stands there and nowhere else:

    class Parameters(NamedTuple):
        repulsion_m: Annotated[float, Parameter("m", "Fine 2015, section 2.1.1", low=0.0)] = 0.66

What must hold between parameters is said in words, as in "core_m at most equilibrium_m" or "gain below 1" (`relation`).
"""

from __future__ import annotations

import difflib
import math
import operator
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple, get_type_hints

from flocking.errors import InputError, unknown_name
from flocking.found import is_path


@dataclass(frozen=True)
class Parameter:
    """Unit, source and bounds of one parameter (bounds inclusive)."""

    unit: str
    source: str
    published: bool = False
    """True where the source gives this very value; False where it is a choice of ours."""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    named: Callable[[], Iterable[str]] | None = None
    """Of a text that names something with a file of its own: all such names, with hyphens."""
    paths: bool = False
    """Of such a text: the path of a file or a folder of the user's own will do as well."""
    reads: Callable[[str], object] | None = None
    """Of a text with a grammar: what reads it, and raises `InputError` where it cannot."""
    plausible: tuple[Any, ...] | None = None
    """Of a choice, what else would have been as good: the lowest and highest number, or three and more where there are
    none between; all values of a text or of a truth value. `herd sensitivity` varies it there, and docs/sensitivity.md
    has the reasons. None: a number from half of it to twice, a text or a truth value not at all. (): never varied, as
    no verdict is to hang on it or it follows from others."""


COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = MappingProxyType(
    {"below": operator.lt, "at most": operator.le, "above": operator.gt, "at least": operator.ge}
)
_RELATION = re.compile(rf"(\w+) ({'|'.join(COMPARISONS)}) (\S+)")


class Declared(NamedTuple):
    """A parameter with its name, its Python type and its default."""

    name: str
    type: type
    default: Any
    about: Parameter


@cache
def declared(parameters: type) -> Mapping[str, Declared]:
    """The parameters that a `Parameters` class declares, in order."""
    hints = get_type_hints(parameters, include_extras=True)
    defaults = getattr(parameters, "_field_defaults", {})
    found = {}
    for name, hint in hints.items():
        about = next((m for m in getattr(hint, "__metadata__", ()) if isinstance(m, Parameter)), None)
        if about is None or name not in defaults:
            raise InputError(
                f"parameter {name!r} of {parameters.__module__}.{parameters.__qualname__} lacks "
                "its Parameter(unit, source) annotation or its default"
            )
        found[name] = Declared(name, hint.__origin__, defaults[name], about)
    return MappingProxyType(found)


def checked(key: str, value: Any, parameter: Declared) -> Any:
    """`value` as the parameter's type, or an `InputError` that names the key, the value and the bounds."""
    about, given = parameter.about, value
    if parameter.type is bool:
        if not isinstance(value, bool):
            raise InputError(f"{key} = {given!r}: expected true or false")
        return value
    if parameter.type is str:
        if not isinstance(value, str) or (about.choices and value not in about.choices):
            near = difflib.get_close_matches(str(given), about.choices, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InputError(f"{key} = {given!r}: expected {' or '.join(about.choices) or 'text'}{hint}")
        if about.reads is not None:
            about.reads(value)
        return _known(parameter, value) if about.named is not None else value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{key} = {given!r}: expected {_number(parameter)}")
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise InputError(f"{key} = a number beyond 1e308: expected {_bounds(parameter)}")
    if parameter.type is int and value != int(value if math.isfinite(value) else 0.5):
        raise InputError(f"{key} = {given!r}: expected {_number(parameter)}")
    if not math.isfinite(value) or not about.low <= value <= about.high:
        raise InputError(f"{key} = {given!r}: expected {_bounds(parameter)}")
    return parameter.type(value)


def _known(parameter: Declared, name: str) -> str:
    """A name in its usual spelling, with hyphens, or a path. Raises `InputError` with the nearest ones otherwise."""
    if parameter.about.paths and is_path(name):
        return name
    known, wanted = list(parameter.about.named() if parameter.about.named else ()), name.replace("_", "-")
    if wanted not in known:
        raise unknown_name(parameter.name, name, known)
    return wanted


def filled(parameters: type, given: Mapping[str, Any], prefix: str = "") -> Any:
    """An instance of `parameters` with the given values checked and the defaults elsewhere."""
    known = declared(parameters)
    for name in given:
        if name not in known:
            raise unknown_name("parameter", f"{prefix}{name}", [f"{prefix}{k}" for k in known])
    return parameters(**{name: checked(f"{prefix}{name}", value, known[name]) for name, value in given.items()})


class Relation(NamedTuple):
    """What must hold of one parameter and another, or a number."""

    words: str
    left: str
    right: str | float
    compare: Callable[[Any, Any], bool]

    @property
    def names(self) -> list[str]:
        """The parameters that it relates."""
        return [side for side in (self.left, self.right) if isinstance(side, str)]

    def holds(self, values: Any) -> bool:
        """Whether it holds of these parameters."""
        right = getattr(values, self.right) if isinstance(self.right, str) else self.right
        return self.compare(getattr(values, self.left), right)


def relation(words: str, parameters: type) -> Relation:
    """The relation between two parameters, or one and a number, in words. Raises `InputError`."""
    known = declared(parameters)
    found = _RELATION.fullmatch(words) if isinstance(words, str) else None
    if found and found[1] in known:
        left, comparison, right = found.groups()
        if right in known:
            return Relation(words, left, right, COMPARISONS[comparison])
        try:
            return Relation(words, left, float(right), COMPARISONS[comparison])
        except ValueError:
            pass
    raise InputError(
        f"relation {words!r}: expected NAME {' or '.join(COMPARISONS)} another NAME or a number, "
        f"with NAME of {', '.join(known) or 'no parameters'}"
    )


def _number(parameter: Declared) -> str:
    """What a number is of: robots are counted, metres are measured."""
    unit = parameter.about.unit
    if parameter.type is int:
        return f"a whole number{f' of {unit}' if unit else ''}"
    return f"a number{f' in {unit}' if unit else ''}"


def _bounds(parameter: Declared) -> str:
    low, high, unit = parameter.about.low, parameter.about.high, parameter.about.unit
    if parameter.type is int:
        least = f"from {low:.0f}" if math.isfinite(high) else f"at least {low:.0f}"
        bounds = [least] if math.isfinite(low) else []
        bounds += [f"{'to' if bounds else 'at most'} {high:.0f}"] if math.isfinite(high) else []
        return " ".join([_number(parameter), *bounds])
    within = f" in {unit}" if unit else ""
    if math.isfinite(low) and math.isfinite(high):
        return f"a number from {low:g} to {high:g}{within}"
    if math.isfinite(low):
        return f"a finite number of at least {low:g}{within}"
    if math.isfinite(high):
        return f"a finite number of at most {high:g}{within}"
    return f"a finite number{within}"
