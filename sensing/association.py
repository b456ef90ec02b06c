"""Association: velocities and headings of neighbours inferred from two detections and the own motion in between.

Fine 2015, section 3.6.3: to associate is to pair what two readings of the sensors show; from a member's displacement
in between follows its velocity. The document says no more, and what follows are choices:

- Inputs nearer to one another than `same_body_m`, directly or by others in between, are one body: detections with many
  inputs a member (readings) would otherwise pair the same beams, which slide along a surface that moves. A body stands
  at the mean of its inputs, and all of them are given its velocity and heading. Members that touch may be one body.
- The last bodies are carried on by their own velocity and brought into the present frame by the own motion. Pairs
  are those with the least sum of distances (SciPy's linear assignment); a pair farther apart than `gate_m` and the way
  at top speed since the body was last seen is none.
- A velocity over ground is the displacement over its time, at most the top speed. Smoothed (`exponential`), it is the
  mean of the new one and those before, weighted by exp(-age / `smoothing_s`); the first one is taken as it is.
- The heading is the direction of the velocity where that is faster than `moving_m_s`, else the last one known: a
  Create does not drive backwards. A member that has not moved since it came into view has no heading.
- A body out of sight is remembered for `memory_s`; 0: for pairs of consecutive detections only.

Six Creates under Couzin's law in the corridor, member-based detection, three trials of 20 s: half of the velocities err
by less than 0.06 m/s and nine in ten by less than 0.17 (0.04 and 0.10 with the true own motion; 0.07 and 0.27 from two
scans alone); half of the headings of members faster than 0.1 m/s err by less than 10 degrees.

Metres, seconds, radians; body frame.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.types import Bools, Floats, Ints, only
from sensing.types import NOBODY, Detection

SMOOTHINGS = ("exponential", "none")
NO_PAIR = 1e6
"""Cost of a pair outside its gate, m: more than any sum of pairs inside."""
TINY = 1e-12
"""m/s: no speed at all."""


class Parameters(NamedTuple):
    """Of the pairing and of what is made of it."""

    top_speed_m_s: Annotated[
        float, Parameter("m/s", "the Create's top speed: Open Interface, drive command", low=0.0)
    ] = 0.5
    gate_m: Annotated[
        float,
        Parameter("m", "choice: half a body radius for noise of the place, 2 degrees of own turn at 2 m", low=0.0),
    ] = 0.15
    same_body_m: Annotated[
        float,
        Parameter("m", "choice: below the gap of 0.16 m between the facing sides of two Creates that touch", low=0.0),
    ] = 0.12
    smoothing: Annotated[
        str, Parameter("", "choice: of two scans alone the noise is as large as a velocity", choices=SMOOTHINGS)
    ] = "exponential"
    smoothing_s: Annotated[float, Parameter("s", "choice: three scans", low=1e-3)] = 0.3
    moving_m_s: Annotated[
        float, Parameter("m/s", "choice: a fifth of the cruising speed, above the noise of the velocity", low=0.0)
    ] = 0.05
    memory_s: Annotated[float, Parameter("s", "choice: three scans in which a member may be missed", low=0.0)] = 0.3


class Bodies(NamedTuple):
    """What is remembered of the last detections: B bodies, in the robot's axes at the last one."""

    positions: Floats
    """(B, 2) where they were last seen, m."""
    velocities: Floats
    """(B, 2) over ground, m/s; nan = not known yet."""
    headings: Floats
    """(B,) rad; nan = not known yet."""
    ages: Floats
    """(B,) s since it was seen, at the last detection."""


class Limits(NamedTuple):
    """The numbers of `Parameters` as compiled code takes them."""

    top_speed_m_s: float
    gate_m: float
    smoothing_s: float
    """0 = not smoothed."""
    moving_m_s: float
    memory_s: float


class Way(NamedTuple):
    """From the last detection to this one: what the remembered bodies have to be moved by."""

    elapsed: float
    """s."""
    moved: Floats
    """(3,) the present pose in the frame of the one before: x, y (m), heading (rad)."""


def _nobody() -> Bodies:
    return Bodies(np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0))


class Association:
    """One robot's memory of whom it saw."""

    def __init__(self, parameters: Parameters, needs: frozenset[str]) -> None:
        """`needs`: of velocities and headings, those without which a member is not handed on."""
        from scipy.optimize import linear_sum_assignment

        self.parameters = parameters
        self._assign = linear_sum_assignment
        self._needs_velocities, self._needs_headings = "velocities" in needs, "headings" in needs
        smoothing_s = parameters.smoothing_s if parameters.smoothing == "exponential" else 0.0
        # plain tuples, here and below: from Python a named tuple takes Numba longer
        self._limits = tuple(
            Limits(
                float(parameters.top_speed_m_s),
                float(parameters.gate_m),
                float(smoothing_s),
                float(parameters.moving_m_s),
                float(parameters.memory_s),
            )
        )
        self._bodies = _nobody()
        self._time, self._pose = -math.inf, np.zeros(3)
        self._last: tuple[Floats, Floats] = np.empty((0, 2)), np.empty(0)

    def infer(self, detection: Detection, time: float, pose: Floats) -> Detection:
        """`detection` with what could be inferred, and without the members of which what is needed is not known.

        `time`: when the scan was made, s. `pose` (3,): where the robot knows itself to be, in any frame that stays. The
        same scan again (the same time) gives the same again.
        """
        members = detection.members
        if time > self._time:
            self._last = self._updated(members.positions, time, _moved(self._pose, pose))
            self._time, self._pose = time, pose.copy()
        velocities, headings = self._last
        members = members._replace(velocities=velocities, headings=headings)
        return known(detection._replace(members=members), self._needs_velocities, self._needs_headings)

    def _updated(self, positions: Floats, time: float, moved: Floats) -> tuple[Floats, Floats]:
        """Velocities (M, 2) and headings (M,) of the inputs at `positions` (M, 2)."""
        labels, centres = _grouped(positions, self.parameters.same_body_m)
        bodies, way = tuple(self._bodies), (float(min(time - self._time, 1e9)), moved)
        stood, costs = _costs(self._limits, bodies, way, centres)
        old, new = self._assign(costs)
        pairs = old.astype(np.int64), new.astype(np.int64)
        self._bodies = _followed(self._limits, bodies, way, stood, centres, costs, pairs)
        return self._bodies.velocities[labels], self._bodies.headings[labels]


def known(detection: Detection, velocities: bool, headings: bool) -> Detection:
    """`detection` without the members whose velocity or heading is needed (true) and not known."""
    members = detection.members
    kept = _kept(members.velocities, members.headings, velocities, headings)
    if kept.all():
        return detection
    return detection._replace(members=only(members, np.flatnonzero(kept)), beams=_renumbered(detection.beams, kept))


@compiled
def _moved(first: Floats, second: Floats) -> Floats:
    """(3,) the pose `second` in the frame of the pose `first`."""
    c, s = math.cos(first[2]), math.sin(first[2])
    x, y = second[0] - first[0], second[1] - first[1]
    return np.array([c * x + s * y, c * y - s * x, second[2] - first[2]])


@compiled
def _grouped(positions: Floats, gap: float) -> tuple[Ints, Floats]:
    """The body (M,) of each input, and the mean position (B, 2) of each body."""
    count = len(positions)
    labels = np.full(count, -1, np.int64)
    stack = np.empty(count, np.int64)
    sums = np.zeros((count, 3))
    bodies = 0
    for first in range(count):
        if labels[first] >= 0:
            continue
        labels[first] = bodies
        stack[0], height = first, 1
        while height > 0:
            height -= 1
            i = stack[height]
            sums[bodies, 0] += positions[i, 0]
            sums[bodies, 1] += positions[i, 1]
            sums[bodies, 2] += 1.0
            for j in range(count):
                if labels[j] < 0:
                    x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
                    if x * x + y * y < gap * gap:
                        labels[j] = bodies
                        stack[height] = j
                        height += 1
        bodies += 1
    centres = np.empty((bodies, 2))
    for b in range(bodies):
        centres[b, 0], centres[b, 1] = sums[b, 0] / sums[b, 2], sums[b, 1] / sums[b, 2]
    return labels, centres


@compiled
def _costs(
    limits: tuple[float, ...], remembered: tuple[Any, ...], way: tuple[float, Floats], centres: Floats
) -> tuple[Floats, Floats]:
    """The bodies' places (B, 2) if they stood still, in the present frame; the distance (B, C) of each pair.

    Takes the fields of `Limits`, `Bodies` and `Way`.
    """
    about, bodies = Limits(*limits), Bodies(*remembered)
    elapsed, moved = way
    count = len(bodies.positions)
    stood, costs = np.empty((count, 2)), np.empty((count, len(centres)))
    c, s = math.cos(moved[2]), math.sin(moved[2])
    for b in range(count):
        x, y = bodies.positions[b, 0] - moved[0], bodies.positions[b, 1] - moved[1]
        stood[b, 0], stood[b, 1] = c * x + s * y, c * y - s * x
        x, y = stood[b, 0], stood[b, 1]
        if not math.isnan(bodies.velocities[b, 0]):
            vx, vy = bodies.velocities[b, 0], bodies.velocities[b, 1]
            x += (c * vx + s * vy) * (elapsed + bodies.ages[b])
            y += (c * vy - s * vx) * (elapsed + bodies.ages[b])
        reach = about.gate_m + about.top_speed_m_s * (elapsed + bodies.ages[b])
        for k in range(len(centres)):
            distance = math.hypot(centres[k, 0] - x, centres[k, 1] - y)
            costs[b, k] = distance if distance <= reach else NO_PAIR
    return stood, costs


@compiled
def _followed(
    limits: tuple[float, ...],
    remembered: tuple[Any, ...],
    way: tuple[float, Floats],
    stood: Floats,
    centres: Floats,
    costs: Floats,
    pairs: tuple[Ints, Ints],
) -> Bodies:
    """The bodies to remember: first those at `centres`, then those out of sight that are not forgotten yet.

    Takes the fields of `Limits`, `Bodies` and `Way`. `pairs`: rows of the bodies and of `centres` that were paired;
    pairs at `NO_PAIR` are none.
    """
    about, bodies = Limits(*limits), Bodies(*remembered)
    elapsed, moved = way
    old, new = pairs
    count, seen = len(bodies.positions), len(centres)
    paired = np.zeros(count, np.bool_)
    for k in range(len(old)):
        paired[old[k]] = costs[old[k], new[k]] < NO_PAIR
    unseen = 0
    for b in range(count):
        if not paired[b] and bodies.ages[b] + elapsed <= about.memory_s:
            unseen += 1
    positions, ages = np.empty((seen + unseen, 2)), np.zeros(seen + unseen)
    velocities, headings = np.full((seen + unseen, 2), np.nan), np.full(seen + unseen, np.nan)
    positions[:seen] = centres
    c, s = math.cos(moved[2]), math.sin(moved[2])
    for k in range(len(old)):
        b, row = old[k], new[k]
        if not paired[b]:
            continue
        time = elapsed + bodies.ages[b]
        x, y = (centres[row, 0] - stood[b, 0]) / time, (centres[row, 1] - stood[b, 1]) / time
        share = min(1.0, about.top_speed_m_s / max(math.hypot(x, y), TINY))
        x, y = share * x, share * y
        if about.smoothing_s > 0.0 and not math.isnan(bodies.velocities[b, 0]):
            kept = math.exp(-time / about.smoothing_s)
            vx, vy = bodies.velocities[b, 0], bodies.velocities[b, 1]
            x = (1.0 - kept) * x + kept * (c * vx + s * vy)
            y = (1.0 - kept) * y + kept * (c * vy - s * vx)
        velocities[row, 0], velocities[row, 1] = x, y
        if math.hypot(x, y) > about.moving_m_s:
            headings[row] = math.atan2(y, x)
        else:
            headings[row] = wrap(bodies.headings[b] - moved[2])
    row = seen
    for b in range(count):
        if paired[b] or bodies.ages[b] + elapsed > about.memory_s:
            continue
        vx, vy = bodies.velocities[b, 0], bodies.velocities[b, 1]
        velocities[row, 0], velocities[row, 1] = c * vx + s * vy, c * vy - s * vx
        positions[row, 0], positions[row, 1] = stood[b, 0], stood[b, 1]
        headings[row] = wrap(bodies.headings[b] - moved[2])
        ages[row] = bodies.ages[b] + elapsed
        row += 1
    return Bodies(positions, velocities, headings, ages)


@compiled
def _kept(velocities: Floats, headings: Floats, needs_velocities: bool, needs_headings: bool) -> Bools:
    """(M,) members of which what is needed is known."""
    kept = np.ones(len(headings), np.bool_)
    for i in range(len(headings)):
        if needs_velocities and math.isnan(velocities[i, 0]):
            kept[i] = False
        if needs_headings and math.isnan(headings[i]):
            kept[i] = False
    return kept


@compiled
def _renumbered(beams: Ints, kept: Bools) -> Ints:
    """The beams with the rows that their inputs have among the kept ones; those of others made none."""
    rows, count = np.full(len(kept), NOBODY, np.int64), 0
    for i in range(len(kept)):
        if kept[i]:
            rows[i] = count
            count += 1
    renumbered = np.full(len(beams), NOBODY, np.int64)
    for b in range(len(beams)):
        if beams[b] >= 0:
            renumbered[b] = rows[beams[b]]
    return renumbered
