"""What the sensors give and what the pipelines make of it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints, Members, Obstacles

NOBODY = -1
"""Owner of a beam or an input that belongs to no member."""


class Scan(NamedTuple):
    """One sweep of a laser, in the focal member's body frame."""

    time: float
    """s, when the last beam was read."""
    angles: Floats
    """(B,) bearing of each beam in the laser's frame, rad, increasing (counter-clockwise)."""
    ranges: Floats
    """(B,) m; inf = no return, −inf = too near, nan = error (REP 117)."""
    intensities: Floats
    """(B,) relative to a white diffuse surface seen head-on at 1 m; nan = not given. Where nobody reads them, scans
    share one array of nan that cannot be written to."""


Picture = NDArray[np.uint8]
"""(H, W, 3) red, green, blue; row 0 is the top, column 0 the left."""


class Images(NamedTuple):
    """What the two cameras of one robot gave at one update."""

    time: float
    """s, when the left image was taken."""
    left: Picture
    """(H, W, 3) RGB of the left camera."""
    right: Picture
    """(H, W, 3) RGB of the right camera."""


class Echoes(NamedTuple):
    """What the sonars of one robot heard at one update, and what it knows of them."""

    ranges: Floats
    """(S,) m, of each sonar; inf = nothing heard."""
    ring: Floats
    """(S, 3) x, y (m) and heading (rad) of each sonar in the body frame."""
    mate_m: float
    """How far from a flockmate's cone an echo of that flockmate may come from, m, of one of the own kind; nan = that
    has no cone."""


class ScanTruth(NamedTuple):
    """What no robot can know: which beam hit whom. For ground truth and recordings only.

    Of images, B = 2W columns stand in place of the beams: those of the left image, then those of the right one.
    """

    owners: Ints
    """(B,) index of the robot that made the reading, or whose cone the column shows; −1 = a wall, nothing, or a reading
    between two surfaces."""
    ranges: Floats
    """(B,) exact distance along each beam without noise, m; inf = nothing in range. (0,) where nobody reads them."""
    lit: Ints
    """(N,) beams that fell on each robot (before drop-outs and mixing); columns that show its cone."""


class WorldTruth(NamedTuple):
    """Global knowledge, for the pipeline of perfect detection only."""

    poses_w: Floats
    """(N, 3) x, y, heading of all robots."""
    velocities_w: Floats
    """(N, 2) m/s."""
    radii: Floats
    """(N,) m, of each robot's silhouette at the laser's height."""
    focal: int
    """Index of the focal member."""
    walls_w: Floats
    """(W, 4) segments x0, y0, x1, y1, which occlude."""
    marked: Bools | None = None
    """(N,) which robots can be told as members; None = all. The others look like parts of walls."""
    desired_w: Floats | None = None
    """(N, 2) how each robot would like to move, m/s; None where nobody is told."""


class Senses(NamedTuple):
    """What one robot sensed at one update; None where its pipeline does not read it."""

    scan: Scan | None
    truth: WorldTruth | None
    owners: Ints | None = None
    """(B,) as in `ScanTruth`: for the pipelines of perfect classification only."""
    images: Images | None = None
    echoes: Echoes | None = None


class Detection(NamedTuple):
    """What a pipeline made of the senses (stage 2)."""

    members: Members
    """The set D: each row is one input to the law."""
    obstacles: Obstacles
    beams: Ints
    """(B,) which row of `members` each beam made, −1 = none; (0,) where the pipeline reads no scan. Of images, (2W,)
    which row each column made: those of the left image, from the left to the right, then those of the right one."""


PipelineState = Any
"""What a pipeline keeps between updates: its parameters, its database, its memory."""
