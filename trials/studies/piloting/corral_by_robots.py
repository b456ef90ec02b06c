"""Figure 8.2 of Fine 2015: a valid corralling construct, and robots that stand along it in its place.

The construct is the one in which tables 7.3 and 7.4 are tried (docs/environments.md): number 17 of the weiring
grammar's environments that pass, 18 m of fence at the scale of Creates. Robots that look like walls stand along it at
equal distances; where there are 27 that is three for each wall of the grammar, as in the document.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.robots import guided
from trials.simulations.robots.fields import group, trial
from trials.studies.piloting.corral_claims import CONSTRUCT, COUNT, GUIDES, claims
from trials.studies.piloting.corral_figures import figures
from trials.studies.piloting.design import pilots
from trials.types import Trial, Value, with_setup

REPEATS = 20
RECORD = "first"
COUNTS = (27, 36)
CONDITIONS = {GUIDES: (guided.PILOTS, guided.WALLS, guided.NOTHING), COUNT: COUNTS}
SOURCES = {
    GUIDES: Parameter("", "Fine 2015, figure 8.2", published=True),
    COUNT: Parameter("robots", "a choice: three a wall of 2 m, as in section 8.2, and four"),
}
KEY_MEASURES = ("elicited", "fitness")
CORRAL = Path(__file__).parent / "corral.json"
FILE = "environment.json"
MEMBERS = 3
"""Fine 2015, tables 7.3 and 7.4: corralling with three robots, of which two have to be corralled."""
SETUP: dict[str, Value] = {
    "behaviour": "corralling", "duration_s": 100.0, "behaviour.iteration_s": 0.2, "behaviour.connectivity": 2.0 / 3.0,
}  # fmt: skip
START: dict[str, Value] = {"gap_m": 0.5, "length_m": 1.6, "half_width_m": 0.5}


def base(repeat: int) -> Trial:
    """Three Creates under BOIDS amid 27 robots that stand along the construct."""
    herd = group("reynolds-boids", MEMBERS, pipeline="sensor-based", obstacles="avoid")
    standing = dataclasses.replace(pilots(COUNTS[0]), law="to-goal")
    made = trial(
        "corral-by-robots", repeat, [herd, standing], world=FILE, formation="scattered",
        formation_parameters=START, world_parameters={"scale": 0.05, "construct": False},
    )  # fmt: skip
    made = dataclasses.replace(made, world_source=CORRAL.read_text(encoding="utf-8"))
    return with_setup(made, {**SETUP, GUIDES: guided.PILOTS})


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Each number of robots; the construct and the empty world once."""
    return [
        {GUIDES: guides, **pilots}
        for guides in conditions[GUIDES]
        for pilots in ([{COUNT: count} for count in conditions[COUNT]] if guides == guided.PILOTS else [{}])
    ]


def finish(trial: Trial) -> Trial:
    """The construct where walls guide, the standing robots where they do."""
    guides = trial.setup[GUIDES]
    kept = tuple(each for each in trial.groups if each.name != guided.GROUP or guides == guided.PILOTS)
    world = {**trial.world_parameters, CONSTRUCT: guides == guided.WALLS}
    return dataclasses.replace(trial, groups=kept, world_parameters=world)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
