"""The worlds that there are, and those of a user's own: what each can be given, and the environment that it is.

A world is a Python file, of this package or of the user's own, with

- a docstring whose first sentence says what it is;
- `Parameters`, a `NamedTuple` of declared parameters;
- `environment(parameters) -> Environment`;
- optionally `free_length(parameters, radius_m) -> float`: how far from the origin a robot may get along x (m), where a
  trial that could reach an end is to be refused;

or the file of an environment (docs/environments.md), which has the parameters of `OfFile`. No simulator is needed here.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from types import ModuleType
from typing import Annotated, Any, NamedTuple

from flocking import found
from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, declared, filled
from generation import files, sources
from generation.checking import checked
from generation.environment import Environment

PACKAGE = "worlds"
OPEN = math.nan
"""A value that is left to the file."""


class OfFile(NamedTuple):
    """An environment of your own, as FILE.json (docs/environments.md)."""

    scale: Annotated[
        float, Parameter("", "a choice: by which the file's lengths are multiplied", low=1e-3, high=1e3, plausible=())
    ] = 1.0
    reflectance: Annotated[
        float, Parameter("", "the file's own: diffuse albedo of all walls", low=0.01, high=1.0, plausible=())
    ] = OPEN
    construct: Annotated[
        bool, Parameter("", "whether its construct stands there; false = the empty-world control", plausible=())
    ] = True


class Known(NamedTuple):
    """A world whose parameters are still to be set."""

    parameters: type
    environment: Callable[[Any], Environment]
    """(its parameters) → what stands in it."""
    free_length: Callable[[Any, float], float]
    """(its parameters, radius of the widest robot, m) → how far from the origin a robot may get along x, m."""

    def values(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Every declared parameter with the value given, or its default."""
        values = {name: given.get(name, parameter.default) for name, parameter in declared(self.parameters).items()}
        if self.parameters is OfFile and math.isnan(values["reflectance"]):
            values["reflectance"] = self.environment(OfFile()).reflectance
        return values


def names() -> list[str]:
    """The worlds of this package."""
    return sorted(found.holding(PACKAGE, ["environment"]))


def is_file(world: str) -> bool:
    """Whether a world's name is the path of a file of the user's own."""
    return found.is_path(world)


def text_of(path: str) -> str:
    """The text of a user's own world that travels with a trial: Python, an environment's JSON, or a grammar's TOML.

    Raises `InputError`.
    """
    if _is_grammar(path):
        return found.read(path, "grammar", "a TOML file")
    return sources.environment_text(path) if _is_environment(path) else found.read(path, "world")


def told(path: str) -> list[str]:
    """What a user should know of such a file, one line each. Raises `InputError`."""
    return sources.told(path) if _is_environment(path) and not _is_grammar(path) else []


def load(world: str, text: str = "") -> Known:
    """The world of that name, or of the user's own file at that path, whose text is read there if it is not given.

    Raises `InputError`.
    """
    if _is_grammar(world):
        raise InputError(
            f"world {world!r} is a grammar, of which a herd needs one environment; expected its file, as "
            "`herd generate` makes them"
        )
    if is_file(world) and _is_environment(world):
        return Known(OfFile, partial(_of_file, world, text or text_of(world)), _endless)
    module = found.load(PACKAGE, world, "world", text)
    path = str(module.__file__)
    _check_module(module, world)
    free_length = getattr(module, "free_length", _endless)
    return Known(
        module.Parameters,
        partial(_of_module, module, world if is_file(world) else ""),
        lambda values, radius_m: float(found.run(path, lambda: free_length(values, radius_m))),
    )


def environment_of(world: str, text: str, given: Mapping[str, Any]) -> Environment:
    """What stands in a world with these values of its parameters. Raises `InputError`."""
    known = load(world, text)
    return known.environment(filled(known.parameters, given, prefix="world."))


def _check_module(module: ModuleType, world: str) -> None:
    if callable(getattr(module, "environment", None)) and hasattr(module, "Parameters"):
        return
    if not is_file(world):
        raise unknown_name("world", world, names())
    if callable(getattr(module, "walls", None)):
        raise InputError(
            f"world file {world!r} has walls(parameters), as worlds of version 0.2 had; expected "
            'environment(parameters) that returns Environment((Polygon(corners, "inside"),)), see worlds/corridor.py'
        )
    lacks = "Parameters" if not hasattr(module, "Parameters") else "environment"
    raise InputError(
        f"world file {world!r} lacks {lacks}; expected Parameters and environment(parameters), see worlds/corridor.py"
    )


def _is_environment(path: str) -> bool:
    return not path.endswith(".py")


def _is_grammar(path: str) -> bool:
    return path.lower().endswith(".toml")


def _endless(_values: Any, _radius_m: float) -> float:
    return math.inf


def _of_module(module: ModuleType, own: str, values: Any) -> Environment:
    made = found.run(str(module.__file__), lambda: module.environment(values))
    if not isinstance(made, Environment):
        raise InputError(
            f"{module.__file__}: environment(...) returned {type(made).__name__}; expected "
            "generation.environment.Environment"
        )
    return checked(made, own)[0] if own else made


@lru_cache(maxsize=64)
def _of_file(path: str, text: str, values: OfFile) -> Environment:
    environment = _parsed(path, text)
    if values.scale != 1.0:
        environment = environment.moved(scale=values.scale)
    if not values.construct:
        environment = dataclasses.replace(environment, construct=())
    if not math.isnan(values.reflectance):
        environment = dataclasses.replace(environment, reflectance=values.reflectance)
    return environment


@lru_cache(maxsize=8)
def _parsed(path: str, text: str) -> Environment:
    return files.from_json(text, path)
