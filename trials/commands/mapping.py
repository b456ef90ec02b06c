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
from trials.commands.stopping import StoppedError

if TYPE_CHECKING:
    from generation.maps.judging import Control
    from generation.maps.trees import Judged, ParameterMap
    from trials.types import Trial

TABLE, NUMBERS = "map.csv", "map.json"
LAW_LIMIT_S = 30.0
"""Processor time that a user's law may use without progress, as in a run."""


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
    from flocking import lawentry, users_files
    from trials.commands import lawcheck

    if os.path.lexists(asked.out):
        raise InputError(f"--out {asked.out}: there is such a file or folder; expected a new one")
    if lawentry.is_path(asked.law):
        lawcheck.check(asked.law)
    with users_files.executed(True):
        _make(asked)


def _make(asked: Asked) -> None:
    from generation import found as schemas
    from generation.found import is_path
    from trials import simulations
    from trials.batch.folders import write_whole
    from trials.environments.hands import in_order
    from trials.simulations.maps import fields, loop
    from trials.simulations.maps.measures import ABOUT, measure

    if not is_path(asked.schema):
        schemas.load(asked.schema)  # unknown names are refused as those of schemas, not of a trial's worlds
    trial = _trial(asked)
    simulations.check(trial)
    chosen = fields.chosen_by(trial)
    loop.judging_of(trial, chosen)  # refused before anything is simulated
    users = [name for name in (asked.law, asked.schema, asked.behaviour or "") if is_path(name)]
    if users:  # their code may never return: it runs in a process that can be ended
        try:
            ((made, flips, alone, stopped),) = in_order(mapped, [(trial,)], 1, law_limit_s=LAW_LIMIT_S)
        except InputError as error:
            raise InputError(f"{' or '.join(map(repr, users))}: {error}") from None
    else:
        made, flips, alone, stopped = mapped(trial, keeps=True)
    measured = {name: value for name, value in measure(made, chosen.within, alone).items() if math.isfinite(value)}
    asked.out.mkdir(parents=True)
    write_whole(asked.out / TABLE, _table(made).encode())
    numbers = {"schema": asked.schema, "seed": asked.seed, "trial": trial.as_dict(), "measures": measured}
    write_whole(asked.out / NUMBERS, (json.dumps(numbers, indent=1, default=str) + "\n").encode())
    _draw(made, flips, trial, asked.out)
    for name, value in measured.items():
        unit = f" {ABOUT[name].unit}" if ABOUT[name].unit else ""
        print(f"{name:20} {f'{value:.4g}{unit}':12} {ABOUT[name].text}")
    print(f"results              {asked.out}")
    if stopped:
        raise StoppedError(
            f"the map has {len(made.points)} configurations, of the iterations that were done: {asked.out}"
        )


def mapped(trial: Trial, keeps: bool = False) -> tuple[ParameterMap, dict[str, Any], Control, bool]:
    """The map of a trial, its two nearest environments of opposite outcomes, what the herd does without any, and
    whether Ctrl-C ended it before its time; tells each iteration as it ends. `keeps`: Ctrl-C keeps the iterations
    before."""
    import flocking.kinematic.kernel  # noqa: F401 (its import compiles it: here, since no watch is on yet)
    from flocking import users_files
    from flocking.kinematic import LawFailedError
    from generation.maps import trees
    from generation.maps.judging import control
    from trials.simulations import watch
    from trials.simulations.maps import fields, loop

    iterations: list[int] = []

    def told(judged: Judged) -> None:
        iterations.append(len(judged.trials))
        print(f"iteration {len(iterations)}: {len(judged.trials)} configurations", file=sys.stderr, flush=True)

    with users_files.executed(True):
        chosen = fields.chosen_by(trial)
        judging = loop.judging_of(trial, chosen)
        try:
            with watch.watched():
                stops: list[bool] = []
                made = loop.mapped(trial, chosen, judging, watch.breathe, told, stops if keeps else None)
                return made, loop.flipped(judging, made), control(judging, made), bool(stops)
        except trees.StoppedError:
            raise KeyboardInterrupt from None
        except LawFailedError as error:
            raise InputError(" ".join(str(error).split())) from None


def _trial(asked: Asked) -> Trial:
    """The trial that makes the map. Raises `InputError`."""
    from flocking import lawentry, lawsource
    from trials import keys
    from trials.simulations.maps import fields

    herd = fields.herd(asked.members, asked.law if lawentry.is_path(asked.law) else asked.law.replace("_", "-"))
    if lawentry.is_path(asked.law):
        herd = dataclasses.replace(herd, law_source=lawsource.read_source(asked.law))
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
