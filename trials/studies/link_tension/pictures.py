"""Pictures of flocks with their links coloured by the index, as figures 4 and 5 of Akama and Naruse 2014."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.measures.links import link_tension, links_within
from flocking.types import Floats, Ints
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.figures import Canvas
from trials.reports.ways import first_result
from trials.simulations.kinematic import fields
from trials.simulations.kinematic.links import WITHIN
from trials.types import Trial, TrialResult

MOMENTS = (0, 1, 2)
"""Units of time."""
BREAKS, HOLDS, AGENT = "#d62728", "#1f4fd6", "#2ca02c"
"""As published: red, blue and green."""
SAME_M = 1e-9
"""A trial simulated again is the trial that was run if its last positions are the same, but for rounding."""


class Snapshot(NamedTuple):
    """Of N members with L links."""

    positions: Floats
    links: Ints
    """(L, 2)."""
    tension: Floats
    """(L,)."""


def flock(run: Run, rows: Sequence[tuple[str, Mapping[str, Any]]]) -> Canvas:
    """A row a setting, the first finished trial of it at each moment."""
    from matplotlib.collections import LineCollection

    canvas, axes = draw.grid(len(rows) * len(MOMENTS), len(MOMENTS), width=9.6, height=3.1)
    for row, (title, conditions) in enumerate(rows):
        taken = snapshots(first_result(run, conditions))
        for column, moment in enumerate(MOMENTS):
            axis = axes[row * len(MOMENTS) + column]
            axis.set_title(f"{title}, t = {moment}", loc="left")
            axis.set_aspect("equal", adjustable="datalim")
            axis.tick_params(labelsize=6)
            if taken is None:
                draw.absent(axis)
                continue
            at = taken[column]
            colours = np.where(at.tension > 0.0, BREAKS, HOLDS).tolist()
            axis.add_collection(LineCollection(list(at.positions[at.links]), colors=colours, lw=0.7, zorder=1))
            axis.plot(*at.positions.T, "o", color=AGENT, ms=2.2, mew=0.0, zorder=2)
    return canvas


def snapshots(result: TrialResult | None) -> list[Snapshot] | None:
    """The flock at each moment; None without a trial, or if it does not run again as it ran (another version's)."""
    if result is None or fields.links_of(result.trial) is None:
        return None
    trial, given = result.trial, fields.links_of(result.trial)
    assert given is not None
    positions, velocities, dt = again(trial)
    if not np.allclose(
        positions[:: fields.of_trial(trial).every][-1], result.poses_w[-1, :, :2], rtol=0.0, atol=SAME_M
    ):
        return None
    found = []
    for moment in MOMENTS:
        at = round(moment * given.unit_s / dt)
        if at >= len(positions):
            return None
        links = links_within(positions[at], given.range_m * WITHIN)
        index = link_tension(positions[at], velocities[at], links, given.range_m, given.rest_m)
        found.append(Snapshot(positions[at], links, index))
    return found


def again(trial: Trial) -> tuple[Floats, Floats, float]:
    """Positions and velocities (T, N, 2) of every step of a trial, and the time step."""
    from trials.simulations.kinematic.herd import assemble
    from trials.simulations.kinematic.loop import simulated

    herd = assemble(trial)
    history = simulated(trial, herd, 1)
    return history.positions_w, history.velocities_w, herd.fields.timestep_s
