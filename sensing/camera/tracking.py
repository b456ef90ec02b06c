"""Cones followed from image to image: which one is which, smoothed places, and velocities over ground.

Tracks are carried on by their own velocity and brought into the present body frame by the robot's own motion. Pairs of
tracks and cones are those of least cost (SciPy's linear assignment): how far they are apart in bearing and in the
logarithm of the distance, each over what noise and motion allow; beyond three times that there is no pair, and none
between colours. A track's place and velocity follow an alpha-beta filter whose gains fall, as those of a least-squares
line do, to the ones given. A track that no cone meets is kept for a while.

Metres, seconds, radians; the robot's body frame.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from flocking.angles import wrapped
from flocking.types import Floats, Ints, Own

GATE = 3.0
NO_PAIR = 1e6
NEAR_M = 0.1
"""Of a cone nearer than this, motion turns the bearing as if it were this far."""


class Settings(NamedTuple):
    """Of the pairing and the filter."""

    top_speed_m_s: float
    bearing_noise_rad: float
    distance_noise: float
    """Share of the distance."""
    place_gain: float
    velocity_gain: float
    memory_s: float


class Tracks(NamedTuple):
    """T tracks, seen now or not long ago."""

    places: Floats
    """(T, 2)."""
    velocities: Floats
    """(T, 2) over ground, in the body's axes."""
    colours: Ints
    """(T,)."""
    ids: Ints
    """(T,) rising, never used again."""
    hits: Ints
    """(T,) how many cones each has met."""
    unseen_s: Floats
    """(T,) since the last one, up to now."""
    next_id: int


NO_TRACKS = Tracks(
    np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, np.int64),
    np.empty(0), 0,
)  # fmt: skip


def moved(tracks: Tracks, own: Own) -> Tracks:
    """The tracks at this update: on by their own velocities, and in the frame of the robot that has moved."""
    dt = own.dt if math.isfinite(own.dt) and own.dt > 0.0 else 0.0
    if not len(tracks.ids) or dt == 0.0:
        return tracks
    velocity = np.where(np.isfinite(own.velocity), own.velocity, 0.0)
    turn = own.turn_rate * dt if math.isfinite(own.turn_rate) else 0.0
    # the velocity is in the axes of now; half a turn ago the body looked the other half of the way
    back, half = _turned_by(-turn), _turned_by(turn / 2.0)
    places = (tracks.places + tracks.velocities * dt) @ back.T - (half @ velocity * dt) @ back.T
    return tracks._replace(places=places, velocities=tracks.velocities @ back.T, unseen_s=tracks.unseen_s + dt)


def _turned_by(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def followed(tracks: Tracks, cones: Floats, colours: Ints, settings: Settings) -> tuple[Tracks, Ints]:
    """The tracks after meeting cones at (M, 2) of these colours (M,), and which track (M,) each cone is.

    `tracks` are those of now (`moved`).
    """
    pairs = np.full(len(cones), -1)
    if len(cones) and len(tracks.ids):
        costs = _costs(tracks, cones, colours, settings)
        rows, columns = linear_sum_assignment(costs)
        good = costs[rows, columns] < NO_PAIR
        pairs[columns[good]] = rows[good]
    places, velocities = tracks.places.copy(), tracks.velocities.copy()
    hits, unseen = tracks.hits.copy(), tracks.unseen_s.copy()
    met = np.flatnonzero(pairs >= 0)
    rows = pairs[met]
    hits[rows] += 1
    n = hits[rows].astype(np.float64)
    alpha = np.maximum(2.0 * (2.0 * n - 1.0) / (n * (n + 1.0)), settings.place_gain)
    beta = np.maximum(6.0 / (n * (n + 1.0)), settings.velocity_gain)
    off = cones[met] - places[rows]
    places[rows] += alpha[:, None] * off
    since = np.where(unseen[rows] > 0.0, unseen[rows], math.inf)
    velocities[rows] += (beta / since)[:, None] * off
    speeds = np.hypot(*velocities[rows].T)
    velocities[rows] *= np.minimum(1.0, settings.top_speed_m_s / np.maximum(speeds, 1e-12))[:, None]
    unseen[rows] = 0.0

    kept = np.flatnonzero(unseen <= settings.memory_s)
    now_at = np.full(len(unseen), -1)
    now_at[kept] = np.arange(len(kept))
    new = np.flatnonzero(pairs < 0)
    pairs[met] = now_at[rows]
    pairs[new] = len(kept) + np.arange(len(new))
    return (
        Tracks(
            np.concatenate([places[kept], cones[new]]),
            np.concatenate([velocities[kept], np.zeros((len(new), 2))]),
            np.concatenate([tracks.colours[kept], colours[new]]),
            np.concatenate([tracks.ids[kept], tracks.next_id + np.arange(len(new))]),
            np.concatenate([hits[kept], np.ones(len(new), np.int64)]),
            np.concatenate([unseen[kept], np.zeros(len(new))]),
            tracks.next_id + len(new),
        ),
        pairs,
    )


def _costs(tracks: Tracks, cones: Floats, colours: Ints, settings: Settings) -> Floats:
    """(T, M), `NO_PAIR` beyond the gate."""
    near = np.maximum(np.hypot(*tracks.places.T), NEAR_M)
    far = np.maximum(np.hypot(*cones.T), NEAR_M)
    turns = wrapped(np.subtract.outer(np.arctan2(*tracks.places.T[::-1]), np.arctan2(*cones.T[::-1])))
    ways = np.subtract.outer(np.log(near), np.log(far))
    # what moves within the time since it was seen: a track's own velocity is part of it already, once it has one
    motion = (settings.top_speed_m_s * np.maximum(tracks.unseen_s, 0.0) / near)[:, None]
    squares = (turns / (settings.bearing_noise_rad + motion)) ** 2 + (ways / (settings.distance_noise + motion)) ** 2
    allowed = (squares <= GATE**2) & (tracks.colours[:, None] == colours)
    return np.where(allowed, squares, NO_PAIR)
