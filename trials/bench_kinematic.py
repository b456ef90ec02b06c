"""`herd bench`, the kinematic herd: steps a second, growth with the herd, against plain Python, a whole command."""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np

from flocking import lawentry
from flocking.kinematic import Band, Space, plain, simulate, start_uniform
from flocking.kinematic.arrays import Bodies
from flocking.types import Floats

BOIDS = "reynolds-opensteer"
SIZES = (1_000, 10_000, 100_000)
NEIGHBOURS = 8.0
"""Mean number of members within the range of cohesion at the start: a short range against the space."""
STEPS = 100
"""Steps of a run are 30 to 1000: large herds do fewer."""
SMALL = 50
"""Members of the herd that is held against plain Python."""


def _boids(count: int) -> tuple[Band, Floats, float]:
    """A flock of boids in the open, its start and its time step."""
    law = lawentry.load(BOIDS)
    parameters = law.parameters({})
    side = parameters.cohesion_m * math.sqrt(math.pi * count / NEIGHBOURS)
    return Band(law, count), start_uniform(count, side, np.random.default_rng(1)), law.herd.dt_s


def _step_seconds(count: int, steps: int) -> float:
    """Wall time of one step of that many boids in unbounded space, on one core."""
    band, poses, dt = _boids(count)
    started = perf_counter()
    simulate(
        band,
        poses,
        dt_s=dt,
        steps=steps,
        every=steps,
        rng=np.random.default_rng(2),
        speeds_m_s=band.law.herd.speed_m_s,
        space=Space(),
    )
    return (perf_counter() - started) / steps


def _plain_seconds() -> float:
    """Wall time of one step of the small flock, member by member in plain Python and NumPy."""
    band, poses, dt = _boids(SMALL)
    velocities = band.law.herd.speed_m_s * np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    state = Bodies(
        poses[:, :2].copy(),
        poses[:, 2].copy(),
        velocities,
        np.zeros(SMALL),
        np.zeros((SMALL, 2), bool),
        np.zeros((SMALL, 0)),
    )
    draws = np.zeros((SMALL, band.law.draws))
    started = perf_counter()
    for _ in range(3):
        state = plain.step([band], state, [draws], dt)
    return (perf_counter() - started) / 3


def measured(repeated: Callable[..., tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    """The runs of each figure: steps a second by size, exponent of growth, times plain Python."""
    found: dict[str, tuple[float, ...]] = {}
    costs = {
        count: repeated(_step_seconds, count, max(2, min(10 * STEPS, 3 * STEPS * 10_000 // count))) for count in SIZES
    }
    for count, seconds in costs.items():
        found[f"{count:,} boids"] = tuple(1.0 / s for s in seconds)
    logs = np.log(np.array([costs[count] for count in SIZES]))
    found["exponent"] = tuple(np.polyfit(np.log(SIZES), logs, 1)[0].tolist())
    small = repeated(_step_seconds, SMALL, 2000)
    slow = repeated(_plain_seconds)
    found["plain"] = tuple(p / s for p, s in zip(slow, small, strict=True))
    return found


def table_4_1_seconds() -> float:
    """Wall time of `herd run lch-table-4-1` with its report, in a process of its own on all cores."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "trials.cli", "run", "lch-table-4-1", "--out", str(Path(folder) / "run")]
        started = perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        return perf_counter() - started
