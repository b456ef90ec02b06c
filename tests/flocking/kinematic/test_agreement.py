"""The compiled herd against a plain evaluation, in a process that compiles nothing: every law, hundreds of states."""

from __future__ import annotations

import math
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.kinematic import Band, Space
from flocking.kinematic.arrays import Bodies
from flocking.kinematic.herd import KinematicHerd

ROOT = Path(lawentry.__file__).parents[1]
MEMBERS, STATES = 8, 120
"""States recorded a law; with 8 members each, some thousand decisions."""
TOLERANCE = 1e-12
"""Of a coordinate in units of the scene: the two add the same terms, in another order and by another maths library;
forces grow steep near a neighbour, so it is relative to the largest number in the state after the step."""

LAWS = lawentry.names()


def scene(name: str) -> tuple[Band, np.ndarray, Space, float, np.ndarray]:
    """A herd of the law at its own scale, its start, its space, its time step and its graph."""
    law = lawentry.load(name)
    rng = np.random.default_rng(11)
    side = law.herd.spacing_m * math.sqrt(MEMBERS)
    poses = np.column_stack([rng.uniform(0.0, side, (MEMBERS, 2)), rng.uniform(-math.pi, math.pi, MEMBERS)])
    goals = np.full((MEMBERS, 2), np.nan)
    goals[::2] = 10.0 * side
    band = Band(law, MEMBERS, cruise_m_s=2.0 * law.herd.speed_m_s, goals_w=goals)
    periodic = law.herd.space == "periodic"
    graph = np.abs(np.subtract.outer(range(MEMBERS), range(MEMBERS))) == 1
    return band, poses, Space("periodic", side) if periodic else Space(), law.herd.dt_s, graph


def copied(bodies: Bodies) -> Bodies:
    return Bodies._make(array.copy() for array in bodies)


def recorded(name: str) -> list[tuple[Bodies, np.ndarray, Bodies]]:
    """(before, draws, after) of single steps; the herd starts anew, elsewhere, every 20 steps."""
    band, poses, space, dt, graph = scene(name)
    found = []
    for start in range(STATES // 20):
        rng = np.random.default_rng(start)
        moved = poses + rng.normal(0.0, 0.3 * band.law.herd.spacing_m, poses.shape)
        herd = KinematicHerd([band], moved, space, graph, dt, np.random.default_rng(start))
        herd.start(None, band.law.herd.speed_m_s)
        for step in range(20):
            herd.law_rng = np.random.default_rng([start, step])
            before = copied(herd.bodies)
            herd.advance(1, np.empty((1, MEMBERS, 5)), 1, step, True)
            found.append(
                (before, np.random.default_rng([start, step]).random((MEMBERS, band.law.draws)), copied(herd.bodies))
            )
    return found


def plain_steps(data: dict[str, list[tuple[Bodies, np.ndarray]]]) -> dict[str, list[Bodies]]:
    """The same steps by plain Python."""
    from flocking.kinematic import plain

    found = {}
    for name, states in data.items():
        band, _, space, dt, graph = scene(name)
        period = space.size_m if space.kind == "periodic" else 0.0
        found[name] = [plain.step([band], before, [draws], dt, period, graph) for before, draws in states]
    return found


@pytest.fixture(scope="module")
def both() -> dict[str, tuple[list[Bodies], list[Bodies]]]:
    """For each law the states after each step: compiled, and by a process in which nothing is compiled."""
    steps = {name: recorded(name) for name in LAWS}
    given = pickle.dumps({name: [(before, draws) for before, draws, _ in rows] for name, rows in steps.items()})
    done = subprocess.run(
        [sys.executable, str(Path(__file__).resolve())],
        input=given,
        stdout=subprocess.PIPE,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)},
        check=True,
    )
    plain: dict[str, Any] = pickle.loads(done.stdout)
    return {name: ([after for _, _, after in rows], plain[name]) for name, rows in steps.items()}


@pytest.mark.parametrize("name", LAWS)
def test_single_steps_are_those_of_the_plain_law(name: str, both: dict[str, tuple[list[Bodies], list[Bodies]]]) -> None:
    compiled, plain = both[name]
    assert len(compiled) == len(plain) == STATES
    for ours, theirs in zip(compiled, plain, strict=True):
        for field in ("positions", "velocities", "memory"):
            a, b = getattr(ours, field), getattr(theirs, field)
            assert np.abs(a - b).max(initial=0.0) <= TOLERANCE * max(1.0, np.abs(b).max(initial=0.0)), field
        turned = (ours.headings - theirs.headings + math.pi) % (2.0 * math.pi) - math.pi
        moving = np.hypot(*theirs.velocities.T) > 1e-3 * np.hypot(*theirs.velocities.T).max()
        # of a member that has all but stopped, the direction is that of its rounding errors
        assert np.abs(turned[moving]).max(initial=0.0) <= 1e3 * TOLERANCE


def test_the_herds_move() -> None:
    """The comparison would hold for herds that stand still."""
    still = [name for name in LAWS if not any((b.positions != a.positions).any() for b, _, a in recorded(name)[:20])]
    assert not still


if __name__ == "__main__":
    import numba

    assert numba.config.DISABLE_JIT
    pickle.dump(plain_steps(pickle.load(sys.stdin.buffer)), sys.stdout.buffer)
