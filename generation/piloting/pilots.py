"""Piloting robots on their ways: the local planner that keeps them off a herd and off one another.

A choice, as the document says nothing of it. Each robot follows its own route (`routes`) towards a place a little
ahead on it, and plans anew every `ANEW_S`. It stands and waits while somebody is near before it: a member of the herd,
a robot that has arrived, or one that goes before it by its number. Who has waited for `PATIENCE_S` plans a way round
all that stand near.
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
ROOM_M = 0.38
"""Distance of a route from robots that stand: two radii of a Create, and 50 mm. So the middle place between two robots
of a short wall, 0.35 m from each, is open from before it."""
ARRIVED_M = 0.1
"""A robot this near to its place has arrived: it may stay that far off, as a Create at rest does."""
CLEAR_M = 0.08
"""Distance of routes from walls, beside the radius. A choice: what a Create is off its way in a bend."""
ANEW_S = 2.0
PATIENCE_S = 3.0


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
                stand = still | ~np.isnan(self._waits)
                self._plan(k, time, places, herd, np.flatnonzero(stand & (np.arange(len(places)) != k)))
            aim = self._ahead(k, places[k])
            others = np.array([place for j, place in enumerate(places) if j != k and (still[j] or j < k)])
            # whom it will stand beside it need not keep farther from than that
            keep = np.minimum(KEEP_M, np.hypot(*(others.reshape(-1, 2) - self.goals[k]).T))
            near = np.concatenate([herd, others.reshape(-1, 2)]), np.concatenate([np.full(len(herd), KEEP_M), keep])
            if len(aim) == 0 or self._met(places[k], aim, *near):
                self._wait(k, time, places, herd)
                continue
            self._waits[k] = math.nan
            found[k] = aim
        return found

    def _plan(self, k: int, time: float, places: Floats, herd: Floats, standing: Ints) -> None:
        self._routes[k] = route(self.over, places[k], self.goals[k], herd, places[standing], ROOM_M)
        self._planned[k] = time

    def _ahead(self, k: int, place: Floats) -> Floats:
        """(2,) the place on the route that is driven to; (0,) without a route."""
        way = self._routes[k]
        if len(way) == 0:
            return np.empty(0)
        nearest = int(np.hypot(*(way - place).T).argmin())
        run = np.append(0.0, np.cumsum(np.hypot(*np.diff(way[nearest:], axis=0).T)))
        within = int(np.flatnonzero(run <= AHEAD_M)[-1])
        for further in range(within, 1, -1):  # round corners, not across them
            if self.over.is_clear(place, way[nearest + further]):
                return np.asarray(way[nearest + further])
        return np.asarray(way[nearest + min(within, 1)])

    def _met(self, place: Floats, aim: Floats, others: Floats, keep: Floats) -> bool:
        """Whether any of the others (O, 2) is nearer than `keep` (O,) before a robot that drives to `aim`."""
        way, offsets = aim - place, others - place
        apart = np.hypot(*offsets.T)
        return bool(((apart < keep) & (offsets @ way > BEFORE * apart * np.hypot(*way))).any())

    def _wait(self, k: int, time: float, places: Floats, herd: Floats) -> None:
        if math.isnan(self._waits[k]):
            self._waits[k] = time
        elif time - self._waits[k] >= PATIENCE_S:
            near = np.hypot(*(places - places[k]).T) < 2.0 * KEEP_M
            near[k] = False
            self._plan(k, time, places, herd, np.flatnonzero(near))
            self._waits[k] = time
