"""What a law's compiled code rests on beside the law's own text: what its file imports, and the numbers it holds."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import ModuleType

import numpy as np

from flocking.compilation import PACKAGES


def foreign(source: str, seen: frozenset[str] = frozenset()) -> bool:
    """Whether a law's text imports a file that may change unseen: the law is then compiled anew in each process.

    Files of ours change the name of the cache's folder, but those of laws may themselves import what is not ours.
    """
    for name in _imports(source) - seen:
        top, *parts = name.split(".")
        if top not in {*PACKAGES, "numpy", "numba", *sys.stdlib_module_names}:
            return True
        if name.startswith("flocking.laws."):
            law = Path(__file__).parent / "laws" / f"{parts[1]}.py"
            if not law.exists() or foreign(law.read_text(encoding="utf-8"), seen | {name}):
                return True
    return False


def _imports(source: str) -> set[str]:
    """Dotted names of what a text imports, at its top or anywhere else."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" if not node.level else "." for alias in node.names}
    return found


def constants(module: ModuleType) -> str:
    """The numbers that a law's module holds, as text: they are compiled in, and may come from a file of data."""
    held = {name: value for name, value in vars(module).items() if not name.startswith("__")}
    plain = {name: value for name, value in held.items() if isinstance(value, (int, float, complex, np.generic))}
    arrays = {name: (v.shape, str(v.dtype), v.tobytes()) for name, v in held.items() if isinstance(v, np.ndarray)}
    return f"{plain!r} {arrays!r}"
