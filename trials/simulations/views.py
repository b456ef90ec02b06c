"""The parts of a recording's layout in the viewer that all simulations share, and the trial in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import rerun.blueprint as rrb

from trials.simulations.columns import TIMELINE
from trials.types import TrialResult

BACKGROUND = [14, 17, 23]
Range = tuple[float, float]


def layout(views: rrb.Horizontal) -> rrb.Blueprint:
    """The views, with the time panel playing and the viewer's other panels folded."""
    return rrb.Blueprint(
        views,
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", play_state="playing", loop_mode="all"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )


def plan(
    name: str,
    contents: list[str],
    x_range: Range,
    y_range: Range,
    shown_s: Mapping[str, float],
    origin: str = "/",
) -> rrb.Spatial2DView:
    """A view from above. `shown_s`: by entity, for how long (s) what was logged stays in sight."""
    return rrb.Spatial2DView(
        origin=origin,
        contents=contents,
        name=name,
        background=BACKGROUND,
        visual_bounds=rrb.VisualBounds2D(x_range=x_range, y_range=y_range),
        overrides={entity: _last(seconds) for entity, seconds in shown_s.items()},
    )


def plot(name: str, entities: list[str], y_range: Range | None = None) -> rrb.TimeSeriesView:
    """A plot over time of the entities' series; with a legend where there may be several."""
    return rrb.TimeSeriesView(
        origin="/",
        contents=[f"+ {entity}" for entity in entities],
        name=name,
        axis_y=rrb.ScalarAxis(range=y_range) if y_range else None,
        plot_legend=rrb.PlotLegend(visible=len(entities) > 1 or entities[0].endswith("**")),
    )


def legend() -> rrb.TextDocumentView:
    """What is drawn, in words."""
    return rrb.TextDocumentView(origin="/legend", name="Legend")


def about(result: TrialResult, course: str, groups: Sequence[str]) -> str:
    """The trial in words (Markdown). `course`: its world, start and duration; `groups`: each in words."""
    trial = result.trial
    lines = [
        f"# {trial.experiment}, trial {trial.index}",
        f"Seed {trial.seed}, repeat {trial.repeat}; {course}.",
        f"**{result.outcome}**{': ' + result.reason if result.reason else ''}",
        "",
    ]
    lines += [f"- `{key}` = {value}" for key, value in trial.conditions.items()]
    lines += [f"- {group.count} x {group.name}: {words}" for group, words in zip(trial.groups, groups, strict=True)]
    if result.measures:
        lines += ["", "| measure | value |", "|---|---|"]
        lines += [f"| {name} | {value:.4g} |" for name, value in result.measures.items() if "/" not in name]
    return "\n".join(lines)


def _last(seconds: float) -> rrb.VisibleTimeRanges:
    """Shows what was logged in the last `seconds` before the time shown."""
    return rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-seconds),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
