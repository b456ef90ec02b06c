"""Many small herds of one band, one after the other in one compiled call: what `simulate` does, set up only once.

Herds differ in their start, their walls and their random numbers; all else they share. The kernel is the one of
`flocking.kinematic.kernel`, so that each herd's positions are those of `simulate`, bit for bit. Metres, world frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from time import perf_counter
from typing import NamedTuple

import numpy as np

from flocking.angles import wrapped
from flocking.errors import InputError, StorageError
from flocking.kinematic.bands import Band, Space
from flocking.kinematic.herd import PIECE_S, KinematicHerd, LawFailedError, Schedule, simulate
from flocking.perception import Step
from flocking.types import Floats

MOST_STATES = 200_000
"""Steps times members of one herd, above which setting it up costs nothing beside them and `simulate` does as well."""
MOST_KEPT = 8_000_000
"""Numbers that one call's herds may leave and draw."""


class Start(NamedTuple):
    """Where one herd begins, and by which random numbers it goes on."""

    poses_w: Floats
    """(N, 3)."""
    walls_w: Floats
    """(W, 4) segments."""
    seed: tuple[int, ...]


def positions_of(
    bands: Sequence[Band], starts: Sequence[Start], dt_s: float, steps: int, speeds_m_s: Floats
) -> Iterator[Floats]:
    """The positions (steps + 1, N, 2) of each herd, in the order of `starts`, synchronous, all steps kept.

    `speeds_m_s` (N,): along their headings at the start. Raises `InputError` for what does not fit and
    `LawFailedError` if a law fails, as `simulate` does.
    """
    if not starts:
        return
    schedule = Schedule(dt_s, steps).checked()
    first = KinematicHerd(
        list(bands), starts[0].poses_w, Space(walls=starts[0].walls_w), None, dt_s, np.random.default_rng(0)
    )
    states = (schedule.steps + 1) * len(first.positions)
    if len(bands) > 1 or states > MOST_STATES or Step.GRAPH in first.stages[0].steps or first.voronoi:
        for poses, walls, seed in starts:
            rng = np.random.default_rng(seed)
            space = Space(walls=walls)
            yield simulate(bands, poses, schedule, rng=rng, space=space, speeds_m_s=speeds_m_s).positions_w
        return
    at_a_time, most, done = 1, max(1, MOST_KEPT // (states * (2 + first.draws[0]))), 0
    while done < len(starts):
        chunk = starts[done : done + at_a_time]
        began = perf_counter()
        positions, failed = _together(first, chunk, schedule, speeds_m_s)
        each = (perf_counter() - began) / len(chunk)
        yield from positions
        if failed:
            raise LawFailedError(failed)
        done += len(chunk)
        at_a_time = max(1, min(most, int(PIECE_S / max(each, 1e-9)), 4 * at_a_time))


def _together(herd: KinematicHerd, starts: Sequence[Start], schedule: Schedule, speeds: Floats) -> tuple[Floats, str]:
    """One call of the compiled code: the positions (J, steps + 1, N, 2) of the herds, and why the one after failed."""
    from flocking.kinematic.kernel import many

    law, count, steps = herd.bands[0].law, len(herd.positions), schedule.steps
    if any(np.shape(start.poses_w) != (count, 3) for start in starts):
        raise InputError(f"starting poses of different shapes; expected ({count}, 3) each")
    poses = np.array([start.poses_w for start in starts], dtype=np.float64)
    if not np.isfinite(poses).all():
        raise InputError("a starting pose is not finite; expected x, y, heading")
    poses[..., 2] = wrapped(poses[..., 2])
    velocities = np.stack([np.cos(poses[..., 2]), np.sin(poses[..., 2])], axis=-1) * np.asarray(speeds)[..., None]
    walls = [np.asarray(start.walls_w, dtype=np.float64) for start in starts]
    clearances = np.array([Space(walls=each).clearance_m for each in walls])
    ends = np.cumsum([0, *(len(each) for each in walls)])
    draws = np.zeros((len(starts), steps, count, law.draws))
    if law.draws:
        for row, start in zip(draws, starts, strict=True):
            row[:] = np.random.default_rng(start.seed).spawn(2)[0].random(row.shape)  # as `KinematicHerd` does
    positions, turn, raised = np.empty((len(starts), steps + 1, count, 2)), np.zeros(3, np.int64), ""
    joined = np.ascontiguousarray(np.concatenate([np.empty((0, 4)), *walls]))
    if not np.isfinite(joined).all():
        raise InputError("walls that are not finite; expected (W, 4) numbers x0, y0, x1, y1")
    try:
        failed = many(
            law.entry, herd.stages[0], herd.arrays, poses, velocities, joined, ends, clearances, draws, positions, turn
        )
    except StorageError:
        raise
    except Exception as error:  # whatever a law of the user's may raise
        failed, raised = 1, " ".join(f"{type(error).__name__}: {error}".split())
    if not failed:
        return positions, ""
    job, step, member = turn.tolist()
    told = raised and f"raised {raised}"
    told = told or "returned no valid motion; expected a kind of 0 to 5 and finite numbers"
    return positions[:job], f"law {law.name!r} for member {member + 1} at step {step + 1}: {told}"
