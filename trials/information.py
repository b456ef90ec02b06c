"""Whether a law, with the sets that it selects, can have what it needs on robots: from the pipeline, by association, or
from what a robot knows of itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import ModuleType
from typing import Any, NamedTuple

from flocking import found, lawentry, selection
from flocking.errors import InputError
from flocking.parameters import declared, filled
from flocking.perception import Step
from trials.types import Group

PIPELINES = "sensing.pipelines"
INFERRED = frozenset({"velocities", "headings"})
"""What association makes of positions."""
OF_ITSELF = frozenset({"compass", "goal", "contacts"})


class Wanted(NamedTuple):
    """What a group's law needs, and what its robots must do to have it."""

    needs: frozenset[str]
    """Of the members, the law's and its selections'."""
    associate: bool
    """Whether velocities or headings are to be inferred."""
    own_pose: bool
    """Whether a robot must follow its own pose."""


def given(pipeline: ModuleType) -> frozenset[str]:
    """What a pipeline gives: its `GIVES`, or positions and bearings where it does not say."""
    return frozenset(getattr(pipeline, "GIVES", {"positions", "bearings", "obstacles"}))


def parameters_of(group: Group) -> Any:
    """The values with which a group of Creates runs its law: given, else for Creates, else the law's own."""
    module = lawentry.module_of(group.law, group.law_source)
    return filled(module.Parameters, for_creates(module, group.law_parameters), prefix=f"{group.name}.law.")


def for_creates(law: ModuleType, given: Mapping[str, Any]) -> dict[str, Any]:
    """The given parameters over those that the law's file names for Creates."""
    return {**getattr(law, "CREATE", {}), **given}


def selections(group: Group) -> list[list[selection.Chosen]]:
    """The steps that make each of the law's sets, with numbers in place. Raises `InputError`."""
    module = lawentry.module_of(group.law, group.law_source)
    names = declared(module.Parameters)
    sets = selection.parse_sets(group.selection, lawentry.sets_of(module), names)
    values = parameters_of(group)._asdict()
    return [selection.resolved(steps, values) for steps in sets]


def wanted(group: Group) -> Wanted:
    """Raises `InputError`, in one line that says what is missing and what gives it."""
    module = lawentry.module_of(group.law, group.law_source)
    sets = selections(group)
    for name, steps in zip(lawentry.sets_of(module), sets, strict=True):
        if any(chosen.step is Step.GRAPH for chosen in steps):
            ids = ", ".join(map(str, range(min(group.count, 3))))
            raise InputError(
                f"law {group.law!r} selects {name} by fixed-set without ids, and robots have no graph; expected ids, as "
                f"in --set '{group.name}.selection=\"{name}: fixed-set({ids})\"'"
            )
    needs = lawentry.needs_of(module) | selection.needs(step for steps in sets for step in steps)
    if group.obstacles != "as-law":
        needs |= {"obstacles"}
    has = given(found.load(PIPELINES, group.pipeline, "pipeline"))
    missing = needs - has - OF_ITSELF
    inferable = missing & INFERRED if "positions" in has else frozenset()
    if group.association == "none" or missing - inferable:
        _refuse(group, missing, inferable)
    tells = bool(needs & {"compass", "goal"})
    return Wanted(needs & lawentry.OF_MEMBERS, bool(inferable), tells or bool(inferable))


def _refuse(group: Group, missing: frozenset[str], inferable: frozenset[str]) -> None:
    """Raises unless nothing is missing."""
    if not missing:
        return
    ways = []
    if missing == inferable:
        ways.append(f"association (--set {group.name}.association=two-scans)")
    givers = [name for name in found.modules(PIPELINES) if missing <= given(found.load(PIPELINES, name, "pipeline"))]
    ways += [f"pipeline {name}" for name in sorted(givers)]
    raise InputError(
        f"law {group.law!r} needs {_listed(missing)} of its neighbours or surroundings, which pipeline "
        f"{group.pipeline!r} does not give; given by: {', '.join(ways) or 'no pipeline'}"
    )


def _listed(names: Iterable[str]) -> str:
    return " and ".join(sorted(names))
