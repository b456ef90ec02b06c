"""Whether a law, with the sets that it selects, can have what it needs on robots: from the pipeline, by association, or
from what a robot knows of itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from flocking import lawentry, selection
from flocking.errors import InputError
from flocking.parameters import declared
from flocking.perception import Step
from sensing.pipelines import INFERRED, OF_ITSELF, all_pipelines, given
from trials.simulations.robots.fields import AS_LAW, TWO_SCANS, of_group, pipeline_of
from trials.types import Group


class Wanted(NamedTuple):
    """What a group's law and its selections need, and what its robots must do to have it."""

    needs: frozenset[str]
    missing: frozenset[str]
    """What the pipeline does not give."""
    inferable: frozenset[str]
    """What association gives of that."""
    own_pose: bool
    """Whether a robot must follow its own pose."""

    @property
    def associate(self) -> bool:
        """Whether velocities or headings are to be inferred."""
        return bool(self.inferable)


def parameters_of(group: Group) -> Any:
    """The values with which a group of Creates runs its law: given, else for Creates, else the law's own."""
    module = lawentry.module_of(group.law, group.law_source)
    given = {**getattr(module, "CREATE", {}), **group.law_parameters}
    return lawentry.parameters_of(group.law, module, given, f"{group.name}.law.")


def selections(group: Group) -> list[list[selection.Chosen]]:
    """The steps that make each of the law's sets, with numbers in place. Raises `InputError`."""
    module = lawentry.module_of(group.law, group.law_source)
    names = declared(module.Parameters)
    sets = selection.parse_sets(group.selection, lawentry.sets_of(module), names)
    values = parameters_of(group)._asdict()
    return [selection.resolved(steps, values) for steps in sets]


def wanted(group: Group) -> Wanted:
    """Whether it can be had is for `check` to say. Raises `InputError` for names that do not exist."""
    law = lawentry.module_of(group.law, group.law_source)
    needs = lawentry.needs_of(law) | selection.needs(step for steps in selections(group) for step in steps)
    fields = of_group(group)
    if fields.obstacles != AS_LAW:
        needs |= {"obstacles"}
    has = given(pipeline_of(group))
    missing = needs - has - OF_ITSELF
    inferable = missing & INFERRED if fields.association == TWO_SCANS and "positions" in has else frozenset()
    return Wanted(needs, missing, inferable, bool(needs & {"compass", "goal"}) or bool(inferable))


def check(group: Group) -> None:
    """Raises `InputError`, in one line that says what is missing and what gives it."""
    associates = of_group(group).association == TWO_SCANS
    sets = lawentry.sets_of(lawentry.module_of(group.law, group.law_source))
    for name, steps in zip(sets, selections(group), strict=True):
        if any(chosen.step is Step.GRAPH for chosen in steps):
            ids = ", ".join(map(str, range(group.count)))
            raise InputError(
                f"law {group.law!r} selects its set {name!r} by fixed-set without ids, and robots have no graph; "
                f"expected ids: --set '{group.name}.selection=\"{name}: fixed-set({ids})\"'"
            )
    _, missing, inferable, _ = wanted(group)
    if missing == inferable:
        return
    ways = []
    if missing <= INFERRED and not associates:
        ways.append(f"association (--set {group.name}.association={TWO_SCANS})")
    for name, pipeline in all_pipelines().items():
        has = given(pipeline)
        inferred = INFERRED if associates and "positions" in has else frozenset()
        if missing <= has | inferred:
            ways.append(f"pipeline {name}")
    raise InputError(
        f"law {group.law!r} needs {_listed(missing - inferable)}, which pipeline {group.pipeline!r} does not give; "
        f"given by: {', '.join(ways) or 'no pipeline'}"
    )


def _listed(names: Iterable[str]) -> str:
    return " and ".join(sorted(names))
