"""Filters: which generated environments are feasible (C_f of Fine 2015, definition 2).

A filter is one file of this folder, found by its file and named by it, or a user's own file anywhere. It has

- a docstring whose first line says what it lets pass;
- `Parameters`, a `NamedTuple` of declared parameters (`flocking.parameters`);
- `passes(environment, parameters) -> bool`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flocking import found
from flocking.errors import InputError
from flocking.parameters import declared, filled
from generation.environment import Environment


@dataclass(frozen=True)
class Filter:
    """A filter, whatever its file."""

    name: str
    """As it was asked for: a name with hyphens, or a path."""
    about: str
    """First line of its description."""
    parameters: type
    """Its `Parameters`."""
    passes: Callable[[Environment, Any], Any]
    """As its file has it; `accepts` holds what it returns against its promise."""

    def filled(self, given: Mapping[str, Any] | None = None) -> Any:
        """Its parameters, with given values checked. Raises `InputError`."""
        return filled(self.parameters, given or {}, f"{self.name}.")

    def accepts(self, environment: Environment, parameters: Any = None) -> bool:
        """Whether an environment passes.

        Raises `InputError` for a marker that is missing, and where a user's file fails or returns no truth value.
        """
        values = self.parameters() if parameters is None else parameters
        if not found.is_path(self.name):
            return bool(self.passes(environment, values))
        value = found.run(self.name, lambda: self.passes(environment, values))
        if not isinstance(value, bool | np.bool_):
            raise InputError(f"filter {self.name} returned {value!r}; expected True or False")
        return bool(value)


def names() -> list[str]:
    """Names of the filters of this folder, with hyphens."""
    return sorted(found.modules(__name__))


def load(name: str) -> Filter:
    """The filter of that name (`-` and `_` are equal), or that of the user's own file at that path.

    Raises `InputError` with the nearest names, or with what a file lacks.
    """
    module = found.load(__name__, name, "filter")
    shown = name if found.is_path(name) else name.replace("_", "-")
    lacking = [part for part in ("Parameters", "passes") if not callable(getattr(module, part, None))]
    if lacking:
        raise InputError(f"filter {shown} lacks {', '.join(lacking)}")
    declared(module.Parameters)
    return Filter(shown, (module.__doc__ or "").strip().partition("\n")[0], module.Parameters, module.passes)
