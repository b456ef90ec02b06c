"""Adding one file is all it takes: laws, pipelines, worlds, bodies and experiments are found by their files."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import pkgutil
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from types import ModuleType

from flocking.errors import unknown_name


def modules(package: str) -> dict[str, str]:
    """Names (with hyphens) of the public modules of a package, and the module each stands for."""
    spec = importlib.util.find_spec(package)
    if spec is None or spec.submodule_search_locations is None:
        return {}
    found = pkgutil.iter_modules(list(spec.submodule_search_locations))
    return {m.name.replace("_", "-"): f"{package}.{m.name}" for m in found if not m.name.startswith("_")}


def folders(package: str, file: str) -> dict[str, str]:
    """Names (with hyphens) of the folders of a package that hold a module `file`, and that module of each."""
    return {name: f"{module}.{file}" for name, module in modules(package).items() if file in modules(module)}


def defining(package: str, names: Iterable[str]) -> dict[str, str]:
    """Names (with hyphens) of the modules in the folders of a package that define all of `names`, without running any.

    A name that two folders use is the first folder's, by the alphabet.
    """
    wanted, found = set(names), dict[str, str]()
    for folder in sorted(modules(package).values()):
        for name, module in modules(folder).items():
            if wanted <= _defined(module):
                found.setdefault(name, module)
    return found


@cache
def _defined(module: str) -> frozenset[str]:
    """The names that a module's file gives a value, or a function, at its top level."""
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return frozenset()
    found: set[str] = set()
    text = Path(spec.origin).read_text(encoding="utf-8")
    try:
        body = ast.parse(text).body
    except SyntaxError:  # told when the file is loaded; all others can still be used
        return frozenset(re.findall(r"^(?:def )?(\w+)(?: =|\()", text, re.MULTILINE))
    for node in body:
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {target.id for target in targets if isinstance(target, ast.Name)}
        elif isinstance(node, ast.ImportFrom):
            found |= {alias.asname or alias.name for alias in node.names}
    return frozenset(found)


def load(package: str, name: str, kind: str) -> ModuleType:
    """The module of a package that `name` means (`-` and `_` are equal).

    Raises `InputError` with the nearest names if there is none.
    """
    known = modules(package)
    wanted = name.replace("_", "-")
    if wanted not in known:
        raise unknown_name(kind, name, known)
    return importlib.import_module(known[wanted])
