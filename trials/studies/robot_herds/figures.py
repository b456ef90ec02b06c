"""Figures 5 to 8 of Hodgins and Brogan 1994 redrawn, and what they put in words as curves."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from trials.evidence.runs import Run
from trials.evidence.statistics import mean_interval
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Canvas, Figure, Place
from trials.reports.ways import curve_of, curves, first_result
from trials.simulations.running import fields, script
from trials.simulations.running.measures import centres_of
from trials.studies.robot_herds.design import AHEAD, BODIES, BODY, BREAKAWAY, GAP, SELECTION, VELOCITIES, VISIBLE
from trials.types import TrialResult

HERD, USER, FALLEN = "#333333", "#d62728", "#999999"
DISTURBANCES = {
    "ground.friction": "friction of the foot",
    "ground.uneven_m": "heights of the ground, std (m)",
    "push.impulse_n_s": "pushes every 10 s (N s)",
    "herd.imperfections.torque_n_m": "most torque at the hip (N m)",
    "herd.imperfections.velocity_m_s": "noise of the velocity (m/s)",
    "herd.imperfections.angle_deg": "noise of angles (deg)",
    "herd.imperfections.rate_deg_s": "noise of turn rates (deg/s)",
    "herd.imperfections.delay_s": "delay (s)",
}
"""What `herd-disturbed` varies, in words."""
EVERY_S = 100.0
"""From one snapshot to the next, figure 5."""


def steady_figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 5: the herd at the start and every 100 s."""
    return by_arm(run, folder, (BODY,), _steady)


def _steady(run: Run, place: Place) -> list[Figure]:
    results = [(body, first_result(run, {BODY: body})) for body in BODIES]
    moments = [0.0, 1.0, 2.0, 3.0]
    canvas, axes = draw.grid(len(results) * len(moments), len(moments), width=9.6, height=2.5, share=True)
    for row, (body, result) in enumerate(results):
        for column, number in enumerate(moments):
            axis = axes[row * len(moments) + column]
            axis.set_title(f"{body}, {number * EVERY_S:g} s", loc="left")
            axis.set_aspect("equal", adjustable="box")
            if result is None or result.times[-1] < number * EVERY_S - 1e-6:
                draw.absent(axis)
                continue
            t = int(np.abs(result.times - number * EVERY_S).argmin())
            _herd(axis, result, t, centres_of(result)[t])
    caption = "Places from the herd's centre (m), one trial of each; red: the user's creature. As figure 5."
    return [draw.save(canvas, place, "herds", "The herds every 100 s", caption, dots=True)]


def acceleration_figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 6: the herd where the velocity changes, and the way of the user's creature."""
    return by_arm(run, folder, (BODY,), lambda part, place: [_course(part, place, "as figure 6", 2.4)])


def zigzag_figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 7: the same of the zigzag."""
    return by_arm(
        run, folder, (BODY,), lambda part, place: [_course(part, place, "as figure 7", 4.0), _collided(part, place)]
    )


def _course(run: Run, place: Place, words: str, height: float) -> Figure:
    """Snapshots at the begin of the test, at each change and at the end, on the way of the user's creature."""
    canvas, axes = draw.grid(len(BODIES), 1, width=9.6, height=height)
    for axis, body in zip(axes, BODIES, strict=True):
        result = first_result(run, {BODY: body})
        axis.set_title(body, loc="left")
        axis.set_aspect("equal", adjustable="datalim")
        if result is None:
            draw.absent(axis)
            continue
        given = fields.of_trial(result.trial)
        changes = [given.settle_s + leg.from_s for leg in script.parse(given.script)]
        first = int(np.abs(result.times - given.settle_s).argmin())
        origin = centres_of(result)[first]
        axis.plot(*(result.poses_w[first:, 0, :2] - origin).T, color=USER, lw=0.7, zorder=1)
        for time in (*changes, result.times[-1]):
            _herd(axis, result, int(np.abs(result.times - time).argmin()), origin)
        axis.set_ylabel("y (m)")
    axes[-1].set_xlabel("x (m)")
    caption = (
        "The herd where its user's creature is told another velocity, and at the end; red: that creature and its way; "
        f"{words}."
    )
    return draw.save(canvas, place, "course", "The herds on their course", caption, dots=True)


def _collided(run: Run, place: Place) -> Figure:
    """How many collisions there have been, over the time of the test."""
    canvas, (axis,) = draw.grid(1, 1, width=6.4, height=3.0)
    done = {row.index for row in run.rows() if row.status == "done"}
    for rank, body in enumerate(BODIES):
        own = [t for t in run.trials if t.index in done and t.conditions.get(BODY) == body]
        times: list[Floats] = []
        for trial in own:
            with suppress(InputError):  # its file is lost
                times.append(run.series(trial.index).contacts.times - fields.of_trial(trial).settle_s)
        if times:
            at = np.sort(np.concatenate(times))
            label = f"{body}, mean of {len(times)} trials"
            end = fields.of_trial(own[0]).duration_s - fields.of_trial(own[0]).settle_s
            counts = np.arange(1, len(at) + 1) / len(times)
            axis.step([0.0, *at, end], [0.0, *counts, *counts[-1:], *[0.0] * (not len(at))], where="post",
                      color=draw.SERIES_COLOURS[rank], lw=0.9, label=label)  # fmt: skip
    axis.set_xlabel("time of the test (s)")
    axis.set_ylabel("collisions so far")
    axis.legend(frameon=False)
    caption = "Collisions at the trial's `collision_m`, counted from the test's begin, a trial on average."
    return draw.save(canvas, place, "collided", "Collisions over time", caption)


def breakaway_figures(run: Run, folder: Path) -> list[Figure]:
    """How large the largest group is at the end, by how many start apart."""
    return by_arm(run, folder, (BREAKAWAY, GAP, BODY), _breakaway)


def _breakaway(run: Run, place: Place) -> list[Figure]:
    gaps = sorted({trial.conditions[GAP] for trial in run.trials if GAP in trial.conditions})
    panels = {
        f"{body}": [
            curve_of(run, "largest_share_end", BREAKAWAY, f"gap of {gap:g} m", {BODY: body, GAP: gap}) for gap in gaps
        ]
        for body in BODIES
    }
    caption = "Share of the herd in its largest group after a minute; means over the trials with 95 % intervals."
    drawn = curves(panels, "creatures that start behind", bounds=(0.0, 1.05))
    return [draw.save(drawn, place, "breakaway", "Who rejoins", caption)]


def obstacle_figures(run: Run, folder: Path) -> list[Figure]:
    """Figure 8: the ways of all creatures about the obstacle."""
    return by_arm(run, folder, (AHEAD, BODY), _obstacle)


def _obstacle(run: Run, place: Place) -> list[Figure]:
    levels = sorted({trial.conditions[AHEAD] for trial in run.trials if AHEAD in trial.conditions})
    cells = [(ahead, body) for ahead in levels for body in BODIES]
    if not cells:
        return []
    canvas, axes = draw.grid(len(cells), len(BODIES), width=9.6, height=2.4, share=True)
    for axis, (ahead, body) in zip(axes, cells, strict=True):
        result = first_result(run, {AHEAD: ahead, BODY: body})
        axis.set_title(f"{body}, {ahead:g} m ahead", loc="left")
        axis.set_aspect("equal", adjustable="box")
        if result is None:
            draw.absent(axis)
            continue
        _ways(axis, result)
    caption = (
        "The ways of all creatures from left to right for 20 s from when the obstacle appears, first trials; red: the "
        "user's creature. As figure 8."
    )
    return [draw.save(canvas, place, "obstacle", "Ways about the obstacle", caption, dots=True)]


def _ways(axis: Any, result: TrialResult) -> None:
    from matplotlib.collections import LineCollection

    given = fields.of_trial(result.trial)
    shown = (result.times >= given.settle_s - 1e-9) & (result.times <= given.settle_s + 20.0)
    places = result.poses_w[shown][:, :, :2]
    origin = places[0].mean(axis=0)
    ways = np.moveaxis(places - origin, 1, 0)
    axis.add_collection(LineCollection(list(ways[1:]), colors=HERD, lw=0.3))
    axis.plot(*ways[0].T, color=USER, lw=0.7)
    axis.add_collection(LineCollection(list(result.walls_w.reshape(-1, 2, 2) - origin), colors="black", lw=1.2))
    axis.set_xlim(-10.0, 45.0)
    axis.set_ylim(-12.0, 12.0)


def _herd(axis: Any, result: TrialResult, moment: int, origin: Floats) -> None:
    """The places of all at one moment, from `origin`."""
    places = result.poses_w[moment, :, :2] - origin
    fallen = result.tables["fallen_s"] <= result.times[moment]
    axis.plot(*places[~fallen].T, ".", color=HERD, ms=2.0, mew=0.0)
    axis.plot(*places[fallen].T, "x", color=FALLEN, ms=2.5)
    axis.plot(*places[0], "o", color=USER, ms=2.5, mew=0.0)


def visible_figures(run: Run, folder: Path) -> list[Figure]:
    """Stability over the number of visible creatures."""
    return by_arm(run, folder, (VISIBLE, BODY), _visible)


def _visible(run: Run, place: Place) -> list[Figure]:
    shown = {
        "unrest": "deviation of velocities (m/s)",
        "largest_share_end": "share in the largest group",
        "radius_end": "outer radius (m)",
    }
    panels = {
        title: [curve_of(run, measure, VISIBLE, body, {BODY: body}) for body in BODIES]
        for measure, title in shown.items()
    }
    caption = "Means over the trials with 95 % intervals, of 40 s."
    return [draw.save(curves(panels, "visible creatures", logarithmic=True), place, "visible", "Stability", caption)]


def perception_figures(run: Run, folder: Path) -> list[Figure]:
    """How fast the herds run, by what is seen and told."""
    return by_arm(run, folder, (SELECTION, VELOCITIES, BODY), _perception)


def _perception(run: Run, place: Place) -> list[Figure]:
    cells = sorted({(str(t.conditions.get(SELECTION)), str(t.conditions.get(VELOCITIES))) for t in run.trials})
    canvas = _speeds(run, [{SELECTION: selection, VELOCITIES: velocities} for selection, velocities in cells])
    caption = "Speed of the herd's centre over 2 s, first trial of each; dashed: what its user's creature is told."
    return [draw.save(canvas, place, "speeds", "How fast the herds run", caption)]


def personality_figures(run: Run, folder: Path) -> list[Figure]:
    """The spread of the gains against what it does."""
    keys = ("herd.spread.kp_per_s", "herd.place_error_m", BODY)
    return by_arm(run, folder, keys, _personality)


def _personality(run: Run, place: Place) -> list[Figure]:
    over, error = "herd.spread.kp_per_s", "herd.place_error_m"
    errors = sorted({trial.conditions[error] for trial in run.trials if error in trial.conditions})
    shown = {"unrest": "deviation of velocities (m/s)", "radius_end": "outer radius (m)"}
    panels = {
        title: [
            curve_of(run, measure, over, f"{body}, errors of {each:g} m", {BODY: body, error: each})
            for body in BODIES
            for each in errors
        ]
        for measure, title in shown.items()
    }
    caption = "Means over the trials with 95 % intervals; the spring's gain spread uniformly by this share."
    return [draw.save(curves(panels, "spread of k_p"), place, "personality", "Different creatures", caption)]


def disturbed_figures(run: Run, folder: Path) -> list[Figure]:
    """The share that stays upright against each disturbance."""
    return by_arm(run, folder, tuple(DISTURBANCES), lambda arm, place: [_disturbed(arm, place)])


def _disturbed(run: Run, place: Place) -> Figure:
    """A panel for each disturbance, along which the others are as in the run's first cell."""
    usual = {key: run.trials[0].conditions[key] for key in DISTURBANCES if key in run.trials[0].conditions}
    canvas, axes = draw.grid(len(DISTURBANCES), 4, width=9.6, height=5.0)
    for axis, (key, title) in zip(axes, DISTURBANCES.items(), strict=True):
        alone = {other: value for other, value in usual.items() if other != key}
        curve = curve_of(run, "upright", key, "", alone)
        means = np.array([mean_interval(values) for values in curve.values]).reshape(-1, 3)
        axis.plot(curve.x, means[:, 0], "-o", color=draw.SERIES_COLOURS[0], ms=2.5, lw=0.9)
        axis.vlines(curve.x, means[:, 1], means[:, 2], color=draw.SERIES_COLOURS[0], lw=0.9)
        axis.set_title(title, loc="left")
        axis.set_ylim(-0.05, 1.1)
        if key.endswith("torque_n_m"):
            axis.set_xscale("log")
    caption = (
        "Share of the robots that are upright at the end, means over the trials with 95 % intervals; one thing at a "
        "time. A torque of 300 N m is the control's own bound."
    )
    return draw.save(canvas, place, "upright", "Upright against each disturbance", caption)


def _speeds(run: Run, cells: Sequence[dict[str, Any]]) -> Canvas:
    canvas, axes = draw.grid(len(cells), min(4, len(cells)), width=9.6, height=2.4, share=True)
    for axis, cell in zip(axes, cells, strict=True):
        axis.set_title(", ".join(str(value) for value in cell.values()), loc="left")
        axis.set_xlabel("time (s)")
        for rank, body in enumerate(BODIES):
            result = first_result(run, {**cell, BODY: body})
            if result is None:
                continue
            lag = max(1, int(np.searchsorted(result.times, 2.0)))
            centre = centres_of(result)
            if len(centre) <= lag:
                continue
            speeds = np.hypot(*(centre[lag:] - centre[:-lag]).T) / (result.times[lag:] - result.times[:-lag])
            axis.plot(result.times[lag:], speeds, color=draw.SERIES_COLOURS[rank], lw=0.8, label=body)
            told = script.at(script.parse(fields.of_trial(result.trial).script), 0.0).speed
            axis.axhline(told, color="#999999", ls="--", lw=0.6)
    handles, labels = axes[0].get_legend_handles_labels()
    if labels:
        canvas.legend(handles, labels, loc="outside upper center", ncols=2, frameon=False)
    return canvas
