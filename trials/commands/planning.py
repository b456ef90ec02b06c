"""`herd plan`: finds the walls that guide a herd through a task, or shows that no standing walls of a grid do."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from flocking.errors import InputError, unknown_name

if TYPE_CHECKING:
    from generation.group import Group
    from generation.piloting.plan import Judged, Plan
    from generation.piloting.planner import Grid, Progress, Search
    from generation.piloting.task import Task


FINEST_DEG = 0.5
"""Steps of angle below this make more walls at a turn than anybody waits for."""


class Asked(NamedTuple):
    """What the command was asked for."""

    task: str
    law: str
    members: int
    body: str | None
    static: bool
    exhaust: bool
    starts: int
    share: float
    budget: int
    seed: int
    jobs: int
    settings: Mapping[str, Any]
    out: Path | None


def plan(asked: Asked) -> None:
    """Makes the plan and prints it; `out` gets it, or as much of it as was found. Raises `InputError`."""
    from flocking import lawentry, users_files
    from robots import body as bodies
    from trials.commands import lawcheck

    _check_out(asked.out)  # refused before the search begins, as all that follows
    if asked.body is not None:
        bodies.load(asked.body)
    if lawentry.is_path(asked.law):
        lawcheck.check(asked.law)
    with users_files.executed(True):
        _exhaust(asked) if asked.exhaust else _search(asked)


def _check_out(out: Path | None) -> None:
    """Raises `InputError` for a place to which no plan can be written."""
    if out is None:
        return
    folder = out.absolute().parent
    if out.is_dir() or not folder.is_dir() or not os.access(folder, os.W_OK):
        raise InputError(f"--out {out}: expected the name of a file, in a folder that exists and can be written")


def _how(asked: Asked) -> Search:
    from generation.piloting.planner import Search

    return Search(
        grid=_grid(asked.settings), starts=asked.starts, share=asked.share, budget=asked.budget, seed=asked.seed
    )


def _search(asked: Asked) -> None:
    from generation.piloting import chain, members, planner
    from generation.piloting.plan import Plan

    task, group = _asked_for(asked)
    how = _how(asked)
    begun = _begun(asked, task)
    progress = planner.Progress(say=lambda line: print(line, file=sys.stderr))
    try:
        found = planner.search(
            task, group, members.STEP_M, how, asked.static, progress, begun, _robots(asked, group.count)
        )
    except (InputError, KeyboardInterrupt) as ended:
        print(_kept(asked, task, progress, ended), file=sys.stderr)
        raise
    _write(asked, found, progress.simulations)
    print(_told(asked, task, found, progress.simulations))
    other = Plan(found.task, not found.static, found.walls)
    fresh = planner.fresh_herds(task, group.count, how)
    judged = {found.static: found.judged, other.static: chain.judge(task, other, group, fresh, members.STEP_M)}
    shares = {static: _interval(each) for static, each in judged.items() if each is not None}
    print(f"of {how.herds} new herds {shares[True]} arrive while all walls stand, {shares[False]} while two do")


def _interval(judged: Judged) -> str:
    return f"{judged.share:.2f} [{judged.low:.2f}, {judged.high:.2f}]"


def _kept(asked: Asked, task: Task, progress: Progress, ended: BaseException) -> str:
    """Keeps the longest chain of walls that a search found which has no plan, and says so in a line."""
    from generation.piloting.planner import BudgetSpentError

    part = progress.best
    if part is not None and len(part.walls) == len(task.turns):  # a whole one that guided too few new herds
        part = replace(part, walls=part.walls[:-1], shares=part.shares[:-1])
    if part is None or not part.walls:
        return "no wall was found yet: there is nothing to keep"
    if asked.out is None:
        return f"{len(part.walls)} walls were found; --out FILE keeps them"
    _write(asked, part, progress.simulations)
    goes_on = "the same command goes on from them"
    if isinstance(ended, BudgetSpentError):
        goes_on = "the same command with a larger --budget goes on from them"
    elif isinstance(ended, InputError):
        goes_on = "the same command with a finer grid (--set grid.angle_step_deg=…) goes on from them"
    return f"{len(part.walls)} walls are kept in {asked.out}: {goes_on}"


def _exhaust(asked: Asked) -> None:
    from generation.piloting import chain, members, static
    from generation.piloting.planner import USUAL, fresh_herds

    if asked.body is not None:
        raise InputError(f"--body {asked.body} with --exhaust: expected one; all sets are tried by kinematic herds")
    task, group = _asked_for(asked)
    states = chain.starts(task, group.count, asked.starts, asked.seed, USUAL.side_m, USUAL.apart_m)
    grid = _grid(asked.settings)

    def say(tried: int, sets: int) -> None:
        print(f"{tried:,} stages tried, of {sets:,} sets", file=sys.stderr)

    found = static.exhaust(task, group, states, members.STEP_M, members.SEES_M, grid, asked.budget, say)
    lengths = ", ".join(f"{length:g}" for length in grid.lengths_m)
    print(
        f"{task.name}: {found.sets:,} sets of one wall a turn, {lengths} m long, every {grid.angle_step_deg:g} degrees"
    )
    print(f"{found.tried:,} stages simulated; the best set guides {found.best:.2f} of the members to the goal")
    if asked.out is not None:
        if found.plan is None:
            print(f"no set guides anybody: nothing is kept in {asked.out}")
        else:
            fresh = fresh_herds(task, group.count, _how(asked))
            judged = chain.judge(task, found.plan, group, fresh, members.STEP_M)
            print(f"of {judged.herds} new herds {_interval(judged)} arrive among its walls")
            _write(asked, replace(found.plan, judged=judged), found.tried * asked.starts)


def _asked_for(asked: Asked) -> tuple[Task, Group]:
    from generation.piloting import members, task

    own = {key.removeprefix("law."): value for key, value in asked.settings.items() if key.startswith("law.")}
    return task.load(asked.task), members.group(asked.law, asked.members, own)


def _robots(asked: Asked, count: int) -> Group | None:
    """Robots of the body that was asked for, which run the law with the members' numbers."""
    from generation.piloting import members
    from trials.environments.robots import robots

    if asked.body is None:
        return None
    own = {key.removeprefix("law."): value for key, value in asked.settings.items() if key.startswith("law.")}
    return robots(
        asked.law,
        count,
        law_parameters={**members.of_law(asked.law), **own},
        body=asked.body,
        pipeline="sensor-based",
        scale=1.0,
        step_units=members.STEP_M,
        setup={"speed_m_s": members.SPEED_M_S},
        jobs=asked.jobs,
    )


def _grid(settings: Mapping[str, Any]) -> Grid:
    from generation.piloting.planner import Grid

    grid = Grid()
    own: dict[str, Any] = {}
    for key, value in settings.items():
        if key.startswith("law."):
            continue
        name = key.removeprefix("grid.")
        if name == key or name not in Grid._fields:
            raise unknown_name("key", key, ["law.PARAMETER", *(f"grid.{field}" for field in Grid._fields)])
        several = isinstance(getattr(grid, name), tuple)
        numbers = value if several and isinstance(value, list) else [value]
        fits = numbers and all(isinstance(n, int | float) and not isinstance(n, bool) and 0 < n <= 360 for n in numbers)
        fits = fits and not (name == "angle_step_deg" and value < FINEST_DEG)
        if not fits or (name == "robots" and not isinstance(value, int)):
            expected = (
                "lengths above 0, as in [1.5, 2.12]"
                if several
                else f"a number above 0, and at most 360; an angle of at least {FINEST_DEG:g}"
            )
            raise InputError(f"--set {key}={value!r}: expected {expected}")
        own[name] = tuple(float(n) for n in numbers) if several else value
    return grid._replace(**own)


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
    _check_same(asked)
    return found


def _write(asked: Asked, found: Plan, simulations: int) -> None:
    from generation.piloting import plan as plans
    from trials.batch.folders import write_whole

    if asked.out is None:
        return
    write_whole(asked.out, plans.to_json(found, {**_found_with(asked), "simulations": simulations}).encode())


def _found_with(asked: Asked) -> dict[str, Any]:
    """All that a plan hangs on: what was asked for, and every number of the search, of its grid and of its members."""
    from generation.piloting import members

    how = _how(asked)._asdict()
    own = {key: value for key, value in asked.settings.items() if key.startswith("law.")}
    usual = {f"law.{name}": value for name, value in members.of_law(asked.law).items()}
    return {
        "law": asked.law, "members": asked.members, "body": asked.body, "starts": asked.starts, "share": asked.share,
        "budget": asked.budget, "seed": asked.seed, "exhaust": asked.exhaust, "settings": {**usual, **own},
        "grid": how.pop("grid")._asdict(),
        "search": {name: value for name, value in how.items() if name not in ("starts", "share", "budget", "seed")},
        "herd": {"speed_m_s": members.SPEED_M_S, "iteration_s": members.DT_S},
    }  # fmt: skip


SAME = ("law", "members", "body", "starts", "share", "seed", "settings")
"""What must be the same for a search to go on from a partial plan: its walls are valid by these alone."""


def _check_same(asked: Asked) -> None:
    """Raises `InputError` where the partial plan in `out` was found otherwise than is asked for now."""
    from generation.piloting import plan as plans

    assert asked.out is not None
    before, now = plans.found_with(asked.out), _found_with(asked)
    other = [f"{name} {before[name]}, not {now[name]}" for name in SAME if name in before and before[name] != now[name]]
    if other:
        raise InputError(
            f"--out {asked.out}: its walls were found with {'; '.join(other)}; expected the same, or a new file"
        )


def _told(asked: Asked, task: Task, found: Plan, simulations: int) -> str:
    from generation.piloting import plan as plans

    lines = [f"{'turn':>4}  {'anchor':>6}  {'angle':>9}  {'length':>7}  share"]
    for number, (wall, share) in enumerate(zip(found.walls, found.shares, strict=True), 1):
        lines.append(f"{number:>4}  {wall.anchor:>6}  {wall.angle_deg:>5g} deg  {wall.length_m:>5g} m  {share:.2f}")
    kind = "standing" if found.static else "changing"
    lines.append(f"{task.name}: {len(found.walls)} {kind} walls, {simulations} simulations of a stage")
    changing = "" if found.static else f" --set piloting.at_once={plans.AT_ONCE}"
    lines.append(
        f"a trial's: --sweep task={asked.task} --set 'piloting.walls=\"{plans.words(found.walls)}\"'{changing}"
    )
    return "\n".join(lines)
