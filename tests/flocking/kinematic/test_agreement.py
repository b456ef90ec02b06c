"""The compiled herd against a plain evaluation, in a process that compiles nothing: every law, hundreds of states."""

from __future__ import annotations

import math
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from flocking import avoidance, lawentry, lawsource
from flocking.kinematic import Band, Space
from flocking.kinematic.arrays import Bodies
from flocking.kinematic.herd import KinematicHerd
from flocking.parameters import declared

ROOT = Path(lawentry.__file__).parents[1]
TOLERANCE = 1e-12
"""Of a coordinate in units of the scene: the two add the same terms, in another order and by another maths library;
forces grow steep near a neighbour, so it is relative to the largest number in the state after the step."""
LEAST_SHARE = 1e-3
"""Of the fastest member's speed: of a slower one the direction is that of its rounding errors."""

LAWS = lawsource.names()
OBSTACLES = ("as-law", "avoid", "virtual-members")


class Scene(NamedTuple):
    """A herd of one law at its own scale, and of which steps of it the plain law is to find the same."""

    bands: list[Band]
    poses_w: np.ndarray
    space: Space
    graph: np.ndarray
    dt: float
    starts: int
    """The herd starts anew, elsewhere, so many times."""
    steps: int
    """From each start."""
    judged: list[int]
    """Members whose steps are compared."""
    synchronous: bool = True

    @property
    def period(self) -> float:
        return self.space.size_m if self.space.kind == "periodic" else 0.0

    @property
    def walls(self) -> np.ndarray | None:
        return self.space.walls if len(self.space.walls) else None


def bare(name: str) -> Scene:
    """Eight members in the law's own space without walls, half of them with a goal: 200 states."""
    law, count = lawentry.load(name), 8
    poses, graph, side = started(law, count)
    goals = np.full((count, 2), np.nan)
    goals[::2] = 10.0 * side
    band = Band(law, count, cruise_m_s=2.0 * law.herd.speed_m_s, goals_w=goals)
    space = Space("periodic", side) if law.herd.space == "periodic" else Space()
    return Scene([band], poses, space, graph, law.herd.dt_s, 10, 20, list(range(count)))


def in_turn(name: str) -> Scene:
    """The bare herd, whose members decide and move one after the other: 40 states."""
    return bare(name)._replace(starts=10, steps=4, synchronous=False)


def furnished(name: str) -> Scene:
    """Sixty members, some of them leaders with parameters of their own, with limits, among walls: 40 states.

    Enough members for cells; what is done about obstacles goes by turns from law to law.
    """
    law, count, leaders = lawentry.load(name), 60, 5
    poses, graph, side = started(law, count)
    spacing, speed = law.herd.spacing_m, law.herd.speed_m_s
    limits: dict[str, Any] = {
        "cruise_m_s": 2.0 * speed,
        "max_speed_m_s": 1.2 * speed,
        "max_turn_rate_rad_s": 0.5 / law.herd.dt_s,
        "sight_m": 2.0 * spacing,
        "obstacles": OBSTACLES[LAWS.index(name) % len(OBSTACLES)],
        "obstacle_selection": ("all", "nearest", "ahead(200) & within(50)")[LAWS.index(name) % 4 % 3],
        "avoidance": avoidance.Parameters(0.75 * spacing, 0.28 * spacing, spacing),
    }
    bands = [
        Band(law, leaders, varied(law, leaders), goals_w=np.full((leaders, 2), 3.0 * side), role=1, **limits),
        Band(law, count - leaders, goals_w=np.full((count - leaders, 2), np.nan), **limits),
    ]
    rng = np.random.default_rng(7)
    middles, turns = rng.uniform(0.0, side, (12, 2)), rng.uniform(0.0, math.pi, 12)
    along = 0.5 * spacing * np.column_stack([np.cos(turns), np.sin(turns)])
    space = Space(walls=np.hstack([middles - along, middles + along]))
    return Scene(bands, poses, space, graph, law.herd.dt_s, 10, 4, [0, 3, 20, 33, 59])


def started(law: lawentry.Law, count: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Poses, who is linked to whom, and the side of the square that the members fill."""
    rng = np.random.default_rng(11)
    side = law.herd.spacing_m * math.sqrt(count)
    poses = np.column_stack([rng.uniform(0.0, side, (count, 2)), rng.uniform(-math.pi, math.pi, count)])
    return poses, np.abs(np.subtract.outer(range(count), range(count))) == 1, side


def varied(law: lawentry.Law, count: int) -> list[dict[str, Any]]:
    """Parameters for each of so many members: the law's numbers, one of them a little smaller from member to member."""
    fields = declared(law.module.Parameters).values()
    name = next((d.name for d in fields if d.type is float and d.default > d.about.low >= 0.0), None)
    if name is None:
        return [{} for _ in range(count)]
    usual = law.parameters({})._asdict()[name]
    low = declared(law.module.Parameters)[name].about.low
    return [{name: low + (usual - low) * (1.0 - 0.01 * k)} for k in range(count)]


SCENES: dict[str, Callable[[str], Scene]] = {"bare": bare, "in turn": in_turn, "furnished": furnished}
CASES = [
    (kind, name)
    for kind in SCENES
    for name in LAWS
    # the herd's cells are those of the step's beginning, the plain step's those of each member's turn
    if kind != "in turn" or "voronoi" not in "".join(lawentry.sets_of(lawentry.module_of(name)).values())
]


def forward(law: lawentry.Law) -> bool:
    """Whether the law's own herd moves by the old velocities."""
    return law.herd.updating == "forward"


def copied(bodies: Bodies) -> Bodies:
    return Bodies._make(array.copy() for array in bodies)


def draws_of(scene: Scene, start: int, step: int) -> list[np.ndarray]:
    """What the law of each band draws in one step."""
    rng = np.random.default_rng([start, step])
    return [rng.random((band.count, band.law.draws)) for band in scene.bands]


def order_of(scene: Scene, start: int, step: int) -> np.ndarray:
    """Who comes when, if they come in turn."""
    return np.argsort(np.random.default_rng([start, step, 1]).random(len(scene.poses_w)))


def recorded(scene: Scene) -> list[tuple[Bodies, list[np.ndarray], Bodies]]:
    """(before, draws, after) of single steps."""
    found = []
    for start in range(scene.starts):
        rng = np.random.default_rng(start)
        moved = scene.poses_w + rng.normal(0.0, 0.3 * scene.bands[0].law.herd.spacing_m, scene.poses_w.shape)
        rng = np.random.default_rng(start)
        herd = KinematicHerd(
            scene.bands, moved, scene.space, scene.graph, scene.dt, rng, forward=forward(scene.bands[0].law)
        )
        herd.start(None, scene.bands[0].law.herd.speed_m_s)
        for step in range(scene.steps):
            herd.law_rng = np.random.default_rng([start, step])
            herd.order_rng = np.random.default_rng([start, step, 1])
            before = copied(herd.bodies)
            herd.advance(1, np.empty((1, len(moved), 5)), 1, step, scene.synchronous)
            found.append((before, draws_of(scene, start, step), copied(herd.bodies)))
    return found


Given = dict[tuple[str, str], list[tuple[Bodies, list[np.ndarray]]]]


def plain_steps(data: Given) -> dict[tuple[str, str], list[Bodies]]:
    """The same steps by plain Python."""
    from flocking.kinematic import plain

    found = {}
    for (kind, name), states in data.items():
        scene = SCENES[kind](name)
        found[kind, name] = []
        for k, (state, draws) in enumerate(states):
            around = (scene.dt, scene.period, scene.graph, scene.walls)
            updating = forward(scene.bands[0].law)
            turns, numbers = [scene.judged], draws
            if not scene.synchronous:  # each on what the others have left; draws are in the order of the turns
                order = order_of(scene, *divmod(k, scene.steps))
                turns, numbers = [[int(i)] for i in order], [draws[0][np.argsort(order)]]
            for who in turns:
                state = plain.step(scene.bands, state, numbers, *around, who, updating)
            found[kind, name].append(state)
    return found


class Steps(NamedTuple):
    """The states of a scene's herd: before each step, after it, and after it by a process that compiles nothing."""

    before: list[Bodies]
    compiled: list[Bodies]
    plain: list[Bodies]


@pytest.fixture(scope="module")
def both() -> dict[tuple[str, str], Steps]:
    """Of each law in each kind of scene."""
    steps = {(kind, name): recorded(SCENES[kind](name)) for kind, name in CASES}
    given = pickle.dumps({key: [(before, draws) for before, draws, _ in rows] for key, rows in steps.items()})
    done = subprocess.run(
        [sys.executable, str(Path(__file__).resolve())],
        input=given,
        stdout=subprocess.PIPE,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)},
        check=True,
    )
    plain: dict[tuple[str, str], list[Bodies]] = pickle.loads(done.stdout)
    return {
        key: Steps([before for before, _, _ in rows], [after for _, _, after in rows], plain[key])
        for key, rows in steps.items()
    }


@pytest.mark.parametrize(("kind", "name"), CASES)
def test_single_steps_are_those_of_the_plain_law(kind: str, name: str, both: dict[tuple[str, str], Steps]) -> None:
    _, compiled, plain = both[kind, name]
    scene = SCENES[kind](name)
    assert len(compiled) == len(plain) == scene.starts * scene.steps
    compared = 0
    for ours, theirs in zip(compiled, plain, strict=True):
        free = [i for i in scene.judged if not ours.contacts[i].any()]  # a wall stops the others in ours alone
        compared += len(free)
        for field in ("positions", "velocities", "memory"):
            a, b = getattr(ours, field)[free], getattr(theirs, field)[free]
            assert np.abs(a - b).max(initial=0.0) <= TOLERANCE * max(1.0, np.abs(b).max(initial=0.0)), field
        speeds = np.hypot(*theirs.velocities[free].T)
        fastest = speeds.max(initial=0.0)
        for field, times in (("headings", 1.0), ("turn_rates", scene.dt)):
            a, b = getattr(ours, field)[free] * times, getattr(theirs, field)[free] * times
            turned = np.abs((a - b + math.pi) % (2.0 * math.pi) - math.pi)
            # an error of the velocity turns it by as much over its length
            allowed = TOLERANCE * fastest / np.maximum(speeds, LEAST_SHARE * fastest + 1e-300)
            moving = speeds > LEAST_SHARE * fastest
            assert (turned[moving] <= np.maximum(allowed, 4.0 * TOLERANCE)[moving]).all(), field
    assert compared >= 0.5 * len(scene.judged) * len(compiled)


def test_the_herds_move(both: dict[tuple[str, str], Steps]) -> None:
    """The comparison would hold for herds that stand still."""
    for name in LAWS:
        before, after, _ = both["bare", name]
        assert any((b.positions != a.positions).any() for b, a in zip(before, after, strict=True)), name


if __name__ == "__main__":
    import numba

    assert numba.config.DISABLE_JIT
    pickle.dump(plain_steps(pickle.load(sys.stdin.buffer)), sys.stdout.buffer)
