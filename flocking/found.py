"""Adding one file is all it takes: laws, pipelines, worlds, bodies and experiments are found by their files."""

from __future__ import annotations

import ast
import hashlib
import importlib
import importlib.util
import os
import pkgutil
import re
import sys
import traceback
from collections.abc import Callable, Iterable
from functools import cache, lru_cache
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from flocking import users_files
from flocking.errors import InputError, unknown_name

Returned = TypeVar("Returned")
SUFFIXES = (".py", ".json", ".svg", ".dxf", ".yaml", ".yml", ".csv", ".toml")
"""Of the names that mean files of a user's own: Python, environments and plans, starting poses, grammars."""


def modules(package: str) -> dict[str, str]:
    """Names (with hyphens) of the public modules of a package, and the module each stands for."""
    spec = importlib.util.find_spec(package)
    if spec is None or spec.submodule_search_locations is None:
        return {}
    folders = tuple(spec.submodule_search_locations)
    names = _listed(folders, tuple(os.stat(folder).st_mtime_ns for folder in folders if os.path.isdir(folder)))
    return {name.replace("_", "-"): f"{package}.{name}" for name in names}


@lru_cache(maxsize=1000)
def _listed(folders: tuple[str, ...], changed: tuple[int, ...]) -> tuple[str, ...]:
    """The public modules in folders that last changed at these times, ns."""
    return tuple(m.name for m in pkgutil.iter_modules(list(folders)) if not m.name.startswith("_"))


def folders(package: str, file: str) -> dict[str, str]:
    """Names (with hyphens) of the folders of a package that hold a module `file`, and that module of each."""
    return {name: f"{module}.{file}" for name, module in modules(package).items() if file in modules(module)}


def holding(package: str, names: Iterable[str]) -> dict[str, str]:
    """Names (with hyphens) of the modules of a package that define all of `names`, without running any."""
    wanted = set(names)
    return {name: module for name, module in modules(package).items() if wanted <= _defined(module)}


def defining(package: str, names: Iterable[str]) -> dict[str, str]:
    """Names (with hyphens) of the modules in the folders of a package that define all of `names`, without running any.

    A name that two folders use is the first folder's, by the alphabet.
    """
    wanted, found = set(names), dict[str, str]()
    for folder in sorted(modules(package).values()):
        for name, module in holding(folder, wanted).items():
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


def is_path(name: str) -> bool:
    """Whether a name means a file, or a folder, of the user's own."""
    return name.lower().endswith(SUFFIXES) or os.sep in name


def read(path: str, kind: str, expected: str = "a Python file") -> str:
    """The text of a user's own file; `InputError` if it cannot be read. `kind`: what it is to hold."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{kind} file {path!r} does not exist; expected {expected}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{kind} file {path!r} cannot be read: {' '.join(str(error).split())}") from None


@cache
def from_text(path: str, text: str, kind: str) -> ModuleType:
    """The module of a user's own file, made from its text. Raises `InputError` that tells its fault in one line."""
    module = ModuleType(f"own_{kind}_{hashlib.sha256(text.encode()).hexdigest()[:16]}")
    module.__file__ = path
    sys.modules[module.__name__] = module
    run(path, lambda: exec(compile(text, path, "exec"), vars(module)))
    return module


def run(path: str, call: Callable[[], Returned]) -> Returned:
    """What a call into a user's own file returns. Raises `InputError` that tells its fault in one line."""
    try:
        return call()
    except InputError:
        raise
    except SyntaxError as error:
        raise InputError(f"{error.filename or path}, line {error.lineno}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == path]
        where = f", line {frames[-1].lineno}" if frames else ""
        told = " ".join(str(error).split())
        raise InputError(f"{path}{where}: {type(error).__name__}{': ' if told else ''}{told}") from error


def load(package: str, name: str, kind: str, text: str = "") -> ModuleType:
    """The module of a package that `name` means (`-` and `_` are equal), or that of the user's own file at that path.

    `text`: of the user's file, where it is known already. Raises `InputError` with the nearest names if there is none.
    """
    if is_path(name):
        users_files.check_executed(kind, name)
        return from_text(name, text or read(name, kind), kind)
    known = modules(package)
    wanted = name.replace("_", "-")
    if wanted not in known:
        raise unknown_name(kind, name, known)
    return importlib.import_module(known[wanted])
