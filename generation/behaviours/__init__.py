"""Behaviours: what a herd is to do, as functions of its trajectories and the environment (Fine 2015, definition 3).

A behaviour is one file of this folder, found by its file and named by it, or a user's own file anywhere. It has

- a docstring whose first line says what it is;
- `Parameters`, a `NamedTuple` of declared parameters (`flocking.parameters`);
- `ITERATIONS`, a whole number: the steps of the simulation in which it has to show itself;
- `fitness(positions, environment, parameters) -> float`: from 0 to 1, complete compliance, of positions (T, N, 2) in m,
  the start first;
- `SUCCESS`, a number: from this fitness on, the behaviour was shown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flocking import found
from flocking.errors import InputError
from flocking.parameters import declared, filled
from flocking.types import Floats
from generation.environment import Environment


@dataclass(frozen=True)
class Behaviour:
    """A behaviour, whatever its file."""

    name: str
    """As it was asked for: a name with hyphens, or a path."""
    about: str
    """First line of its description."""
    parameters: type
    """Its `Parameters`."""
    iterations: int
    success: float
    fitness: Callable[[Floats, Environment, Any], Any]
    """As its file has it; `judged` holds what it returns against its promise."""

    def filled(self, given: Mapping[str, Any] | None = None) -> Any:
        """Its parameters, with given values checked. Raises `InputError`."""
        return filled(self.parameters, given or {}, f"{self.name}.")

    def judged(self, positions: Floats, environment: Environment, parameters: Any = None) -> float:
        """The fitness of members at positions (T, N, 2), 0 to 1.

        Raises `InputError` for positions that are not finite, for a marker that is missing, and where a user's file
        fails or returns something else than a number from 0 to 1.
        """
        positions = np.ascontiguousarray(positions, dtype=np.float64)
        if positions.ndim != 3 or positions.shape[2] != 2 or 0 in positions.shape:
            raise InputError(f"positions of shape {positions.shape}: expected (times, members, 2), none of them 0")
        if not np.isfinite(positions).all():
            raise InputError(f"behaviour {self.name}: positions are not finite")
        parameters = self.parameters() if parameters is None else parameters
        value = (
            found.run(self.name, lambda: self.fitness(positions, environment, parameters))
            if found.is_path(self.name)
            else self.fitness(positions, environment, parameters)
        )
        number = isinstance(value, bool | int | float | np.bool_ | np.integer | np.floating)
        if not number or not 0.0 <= value <= 1.0:
            raise InputError(f"behaviour {self.name} returned the fitness {value!r}; expected a number from 0 to 1")
        return float(value)

    def succeeds(self, fitness: float) -> bool:
        """Whether a herd of this fitness showed the behaviour: binary fitness and rounding of shares are forgiven."""
        return fitness >= self.success - 1e-9


def names() -> list[str]:
    """Names of the behaviours of this folder, with hyphens."""
    return sorted(found.modules(__name__))


def load(name: str) -> Behaviour:
    """The behaviour of that name (`-` and `_` are equal), or that of the user's own file at that path.

    Raises `InputError` with the nearest names, or with what a file lacks.
    """
    module = found.load(__name__, name, "behaviour")
    shown = name if found.is_path(name) else name.replace("_", "-")
    lacking = [part for part in ("Parameters", "ITERATIONS", "SUCCESS", "fitness") if not hasattr(module, part)]
    if lacking:
        raise InputError(f"behaviour {shown} lacks {', '.join(lacking)}")
    declared(module.Parameters)
    iterations, success = module.ITERATIONS, module.SUCCESS
    if isinstance(iterations, bool) or not isinstance(iterations, int) or iterations < 1:
        raise InputError(f"behaviour {shown}: ITERATIONS = {iterations!r}; expected a whole number of at least 1")
    if isinstance(success, bool) or not isinstance(success, int | float) or not 0.0 < success <= 1.0:
        raise InputError(f"behaviour {shown}: SUCCESS = {success!r}; expected a number above 0 and at most 1")
    if not callable(module.fitness):
        raise InputError(f"behaviour {shown}: fitness is no function")
    about = (module.__doc__ or "").strip().partition("\n")[0]
    return Behaviour(shown, about, module.Parameters, iterations, float(success), module.fitness)
