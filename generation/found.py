"""Schemas by the names of their files in `generation/schemas/`, or by the path of a user's own file.

A file is a Python module (`generation.schema` says what it has) or a shape grammar in TOML (`generation.grammar`).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from flocking import found
from flocking.errors import InputError, unknown_name
from flocking.parameters import declared
from generation import sources
from generation.environment import Environment
from generation.grammar import files
from generation.grammar.schema import schema_of
from generation.schema import Schema

PACKAGE = "generation.schemas"
FOLDER = Path(__file__).with_name("schemas")
NEEDED = ("Parameters", "workspace", "generate", "FILTER", "BEHAVIOUR")
"""What a schema's Python file defines besides its docstring."""


def schemas() -> list[str]:
    """The names of all schemas that come with the product, with hyphens."""
    return sorted({*found.modules(PACKAGE), *_grammars()})


def load(name: str, text: str = "") -> Schema:
    """The schema of this name (`-` and `_` are equal), or that of the user's own file (.py or .toml) at this path.

    `text`: of the user's file, where it is known already. Raises `InputError` with the nearest names where there is
    none, and with its fault where the file is no schema.
    """
    if is_path(name):
        if Path(name).suffix.lower() in sources.SUFFIXES:
            raise InputError(
                f"schema {name!r}: expected a schema's name or file, since environments are made here; one that is "
                "made already is tried by herd validate, or by --world of an experiment of robots or of a herd"
            )
        if not name.endswith(".toml"):
            return _of_module(name, found.load(PACKAGE, name, "schema", text))
        return _of_grammar(name, text)
    wanted, grammars = name.replace("_", "-"), _grammars()
    if wanted in grammars:
        return _of_grammar(str(grammars[wanted]))
    if wanted not in found.modules(PACKAGE):
        raise unknown_name("schema", name, schemas())
    return _of_module(wanted, found.load(PACKAGE, wanted, "schema"))


def is_path(name: str) -> bool:
    """Whether a schema's name means a user's own file."""
    return name.endswith((".py", ".toml")) or os.sep in name


def _grammars() -> dict[str, Path]:
    """The grammar files that come with the product, by name."""
    return {path.stem.replace("_", "-"): path for path in FOLDER.glob("*.toml")}


def _of_grammar(path: str, text: str = "") -> Schema:
    grammar = files.from_text(text, path) if text else files.read(path)
    if not grammar.workspace:
        return schema_of(grammar, Environment)
    if grammar.workspace in _grammars() or grammar.workspace not in found.modules(PACKAGE):
        raise unknown_name(f"workspace of {path}: schema", grammar.workspace, found.modules(PACKAGE))
    return schema_of(grammar, lambda: load(grammar.workspace).workspace())


def _of_module(name: str, module: ModuleType) -> Schema:
    lacking = [needed for needed in NEEDED if not hasattr(module, needed)]
    if lacking:
        raise InputError(f"schema {name!r} lacks {', '.join(lacking)}; expected {', '.join(NEEDED)} and a docstring")
    about = (module.__doc__ or "").strip().partition("\n")[0]
    if not about:
        raise InputError(f"schema {name!r} lacks a docstring; expected one whose first line says what it generates")
    for function in ("workspace", "generate"):
        if not callable(getattr(module, function)):
            raise InputError(f"schema {name!r}: {function} is {getattr(module, function)!r}; expected a function")
    for text in ("FILTER", "BEHAVIOUR"):
        if not isinstance(getattr(module, text), str):
            raise InputError(f"schema {name!r}: {text} is {getattr(module, text)!r}; expected a name")
    declared(module.Parameters)

    def told(function: Callable[..., Any]) -> Callable[..., Any]:
        """A user's function whose faults are told in one line."""

        def call(*arguments: Any) -> Any:
            return found.run(name, lambda: function(*arguments))

        return call if is_path(name) else function

    return Schema(
        name if not is_path(name) else Path(name).stem.replace("_", "-"),
        about,
        module.Parameters,
        told(module.workspace),
        told(module.generate),
        module.FILTER,
        module.BEHAVIOUR,
        getattr(module, "parts", None),
    )
