"""What a law's file declares, as plain data: a user's own law is then planned and reported without being executed."""

from __future__ import annotations

import math
from collections import namedtuple
from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Annotated, Any

from flocking.errors import InputError
from flocking.parameters import Declared, Parameter, declared
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation

TYPES = {kind.__name__: kind for kind in (float, int, bool, str)}
TUPLES = {"HERD": Herd, "TAXONOMY": Taxonomy, "VALIDATION": Validation}
"""Constants of a law's file that are named tuples."""
PLAIN: dict[str, tuple[type, ...]] = {
    "RULES": (tuple, list),
    "RELATIONS": (tuple, list),
    "NEEDS": (set, frozenset, tuple, list),
    "MAY_LACK": (set, frozenset, tuple, list),
    "SETS": (tuple, list, Mapping),
    "CREATE": (Mapping,),
    "MEMORY": (int,),
    "DRAWS": (int,),
    "CHIRAL": (bool,),
    "AXIS": (bool,),
}
"""The other constants, and the types that each may have."""


def as_data(name: str, module: ModuleType) -> dict[str, Any]:
    """What the module of the law `name` declares, for JSON. Raises `InputError` for what is of another type."""
    data: dict[str, Any] = {"doc": (module.__doc__ or "").strip()}
    data["parameters"] = [_parameter(each) for each in declared(module.Parameters).values()]
    for constant, kind in TUPLES.items():
        value = getattr(module, constant, None)
        if value is not None and not isinstance(value, kind):
            raise InputError(f"law file {name!r}: {constant} = {value!r}: expected {kind.__name__}(...)")
        if isinstance(value, tuple):
            data[constant] = list(value)
    for constant, kinds in PLAIN.items():
        if not hasattr(module, constant):
            continue
        value = getattr(module, constant)
        if not isinstance(value, kinds):
            words = " or ".join(kind.__name__.lower() for kind in kinds)
            raise InputError(f"law file {name!r}: {constant} = {value!r}: expected a {words}")
        data[constant] = _plain(value)
    filled = getattr(module, "FILLED", ())
    if not isinstance(filled, tuple | list) or not all(isinstance(each, Filled) for each in filled):
        raise InputError(f"law file {name!r}: FILLED = {filled!r}: expected a tuple of Filled(...)")
    data["FILLED"] = [list(each) for each in filled]
    return data


def from_data(name: str, data: object) -> ModuleType:
    """A module that declares what `as_data` told of the law `name`; it has no function `law`.

    Raises `InputError` for data that `as_data` does not make.
    """
    try:
        return _module(name, data)
    except (TypeError, ValueError, KeyError, AttributeError, IndexError) as error:
        told = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"what is kept of law {name!r} is damaged ({told})") from error


def _module(name: str, data: Any) -> ModuleType:
    made = ModuleType(name, str(data["doc"]))
    fields = {field: (TYPES[kind], default, about) for field, kind, default, about in data["parameters"]}
    make: Any = namedtuple
    parameters = make("Parameters", list(fields), defaults=[default for _, default, _ in fields.values()])
    parameters.__annotations__ = {
        field: Annotated[kind, Parameter(**{**about, **_bounds(about)})] for field, (kind, _, about) in fields.items()
    }
    made.Parameters = parameters  # type: ignore[attr-defined]
    declared(parameters)
    for constant, tuple_kind in TUPLES.items():
        if constant in data:
            setattr(made, constant, tuple_kind(*data[constant]))
    for constant, kinds in PLAIN.items():
        if constant in data:
            value = data[constant]
            if not isinstance(value, (*kinds, list)):
                raise TypeError(f"{constant} = {value!r}")
            setattr(made, constant, tuple(value) if isinstance(value, list) else value)
    made.FILLED = tuple(Filled(*each) for each in data["FILLED"])  # type: ignore[attr-defined]
    return made


def _parameter(field: Declared) -> list[Any]:
    about = field.about
    told: dict[str, Any] = {"unit": about.unit, "source": about.source, "published": about.published}
    told |= {side: value for side, value in (("low", about.low), ("high", about.high)) if math.isfinite(value)}
    if about.choices:
        told["choices"] = list(about.choices)
    if about.plausible is not None:
        told["plausible"] = list(about.plausible)
    return [field.name, field.type.__name__, field.default, told]


def _bounds(about: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {side: float(about[side]) for side in ("low", "high") if side in about}
    if "plausible" in about:
        found["plausible"] = tuple(about["plausible"])
    return {**found, "choices": tuple(about.get("choices", ()))}


def _plain(value: Any) -> Any:
    """Mappings and sequences as JSON has them; sets in order."""
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, set | frozenset):
        return sorted(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(each) for each in value]
    return value
