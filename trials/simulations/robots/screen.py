"""The layout of a recording in the viewer: its views, what each shows, and the colours."""

from __future__ import annotations

import numpy as np
import rerun.blueprint as rrb

from flocking.types import Floats
from trials.simulations import views
from trials.simulations.robots import guided, recorded_cameras, recorded_echoes, recorded_tasks
from trials.simulations.robots.fields import of_group, of_trial
from trials.types import TrialResult

TRAIL_S = 15.0
"""How long the path behind a robot stays in sight, s."""
CONTACT_S = 1.5
"""How long a contact stays in sight, s."""

IDLE_COLOUR = 0x6B7280FF
"""Colour of the rule `none`."""
RULE_COLOURS = (0x3B9BFFFF, 0xFFB000FF, 0xDC267FFF, 0x44C26DFF, 0xA678F0FF, 0x2ED1C9FF)


LEGEND = """
- **disc**: a robot, to scale, in its own colour; **white arrow**: its heading; **white arc**: a pressed bumper
- **line behind it**: its way in the last 15 s; **faint line**: its whole way; **grey line**: a wall
- **small dots**: what its laser saw, from weak (dark) to strong (light); grey: without an intensity
- **larger dots** in its colour: the members that its detection gave to its law; **red**: one that is nobody
- **arrow in another colour**: to its way-point, in the colour of the rule that chose it (*Rule that acts*)
- **white dot**: something was touched there just now
"""
"""What is drawn, in Markdown."""


def legend(result: TrialResult) -> str:
    """What is drawn, in Markdown, with what a task brings."""
    cameras = recorded_cameras.LEGEND.lstrip("\n") if result.pictures is not None else ""
    echoes = recorded_echoes.LEGEND.lstrip("\n") if result.heard is not None else ""
    return LEGEND + echoes + cameras + (recorded_tasks.LEGEND.lstrip("\n") if guided.has_task(result.trial) else "")


def rule_names(result: TrialResult) -> list[str]:
    """All rules of the robots' laws, each once."""
    return list(dict.fromkeys(rule for rules in result.rules for rule in rules))


def rule_colours(result: TrialResult) -> dict[str, int]:
    """Packed colour of each rule."""
    speaking = [rule for rule in rule_names(result) if rule != "none"]
    colours = {rule: RULE_COLOURS[i % len(RULE_COLOURS)] for i, rule in enumerate(speaking)}
    return {"none": IDLE_COLOUR, **colours}


def blueprint(result: TrialResult) -> rrb.Blueprint:
    """Plan views and the rules on the left, plots and words on the right."""
    half_width, half_height = _reach(result)
    low, high = _ground(result)
    everything = ["+ /world/**"]
    left_out = ["scans/**", "echoes/**", "obstacles/**", "members/**", "way_points/**", "trails"]
    left_out += [f"robots/{name}/name" for name in result.robot_names]  # names would hide so small a herd
    close = views.plan(
        "Plan, following the herd",
        everything,
        (-half_width, half_width),
        (-half_height, half_height),
        {"world/trails": TRAIL_S, "world/contacts": CONTACT_S},
        origin="/herd",
    )
    whole = views.plan(
        "Whole way",
        [*everything, *(f"- /world/{entity}" for entity in left_out)],
        (low[0], high[0]),
        (-high[1], -low[1]),
        {"world/contacts": CONTACT_S},
    )
    states = rrb.Tabs(
        rrb.StateTimelineView(origin="/rules", name="Rule that acts"),
        rrb.StateTimelineView(origin="/bumpers", name="Bumpers"),
        rrb.TextLogView(origin="/events", name="Contacts"),
    )
    below = rrb.Horizontal(states, views.legend(), column_shares=[3, 2])
    task = [views.plot("Arrived and astray", ["/task_shares/**"], (0.0, 1.05))] if guided.has_task(result.trial) else []
    plots = [
        *task,
        views.plot("Order", ["/measures/polarization", "/measures/straightness"], (0.0, 1.05)),
        views.plot("Median distance from the centre (m)", ["/measures/mmd"]),
        views.plot("Speed of the group (m/s)", ["/measures/group_speed"]),
        views.plot("Number of groups", ["/measures/groups"], (0.0, len(result.robot_names) + 0.5)),
        rrb.Tabs(
            views.plot("Share of each rule", ["/rule_shares/**"], (0.0, 1.05)),
            views.plot("Distance to the nearest input (m)", ["/nearest_inputs/**"]),
            rrb.TextDocumentView(origin="/about", name="About"),
        ),
    ]
    return views.layout(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Horizontal(close, *recorded_cameras.views_of(result)), whole, below, row_shares=[5, 1.3, 2.9]
            ),
            rrb.Vertical(*plots, row_shares=[*([1] * (len(plots) - 1)), 1.7]),
            column_shares=[2, 1],
        )
    )


def about(result: TrialResult) -> str:
    """The trial in words (Markdown)."""
    trial, given = result.trial, of_trial(result.trial)
    groups = []
    for group in trial.groups:
        its = of_group(group)
        groups.append(f"{its.body}, {its.sensors} laser, {group.pipeline}, {group.law}")
    course = f"{trial.world}, formation {trial.formation}; {given.duration_s:g} s in steps of {given.timestep_s:g} s"
    return views.about(result, course, groups)


def _reach(result: TrialResult) -> tuple[float, float]:
    """Half width and half height (m) of the view that follows the herd: those of the herd, within bounds."""
    positions = result.poses_w[np.isfinite(result.poses_w).all(axis=(1, 2)), :, :2]
    if positions.size == 0:
        return 3.0, 1.6
    spread = np.abs(positions - positions.mean(axis=1, keepdims=True)).max(axis=1)
    width, height = np.median(spread, axis=0) + 0.6
    return float(np.clip(width, 2.5, 6.0)), float(np.clip(height, 1.4, 6.0))


def _ground(result: TrialResult) -> tuple[Floats, Floats]:
    """Lower and upper corner (2,), (2,) of the area where the robots went, with a margin, m."""
    positions = result.poses_w[..., :2].reshape(-1, 2)
    positions = positions[np.isfinite(positions).all(axis=1)]
    if len(positions) == 0:
        return np.array([-3.0, -2.0]), np.array([3.0, 2.0])
    return positions.min(axis=0) - 1.0, positions.max(axis=0) + 1.0
