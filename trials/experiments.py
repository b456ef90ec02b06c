"""The files of experiments: found by what they define, or given by their path; checked, and called.

An experiment's file holds

- a docstring whose first line says what it is;
- `REPEATS`: how many times each cell is run by default;
- `CONDITIONS`: the dotted keys that it varies and their values: a full factorial design;
- `base(repeat) -> Trial`: the trial of that repeat before the conditions are put in;
- optionally `cells(conditions) -> list[dict]`: the keys and values of each cell, where the design is not a full
  factorial of the conditions (its own, or those that the user put in their place);
- optionally `finish(trial) -> Trial`: the trial completed once the conditions and the user's settings are put in;
- optionally `SOURCES`: by key, where its value comes from, where that is not what the parameter declares;
- optionally `RECORD`: which trials are recorded without `--record` (`all` by default);
- optionally `KEY_MEASURES`: the measures that a first look at the report needs;
- optionally `claims(run)` and `figures(run, folder)`: the claims and figures of `herd report`.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from flocking import found
from flocking.errors import InputError, unknown_name
from flocking.found import is_path
from flocking.parameters import Parameter
from trials.types import Trial

STUDIES = "trials.studies"
DEFINING = ("CONDITIONS", "base")
RECORD = ("all", "first", "none")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9-]*")
_own: dict[str, ModuleType] = {}
"""By name, the experiments of the user's own that this process was given the paths of."""


def experiment_names() -> list[str]:
    """Names of all experiments that come with the project."""
    return sorted(experiments())


def experiments() -> dict[str, str]:
    """Names of all experiments, and the module of each: files in the folders of studies, by what they define."""
    return found.defining(STUDIES, DEFINING)


def name_of(name: str) -> str:
    """The name of an experiment, with hyphens: of a path, that of its file."""
    return (Path(name).stem if is_path(name) else name).replace("_", "-")


def load(name: str) -> ModuleType:
    """The module of an experiment, by its name or by the path of its file.

    Raises `InputError` with the nearest names if there is none, and for a file that is no experiment.
    """
    if is_path(name):
        return _from_file(name)
    wanted = name_of(name)
    if wanted in _own:
        return _own[wanted]
    known = experiments()
    if wanted not in known:
        raise unknown_name("experiment", name, known)
    spec = importlib.util.find_spec(known[wanted])
    path = spec.origin if spec is not None and spec.origin is not None else known[wanted]
    module = found.run(path, lambda: importlib.import_module(known[wanted]))
    check(module, path)
    return module


def known(name: str) -> bool:
    """Whether there is an experiment of that name, ours or one that this process was given the path of."""
    return name_of(name) in _own or name_of(name) in experiments()


def run_in(module: ModuleType, function: str, *arguments: Any) -> Any:
    """What a function of an experiment's file returns. Raises `InputError` that tells a fault in one line."""
    return found.run(str(getattr(module, "__file__", "")), lambda: getattr(module, function)(*arguments))


def title(module: ModuleType) -> str:
    """First line of an experiment's docstring."""
    return (module.__doc__ or "").strip().splitlines()[0]


def made_by(module: ModuleType, function: str, *arguments: Any) -> Any:
    """What one of the functions that an experiment's file must or may have returns, checked.

    `function`: base, cells or finish. Raises `InputError`.
    """
    path = str(getattr(module, "__file__", ""))
    made = run_in(module, function, *arguments)
    if function == "cells":
        sound = isinstance(made, Sequence) and all(isinstance(cell, Mapping) for cell in made) and len(made) > 0
        expected = "at least one mapping of keys to values, in a list"
    else:
        sound, expected = isinstance(made, Trial), "a Trial"
    if not sound:
        given = f"{arguments[0]}" if function == "base" else ""
        raise InputError(f"{path}: {function}({given}) returned {_short(made)}; expected {expected}")
    return made


def check(module: ModuleType, path: str) -> None:
    """Refuses what an experiment's file declares and cannot be: `InputError`."""

    def expect(sound: bool, what: str, expected: str) -> None:
        if not sound:
            told = f"{what} = {_short(getattr(module, what))}" if hasattr(module, what) else f"it has no {what}"
            raise InputError(f"{path}: {told}; expected {expected}")

    if not (module.__doc__ or "").strip():
        raise InputError(f"{path}: it has no docstring; expected one whose first line says what the experiment is")
    repeats, conditions = getattr(module, "REPEATS", None), getattr(module, "CONDITIONS", None)
    whole = isinstance(repeats, int) and not isinstance(repeats, bool) and repeats >= 1
    expect(whole, "REPEATS", "a whole number of at least 1")
    expect(
        isinstance(conditions, Mapping)
        and all(isinstance(key, str) and _is_list(values) and len(values) > 0 for key, values in conditions.items()),
        "CONDITIONS",
        'a mapping of keys to lists of values, as in {"herd.count": (10, 20)}',
    )
    expect(callable(getattr(module, "base", None)), "base", "a function base(repeat) that returns a Trial")
    sources = getattr(module, "SOURCES", {})
    sound = isinstance(sources, Mapping) and all(isinstance(about, Parameter) for about in sources.values())
    expect(sound, "SOURCES", "a mapping of keys to Parameter(unit, source)")
    expect(getattr(module, "RECORD", "all") in RECORD, "RECORD", " or ".join(RECORD))
    measures = getattr(module, "KEY_MEASURES", ())
    expect(_is_list(measures) and all(isinstance(each, str) for each in measures), "KEY_MEASURES", "names of measures")
    for function in ("cells", "finish", "claims", "figures"):
        expect(callable(getattr(module, function, check)), function, "a function")


def _from_file(path: str) -> ModuleType:
    """The experiment of a user's own file, run once in a process; its folder is looked in for what it imports."""
    name, file = name_of(path), Path(path)
    known = _own.get(name)
    if known is not None and Path(str(known.__file__)) == file.resolve():
        return known
    if file.exists() and not file.is_file():
        raise InputError(f"experiment file {path!r} is no file; expected a Python file, or a name of herd list")
    if not file.is_file():
        raise InputError(f"experiment file {path!r} does not exist; expected a Python file, or a name of herd list")
    if not _NAME.fullmatch(name) or known is not None or name in experiments():
        taken = "is that of another experiment" if _NAME.fullmatch(name) else "is no name"
        raise InputError(f"{path}: {name!r} {taken}: expected a file whose name, in letters, digits and _, is its own")
    file = file.resolve()
    module_name = f"own_experiment_{name.replace('-', '_')}"
    spec = importlib.util.spec_from_file_location(module_name, file)
    if spec is None or spec.loader is None:
        raise InputError(f"experiment file {path!r}: expected a Python file whose name ends in .py")
    module, loader = importlib.util.module_from_spec(spec), spec.loader
    sys.modules[module_name] = module
    if str(file.parent) not in sys.path:
        sys.path.append(str(file.parent))  # last: no package of ours, nor an installed one, is hidden by a file there
    found.run(str(file), lambda: loader.exec_module(module))
    check(module, path)
    _own[name] = module
    return module


def _is_list(values: object) -> bool:
    return isinstance(values, Sequence) and not isinstance(values, str)


def _short(value: object) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else f"{text[:77]}..."
