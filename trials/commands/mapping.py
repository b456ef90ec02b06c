"""`herd map`: one parameter-space map, its table, its figures and its numbers."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from flocking.errors import InputError

if TYPE_CHECKING:
    from generation.maps.trees import Judged, ParameterMap
    from trials.types import Trial

TABLE, NUMBERS = "map.csv", "map.json"


class Asked(NamedTuple):
    """What the command was asked for."""

    schema: str
    behaviour: str | None
    law: str
    members: int
    refinements: int
    refined: str | None
    grid: str | None
    budget: int
    method: str
    seed: int
    settings: Mapping[str, Any]
    out: Path


def map_(asked: Asked) -> None:
    """Makes the map, writes it to a new folder, and prints its numbers. Raises `InputError`."""
    from trials import simulations
    from trials.batch.folders import write_whole
    from trials.simulations.maps import fields, loop
    from trials.simulations.maps.measures import ABOUT, measure

    trial = _trial(asked)
    simulations.check(trial)
    if os.path.lexists(asked.out):
        raise InputError(f"--out {asked.out}: there is such a file or folder; expected a new one")
    chosen = fields.chosen_by(trial)
    judging = loop.judging_of(trial, chosen)
    iterations: list[int] = []

    def told(judged: Judged) -> None:
        iterations.append(len(judged.trials))
        print(f"iteration {len(iterations)}: {len(judged.trials)} configurations", file=sys.stderr, flush=True)

    made = loop.mapped(trial, chosen, judging, lambda _: None, told)
    measured = {name: value for name, value in measure(made, chosen.within).items() if math.isfinite(value)}
    asked.out.mkdir(parents=True)
    write_whole(asked.out / TABLE, _table(made).encode())
    numbers = {"schema": asked.schema, "seed": asked.seed, "trial": trial.as_dict(), "measures": measured}
    write_whole(asked.out / NUMBERS, (json.dumps(numbers, indent=1, default=str) + "\n").encode())
    _draw(made, loop.flipped(judging, made), trial, asked.out)
    for name, value in measured.items():
        unit = f" {ABOUT[name].unit}" if ABOUT[name].unit else ""
        print(f"{name:20} {f'{value:.4g}{unit}':12} {ABOUT[name].text}")
    print(f"results              {asked.out}")


def _trial(asked: Asked) -> Trial:
    """The trial that makes the map. Raises `InputError`."""
    from flocking import lawentry
    from trials import keys
    from trials.simulations.maps import fields

    herd = fields.herd(asked.members, asked.law if lawentry.is_path(asked.law) else asked.law.replace("_", "-"))
    if lawentry.is_path(asked.law):
        herd = dataclasses.replace(herd, law_source=lawentry.read_source(asked.law))
    trial = fields.trial("map", 1, [herd], asked.schema)
    trial = dataclasses.replace(trial, seed=asked.seed)
    given: dict[str, Any] = {"method": asked.method, "refinements": asked.refinements, "budget": asked.budget}
    own = {"behaviour": asked.behaviour, "refined": asked.refined, "grid": asked.grid}
    given |= {key: value for key, value in own.items() if value is not None}
    for key, value in {**given, **asked.settings}.items():
        trial = keys.put(trial, key, value)
    return trial


def _table(map_: ParameterMap) -> str:
    """A row a configuration, as CSV."""
    from generation.maps.surfaces import interval

    judged, text = map_.judged, io.StringIO()
    low, high = interval(judged.successes, judged.trials)
    writer = csv.writer(text, lineterminator="\n")
    names = [axis.name for axis in map_.box.axes]
    columns = ("level", "simulations", "successes", "share", "low", "high", "successful", "fitness", "x_deviation_m")
    writer.writerow([*names, *columns])
    successful, possible = map_.successful, map_.possible
    for k, point in enumerate(map_.points):
        own: list[Any] = [map_.levels[k], judged.trials[k], judged.successes[k]]
        if possible[k]:
            share = judged.successes[k] / judged.trials[k]
            own += [f"{share:.4g}", f"{low[k]:.4g}", f"{high[k]:.4g}", int(successful[k])]
            own += [f"{judged.fitness[k]:.6g}", f"{judged.x_deviation[k]:.6g}"]
        else:
            own += [""] * 6
        writer.writerow([*map(repr, map(float, point)), *own])
    return text.getvalue()


def _draw(map_: ParameterMap, flips: Mapping[str, Any], trial: Trial, folder: Path) -> None:
    from trials.reports import maps
    from trials.reports.figures import save

    title = f"{trial.world}, {sum(group.count for group in trial.groups)} members"
    drawn = [("map", maps.marks([(title, map_)]))]
    if len(map_.box.axes) == maps.MOST_SHOWN:
        drawn.append(("surface", maps.surfaces([(title, map_)])))
    if flips:
        drawn.append(("flips", maps.flips(flips, map_)))
    for name, canvas in drawn:
        save(canvas, folder, name, title, "", dots=True)
