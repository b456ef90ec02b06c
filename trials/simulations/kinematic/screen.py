"""The layout of a kinematic trial's recording in the viewer."""

from __future__ import annotations

import numpy as np
import rerun.blueprint as rrb
from numpy.typing import NDArray

from trials.simulations import views
from trials.simulations.columns import MEMBER_COLOURS
from trials.simulations.kinematic import fields
from trials.simulations.tracks import period_of
from trials.types import TrialResult

TRAIL_SHARE = 0.1
"""How long the path behind a member stays in sight, as a share of the trial."""
TRAIL_COLOUR = 0x8FA3B880
MARK_SHARE = 0.25
"""Drawn size of a member without a radius, as a share of the spacing at the start."""


def size_of(result: TrialResult) -> float:
    """Length of a member's arrow, m."""
    largest = float(result.radii.max(initial=0.0))
    return 2.0 * largest if largest > 0.0 else MARK_SHARE * fields.spacing_of(result.trial)


def colours(result: TrialResult) -> NDArray[np.uint32]:
    """(N,) packed: one colour for the informed of a group and one for its others; few members each have their own."""
    groups = result.trial.groups
    if len(result.robot_names) <= len(MEMBER_COLOURS):
        return MEMBER_COLOURS[: len(result.robot_names)]
    kinds: list[int] = []
    for number, group in enumerate(groups):
        informed = round(fields.of_group(group).informed_share * group.count)
        kinds += [2 * number] * informed + [2 * number + 1] * (group.count - informed)
    return MEMBER_COLOURS[np.array(kinds) % len(MEMBER_COLOURS)]


def legend(result: TrialResult) -> str:
    """What is drawn, in Markdown."""
    if len(result.robot_names) <= len(MEMBER_COLOURS):
        colours = "each in its own colour"
    else:
        colours = "in one colour for each group, and for those of it that know the goal"
    sized = "to scale" if (result.radii > 0.0).any() else "points without a size"
    lines = [
        f"- **dot**: a member, {sized}, {colours}; **white arrow**: its heading",
        "- **line behind it**: its way in the last tenth of the trial",
    ]
    if len(result.walls_w):
        lines.append("- **grey line**: a wall")
    if period_of(result) is not None:
        lines.append("- **grey square**: the border of the world, whose opposite sides are one")
    return "\n".join(lines)


def blueprint(result: TrialResult) -> rrb.Blueprint:
    """The plane on the left, plots and words on the right."""
    positions = result.poses_w[..., :2].reshape(-1, 2)
    positions = positions[np.isfinite(positions).all(axis=1)]
    margin = 2.0 * size_of(result)
    ends = np.concatenate([positions, result.walls_w.reshape(-1, 2), np.zeros((1, 2))])
    low, high = ends.min(axis=0) - margin, ends.max(axis=0) + margin
    span = float(result.times[-1]) * TRAIL_SHARE if len(result.times) else 0.0
    plane = views.plan("Plane", ["+ /world/**"], (low[0], high[0]), (-high[1], -low[1]), shown_s={"world/trails": span})
    plots = [
        views.plot("Order and unity", ["/measures/polarization", "/measures/largest_share"], (0.0, 1.05)),
        views.plot("Median distance from the centre (m)", ["/measures/mmd"]),
        views.plot("Number of groups", ["/measures/groups"]),
        rrb.Tabs(
            views.plot("Net displacement of the centre (m)", ["/measures/net_displacement"]),
            rrb.TextDocumentView(origin="/about", name="About"),
        ),
    ]
    left = rrb.Vertical(plane, views.legend(), row_shares=[7, 1])
    return views.layout(rrb.Horizontal(left, rrb.Vertical(*plots), column_shares=[2, 1]))


def about(result: TrialResult) -> str:
    """The trial in words (Markdown)."""
    trial, given = result.trial, fields.of_trial(result.trial)
    order = "synchronous" if given.synchronous else "asynchronous"
    course = (
        f"{fields.space_of(trial)} space, formation {trial.formation}; "
        f"{given.steps} {order} steps of {given.timestep_s:g} s"
    )
    return views.about(
        result, course, [f"{group.law}, {group.pipeline}, selection {group.selection}" for group in trial.groups]
    )
