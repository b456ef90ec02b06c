"""Builds the herd of a kinematic trial, as `flocking.kinematic` takes it, from the trial's names and numbers."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flocking import avoidance, lawentry, obstacle_selection, selection
from flocking.errors import InputError, unknown_name
from flocking.kinematic import Band, Space
from flocking.kinematic.bands import check_linked, parsed_sets
from flocking.lawentry import OF_MEMBERS
from flocking.perception import Step
from flocking.types import Bools, Floats, Ints
from trials.simulations import judged, spread
from trials.simulations.kinematic import fields, formations, lattice_starts
from trials.streams import Purpose, stream
from trials.types import Group, Trial
from worlds import start_poses, starts

BEARINGS_ALONE = frozenset({"bearings", "positions", "ids"})
"""What is known of neighbours where poses are not: a position then stands at the assumed distance."""
MOST_KEPT = 100_000_000
"""Members times moments kept: some 5 GB while the trial runs."""


@dataclass(frozen=True)
class Herd:
    """All that `flocking.kinematic.simulate` needs, but for random numbers."""

    bands: list[Band]
    """One band a group, or two where a group has leaders and others: the leaders come first."""
    space: Space
    poses_w: Floats
    """(N, 3) at the start."""
    speeds: Floats
    """(N,) at the start, m/s."""
    fields: fields.TrialFields
    graph: Bools | None
    """(N, N): who is in whose fixed set; None if nobody selects by one."""
    kinds: Ints
    """(N,) number of each member's kind: its group, and within it whether it is informed."""


def assemble(trial: Trial) -> Herd:
    """Builds the herd of a trial. Raises `InputError` for names and numbers that do not exist or fit."""
    space = _space(trial)
    poses_w, speeds = _start(trial, space)
    centre = np.zeros(2) if space.kind == "unbounded" else np.full(2, space.size_m / 2.0)
    if (environment := fields.environment_of(trial)) is not None:
        centre = starts.put_at_start(environment, np.zeros((1, 3)))[0, :2]
    whole = [_band(trial, number, centre) for number in range(len(trial.groups))]
    kinds = [2 * g + (np.isfinite(_goals(band)).all(axis=1)) for g, band in enumerate(whole)]
    bands = _parts(whole, trial.groups)
    given = fields.of_trial(trial)
    graph = _graph(given.graph, len(poses_w)) if any(map(_selects_by_graph, bands)) else None
    return Herd(bands, space, poses_w, speeds, given, graph, np.concatenate(kinds))


def bands_of(trial: Trial, centre: Floats) -> list[Band]:
    """The bands of all groups of a trial; goals are given from `centre` (2,)."""
    return _parts([_band(trial, number, centre) for number in range(len(trial.groups))], trial.groups)


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`.

    Its start is `check_start`'s.
    """
    fields.world_parameters(trial)
    fields.formation_parameters(trial)
    given = fields.of_trial(trial)
    count = sum(group.count for group in trial.groups)
    if count == 0:
        raise InputError(f"{trial.groups[0].name}.count = 0: expected at least 1 member in all groups together")
    every = 1 if fields.every_step(trial) else given.every
    if given.every > given.steps:
        raise InputError(
            f"steps = {given.steps}: expected at least every = {given.every}, after which the first moment is kept; "
            f"or --set every={given.steps}"
        )
    if count * (given.steps // every + 1) > MOST_KEPT:
        raise InputError(
            f"{count} members at {given.steps // every + 1} moments: expected at most {MOST_KEPT} positions "
            f"to keep, as with --set every={math.ceil(count * given.steps / MOST_KEPT)}"
        )
    for number in range(len(trial.groups)):
        check_group(trial, number)
    fields.formation_of(trial)
    space, _ = fields.space_of(trial), fields.world_of(trial)
    if trial.formation in lattice_starts.NAMES:
        lattice_starts.check(space)
    fields.environment_of(trial)
    judged.check(trial, given.behaviour)


def check_group(trial: Trial, number: int) -> None:
    """Refuses the group of that number where its names and numbers do not fit one another: `InputError`."""
    group = trial.groups[number]
    if group.pipeline not in fields.DETECTIONS:
        raise unknown_name("pipeline", group.pipeline, fields.DETECTIONS)
    own = fields.of_group(group)
    obstacle_selection.parse(own.obstacle_selection)
    if own.leaders > group.count:
        raise InputError(f"{group.name}.leaders = {own.leaders}: expected at most the {group.count} members there are")
    if _check_law(group) & {Step.GRAPH, Step.VORONOI}:
        check_linked(sum(each.count for each in trial.groups))
    spread.check(trial, number, group.law_parameters)


def check_start(trial: Trial) -> None:
    """Refuses a trial whose members do not all start within its world: `InputError`.

    Nothing is drawn where they do whatever is drawn.
    """
    if start_poses.is_file(trial.formation):
        _check_file(trial)
    if (environment := fields.environment_of(trial)) is not None:
        starts.check(members_of(trial), environment)
        return
    if start_poses.is_file(trial.formation):
        return
    if trial.formation in ("uniform", *lattice_starts.NAMES) or fields.space_of(trial) == "unbounded":
        return
    count = sum(group.count for group in trial.groups)
    if formations.widest_m(trial.formation, fields.formation_of(trial), count) > fields.world_of(trial).size_m:
        _start(trial, _space(trial))


def _check_file(trial: Trial) -> None:
    """Refuses poses of a file that overlap, or that are outside of a sized world: `InputError`."""
    members, size = members_of(trial), getattr(fields.world_of(trial), "size_m", math.inf)
    starts.check_apart(members)
    places = members.poses_w[:, :2]
    if size < math.inf and ((places < 0.0) | (places > size)).any():
        x, y = places[((places < 0.0) | (places > size)).any(axis=1)][0]
        raise InputError(f"{trial.formation}: ({x:g}, {y:g}) m is outside of the world; expected 0 to {size:g} m")


def members_of(trial: Trial) -> starts.Starting:
    """The members of a trial at their start."""
    poses_w, _ = _start(trial, _space(trial))
    names = [f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)]
    radii = np.repeat([fields.of_group(group).radius_m for group in trial.groups], [g.count for g in trial.groups])
    together = np.full(len(names), not start_poses.is_file(trial.formation))
    return starts.Starting(names, poses_w, radii, together)


def _check_law(group: Group) -> set[Step]:
    """The steps that a group selects by.

    Raises `InputError` for a law that needs what is not known, or a selection that does not fit it.
    """
    module = lawentry.module_of(group.law, group.law_source)
    values = lawentry.parameters_of(group.law, module, group.law_parameters, f"{group.name}.law.")._asdict()
    sets = parsed_sets(group.law, group.selection, lawentry.sets_of(module), list(values))
    for steps in sets:
        selection.resolved(steps, values)
    needs = frozenset(getattr(module, "NEEDS", {"positions"})) & OF_MEMBERS
    missing = needs - BEARINGS_ALONE if fields.of_group(group).information == "bearings" else frozenset()
    if missing:
        raise InputError(
            f"law {group.law!r} needs {' and '.join(sorted(missing))} of its neighbours, which bearings do not give; "
            f"expected --set {group.name}.information=poses"
        )
    return {chosen.step for steps in sets for chosen in steps}


def _start(trial: Trial, space: Space) -> tuple[Floats, Floats]:
    """Poses (N, 3) and speeds (N,) at the start: in an environment, about its start."""
    poses_w, speeds = _drawn_start(trial, space)
    environment = None if start_poses.is_file(trial.formation) else fields.environment_of(trial)
    return (poses_w if environment is None else starts.put_at_start(environment, poses_w)), speeds


def _drawn_start(trial: Trial, space: Space) -> tuple[Floats, Floats]:
    count = sum(group.count for group in trial.groups)
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    given = fields.formation_of(trial)
    if trial.formation in lattice_starts.NAMES:
        lattice_starts.check(space.kind)
        return lattice_starts.start(trial.formation, given, count, rng)
    size = space.size_m if space.kind != "unbounded" else math.inf
    speeds = np.repeat([fields.of_group(group).speed_m_s for group in trial.groups], [g.count for g in trial.groups])
    if start_poses.is_file(trial.formation):
        return start_poses.poses(trial.formation, trial.formation_source, count), speeds
    return formations.poses(trial.formation, given, count, size, rng), speeds


def _space(trial: Trial) -> Space:
    if (environment := fields.environment_of(trial)) is not None:
        return Space(walls=environment.walls())
    kind, given = fields.space_of(trial), fields.world_of(trial)
    if kind == "unbounded":
        return Space()
    if kind != "obstacles":
        return Space(kind, given.size_m)
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.WORLD)
    return Space("bounded", given.size_m, formations.walls(given.walls, given.length_m, given.size_m, rng))


def _band(trial: Trial, number: int, centre: Floats) -> Band:
    group = trial.groups[number]
    given = fields.of_group(group)
    each: Mapping[str, Any] | list[dict[str, Any]] = group.law_parameters
    if group.spread:
        each = [spread.parameters(trial, number, member, group.law_parameters) for member in range(group.count)]
    goals = np.full((group.count, 2), np.nan)
    goals[: round(given.informed_share * group.count)] = centre + np.array([given.goal_x_m, given.goal_y_m])
    return Band(
        law=lawentry.load(group.law, group.law_source),
        count=group.count,
        parameters=each,
        selection=group.selection,
        cruise_m_s=_limit(given.cruise_m_s),
        max_speed_m_s=_limit(given.max_speed_m_s),
        max_turn_rate_rad_s=_limit(given.max_turn_rate_rad_s),
        radius_m=given.radius_m,
        goals_w=goals,
        role=given.role,
        detection=group.pipeline,
        information=given.information,
        assumed_distance_m=given.assumed_distance_m,
        silhouette_m=given.silhouette_m,
        sight_m=_limit(given.sight_m),
        obstacle_selection=given.obstacle_selection,
        obstacles=given.obstacles,
        avoidance=avoidance.Parameters(given.look_ahead_m, given.margin_m, given.virtual_range_m),
    )


def _parts(bands: Sequence[Band], groups: Sequence[Group]) -> list[Band]:
    """One band a group, or two where a group has leaders and others: the leaders come first. None of nobody; one of
    groups that follow one another and differ in no more than parameters and goals."""
    there = [pair for pair in zip(bands, groups, strict=True) if pair[1].count > 0]
    parts: list[Band] = []
    for part in (part for band, group in there for part in _by_role(band, group)):
        if parts and _alike(parts[-1]) == _alike(part):  # one band is the faster
            parts[-1] = _joined(parts[-1], part)
        else:
            parts.append(part)
    return parts


def _alike(band: Band) -> dict[str, Any]:
    """What the members of two bands must share to be one: all but their number, their goals and their parameters."""
    own = {field.name: getattr(band, field.name) for field in dataclasses.fields(band)}
    return {name: value for name, value in own.items() if name not in ("count", "goals_w", "parameters")}


def _joined(first: Band, second: Band) -> Band:
    """Two bands that differ in what each member has of its own, as one."""
    each: list[Mapping[str, Any]] = []
    for band in (first, second):
        given = band.parameters
        each += band.count * [given] if isinstance(given, Mapping) else given
    goals = np.concatenate([_goals(first), _goals(second)])
    return dataclasses.replace(first, count=first.count + second.count, goals_w=goals, parameters=each)


def _by_role(band: Band, group: Group) -> list[Band]:
    """A group's band, or its leaders' and the others' if it has both."""
    leaders = fields.of_group(group).leaders
    if leaders == 0 or band.role == fields.LEADER:
        return [band]
    if leaders == band.count:
        return [dataclasses.replace(band, role=fields.LEADER)]
    goals, each = _goals(band), band.parameters
    return [
        dataclasses.replace(
            band,
            count=len(goals[part]),
            goals_w=goals[part],
            parameters=each if isinstance(each, Mapping) else each[part],
            role=role,
        )
        for part, role in ((slice(leaders), fields.LEADER), (slice(leaders, None), band.role))
    ]


def _selects_by_graph(band: Band) -> bool:
    sets = selection.parse_sets(band.selection, band.law.sets, band.law.parameter_names)
    return any(chosen.step is Step.GRAPH for steps in sets for chosen in steps)


def _graph(kind: str, count: int) -> Bools:
    """(N, N) links: each member to the next and the last to the first, or all to all."""
    check_linked(count)
    if kind == "complete":
        return ~np.eye(count, dtype=np.bool_)
    linked = np.zeros((count, count), dtype=np.bool_)
    members = np.arange(count)
    linked[members, (members + 1) % count] = linked[(members + 1) % count, members] = True
    np.fill_diagonal(linked, False)
    return linked


def _goals(band: Band) -> Floats:
    assert band.goals_w is not None
    return band.goals_w


def _limit(value: float) -> float:
    return value if value > 0.0 else math.inf
