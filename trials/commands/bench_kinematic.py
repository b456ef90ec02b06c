"""The part of `herd bench` on kinematic herds: steps a second, growth with size, against NumPy, a whole command."""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from flocking import lawentry
from flocking.kinematic import Band, Schedule, Space, plain, simulate, start_uniform
from flocking.kinematic.arrays import Bodies
from flocking.types import Floats

BOIDS = "reynolds-opensteer"
SIZES = (1_000, 10_000, 100_000)
NEIGHBOURS = 8.0
"""Mean number of members within the range of cohesion at the start: a short range against the space."""
STEPS = 100
"""Runs have ten times so many steps, those of large herds fewer: 300 of 10,000 members, 30 of 100,000."""
SMALL = 50
"""Members of the herd that is held against the same law without a compiler."""


def _boids(count: int) -> tuple[Band, Floats, float]:
    """A flock of boids in unbounded space, its start and its time step."""
    law = lawentry.load(BOIDS)
    parameters = law.parameters({})
    side = parameters.cohesion_m * math.sqrt(math.pi * count / NEIGHBOURS)
    return Band(law, count), start_uniform(count, side, np.random.default_rng(1)), law.herd.dt_s


def _step_seconds(count: int, steps: int) -> float:
    """Processor time of one step of that many boids in unbounded space, on one core."""
    band, poses, dt = _boids(count)
    started = process_time()
    simulate(
        band,
        poses,
        Schedule(dt, steps, every=steps),
        rng=np.random.default_rng(2),
        speeds_m_s=band.law.herd.speed_m_s,
        space=Space(),
    )
    return (process_time() - started) / steps


def small_flock() -> tuple[Band, Bodies, float]:
    """The small flock, its state at the start and its time step."""
    band, poses, dt = _boids(SMALL)
    velocities = band.law.herd.speed_m_s * np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    none = np.zeros((SMALL, 0))
    state = Bodies(
        poses[:, :2].copy(), poses[:, 2].copy(), velocities, np.zeros(SMALL), np.zeros((SMALL, 2), bool), none
    )
    return band, state, dt


def _plain_seconds() -> float:
    """Processor time of one step of the small flock, member by member by the law's own function, not compiled."""
    band, state, dt = small_flock()
    draws = np.zeros((SMALL, band.law.draws))
    started = process_time()
    for _ in range(3):
        state = plain.step([band], state, [draws], dt)
    return (process_time() - started) / 3


def _numpy_seconds() -> float:
    """Processor time of one step of the small flock, member by member in arrays of all others."""
    band, state, dt = small_flock()
    parameters = band.law.parameters({})
    started = process_time()
    for _ in range(20):
        state = numpy_step(state, parameters, dt)
    return (process_time() - started) / 20


def numpy_step(before: Bodies, p: Any, dt: float) -> Bodies:
    """One step of boids with the law's parameters `p`, each member in turn, written with NumPy's arrays."""
    after = Bodies._make(array.copy() for array in before)
    noses = np.column_stack([np.cos(before.headings), np.sin(before.headings)])
    for i, own in enumerate(before.velocities):
        offsets = np.delete(before.positions, i, axis=0) - before.positions[i]
        others = np.delete(noses, i, axis=0)
        distances = np.linalg.norm(offsets, axis=1)
        cosines = offsets @ noses[i]
        urges = np.zeros((3, 2))
        near = (distances < p.separation_m) & (cosines > distances * math.cos(math.radians(p.separation_angle_deg)))
        urges[0] = -(offsets[near] / distances[near, None] ** 2).sum(axis=0)
        near = (distances < p.alignment_m) & (cosines > distances * math.cos(math.radians(p.alignment_angle_deg)))
        if near.any():
            urges[1] = others[near].mean(axis=0) - noses[i]
        near = (distances < p.cohesion_m) & (cosines > distances * math.cos(math.radians(p.cohesion_angle_deg)))
        if near.any():
            urges[2] = offsets[near].mean(axis=0)
        lengths = np.linalg.norm(urges, axis=1)
        urges[lengths > 0.0] /= lengths[lengths > 0.0, None]
        force = np.array([p.separation_weight, p.alignment_weight, p.cohesion_weight]) @ urges
        force *= min(1.0, p.top_force_m_s2 / max(float(np.linalg.norm(force)), 1e-300))
        velocity = own + force * dt
        velocity *= min(1.0, p.top_speed_m_s / max(float(np.linalg.norm(velocity)), 1e-300))
        after.velocities[i] = velocity
        after.positions[i] += velocity * dt
        after.headings[i] = math.atan2(velocity[1], velocity[0])
    return after


def measured(repeated: Callable[..., tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    """The runs of each figure: steps a second by size, exponent of growth, speed against code that is not compiled."""
    found: dict[str, tuple[float, ...]] = {}
    costs = {
        count: repeated(_step_seconds, count, max(2, min(10 * STEPS, 3 * STEPS * 10_000 // count))) for count in SIZES
    }
    for count, seconds in costs.items():
        found[f"{count:,} boids"] = tuple(1.0 / s for s in seconds)
    logs = np.log(np.array([costs[count] for count in SIZES]))
    found["exponent"] = tuple(np.polyfit(np.log(SIZES), logs, 1)[0].tolist())
    small = repeated(_step_seconds, SMALL, 2000)
    for way, cost in (("plain", _plain_seconds), ("numpy", _numpy_seconds)):
        found[way] = tuple(p / s for p, s in zip(repeated(cost), small, strict=True))
    return found


def table_4_1_seconds() -> float:
    """Wall time of `herd run lch-table-4-1` with its report, in a process of its own on all cores."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable,
            "-m",
            "trials.commands.cli",
            "run",
            "lch-table-4-1",
            "--out",
            str(Path(folder) / "run"),
        ]
        started = perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        return perf_counter() - started
