"""What the gap of table 8.1 hangs on: robots a wall, speed of the pilots, size, law and detection of the herd.

One thing at a time differs from `piloting` in its first task, whose walls are here so long that six robots have room
along each: all walls of this experiment are the same. Two walls are held at a time, so that there are twice as many
pilots as robots a wall. Of what does not concern the pilots, walls that stand are tried beside them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from generation.piloting import members
from trials.simulations.robots import guided
from trials.studies.piloting import design
from trials.studies.piloting.ablation_claims import claims
from trials.studies.piloting.ablation_figures import figures
from trials.studies.piloting.design import GUIDES, PILOTS, WALLS, finish
from trials.types import Trial, Value, with_setup

LONG_WALLS = "28 210 2.12, 30 240 2.12, 46 195 2.12"
"""Found as by `herd plan task-1 --starts 8 --set grid.lengths_m=[2.12,2.5] --set grid.robots=6 --set grid.reach_m=1.8`.

The search was made before a whole plan had to guide 90 % of new herds in place of 95 %.
"""
ROBOTS, SPEED, COUNT = "piloting.robots_a_wall", "pilots.speed_m_s", "herd.count"
LAW, PIPELINE = "herd.law", "herd.pipeline"
REPEATS = 10
RECORD = "first"
CONDITIONS = {
    GUIDES: (PILOTS, WALLS),
    ROBOTS: (2, 3, 4, 5, 6),
    SPEED: (0.2, 0.3, 0.4, 0.5),
    COUNT: (1, 2, 4, 7, 10),
    LAW: (members.LAW, "viscido-snn", "random-motion"),
    PIPELINE: ("sensor-based", "member-based", "perfect"),
}
USUAL: Mapping[str, Value] = {
    GUIDES: PILOTS, ROBOTS: guided.Parameters().robots_a_wall, SPEED: design.PILOT_M_S, COUNT: members.COUNT,
    LAW: members.LAW, PIPELINE: "sensor-based",
}  # fmt: skip
BESIDE_WALLS = (COUNT, LAW, PIPELINE)
"""What is tried with walls that stand as well."""
SOURCES = {
    ROBOTS: Parameter("robots", "Fine 2015, section 8.2, has three: a hand-tuned parameter"),
    SPEED: Parameter("m/s", "not published; how fast formations change"),
    COUNT: Parameter("robots", "Fine 2015, section 8.2, has four, and figure 8.6 five"),
    LAW: Parameter("", "Fine 2015, section 8.2, has BOIDS; the others are those of section 6.3.3"),
    PIPELINE: Parameter("", "not published"),
}
KEY_MEASURES = (design.MEASURE, "late_share", "change_s", "pilot_herd_collisions")


def base(repeat: int) -> Trial:
    """The first task, guided by robots along walls that have room for six."""
    return with_setup(design.base("piloting-ablations", repeat), {"piloting.walls": LONG_WALLS})


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """All that differs from the usual in one key, and that beside walls where it makes sense."""
    usual = {key: value if value in conditions[key] else conditions[key][0] for key, value in USUAL.items()}
    beside = {key: value for key, value in usual.items() if key != SPEED}  # no pilots, no speed of theirs
    found: list[dict[str, Value]] = []
    for guides in conditions[GUIDES]:
        same, keys = (usual, USUAL) if guides == PILOTS else (beside, BESIDE_WALLS)
        for key in keys:
            if key != GUIDES:
                found += [{**same, GUIDES: guides, key: value} for value in conditions[key]]
    return [cell for number, cell in enumerate(found) if cell not in found[:number]]


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
