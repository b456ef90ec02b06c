"""The figure of `maebe-presets`: rates and their controls over start size, speed and turn limit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trials.evidence.claims import published
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.environments import design
from trials.studies.environments.claims import BEHAVIOURS, NAMES
from trials.studies.environments.design import KEYS, OF_BEHAVIOURS, SIZE, SPEED, TURN
from trials.types import Value

VARIED = {SIZE: "size", SPEED: "speed", TURN: "turn"}
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")
STYLES = (":", "-", "--", "-.")
Point = tuple[Value, ...]
"""Values of size, speed and turn limit."""


def figures(run: Run, folder: Path) -> list[Figure]:
    """For each arm of the run, the rates and how much of their spread each of the three explains."""
    return by_arm(run, folder, KEYS, _figures)


def main_effects(rates: Mapping[Point, float]) -> dict[str, float]:
    """By key, the share of the rates' variance that lies between the means of its values; nan where nothing varies.

    Shares of a full grid add up to at most one; what is left is interaction.
    """
    values = np.array(list(rates.values()))
    whole = float(np.var(values)) if len(values) else 0.0
    found = {}
    for at, key in enumerate(VARIED):
        levels = np.array([point[at] for point in rates])
        means = np.array([values[levels == level].mean() for level in levels])
        found[key] = float(np.var(means)) / whole if whole > 0.0 else np.nan
    return found


def _figures(run: Run, place: Place) -> list[Figure]:
    wanted = [(behaviour, law) for behaviour in OF_BEHAVIOURS for law in design.LAWS]
    canvas, axes = draw.grid(len(wanted), len(design.LAWS), width=9.6, height=2.6)
    for axis, (behaviour, law) in zip(axes, wanted, strict=True):
        rates, controls = _means(run, behaviour, law, "valid_rate"), _means(run, behaviour, law, "control_rate")
        if not rates:
            draw.absent(axis)
            continue
        _draw(axis, rates, controls)
        axis.axhline(published(__package__, "fine2015", "table_7_2")[behaviour][law], color="#e69f00", lw=0.8)
        told = ", ".join(f"{VARIED[key]} {share:.2f}" for key, share in main_effects(rates).items())
        axis.set_title(f"{BEHAVIOURS[behaviour]}, {NAMES[law]}\n{told}", loc="left", fontsize=7)
        axis.set_ylim(-0.03, 1.03)
        axis.set_xlabel("side of the start, m", fontsize=7)
    caption = (
        "Share of the environments that passed in which the herd showed the behaviour (thick), and in the empty world "
        "(thin, grey), means of the repeats; orange: table 7.2 of Fine 2015. Colour: speed; line: turn limit, "
        "from small (dotted) to large (dashed). Above each panel, what share of the variance of its rates each of the "
        "three explains by itself."
    )
    return [draw.save(canvas, place, "presets", "What the start, the speed and the turn limit decide", caption)]


def _draw(axis: Any, rates: Mapping[Point, float], controls: Mapping[Point, float]) -> None:
    speeds, turns = (sorted({point[at] for point in rates}) for at in (1, 2))
    for k, speed in enumerate(speeds):
        for j, turn in enumerate(turns):
            style = STYLES[j % len(STYLES)]
            for values, look in (
                (controls, {"color": "#999999", "lw": 0.7}),
                (rates, {"color": COLOURS[k % len(COLOURS)], "lw": 1.5, "label": f"{speed:g} m/s, {turn:g} rad/s"}),
            ):
                points = sorted(point for point in values if point[1:] == (speed, turn))
                axis.plot([point[0] for point in points], [values[point] for point in points], style, **look)
    axis.legend(fontsize=5, loc="best")


def _means(run: Run, behaviour: str, law: str, measure: str) -> dict[Point, float]:
    """The mean of a measure over the repeats of each combination of the three."""
    trials = {trial.index: trial.conditions for trial in run.trials}
    found: dict[Point, list[float]] = {}
    for row in run.rows():
        conditions = trials[row.index]
        mine = conditions.get(design.BEHAVIOUR) == behaviour and conditions.get(design.LAW) == law
        value = row.measures.get(measure, np.nan)
        if mine and row.status == "done" and np.isfinite(value):
            found.setdefault(tuple(conditions[key] for key in VARIED), []).append(value)
    return {point: float(np.mean(values)) for point, values in found.items()}
