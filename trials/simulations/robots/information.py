"""Whether robots can give a law, and the selections of its sets, the information that they need.

It comes from the pipeline, by association, or from what a robot knows of itself.
"""

from __future__ import annotations

from collections.abc import Iterable

from flocking import lawentry
from flocking.errors import InputError
from flocking.perception import Step
from robots import body as bodies
from sensing.pipelines import INFERRED, all_pipelines, given_by
from trials.simulations.robots.fields import TWO_SCANS
from trials.simulations.robots.resolved import SONAR, Resolved


def check(resolved: Resolved) -> None:
    """Raises `InputError`, in one line that says what is missing and what gives it."""
    group, associates = resolved.group, resolved.associates
    for name, steps in zip(lawentry.sets_of(resolved.law), resolved.selections, strict=True):
        if any(chosen.step is Step.GRAPH for chosen in steps):
            ids = ", ".join(map(str, range(group.count)))
            raise InputError(
                f"law {group.law!r} selects its set {name!r} by fixed-set without ids, and robots have no graph; "
                f"expected ids: --set '{group.name}.selection=\"{name}: fixed-set({ids})\"'"
            )
    missing, inferable = resolved.wanted.missing, resolved.wanted.inferable
    if missing == inferable:
        return
    if "obstacles" in missing and resolved.reads_echoes:
        raise InputError(
            f"{_asker(resolved)} needs obstacles, which pipeline {group.pipeline!r} makes of echoes, and body "
            f"{resolved.body.name!r} of {group.name} carries no sonar; expected a body with cameras and sonar: "
            f"{', '.join(_with_both())}, or pipeline 'perfect'"
        )
    ways = []
    if missing <= INFERRED and not associates:
        ways.append(f"association (--set {group.name}.association={TWO_SCANS})")
    for name, pipeline in all_pipelines().items():
        has = given_by(pipeline)
        inferred = INFERRED if associates and "positions" in has else frozenset()
        if missing <= has | inferred:
            ways.append(f"pipeline {name}")
    raise InputError(
        f"law {group.law!r} needs {_listed(missing - inferable)}, which pipeline {group.pipeline!r} does not give; "
        f"given by: {', '.join(ways) or 'no pipeline'}"
    )


def _asker(resolved: Resolved) -> str:
    """Who asks for obstacles: the group's setting where that does, else its law."""
    if resolved.avoids:
        return f"{resolved.group.name}.obstacles = {resolved.given.obstacles!r}"
    return f"law {resolved.group.law!r}"


def _with_both() -> list[str]:
    """The bodies with cameras and sonars."""
    return [name for name in bodies.carrying("cameras") if SONAR in bodies.load(name).mounts]


def _listed(names: Iterable[str]) -> str:
    return " and ".join(sorted(names))
