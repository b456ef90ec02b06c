"""What happens in a trial of robots besides them: how far the herd has come, and the walls and pilots that follow it.

At each sample the course of each guided robot is brought up to date. Once all of them that are still on their course
have cleared a wall, the next stage begins: walls rise and vanish, or pilots are sent where they are wanted next. A wall
rises once no robot stands in its place. Sheepdogs know one stage: they drive the members that are still on their course
to the corner of the trajectory that the last of these has next before it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flocking.types import Floats, Ints
from generation.free_space import distance
from generation.piloting import course, formations
from generation.piloting.dogs import ROOM_M, Sheepdogs
from generation.piloting.pilots import CLEAR_M, Pilots
from trials.simulations.contract import Watcher
from trials.simulations.robots import guided
from trials.types import Trial
from worlds.assemble import World
from worlds.walls import FENCE


class Guided:
    """A herd that is guided through a task."""

    def __init__(self, trial: Trial, world: World, tell: Callable[[int, Floats], None]) -> None:
        """`tell`: gives a pilot, by its index, a new goal (2,), m."""
        self.given, self.task, self.plan = guided.parameters(trial), guided.task_of(trial), guided.plan_of(trial)
        self.world, self.tell = world, tell
        self.watcher: Watcher | None = None
        """Says when a wall has been cleared, in place of the herd's course; as the user does in the document."""
        self.herd, self.pilots = guided.members(trial, pilots=False), guided.members(trial, pilots=True)
        self.passed = 0
        """Walls that have been cleared."""
        self.stages: list[tuple[float, float]] = []
        """When each stage began, and when the pilots that were sent then stood in their places (nan: never), s."""
        self.rows: list[tuple[float, float, float, float, float, float]] = []
        """Walls that stood: from, to (nan: to the end), x0, y0, x1, y1."""
        self.sent: list[tuple[float, float, float, float, float]] = []
        """Pilots that were sent to a place: when, which robot, to which wall (from 0), x, y."""
        self._leg, self._astray = np.zeros(len(self.herd), np.int64), np.zeros(len(self.herd), np.bool_)
        self._rooms = np.array([body.radius for body in world.bodies]) + FENCE / 2.0
        """(N,) nearest that the middle of a wall may come to each robot, m."""
        self._waiting = False
        """Whether a wall waits for a robot to leave its place."""
        self._stand: dict[int, int] = {}
        """Number of a wall that stands → its row."""
        self._held: dict[int, Ints] = {}
        self._under_way: dict[int, Ints] = {}
        """Number of a stage → the pilots that were sent in it and have not all arrived."""
        self._drivers: Pilots | None = None
        self._dogs: Sheepdogs | None = None
        radius = max((world.bodies[k].radius for k in self.pilots), default=0.0)
        if self.given.guides == guided.PILOTS:
            self._drivers = Pilots(guided.ground_of(trial, radius + CLEAR_M), len(self.pilots))
        elif self.given.guides == guided.SHEEPDOGS:
            over = guided.ground_of(trial, radius + ROOM_M)
            self._dogs = Sheepdogs(over, len(self.pilots), self.given.rule)

    def update(self, time: float, poses_w: Floats) -> None:
        """Brings everything up to date with where robots are: poses (N, 3) at that time, s."""
        places = poses_w[self.herd, :2]
        of = course.course(self.task, places[None], self._leg, self._astray)
        self._leg, self._astray = of.leg[0], of.astray[0]
        if not self.stages:
            self._begin(time, poses_w)
        elif self.passed < len(self.plan.walls):
            if self._is_cleared(time, places, of):
                self.passed += 1
                self._begin(time, poses_w)
        elif self.watcher is not None:
            there = course.in_goal(self.task, places[None], of)[0]
            self.watcher(time, self.passed, 0, int(there.sum()), int((~self._astray).sum()))
        if self._waiting:
            self._raise_walls(time, poses_w)
        if self._drivers is not None:
            self._drive(time, poses_w)
        if self._dogs is not None:
            self._herd(self._dogs, time, poses_w)

    def tables(self) -> dict[str, Floats]:
        """What is kept of it: `stages` (S, 2), `standing` (E, 6) and `sent` (P, 5), as the lists above."""
        return {
            "stages": np.array(self.stages).reshape(-1, 2),
            "standing": np.array(self.rows).reshape(-1, 6),
            "sent": np.array(self.sent).reshape(-1, 5),
        }

    def _is_cleared(self, time: float, places: Floats, of: course.Course) -> bool:
        through = course.passed(self.task, places[None], of, self.task.turns[self.passed], self.given.beyond_m)[0]
        if self.watcher is not None:
            left = len(self.plan.walls) - self.passed
            return self.watcher(time, self.passed, left, int(through.sum()), int((~self._astray).sum()))
        return bool(through.any() and (through | self._astray).all())

    def _begin(self, time: float, poses_w: Floats) -> None:
        """The next stage: what is to stand from now on."""
        self.stages.append((time, time if self._drivers is None else np.nan))
        if self.given.guides == guided.WALLS:
            self._raise_walls(time, poses_w)
        elif self._drivers is not None:
            held = formations.change(
                self.task, self.plan, self.passed, poses_w[self.pilots, :2], self._held,
                self.given.robots_a_wall, self.given.assignment,  # type: ignore[arg-type]
            )  # fmt: skip
            self._held = held.walls
            sent = set(held.moving.tolist())
            self._under_way = {stage: who for stage, who in self._under_way.items() if not sent & set(who.tolist())}
            self._under_way[len(self.stages) - 1] = held.moving
            self._drivers.send(held.moving, held.places)
            walls = {int(robot): wall for wall, robots in held.walls.items() for robot in robots}
            for robot, place in zip(held.moving.tolist(), held.places.tolist(), strict=True):
                self.sent.append((time, float(self.pilots[robot]), float(walls[robot]), *place))

    def _raise_walls(self, time: float, poses_w: Floats) -> None:
        """Lets the walls stand that are to stand; one in whose place a robot is waits until that has gone."""
        standing, data = self.world.standing, self.world.data
        wanted = self.plan.standing(self.passed, self.given.at_once or None)
        self._waiting = False
        for k in range(len(standing.segments)):
            if standing.up[k] == (k in wanted):
                continue
            if k in wanted and (distance(standing.segments[k : k + 1], poses_w[:, :2]) < self._rooms).any():
                self._waiting = True
                continue
            standing.put(data, k, k in wanted)
            if k in wanted:
                self._stand[k] = len(self.rows)
                self.rows.append((time, np.nan, *standing.segments[k].tolist()))
            else:
                ended = self._stand.pop(k)
                self.rows[ended] = (self.rows[ended][0], time, *self.rows[ended][2:])

    def _drive(self, time: float, poses_w: Floats) -> None:
        assert self._drivers is not None
        places = poses_w[self.pilots, :2]
        for k, target in zip(self.pilots, self._drivers.targets(time, places, poses_w[self.herd, :2]), strict=True):
            self.tell(int(k), target)
        there = self._drivers.arrived(places)
        for stage in [stage for stage, sent in self._under_way.items() if there[sent].all()]:
            self.stages[stage] = (self.stages[stage][0], time)
            del self._under_way[stage]

    def _herd(self, dogs: Sheepdogs, time: float, poses_w: Floats) -> None:
        """Dogs leave those that have gone astray, as stages do; once all have, they go after all."""
        heeded = ~self._astray | self._astray.all()
        goal = self.task.trajectory[self._leg[heeded].min() + 1]
        places = dogs.targets(time, poses_w[self.pilots, :2], poses_w[self.herd[heeded], :2], goal)
        for k, place in zip(self.pilots, places, strict=True):
            self.tell(int(k), place)
