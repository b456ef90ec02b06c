"""What the kinematic herd's compiled code is handed: plain arrays in tuples of fixed type, world frame.

Rows are members, N of them. Metres, seconds, radians.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flocking.perception import ARGUMENTS
from flocking.types import Bools, Floats, Ints

POSES, BEARINGS = 0, 1
"""What is known of where a neighbour is: its position, or its bearing alone."""


COSINE = 1
"""Where, among the numbers of an ANGLE step, the cosine of the angle stands if all members share that angle."""


LEAST, BELOW = 2, 3
"""Where, among the numbers of a DISTANCE_BASED step, the squares of its two distances stand if all members share them
(`flocking.perception.squared_bound`)."""


class Bodies(NamedTuple):
    """The state of each member's body, and its law's memory."""

    positions: Floats
    """(N, 2)."""
    headings: Floats
    """(N,)."""
    velocities: Floats
    """(N, 2)."""
    turn_rates: Floats
    """(N,)."""
    contacts: Bools
    """(N, 2) left and right bumper pressed in the last step."""
    memory: Floats
    """(N, MEMORY) numbers that the laws keep; as wide as the law that keeps most."""


class Limits(NamedTuple):
    """What each member's body can do."""

    cruise: Floats
    """(N,) speed towards a way-point; inf = it is reached in one step."""
    max_speed: Floats
    """(N,) inf = none."""
    max_turn_rate: Floats
    """(N,) inf = none."""
    radii: Floats
    """(N,) 0 = a point that nothing touches."""


class Minds(NamedTuple):
    """What each member's law is given."""

    parameters: Floats
    """(N, P) of its law, as wide as the law that has most; (1, P) if all members have the same."""
    goals: Floats
    """(N, 2) nan = none."""


class Place(NamedTuple):
    """The space that the members are in, and what joins them."""

    period: float
    """Side of the periodic square [0, period)²; 0 = not periodic."""
    walls: Floats
    """(W, 4) segments x0, y0, x1, y1; in periodic space with their images that anybody within it can reach."""
    clearance: float
    """Radius of a point as walls know it."""
    graph: Bools
    """(N, N) or (0, 0): links of `fixed-set` without ids."""
    tessellated: Bools
    """(N, N) or (0, 0): whose Voronoi cells touch."""


class HerdArrays(NamedTuple):
    """A herd at work, as the loops of the kernel share it."""

    bodies: Bodies
    limits: Limits
    minds: Minds
    place: Place
    dt: float
    """Time step, s."""
    motions: Floats
    """(N, 4) kind, x, y and rule of what each member decided last; body frame."""
    forward: bool
    """Whether members move by their old velocity, before they take up the new one."""
    axes: Floats
    """(N, 3) a heading of each member, and its cosine and sine, once worked out; nan = none yet."""


class Tracks(NamedTuple):
    """Where a piece of work keeps which of its steps."""

    rows: Floats
    """(T, N, 5) x, y, heading, vx, vy, world frame: one row a kept step."""
    every: int
    """One step in so many is kept."""
    before: int
    """Steps done, when the piece begins, since the one kept before the first row."""


class Stages(NamedTuple):
    """Stages 2 to 4 of the members of one band."""

    steps: Ints
    """(S, K) of the selections, as in `flocking.selection.Program`."""
    given: Floats
    """(S, K, ARGUMENTS)."""
    named: Ints
    """(S, K, ARGUMENTS)."""
    varied: bool
    """Whether members differ in their parameters: `named` then says where to read them, else `given` has them all."""
    parameters: int
    """How many of the columns of `Minds.parameters` are the law's."""
    memory: int
    """How many of the columns of `Bodies.memory` are the law's."""
    reach: float
    """Members beyond this distance change nothing; inf = no limit."""
    bearings: bool
    """Whether the law or a selection reads bearings."""
    headings: bool
    """Whether the law reads headings: virtual members that stand have none and are left out."""
    velocities: bool
    """Whether the law reads velocities; what it does not say that it reads is nan."""
    detection: int
    """`flocking.kinematic.detection.Detection`."""
    information: int
    """POSES or BEARINGS."""
    assumed_distance: float
    """Distance at which a member is taken to be if only its bearing is known."""
    silhouette: float
    """Radius of the members as a laser sees them."""
    sight: float
    """Range of obstacles and of the laser."""
    role: int
    """Role of all members of the band."""
    goal: bool
    """Whether the law reads its goal."""
    contacts: bool
    """Whether the law reads its bumpers."""
    obstacles: bool
    """Whether the law reads obstacles."""
    obstacle_steps: Ints
    """(K,) steps of the obstacles' selection, as in `flocking.obstacle_selection.program`."""
    obstacle_given: Floats
    """(K,) the number of each."""
    avoids: bool
    """Whether the shared avoidance is added to the law."""
    virtual: bool
    """Whether obstacles become virtual members."""
    virtual_range: float
    """Distance within which they do."""
    sight_lines: bool
    """Whether a wall hides what is behind it."""
    look_ahead: float
    """Of the shared avoidance."""
    margin: float
    """Of the shared avoidance."""


def example_bodies() -> Bodies:
    """Bodies of the right types, for the kernel's signature."""
    return Bodies(
        np.empty((0, 2)), np.empty(0), np.empty((0, 2)), np.empty(0), np.empty((0, 2), np.bool_), np.empty((0, 0))
    )


def example_herd() -> HerdArrays:
    """A herd of the right types, for the kernel's signature."""
    limits = Limits(np.empty(0), np.empty(0), np.empty(0), np.empty(0))
    minds = Minds(np.empty((0, 0)), np.empty((0, 2)))
    place = Place(0.0, np.empty((0, 4)), 0.0, np.empty((0, 0), np.bool_), np.empty((0, 0), np.bool_))
    return HerdArrays(example_bodies(), limits, minds, place, 0.0, np.empty((0, 4)), False, np.empty((0, 3)))


def example_tracks() -> Tracks:
    """Tracks of the right types, for the kernel's signature."""
    return Tracks(np.empty((0, 0, 5)), 1, 0)


def example_stages() -> Stages:
    """Stages of the right types, for the kernel's signature."""
    return Stages(
        np.zeros((1, 1), np.int64),
        np.zeros((1, 1, ARGUMENTS)),
        np.zeros((1, 1, ARGUMENTS), np.int64),
        True,
        0,
        0,
        0.0,
        True,
        True,
        True,
        0,
        0,
        0.0,
        0.0,
        0.0,
        0,
        True,
        True,
        True,
        np.zeros(1, np.int64),
        np.zeros(1),
        True,
        True,
        0.0,
        True,
        0.0,
        0.0,
    )
