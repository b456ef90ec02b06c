"""A law's file made callable: checked, compiled with one fixed signature, cached between runs.

Every law is compiled behind the same signature of plain arrays (`ENTRY_SIGNATURE`), so that a trial's loop and a
kinematic herd's kernel can both be handed any of them.
"""

from __future__ import annotations

import hashlib
import importlib.util
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from flocking import found, lawsource
from flocking.errors import InputError, StorageError
from flocking.found import is_path
from flocking.freshness import constants, foreign
from flocking.lawdata import from_data
from flocking.parameters import Relation, declared, filled, relation
from flocking.selection import parse_sets
from flocking.taxonomy import USUAL_HERD, Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

ENTRY_SIGNATURE = (
    "void(f8[::1], f8[:, ::1], f8[::1], f8[::1], f8[:, ::1], i8[::1], b1[:, ::1], f8[:, ::1], f8[::1], f8[::1], "
    "f8[::1], f8[::1])"
)
"""own (11,), positions (M, 2), bearings (M,), headings (M,), velocities (M, 2), ids (M,), sets (S, M), obstacles
(K, 2), parameters (P,), memory (MEMORY,), u (DRAWS,), motion out (4,): kind, x, y, rule."""

OWN_SIZE = 11
"""velocity x, y; turn rate; compass; goal x, y; left, right bumper; dt; id; role."""

OF_MEMBERS = frozenset({"positions", "bearings", "headings", "velocities", "ids"})
"""What a law may read of each member."""
INFORMATION = OF_MEMBERS | {"compass", "goal", "contacts", "obstacles"}
"""What a law may say that it needs."""
MOST_NUMBERS = 10_000
"""That a law may remember or draw."""
MOTIONS_WITHOUT_NUMBERS = frozenset({int(Kind.HOLD), int(Kind.STOP)})

_TEMPLATE = '''"""Generated from a law's file."""
import importlib.util
import sys

import numba
from flocking.compiled_cache import compiled_now, kept_between_runs
from flocking.types import Members, Obstacles, Own

_spec = importlib.util.spec_from_file_location({module!r}, {path!r})
_module = sys.modules.get({module!r})
if _module is None:
    _module = importlib.util.module_from_spec(_spec)
    sys.modules[{module!r}] = _module
    _spec.loader.exec_module(_module)
law = numba.njit(_module.law, boundscheck={boundscheck}, _nrt={allocates}, forceinline=True)
Parameters = _module.Parameters


@numba.njit(boundscheck={boundscheck}, _nrt={allocates})
def entry(own, positions, bearings, headings, velocities, ids, sets, obstacles, parameters, memory, u, motion):
    decided = law(
        Own(own[0:2], own[2], own[3], own[4:6], (own[6] > 0.5, own[7] > 0.5), own[8], int(own[9]), int(own[10])),
        Members(positions, bearings, headings, velocities, ids),
        sets,
        Obstacles(obstacles),
        Parameters({values}),
        memory,
        u,
    )
    motion[0] = int(decided.kind + 0)
    motion[1] = decided.x
    motion[2] = decided.y
    motion[3] = decided.rule


if {cached}:
    kept_between_runs(entry)
compiled_now(entry, {signature!r})
'''


@dataclass(frozen=True)
class Law:
    """A law ready to be called."""

    name: str
    module: ModuleType
    rules: tuple[str, ...]
    sets: dict[str, str]
    """Name of each set of neighbours → the selection that makes it."""
    memory: int
    draws: int
    needs: frozenset[str]
    """Of `INFORMATION`; what its sets' selections need is not among it."""
    entry: Callable[..., None]
    """Compiled, with `ENTRY_SIGNATURE`."""

    @property
    def taxonomy(self) -> Taxonomy | None:
        """Its row of table 3.2; a user's own law need not have one."""
        return getattr(self.module, "TAXONOMY", None)

    @property
    def validation(self) -> Validation | None:
        """Its row of table 3.4."""
        return getattr(self.module, "VALIDATION", None)

    @property
    def filled(self) -> tuple[Filled, ...]:
        """What its authors left undefined and how it is filled."""
        return tuple(getattr(self.module, "FILLED", ()))

    @property
    def herd(self) -> Herd:
        """A kinematic herd in which its numbers make sense."""
        herd: Herd = getattr(self.module, "HERD", USUAL_HERD)
        return herd

    @property
    def create(self) -> dict[str, Any]:
        """Parameter values for iRobot Creates, where they differ from the defaults."""
        return dict(getattr(self.module, "CREATE", {}))

    @property
    def chiral(self) -> bool:
        """Whether mirroring the world does not mirror its motion."""
        return bool(getattr(self.module, "CHIRAL", False))

    @property
    def axis(self) -> bool:
        """Whether it moves along the world's x axis only."""
        return bool(getattr(self.module, "AXIS", False))

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """In the order of the entry's `parameters`."""
        return tuple(declared(self.module.Parameters))

    @property
    def function(self) -> Callable[..., Motion]:
        """The law as written, not compiled."""
        return self.module.law

    def parameters(self, given: Mapping[str, Any]) -> Any:
        """The law's `Parameters` with the given values, checked."""
        return parameters_of(self.name, self.module, given)

    def decide(
        self,
        own: Own,
        members: Members,
        sets: Bools,
        obstacles: Obstacles,
        parameters: Any,
        memory: Floats,
        u: Floats,
    ) -> Motion:
        """One compiled call, for tests and notebooks: the loop calls `entry` itself.

        The caller compares with `function`, which takes the same arguments.
        """
        out = np.empty(4)
        self.entry(
            packed_own(own),
            *members,
            sets,
            obstacles.points,
            np.array(parameters, dtype=np.float64),
            memory,
            u,
            out,
        )
        return Motion(int(out[0]), float(out[1]), float(out[2]), int(out[3]))


def packed_own(own: Own) -> Floats:
    """`Own` as the (11,) array of the entry's signature."""
    velocity, turn_rate, compass, goal, contacts, *rest = own
    return np.array([*velocity, turn_rate, compass, *goal, *contacts, *rest], dtype=np.float64)


_known: dict[str, ModuleType] = {}
"""By its text: what a user's law declares, without its function."""


def learn(name: str, source: str, data: object) -> None:
    """Takes what the user's law of that text declares from data (`lawdata.as_data`). Raises `InputError`."""
    _known[source] = from_data(name, data)


def module_of(name: str, source: str = "") -> ModuleType:
    """A law's module, imported but not compiled: its parameters and what it declares. `InputError` as in `load`.

    Of a user's law that this process has been told of, only what it declares.
    """
    if not is_path(name):
        return _named(name)
    source = source or lawsource.read_source(name)
    return _known[source] if source in _known else lawsource.executed(name, source)[0]


@cache
def _named(name: str) -> ModuleType:
    """The module of a law of that name; a plan of thousands of trials asks for it many times."""
    return found.load("flocking.laws", name, "law")


def sets_of(module: ModuleType) -> dict[str, str]:
    """The sets that a law's module declares, and the selections that make them; names alone mean all members."""
    sets = getattr(module, "SETS", ("neighbours",))
    return dict(sets) if isinstance(sets, Mapping) else dict.fromkeys(sets, "all")


def needs_of(module: ModuleType) -> frozenset[str]:
    """What a law's module says that it needs: positions, where it does not say."""
    return frozenset(getattr(module, "NEEDS", {"positions"}))


def may_lack_of(module: ModuleType) -> frozenset[str]:
    """What a law's module says that a member may lack: it is then told of one with nan, and else not of that one."""
    return frozenset(getattr(module, "MAY_LACK", ()))


def relations_of(module: ModuleType) -> tuple[Relation, ...]:
    """What a law's module says must hold between its parameters. Raises `InputError`."""
    words = getattr(module, "RELATIONS", ())
    if not isinstance(words, tuple | list):
        raise InputError(f"RELATIONS = {words!r}: expected a tuple of words, as in ('core_m below range_m',)")
    return tuple(relation(each, module.Parameters) for each in words)


def parameters_of(name: str, module: ModuleType, given: Mapping[str, Any], prefix: str = "law.") -> Any:
    """A law's `Parameters` with the given values.

    Raises `InputError` for a value out of its bounds, and for values that the law's relations rule out together.
    """
    values = filled(module.Parameters, given, prefix)
    for each in relations_of(module):
        if not each.holds(values):
            told = " and ".join(f"{prefix}{parameter} = {getattr(values, parameter)!r}" for parameter in each.names)
            raise InputError(f"law {name!r}: {told}: expected {each.words}")
    return values


def room_of(name: str, module: ModuleType) -> tuple[int, int]:
    """How many numbers a law's module remembers, and how many it draws. Raises `InputError`."""
    found = []
    for constant in ("MEMORY", "DRAWS"):
        value = getattr(module, constant, 0)
        if not isinstance(value, int) or not 0 <= value <= MOST_NUMBERS:
            raise InputError(f"law file {name!r}: {constant} = {value!r}: expected a whole number, 0 to {MOST_NUMBERS}")
        found.append(int(value))
    memory, draws = found
    return memory, draws


def load(name: str, source: str = "") -> Law:
    """The law of that name, or the user's own whose path is `name` and whose text is `source`.

    Raises `InputError` naming the file and what is wrong with it.
    """
    if is_path(name):
        return _load_source(name, source or lawsource.read_source(name))
    return _load_named(name.replace("_", "-"))


@cache
def _load_named(name: str) -> Law:
    module = _named(name)
    return _compile(name, module, boundscheck=False)


@cache
def _load_source(name: str, source: str) -> Law:
    return _compile(name, lawsource.executed(name, source)[0], boundscheck=True)


def _compile(name: str, module: ModuleType, *, boundscheck: bool) -> Law:
    fields = declared(module.Parameters)
    for field in fields.values():
        if field.type is str:
            raise InputError(f"law file {name!r}: parameter {field.name!r} is text; a law's parameters are numbers")
    memory, draws = room_of(name, module)
    needs = needs_of(module)
    if not needs <= INFORMATION:
        raise InputError(f"law file {name!r}: NEEDS {sorted(needs - INFORMATION)}; expected of {sorted(INFORMATION)}")
    if not may_lack_of(module) <= needs:
        lacks = sorted(may_lack_of(module) - needs)
        raise InputError(f"law file {name!r}: MAY_LACK {lacks}; expected of its NEEDS, {sorted(needs)}")
    sets = sets_of(module)
    try:
        parse_sets("all", sets, fields)
    except InputError as error:
        raise InputError(f"law file {name!r}: SETS: {error}") from None
    values = ", ".join(f"{field.type.__name__}(parameters[{i}])" for i, field in enumerate(fields.values()))
    try:
        entry = _entry(module, values, boundscheck, allocates=False)
    except StorageError:
        raise
    except Exception:  # perhaps because it makes arrays: references must then be counted
        try:
            entry = _entry(module, values, boundscheck, allocates=True)
        except StorageError:
            raise
        except Exception as error:
            raise InputError(f"law {name!r} does not compile: {lawsource.first_line(error)}") from None
    return Law(
        name=name,
        module=module,
        rules=tuple(getattr(module, "RULES", ("law",))),
        sets=sets,
        memory=memory,
        draws=draws,
        needs=needs,
        entry=entry,
    )


def _entry(module: ModuleType, values: str, boundscheck: bool, allocates: bool) -> Callable[..., None]:
    """The law behind the entry's signature, compiled or taken from the cache."""
    made = generated(
        module,
        "entry",
        _TEMPLATE,
        signature=ENTRY_SIGNATURE,
        values=values,
        boundscheck=boundscheck,
        allocates=allocates,
    )
    entry: Callable[..., None] = made.entry
    return entry


def generated(module: ModuleType, what: str, template: str, **filled_in: Any) -> ModuleType:
    """A module generated from a law's own by a template, with what it compiles kept between runs where that is safe.

    `what`: its file's name begins with that.
    """
    path = Path(str(module.__file__))
    source = path.read_text(encoding="utf-8")
    text = template.format(module=module.__name__, path=str(path), cached=not foreign(source), **filled_in)
    digest = hashlib.sha256((text + source + constants(module)).encode()).hexdigest()[:16]
    made_path = lawsource.written(f"{what}_{path.stem}_{digest}", text)
    spec = importlib.util.spec_from_file_location(made_path.stem, made_path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    sys.modules[made_path.stem] = made
    spec.loader.exec_module(made)
    return made
