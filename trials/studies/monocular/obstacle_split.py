"""Three and six Pioneers and a round post in their way: do they part, pass on both sides and join again?

Kirchner 2006, section 5.1, names obstacles other than flockmates, by sonar or by vision, as an extension, and flocks
elsewhere that part before one and join behind it; it has neither a test nor a number of its own. Here the sonars find
the post, and the avoidance that all laws share (docs/architecture.md) turns the motion that the law gives. The control
is the same floor without the post; perfect sensing, with the cameras' view, stands beside the images.

The robots start in two columns in line of the post, so that it divides them; those in front see nobody.
"""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import Path

from flocking.measures import formation
from flocking.parameters import Parameter
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.simulations.robots.fields import AVOID, trial
from trials.simulations.robots.measures_splitting import REACH_M
from trials.studies.monocular.design import FOOT, HERD, LAW, from_the_lens, seeing
from trials.studies.monocular.flock_claims import COUNT, ONE, PERFECT, PIPELINE
from trials.studies.monocular.monocular_flock import VIEW
from trials.types import Trial, Value

REPEATS = 10
RECORD = "first"
WORLD = "world"
POST, OPEN = "post", "open-floor"
CONDITIONS = {WORLD: (POST, OPEN), COUNT: (3, 6), PIPELINE: (ONE, PERFECT)}
SOURCES = {
    WORLD: Parameter("", "Kirchner 2006, section 5.1, names obstacles; the post is ours"),
    COUNT: Parameter("robots", "Kirchner 2006 has three; six are ours", published=True),
    PIPELINE: Parameter("", "Kirchner 2006, sections 3.6.4 to 3.6.6; perfect sensing is ours"),
    f"{HERD}.obstacles": Parameter("", "Kirchner 2006, section 5.1, names it; the avoidance is ours"),
    "duration_s": Parameter("s", "Kirchner 2006, section 3.3: one minute", published=True),
    f"{HERD}.rate_hz": Parameter("Hz", "a choice: the cameras' bound is 60"),
}
KEY_MEASURES = (
    "split", "flocks_most", "split_s", "rejoined", "apart_s", "flocks", "wall_collisions", "member_collisions",
)  # fmt: skip
SECONDS = 60.0
APART_M = 1.0
"""From robot to robot, along and across: within the ideal distance, and within the four feet that divide flocks."""
AVOIDING: dict[str, Value] = {"avoidance.margin_m": 0.45, "avoidance.look_ahead_m": 1.2}
"""Of Pioneers: a choice. The outline's radius of 0.31 m with a little more to spare than the Create's, and what it
drives in 3 s at twice the speed that it starts with."""

QUICK: dict[str, Value] = {"cameras.height_px": 160, "cameras.judged": False}
"""The middle third of the thesis's 480 rows: the widest row of a cone lies on the horizon, in the middle."""


def base(repeat: int) -> Trial:
    """Pioneers in two columns, which head for the post."""
    herd = seeing(3, formation="together", obstacles=AVOID)
    kept = {key: value for key, value in herd.setup.items() if not key.startswith("formation.")}
    herd = dataclasses.replace(
        herd, setup={**kept, **AVOIDING, **QUICK}, law_parameters={**LAW, "range_m": 8 * FOOT, "nearest_only": True}
    )
    placed: dict[str, Value] = {"spacing_m": APART_M, "jitter_m": 0.05, "heading_spread_deg": 2.0}
    return trial(
        "obstacle-split", repeat, [herd], world=POST, formation="single-group", formation_parameters=placed,
        duration_s=SECONDS,
    )  # fmt: skip


def finish(trial: Trial) -> Trial:
    """Perfect sensing has the cameras' view; images have distances from the lens."""
    (herd,) = trial.groups
    view = VIEW if herd.pipeline == PERFECT else {}
    herd = from_the_lens(dataclasses.replace(herd, pipeline_parameters={**view, **herd.pipeline_parameters}))
    return dataclasses.replace(trial, groups=(herd,))


def figures(run: Run, folder: Path) -> list[Figure]:
    """The ways in the first trial of each cell, and how many flocks there were at each time."""
    return by_arm(run, folder, tuple(CONDITIONS), _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    cells = list(itertools.product(*CONDITIONS.values()))
    wanted = [(f"{world}, {count}, {pipeline}", (world, count, pipeline)) for world, count, pipeline in cells]
    shown = panels(run, [(told, dict(zip(CONDITIONS, cell, strict=True))) for told, cell in wanted])
    ways = draw.save(
        draw.trajectories(shown, columns=2), place, "ways", "Ways", "First trials; a dot where each robot ends."
    )
    canvas, axes = draw.grid(len(shown), 4, width=9.6, height=1.8)
    for axis, (told, result) in zip(axes, shown, strict=True):
        axis.set_title(told.replace(", ", ",\n", 1), loc="left", fontsize=7)
        if result is None or len(result.times) == 0:
            draw.absent(axis)
            continue
        axis.step(result.times, formation.number_of_groups(result.poses_w[..., :2], REACH_M), color="black", lw=1.0)
        axis.set_ylim(0.0, len(result.robot_names) + 0.5)
        axis.set_xlabel("time (s)")
    caption = "Numbers of flocks in the first trials. Flocks are divided by gaps of more than eight feet."
    return [ways, draw.save(canvas, place, "flocks", "Flocks over time", caption)]


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "figures", "finish"]
