"""Which trials run the same code: what is compiled for one of them is compiled for all."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence

from trials.types import Trial


def kinds(trials: Sequence[Trial]) -> list[Trial]:
    """One trial for each combination of laws, pipelines and the like: running these compiles all code beforehand."""
    found: dict[Hashable, Trial] = {}
    for trial in trials:
        found.setdefault(kind_of(trial), trial)
    return list(found.values())


def kind_of(trial: Trial) -> Hashable:
    """Equal for trials that run the same code."""
    return tuple(
        (trial.simulation, trial.world, g.pipeline, g.selection, g.law, g.law_source, _names_in(g.setup))
        for g in trial.groups
    )


def _names_in(setup: Mapping[str, object]) -> tuple[tuple[str, str], ...]:
    """The entries of a setup that are text: names of bodies, of settings and of ways to sense."""
    return tuple(sorted((key, value) for key, value in setup.items() if isinstance(value, str)))
