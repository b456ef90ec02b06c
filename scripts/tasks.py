"""Draws the tasks of piloting with the walls of their plans: docs/tasks.png (`python -m scripts.tasks`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.formations import slots
from trials.reports import figures as draw

PICTURE = Path(__file__).parents[1] / "docs" / "tasks.png"


def main() -> None:
    """Draws all tasks that come with the project."""
    names = tasks.names()
    canvas, axes = draw.grid(len(names), len(names), width=2.6 * len(names), height=2.9)
    for axis, name in zip(axes, names, strict=True):
        panel(axis, name)
    canvas.savefig(PICTURE, dpi=110)


def panel(axis: Any, name: str) -> None:
    """A task: its workspace, start, goal and trajectory, its plan's walls with their numbers and places for robots."""
    task, plan = tasks.load(name), plans.shipped(name)
    for x0, y0, x1, y1 in task.environment.walls():
        axis.plot([x0, x1], [y0, y1], color="#888888", lw=0.7)
    axis.fill(*task.goal.T, color="#009e73", alpha=0.25, lw=0.0)
    axis.plot(task.start.x_m, task.start.y_m, "o", color="#0072b2", ms=5)
    axis.plot(*task.trajectory.T, ":", color="black", lw=1.2)
    for number, wall in enumerate(plan.walls, 1):
        segment = wall.segment(task)
        axis.plot(segment[::2], segment[1::2], color="#f0c000", lw=2.5)
        axis.plot(*slots(segment).T, "o", color="#d55e00", ms=3)
        middle = (segment[::2].mean(), segment[1::2].mean())
        axis.annotate(str(number), middle, xytext=(4, 4), textcoords="offset points")
    axis.set_title(f"{name}, {'all walls stand' if plan.static else 'walls change'}", loc="left")
    axis.set_aspect("equal")
    axis.set_xticks([])
    axis.set_yticks([])


if __name__ == "__main__":
    main()
