"""The senses and decisions of each robot in a recording: scans, inputs to the law, way-points and rules."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints, Kind
from trials.simulations.columns import in_world, member_colours, nanoseconds, packed, series, spans, times_column
from trials.simulations.robots import screen
from trials.simulations.robots.measures import nearest_inputs
from trials.types import Scans, TrialResult, Updates

FALSE_COLOUR = 0xFF3B30FF
NO_INTENSITY_COLOUR = 0x8A8F98FF
INTENSITY_STOPS = np.array([0.0, 0.35, 0.6, 0.8, 1.0])
INTENSITY_COLOURS = np.array([[58, 70, 110], [70, 120, 180], [88, 200, 180], [250, 210, 90], [255, 255, 240]])
INTENSITY_DECADES = (-1.5, 3.5)
"""Decimal logarithms of the intensities at the ends of the colours: 0.03 and 3000 times a white surface at 1 m."""
INTENSITY_LEVELS = 32
"""Few, so that neighbouring beams often have the same colour and the file compresses well."""
DENSE_INPUTS = 10
"""Where a law was given more inputs an update than this on average, and only some scans are kept, only the
inputs at the kept scans are recorded: they are points of those scans, and the file stays small."""
SCANS_AT_ONCE = 500
"""Scans that are made points of at once, so that memory does not grow with the trial's length."""
SPARSE_INPUTS = 32
"""At most so many of these inputs an update are recorded, evenly picked: more would overlap on the screen."""


def send_updates(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends what each robot detected, its way-points, and the rules that chose them."""
    updates = result.updates
    if len(updates.times) == 0:
        return
    colours = member_colours(len(result.robot_names))
    legend = screen.rule_colours(result)
    way_points_w = in_world(updates.motions, updates.poses_w).astype(np.float32)
    origins = updates.poses_w[:, :2].astype(np.float32)
    aimed = (updates.kinds == Kind.WAY_POINT) & np.isfinite(way_points_w).all(axis=1)
    shown, picked = _shown_inputs(result)
    nearest = nearest_inputs(updates.as_selected())
    distances = np.hypot(nearest[:, 0], nearest[:, 1])
    for k, name in enumerate(result.robot_names):
        mine = np.flatnonzero(updates.robots == k)
        if len(mine) == 0:
            continue
        rules = np.array(result.rules[k])[updates.rules[mine]]
        rule_colours = np.array([legend[rule] for rule in result.rules[k]], dtype=np.uint32)
        _way_points(
            recording,
            f"world/way_points/{name}",
            updates.times[mine],
            origins[mine],
            way_points_w[mine],
            aimed[mine],
            rule_colours[updates.rules[mine]],
        )
        _members(recording, f"world/members/{name}", updates, mine[shown[mine]], picked, int(colours[k]))
        changes = np.flatnonzero(np.r_[True, rules[1:] != rules[:-1]])
        known = result.rules[k]
        style = rr.StateConfiguration(values=list(known), colors=packed([legend[rule] for rule in known]))
        recording.log(f"rules/{name}", style, static=True)
        recording.send_columns(
            f"rules/{name}",
            [times_column(updates.times[mine][changes])],
            rr.StateChange.columns(state=rules[changes].tolist()),
        )
        series(recording, f"nearest_inputs/{name}", name, int(colours[k]), updates.times[mine], distances[mine])


def _way_points(
    recording: rr.RecordingStream,
    entity: str,
    times: Floats,
    origins: NDArray[np.float32],
    way_points: NDArray[np.float32],
    aimed: Bools,
    colours: NDArray[np.uint32],
) -> None:
    """Sends a row for each update; it is empty where the law gave no way-point."""
    style = rr.Arrows2D.from_fields(radii=[0.01], draw_order=39.0)
    recording.log(entity, style, static=True)
    columns = rr.Arrows2D.columns(origins=origins[aimed], vectors=(way_points - origins)[aimed], colors=colours[aimed])
    recording.send_columns(entity, [times_column(times)], columns.partition(aimed.astype(np.int32)))


def _members(
    recording: rr.RecordingStream, entity: str, updates: Updates, some: Ints, picked: Bools, colour: int
) -> None:
    """Sends the picked inputs of the updates `some`, a row for each update."""
    if len(some) == 0:
        return
    starts, ends = updates.input_starts[some], updates.input_starts[some + 1]
    rows = spans(starts, ends)
    of_update = np.repeat(np.arange(len(some)), ends - starts)[picked[rows]]
    rows = rows[picked[rows]]
    counts = np.bincount(of_update, minlength=len(some))
    points = in_world(updates.input_positions[rows], updates.poses_w[some][of_update]).astype(np.float32)
    colours = np.where(updates.input_owners[rows] < 0, np.uint32(FALSE_COLOUR), np.uint32(colour))
    recording.log(entity, rr.Points2D.from_fields(radii=[0.03], draw_order=35.0), static=True)
    columns = rr.Points2D.columns(positions=points, colors=colours)
    recording.send_columns(entity, [times_column(updates.times[some])], columns.partition(counts))


def _shown_inputs(result: TrialResult) -> tuple[Bools, Bools]:
    """(U,) updates whose inputs are recorded, and (K,) which inputs of those."""
    updates, scans = result.updates, result.scans
    shown = np.ones(len(updates.times), dtype=bool)
    picked = np.ones(len(updates.input_positions), dtype=bool)
    thinned = scans is not None and len(scans.times) < len(updates.times)
    if scans is None or not thinned or len(picked) <= DENSE_INPUTS * len(shown):
        return shown, picked
    for k in range(len(result.robot_names)):
        mine = np.flatnonzero(updates.robots == k)
        shown[mine] = np.isin(nanoseconds(updates.times[mine]), nanoseconds(scans.times[scans.robots == k]))
    counts = np.diff(updates.input_starts)
    strides = -(-counts // SPARSE_INPUTS)
    places = np.arange(len(picked)) - np.repeat(updates.input_starts[:-1], counts)
    picked = places % np.repeat(np.maximum(strides, 1), counts) == 0
    return shown, picked


def send_scans(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends a row for each scan: its returns in the world, without the codes (no return, too near, error)."""
    scans = result.scans
    if scans is None or len(scans.times) == 0:
        return
    directions = np.stack([np.cos(scans.angles), np.sin(scans.angles)]).astype(np.float32)
    for k, name in enumerate(result.robot_names):
        mine = np.flatnonzero(scans.robots == k)
        entity = f"world/scans/{name}"
        if len(mine):
            recording.log(entity, rr.Points2D.from_fields(radii=[0.012], draw_order=8.0), static=True)
        for first in range(0, len(mine), SCANS_AT_ONCE):
            _some_scans(recording, entity, scans, mine[first : first + SCANS_AT_ONCE], directions)
            recording.flush()  # what is sent waits in memory until it is written


def _some_scans(
    recording: rr.RecordingStream, entity: str, scans: Scans, some: Ints, directions: NDArray[np.float32]
) -> None:
    ranges, poses = scans.ranges[some], scans.poses_w[some]
    hit = np.isfinite(ranges)
    levels = intensity_levels(scans.intensities[some])
    order = np.argsort(levels, axis=1, kind="stable")  # equal colours side by side compress to almost nothing
    hit, levels = np.take_along_axis(hit, order, 1), np.take_along_axis(levels, order, 1)
    points = np.take_along_axis(scan_points(ranges, poses, directions), order[..., None], 1)[hit]
    columns = rr.Points2D.columns(positions=points, colors=INTENSITY_PALETTE[levels[hit]])
    recording.send_columns(entity, [times_column(scans.times[some])], columns.partition(hit.sum(axis=1)))


def scan_points(ranges: NDArray[np.float32], poses_w: Floats, directions: NDArray[np.float32]) -> NDArray[np.float32]:
    """(S, B, 2) m, world: where the beams of S scans ended. `directions` (2, B): cos and sin of their angles."""
    c, s, x, y = (
        v.astype(np.float32)[:, None]
        for v in (np.cos(poses_w[:, 2]), np.sin(poses_w[:, 2]), poses_w[:, 0], poses_w[:, 1])
    )
    points = np.empty((*ranges.shape, 2), dtype=np.float32)
    with np.errstate(invalid="ignore"):  # the codes for no return times a direction of 0
        points[..., 0] = ranges * (c * directions[0] - s * directions[1]) + x
        points[..., 1] = ranges * (s * directions[0] + c * directions[1]) + y
    return points


def intensity_levels(intensities: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(…,) row of `INTENSITY_PALETTE` for each intensity."""
    low, high = INTENSITY_DECADES
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (np.log10(intensities) - np.float32(low)) * np.float32(1.0 / (high - low))
        levels = np.clip(share, 0.0, 1.0) * np.float32(INTENSITY_LEVELS - 1) + np.float32(0.5)
        return np.where(np.isnan(levels), INTENSITY_LEVELS, levels).astype(np.uint8)


def _intensity_palette() -> NDArray[np.uint32]:
    """(INTENSITY_LEVELS + 1,) packed colours; the last is that of no intensity."""
    at = np.linspace(0.0, 1.0, INTENSITY_LEVELS)
    red, green, blue = (np.interp(at, INTENSITY_STOPS, channel).astype(np.uint32) for channel in INTENSITY_COLOURS.T)
    return np.append((red << 24) | (green << 16) | (blue << 8) | 0xFF, NO_INTENSITY_COLOUR).astype(np.uint32)


INTENSITY_PALETTE = _intensity_palette()
