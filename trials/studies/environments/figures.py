"""The figures of `maebe`: rates beside their controls, and figures 7.2 to 7.5 of Fine 2015 redrawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import published
from trials.evidence.runs import Run
from trials.evidence.statistics import mean_interval
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.simulations.environments.loop import walls_of
from trials.studies.environments import design
from trials.studies.environments.claims import BEHAVIOURS, NAMES
from trials.studies.environments.design import OF_BEHAVIOURS, PRESETS, Preset
from trials.types import Trial

SHOWN = 3
"""Environments of a kind that are drawn, as in the publication."""
VALID_COLOUR, CONTROL_COLOUR, PUBLISHED_COLOUR = "#0072b2", "#999999", "#d55e00"
WALL = {"color": "#1a1a1a", "lw": 1.2}


def figures(run: Run, folder: Path) -> list[Figure]:
    """All figures, for each arm of the run."""
    return by_arm(run, folder, design.KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    found = [_rates(run, place)]
    for schema in dict.fromkeys(OF_BEHAVIOURS.values()):
        trial = next((trial for trial in run.trials if trial.world == schema and _done(run, trial)), None)
        if trial is not None:
            found.append(_filtered(run, trial, place))
    for behaviour in OF_BEHAVIOURS:
        found += _elicited(run, behaviour, place)
    return found


def _rates(run: Run, place: Place) -> Figure:
    """Rates of success with their controls, a panel for each behaviour and preset."""
    presets = [preset for preset in PRESETS if any(_of(run, b, design.LAWS[0], preset) for b in OF_BEHAVIOURS)]
    wanted = [(behaviour, preset) for preset in presets for behaviour in OF_BEHAVIOURS]
    canvas, axes = draw.grid(max(1, len(wanted)), 3, width=9.6, height=2.4)
    for axis, (behaviour, preset) in zip(axes, wanted, strict=False):
        axis.set_title(f"{BEHAVIOURS[behaviour]}, start {preset.size_m:g} m, {preset.speed_m_s:g} m/s", loc="left")
        rates = published(__package__, "fine2015", "table_7_2")[behaviour]
        for k, law in enumerate(design.LAWS):
            rows = [row for row in run.rows() if row.index in _of(run, behaviour, law, preset)]
            for shift, measure, colour in ((-0.12, "valid_rate", VALID_COLOUR), (0.12, "control_rate", CONTROL_COLOUR)):
                values = np.array([row.measures.get(measure, np.nan) for row in rows])
                if np.isfinite(values).any():
                    mean, low, high = mean_interval(values)
                    axis.errorbar([k + shift], [mean], [[mean - low], [high - mean]], fmt="o", color=colour, ms=4)
            axis.plot([k], [rates[law]], "_", color=PUBLISHED_COLOUR, ms=14, mew=2)
        axis.set_xticks(range(len(design.LAWS)), [NAMES[law] for law in design.LAWS])
        axis.set_ylim(-0.02, 1.02)
    caption = (
        "Share of the environments that passed in which the herd showed the behaviour (blue), the same of the empty "
        "world on the same starts (grey), both with their 95 % intervals over the repeats, and table 7.2 (orange)."
    )
    return draw.save(canvas, place, "rates", "Environments that elicit a behaviour, and the empty world", caption)


def _filtered(run: Run, trial: Trial, place: Place) -> Figure:
    """Figures 7.2 and 7.3: environments that passed, and that failed."""
    tables = run.series(trial.index).tables
    canvas, axes = draw.grid(2 * SHOWN, SHOWN, width=9.6, height=2.6)
    for row, wanted in enumerate((True, False)):
        numbers = np.flatnonzero(tables["passed"] == wanted)[:SHOWN]
        for column in range(SHOWN):
            axis = axes[row * SHOWN + column]
            if column >= len(numbers):
                draw.absent(axis)
                continue
            axis.set_title(f"{'passed' if wanted else 'failed'}: environment {numbers[column] + 1}", loc="left")
            _draw_walls(axis, walls_of(tables, int(numbers[column])))
    caption = f"Environments of {trial.world}, as in figures 7.2 and 7.3: above those that pass the filter."
    return draw.save(canvas, place, f"filtered-{trial.world}", f"Environments of {trial.world}", caption)


def _elicited(run: Run, behaviour: str, place: Place) -> list[Figure]:
    """Figures 7.4 and 7.5: environments that elicited the behaviour from each law, with the members' ways."""
    trials = {law: _first(run, behaviour, law) for law in design.LAWS}
    if not any(trials.values()):
        return []
    canvas, axes = draw.grid(SHOWN * len(trials), SHOWN, width=9.6, height=3.0)
    for row, (law, trial) in enumerate(trials.items()):
        for column in range(SHOWN):
            axis = axes[row * SHOWN + column]
            tables = run.series(trial.index).tables if trial is not None else {}
            if trial is None or column >= len(tables["example_numbers"]):
                draw.absent(axis)
                continue
            number = int(tables["example_numbers"][column])
            axis.set_title(f"{NAMES[law]}: environment {number + 1}", loc="left")
            _draw_ways(axis, tables["example_ways"][column])
            _draw_walls(axis, walls_of(tables, number))
    caption = "Members' ways, blue at the start and red at the end, as in figures 7.4 and 7.5."
    title = f"Environments that elicited {BEHAVIOURS[behaviour]}"
    return [draw.save(canvas, place, f"valid-{behaviour}", title, caption, dots=True)]


def _draw_walls(axis: Any, walls: Floats) -> None:
    from matplotlib.collections import LineCollection

    axis.add_collection(LineCollection(list(walls.reshape(-1, 2, 2)), **WALL, zorder=3))
    axis.set_aspect("equal", adjustable="datalim")
    axis.autoscale_view()
    axis.tick_params(labelsize=6)


def _draw_ways(axis: Any, ways: Floats) -> None:
    """Ways (T, N, 2), coloured by time."""
    from matplotlib.collections import LineCollection

    pieces = np.stack([ways[:-1], ways[1:]], axis=2)
    times = np.repeat(np.linspace(0.0, 1.0, len(pieces)), ways.shape[1])
    lines = LineCollection(list(pieces.reshape(-1, 2, 2)), cmap="coolwarm", lw=0.6, zorder=2)
    lines.set_array(times)
    axis.add_collection(lines)


def _of(run: Run, behaviour: str, law: str, preset: Preset) -> set[int]:
    """The numbers of the trials of a cell."""
    wanted = design.cell(behaviour, law, preset)
    return {trial.index for trial in run.trials if all(trial.conditions.get(k) == v for k, v in wanted.items())}


def _first(run: Run, behaviour: str, law: str) -> Trial | None:
    """The first finished trial of a law in its first preset."""
    for preset in PRESETS:
        numbers = _of(run, behaviour, law, preset)
        for trial in run.trials:
            if trial.index in numbers and _done(run, trial):
                return trial
    return None


def _done(run: Run, trial: Trial) -> bool:
    return any(row.index == trial.index and row.status == "done" for row in run.rows())
