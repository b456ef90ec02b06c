"""The figures of this study: those of Fine 2015, sections 7.4 and 8.1, redrawn from the first repeat of each map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from generation.maps.trees import ParameterMap
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports import maps
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.reports.ways import first_result
from trials.simulations.maps.loop import map_of
from trials.studies.maps.claims import DIRT_KEYS
from trials.studies.maps.design import ANCHOR, COUNT, FEW, MEMBERS, METHOD, REFINEMENTS, SOLITARY, WORLD
from trials.types import TrialResult

STYLE = "+: the behaviour shows in at least the reliable share of the simulations; dots: it does not."
SMOOTHED = (
    "Beta-binomial kernel smoothing: a place's neighbours count by a Gaussian as wide as the cell that it lies in, "
    "with Jeffreys' prior; beside it the width of the 95 % interval."
)


def of_dirt(run: Run, folder: Path) -> list[Figure]:
    """Figures 7.7 and 7.10 to 7.13, and the probability surfaces."""
    return by_arm(run, folder, DIRT_KEYS, _dirt)


def _dirt(run: Run, place: Place) -> list[Figure]:
    depths = [int(trial.conditions[REFINEMENTS]) for trial in run.trials if REFINEMENTS in trial.conditions]
    if not depths:
        return []
    found = []
    first = _maps(run, [(f"anchor {n}", {ANCHOR: n, COUNT: MEMBERS, REFINEMENTS: min(depths)}) for n in (1, 2, 3, 4)])
    if any(map_ for _, map_ in first):
        caption = f"{STYLE} As figure 7.10 of Fine 2015: the first iteration, seven members."
        found.append(draw.save(maps.marks(first), place, "anchors", "DIRT from four anchors", caption))
    sizes = (SOLITARY, FEW, MEMBERS)
    deep = _maps(run, [(_members(n), {ANCHOR: 4, COUNT: n, REFINEMENTS: max(depths)}) for n in sizes])
    if max(depths) > min(depths) and any(map_ for _, map_ in deep):
        caption = f"{STYLE} As figures 7.11 to 7.13 of Fine 2015: anchor four, refined around successes."
        found.append(draw.save(maps.marks(deep, 3), place, "sizes", "DIRT by group size", caption, dots=True))
        found.append(
            draw.save(maps.surfaces(deep), place, "surfaces", "Probability of a right turn", SMOOTHED, dots=True)
        )
        found += _flips(run, place, {ANCHOR: 4, COUNT: MEMBERS, REFINEMENTS: max(depths)})
    return found


def _flips(run: Run, place: Place, conditions: Mapping[str, Any]) -> list[Figure]:
    result = first_result(run, conditions)
    if result is None or "flip_ways" not in result.tables:
        return []
    caption = "As figure 7.7 of Fine 2015: one start in all three. The walls of both constructs hardly differ."
    canvas = maps.flips(result.tables, map_of(result.trial, result.tables))
    return [draw.save(canvas, place, "flips", "Small changes that flip the outcome", caption, dots=True)]


def of_sampling(run: Run, folder: Path) -> list[Figure]:
    """The first repeat's configurations by both methods."""

    def drawn(run: Run, place: Place) -> list[Figure]:
        panels = _maps(run, [(method, {METHOD: method}) for method in ("quad-tree", "random")])
        return [draw.save(maps.marks(panels), place, "methods", "Quad-tree and random sampling", STYLE)]

    return by_arm(run, folder, (METHOD,), drawn)


def of_dsdr(run: Run, folder: Path) -> list[Figure]:
    """Figure 7.14."""

    def drawn(run: Run, place: Place) -> list[Figure]:
        panels = [(title, map_) for title, map_ in _by_size(run) if map_ is not None]
        if not panels:
            return []
        caption = (
            "As figure 7.14 of Fine 2015, which has them for ten members along the line y = 1; mean of each one's "
            "simulations. A member alone has no deviation."
        )
        return [draw.save(maps.deviations(panels), place, "deviations", "Deviations along x", caption)]

    return by_arm(run, folder, (COUNT,), drawn)


def of_sirt(run: Run, folder: Path) -> list[Figure]:
    """Figure 8.1 and its surface."""

    def drawn(run: Run, place: Place) -> list[Figure]:
        panels = [(f"SIRT, anchor 4{title and f', {title}'}", map_) for title, map_ in _by_size(run)]
        caption = f"{STYLE} As figure 8.1 of Fine 2015. What both rules leave to one is the probability of rule 3."
        return [
            draw.save(maps.marks(panels, 3), place, "rules", "SIRT's rules 1 and 2", caption),
            draw.save(maps.surfaces(panels), place, "surfaces", "Probability of a right turn", SMOOTHED, dots=True),
        ]

    return by_arm(run, folder, (COUNT,), drawn)


def of_both(run: Run, folder: Path) -> list[Figure]:
    """The random configurations of both schemas by group size."""

    def drawn(run: Run, place: Place) -> list[Figure]:
        wanted = [
            (f"{schema.upper()}, {_members(count)}", {WORLD: schema, COUNT: count})
            for schema in ("dirt", "sirt")
            for count in (SOLITARY, FEW, MEMBERS)
        ]
        return [draw.save(maps.marks(_maps(run, wanted), 3), place, "both", "DIRT and SIRT", STYLE)]

    return by_arm(run, folder, (WORLD, COUNT), drawn)


def _members(count: int) -> str:
    return f"{count} member{'s' if count > 1 else ''}"


def _by_size(run: Run) -> list[tuple[str, ParameterMap | None]]:
    """The map of each group size that a run varies, in the order of its trials; else its only one, without a title."""
    counts = list(dict.fromkeys(trial.conditions[COUNT] for trial in run.trials if COUNT in trial.conditions))
    return _maps(run, [(_members(int(count)), {COUNT: count}) for count in counts] or [("", {})])


def _maps(run: Run, wanted: Sequence[tuple[str, Mapping[str, Any]]]) -> list[tuple[str, ParameterMap | None]]:
    """By title, the map of the first finished trial with these conditions."""
    return [(title, _map(first_result(run, conditions))) for title, conditions in wanted]


def _map(result: TrialResult | None) -> ParameterMap | None:
    if result is None or "parameters" not in result.tables:
        return None
    return map_of(result.trial, result.tables)
