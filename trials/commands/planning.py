"""`herd plan`: finds the walls that guide a herd through a task, or shows that no standing walls of a grid do."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from flocking.errors import InputError

if TYPE_CHECKING:
    from generation.group import Group
    from generation.piloting.plan import Plan
    from generation.piloting.task import Task


class Asked(NamedTuple):
    """What the command was asked for."""

    task: str
    law: str
    members: int
    static: bool
    exhaust: bool
    starts: int
    share: float
    budget: int
    seed: int
    settings: Mapping[str, Any]
    out: Path | None


def plan(asked: Asked) -> None:
    """Makes the plan and prints it; `out` gets it, or as much of it as was found. Raises `InputError`."""
    from flocking import lawentry, users_files
    from trials.commands import lawcheck

    if lawentry.is_path(asked.law):
        lawcheck.check(asked.law)
    with users_files.executed(True):
        _exhaust(asked) if asked.exhaust else _search(asked)


def _search(asked: Asked) -> None:
    from generation.piloting import members, planner
    from generation.piloting.plan import Plan

    task, group = _asked_for(asked)
    how = planner.Search(
        grid=_grid(asked.settings), starts=asked.starts, share=asked.share, budget=asked.budget, seed=asked.seed
    )
    begun = _begun(asked, task)
    progress = planner.Progress(say=lambda line: print(line, file=sys.stderr))
    try:
        found = planner.search(task, group, members.STEP_M, how, asked.static, progress, begun)
    except InputError:
        part = progress.best is not None and len(progress.best.walls) < len(task.turns)  # else it guided no new herds
        if part and progress.best is not None and asked.out is not None:
            _write(asked, progress.best, progress.simulations)
            print(
                f"{len(progress.best.walls)} walls are kept in {asked.out}: the same command goes on", file=sys.stderr
            )
        raise
    _write(asked, found, progress.simulations)
    print(_told(task, found, progress.simulations))
    other = Plan(found.task, not found.static, found.walls)
    shares = {kept.static: _share(task, kept, group, asked) for kept in (found, other)}
    print(f"of 20 new herds {shares[True]:.2f} arrive while all walls stand, {shares[False]:.2f} while two do")


def _exhaust(asked: Asked) -> None:
    from generation.piloting import chain, members, static
    from generation.piloting.planner import USUAL

    task, group = _asked_for(asked)
    states = chain.starts(task, group.count, asked.starts, asked.seed, USUAL.side_m, USUAL.apart_m)
    grid = _grid(asked.settings)

    def say(tried: int, sets: int) -> None:
        if tried % 1000 == 0:
            print(f"{tried} walls and sets of walls tried", file=sys.stderr)

    found = static.exhaust(task, group, states, members.STEP_M, members.SEES_M, grid, asked.share, say)
    lengths = ", ".join(f"{length:g}" for length in grid.lengths_m)
    print(
        f"{task.name}: {found.sets:,} sets of one wall a turn, {lengths} m long, every {grid.angle_step_deg:g} degrees"
    )
    print(f"{found.tried:,} stages simulated; the best set guides {found.best:.2f} of the members to the goal")
    if found.plan is not None and asked.out is not None and found.best >= asked.share:
        _write(asked, found.plan, found.tried)


def _asked_for(asked: Asked) -> tuple[Task, Group]:
    from generation.piloting import members, task

    own = {key.removeprefix("law."): value for key, value in asked.settings.items() if key.startswith("law.")}
    return task.load(asked.task), members.group(asked.law, asked.members, own)


def _grid(settings: Mapping[str, Any]) -> Any:
    from generation.piloting.planner import Grid

    known = {"grid.angle_step_deg", "grid.lengths_m"}
    for key in settings:
        if not key.startswith("law.") and key not in known:
            raise InputError(f"--set {key}: expected a key of law.*, {' or '.join(sorted(known))}")
    grid = Grid()
    step = settings.get("grid.angle_step_deg", grid.angle_step_deg)
    lengths = settings.get("grid.lengths_m", list(grid.lengths_m))
    numbers = [step, *(lengths if isinstance(lengths, list) else [None])]
    if not all(isinstance(each, int | float) and not isinstance(each, bool) and 0 < each <= 360 for each in numbers):
        raise InputError(
            f"--set grid: {step!r}, {lengths!r}: expected degrees above 0, and lengths in m as in [1.5, 2.12]"
        )
    if len(numbers) < 2:
        raise InputError("--set grid.lengths_m=[]: expected a length at least, as in [1.5, 2.12]")
    return grid._replace(angle_step_deg=float(step), lengths_m=tuple(float(each) for each in lengths))


def _begun(asked: Asked, task: Task) -> Plan | None:
    """The partial plan of an earlier search in `out`. Raises `InputError` for what is none, or is whole."""
    from generation.piloting import plan as plans

    if asked.out is None or not os.path.lexists(asked.out):
        return None
    found = plans.read(asked.out)
    if found.task != task.name or found.static != asked.static or len(found.walls) >= len(task.turns):
        kind = "static" if found.static else "changing"
        raise InputError(
            f"--out {asked.out}: a {kind} plan of {found.task} with {len(found.walls)} walls; expected a new file, or "
            f"a partial plan of {task.name} to go on with"
        )
    return replace(found, task=task.name)


def _share(task: Task, found: Plan, group: Group, asked: Asked) -> float:
    """Of the members of new herds, how many a plan guides to the goal."""
    from generation.piloting import chain, members
    from generation.piloting.planner import USUAL

    fresh = chain.starts(task, group.count, 20, asked.seed + 1000, USUAL.side_m, USUAL.apart_m)
    return chain.share(chain.follow(task, found, group, fresh, members.STEP_M)[-1])


def _write(asked: Asked, found: Plan, simulations: int) -> None:
    from generation.piloting import plan as plans
    from trials.batch.folders import write_whole

    if asked.out is None:
        return
    told = {"law": asked.law, "members": asked.members, "seed": asked.seed, "simulations": simulations}
    write_whole(asked.out, plans.to_json(found, told).encode())


def _told(task: Task, found: Plan, simulations: int) -> str:
    from generation.piloting import plan as plans

    lines = [f"{'turn':>4}  {'anchor':>6}  {'angle':>9}  {'length':>7}  share"]
    for number, (wall, share) in enumerate(zip(found.walls, found.shares, strict=True), 1):
        lines.append(f"{number:>4}  {wall.anchor:>6}  {wall.angle_deg:>5g} deg  {wall.length_m:>5g} m  {share:.2f}")
    kind = "standing" if found.static else "changing"
    lines.append(f"{task.name}: {len(found.walls)} {kind} walls, {simulations} simulations of a stage")
    lines.append(f"a trial's: --set 'piloting.walls=\"{plans.words(found.walls)}\"'")
    return "\n".join(lines)
