"""Constants that no key sets, such as those of the machines and of the controller, read with their remarks.

Each is defined once, in the module to which it belongs, as `NAME = value  # remark` or with a docstring below it. The
grades in remarks: P a primary document, C published code, S a secondary page, D derived, ? a choice.
"""

from __future__ import annotations

import ast
import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple


class Constant(NamedTuple):
    """One number of a module."""

    name: str
    value: float
    remark: str


def constants(modules: Sequence[str]) -> list[Constant]:
    """Public numeric constants of the modules, in the order of their files."""
    return [constant for name in modules for constant in _of(name)]


def _of(name: str) -> list[Constant]:
    module = importlib.import_module(name)
    text = Path(str(module.__file__)).read_text(encoding="utf-8")
    lines, body = text.splitlines(), ast.parse(text).body
    found = []
    for node, following in zip(body, [*body[1:], None], strict=True):
        if not isinstance(node, ast.Assign) or not isinstance(node.targets[0], ast.Name):
            continue
        constant = node.targets[0].id
        value: Any = getattr(module, constant, None)
        if not constant.isupper() or constant.startswith("_") or isinstance(value, bool):
            continue
        if not isinstance(value, int | float):
            continue
        _, _, comment = lines[node.lineno - 1].partition("  # ")
        if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
            comment = " ".join(str(following.value.value).split())
        found.append(Constant(f"{name}.{constant}", float(value), comment))
    return found
