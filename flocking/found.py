"""Adding one file is all it takes: laws, pipelines, worlds, bodies and experiments are found by their files."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from types import ModuleType

from flocking.errors import unknown_name


def modules(package: str) -> dict[str, str]:
    """Names (with hyphens) of the public modules of a package, and the module each stands for."""
    spec = importlib.util.find_spec(package)
    if spec is None or spec.submodule_search_locations is None:
        return {}
    found = pkgutil.iter_modules(list(spec.submodule_search_locations))
    return {m.name.replace("_", "-"): f"{package}.{m.name}" for m in found if not m.name.startswith("_")}


def load(package: str, name: str, kind: str) -> ModuleType:
    """The module of a package that `name` means (`-` and `_` are equal).

    Raises `InputError` with the nearest names if there is none.
    """
    known = modules(package)
    wanted = name.replace("_", "-")
    if wanted not in known:
        raise unknown_name(kind, name, known)
    return importlib.import_module(known[wanted])
