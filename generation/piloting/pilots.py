"""Piloting robots on their ways: the local planner that keeps them off a herd and off one another.

A choice, as the document says nothing of it. Each robot follows its own route (`routes`) towards a place a little
ahead on it, and plans anew every `ANEW_S`, round the robots that have arrived and those of higher numbers that wait. It
stands and waits while a member of the herd is near before it, and while its way leads too near by any other pilot. Who
has waited for its patience plans a way round all that stand near; lower numbers lose theirs first, so that no two give
way to one another for ever.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.types import Bools, Floats, Ints
from generation.piloting.routes import Ground, route

AHEAD_M = 0.5
"""Way along the route to the place that is driven to: three radii of a Create."""
KEEP_M = 0.55
"""Who is nearer than this, and before a robot, is waited for: two radii of a Create, and 0.2 m to brake in."""
BEFORE = math.cos(math.radians(60.0))
"""Cosine of the largest angle from the way on at which somebody is before a robot."""
ROOM_M = 0.44
"""Distance of a route from robots that stand: two radii of a Create and a tenth of a metre, so that one passes another
in the middle of a street of 1.5 m by the cells beside the wall."""
OFF_M = 0.36
"""Nearest that the way to the place ahead may lead by another pilot: two radii of a Create, and what a way may cut."""
ARRIVED_M = 0.1
"""A robot this near to its place has arrived: it may stay that far off, as a Create at rest does."""
ASIDE_M = 0.04
"""How much nearer the way into a place may lead by a neighbour than the place is: it comes in along cells."""
ANEW_S = 2.0
PATIENCE_S = 3.0
"""Of the first robot; each other's is a second longer than that of the one before."""


class Pilots:
    """Robots of which each has a place to go to, or none."""

    def __init__(self, over: Ground, count: int) -> None:
        self.over, self.goals = over, np.full((count, 2), math.nan)
        self._routes: list[Floats] = [np.empty((0, 2))] * count
        self._planned, self._waits = np.full(count, -math.inf), np.full(count, math.nan)

    def send(self, robots: Ints, places: Floats) -> None:
        """Gives robots (K,) new places (K, 2) to go to, m."""
        self.goals[robots] = places
        self._planned[robots] = -math.inf
        self._waits[robots] = math.nan

    def arrived(self, places: Floats) -> Bools:
        """(R,) which of the robots at places (R, 2) stand where they are to stand; those without a place do."""
        apart = np.hypot(*(places - self.goals).T)
        return np.asarray(~(apart > ARRIVED_M))

    def targets(self, time: float, places: Floats, herd: Floats) -> Floats:
        """(R, 2) where robots at places (R, 2) drive to now, m: their own place where they are to stand still.

        `time`: s; `herd` (M, 2): where its members are.
        """
        still = self.arrived(places)
        found = np.where(still[:, None], np.where(np.isnan(self.goals), places, self.goals), places)
        for k in np.flatnonzero(~still).tolist():
            if time - self._planned[k] >= ANEW_S:
                stand = still | (~np.isnan(self._waits) & (np.arange(len(places)) > k))
                self._plan(k, time, places, herd, np.flatnonzero(stand))
            aim = self._aim(k, places, still)
            if aim is None or _met(places[k], aim, herd):
                self._wait(k, time, places, herd)
                continue
            self._waits[k] = math.nan
            found[k] = aim
        return found

    def _plan(self, k: int, time: float, places: Floats, herd: Floats, standing: Ints) -> None:
        self._routes[k] = route(self.over, places[k], self.goals[k], herd, places[standing], ROOM_M)
        self._planned[k] = time

    def _ahead(self, k: int, place: Floats) -> Floats:
        """(A, 2) the places on the route that can be driven to, the farthest first; none without a route."""
        way = self._routes[k]
        if len(way) == 0:
            return np.empty((0, 2))
        nearest = int(np.hypot(*(way - place).T).argmin())
        run = np.append(0.0, np.cumsum(np.hypot(*np.diff(way[nearest:], axis=0).T)))
        last = nearest + int(np.flatnonzero(run <= AHEAD_M)[-1])
        return np.asarray(way[min(nearest + 1, last) : last + 1][::-1])

    def _aim(self, k: int, places: Floats, still: Bools) -> Floats | None:
        """The farthest place ahead to which the way leads too near by no other pilot; None where there is none.

        To those on their way it keeps its distance over the whole way ahead. Beside those that stand where they are to
        stand it may come as near as its own place is, `ASIDE_M` less.
        """
        ahead, others = self._ahead(k, places[k]), np.arange(len(places)) != k
        offsets, stand = places[others] - places[k], still[others]
        beside = np.minimum(OFF_M, np.hypot(*(places[others] - self.goals[k]).T) - ASIDE_M)
        for aim in ahead:
            if not _near(aim - places[k], offsets[stand], beside[stand]):
                farthest = ahead[0] - places[k]
                return None if _near(farthest, offsets[~stand], np.full(int((~stand).sum()), OFF_M)) else aim
        return None

    def _wait(self, k: int, time: float, places: Floats, herd: Floats) -> None:
        if math.isnan(self._waits[k]):
            self._waits[k] = time
        elif time - self._waits[k] >= PATIENCE_S + k:
            near = np.hypot(*(places - places[k]).T) < 2.0 * KEEP_M
            near[k] = False
            self._plan(k, time, places, herd, np.flatnonzero(near))
            self._waits[k] = time


def _near(way: Floats, offsets: Floats, off: Floats) -> bool:
    """Whether a straight way (2,) leads nearer than `off` (M,) by any of those at `offsets` (M, 2) from its begin, m.

    Those that it leads away from do not count.
    """
    part = np.clip(offsets @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
    nearest = np.hypot(*(offsets - part[:, None] * way).T)
    return bool(((part > 0.0) & (nearest < off)).any())


def _met(place: Floats, aim: Floats, herd: Floats) -> bool:
    """Whether a member of a herd (M, 2) is near before a robot that is about to drive to `aim`."""
    if len(herd) == 0:
        return False
    way, offsets = aim - place, herd - place
    length, apart = np.hypot(*way), np.hypot(*offsets.T)
    before = offsets @ way > BEFORE * apart * length
    return bool(((apart < KEEP_M) & before).any())
