"""The figures of `odometry`: what is read too much, of ways and of turns, beside the publication's tests."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trials.evidence.claims import published
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import SERIES_COLOURS, Figure, Place
from trials.studies.monocular.odometry_claims import KEYS, SPEED, STOP_M, STOP_RAD, WAYS


def figures(run: Run, folder: Path) -> list[Figure]:
    """One figure of two panels for each arm."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    canvas, (ways, turns) = draw.grid(2, 2, width=8.8, height=3.6)
    ways.set_title("straight ways", loc="left")
    ways.set_xlabel("way driven (m)")
    ways.set_ylabel("odometry less way (m)")
    turns.set_title("turns", loc="left")
    turns.set_xlabel("turned (degrees)")
    turns.set_ylabel("odometry less turn (degrees)")
    for axis in (ways, turns):
        axis.axhline(0.0, color="#999999", lw=0.6)
    told = published(__package__, "kirchner2006", "appendix_b")["rows"]
    for rank, speed in enumerate((0.1, 0.2)):
        colour = SERIES_COLOURS[rank]
        rows = [row for row in told if row[0] == speed]
        _dots(ways, [(row[4], row[1] - row[4]) for row in rows], colour, f"published, {speed:g} m/s", filled=False)
        _dots(ways, _read(run, speed, "way"), colour, f"here, {speed:g} m/s")
    rows = published(__package__, "kirchner2006", "appendix_c")["rows"]
    _dots(turns, [(row[1], row[0] - row[1]) for row in rows], SERIES_COLOURS[2], "published", filled=False)
    for rank, (speed, words) in enumerate(WAYS.items()):
        _dots(turns, _read(run, speed, "turn"), SERIES_COLOURS[2 + rank], f"here, {words}")
    for axis in (ways, turns):
        axis.legend(frameon=False, fontsize=7)
    caption = (
        "Each dot a trial. As the tables of appendices B and C of Kirchner 2006. Turns in place and on the wheels of "
        "one side lie on one line: the contacts decide how far the wheels turn the robot, whichever of them run."
    )
    return [draw.save(canvas, place, "over-read", "What odometry reads too much", caption)]


def _read(run: Run, speed: float, what: str) -> list[tuple[float, float]]:
    """Of each finished trial of ways or turns at a speed: truth, and what the odometry reads more."""
    stop, scale = (STOP_M, 1.0) if what == "way" else (STOP_RAD, math.degrees(1.0))
    done = {row.index: row.measures for row in run.rows() if row.status == "done"}
    found = []
    for trial in run.trials:
        given = trial.conditions
        if trial.index in done and given.get(SPEED) == speed and given.get(stop, 0.0) != 0.0:
            measures = done[trial.index]
            error = 1.0 + float(trial.groups[0].law_parameters.get("radius_error", 0.0))
            true = measures[f"true_{what}"]
            found.append((scale * true, scale * (error * measures[f"counted_{what}"] - true)))
    return found


def _dots(axis: Any, points: Sequence[tuple[float, float]], colour: str, label: str, filled: bool = True) -> None:
    xs, ys = [point[0] for point in points], [point[1] for point in points]
    axis.plot(xs, ys, "o", ms=3.5, color=colour, mfc=colour if filled else "none", mew=0.8, label=label)
