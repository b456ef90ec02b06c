"""A made-up finished trial, for tests of what reads a `TrialResult`: plausible, quick and without physics."""

from __future__ import annotations

import dataclasses

import numpy as np

from flocking.types import Floats, Kind
from trials.simulations.robots import fields
from trials.types import Contacts, Scans, TrialResult, Updates

RULES = ("none", "snn", "hamilton", "perpendicular")
RADIUS = 0.165
WALLS_W = np.array([[-5.0, 1.155, 95.0, 1.155], [-5.0, -1.155, 95.0, -1.155]])
"""A corridor of seven robot diameters."""
ANGLES = np.radians(np.linspace(-119.885, 119.885, 682))
MAX_RANGE = 5.6
INTENSITIES = {"wall": 0.4, "member": 8.0}
HIDDEN, DETECTED, MISSED = 0, 1, 2


def synthetic_result(
    seed: int = 1,
    robots: int = 6,
    seconds: float = 60.0,
    scans: str = "some",
    pipeline: str = "sensor-based",
    exclusion_m: float = 0.5,
    index: int = 1,
    repeat: int = 1,
    outcome: str = "done",
) -> TrialResult:
    """Robots that drift along a corridor; scans kept at 10 Hz (all), 2 Hz (some) or not (none)."""
    rng = np.random.default_rng([seed, robots])
    times = np.arange(round(seconds * 10) + 1) * 0.1
    poses_w = _poses(rng, times, robots)
    update_times = (np.arange(round(seconds * 10))[:, None] * 0.1 + rng.uniform(0, 0.1, robots)).ravel()
    update_robots = np.tile(np.arange(robots), round(seconds * 10))
    order = np.argsort(update_times, kind="stable")
    update_times, update_robots = update_times[order], update_robots[order]
    everyone = _interpolated(times, poses_w, update_times)
    kept = _scans(rng, update_times, update_robots, everyone, scans)
    bumpers = rng.random((len(times), robots, 2)) < 0.005
    trial = dataclasses.replace(
        fields.trial(
            "detection-case-study",
            repeat,
            [fields.group(count=robots, pipeline=pipeline)],
            duration_s=max(0.1, float(seconds)),  # a trial may fail at once, but is not planned to last no time
        ),
        index=index,
        seed=seed,
        conditions={"herd.pipeline": pipeline, "herd.law.exclusion_m": exclusion_m},
    )
    return TrialResult(
        trial=trial,
        times=times,
        poses_w=poses_w,
        odometry=_odometry(rng, poses_w),
        bumpers=bumpers,
        robot_names=tuple(f"herd-{k + 1}" for k in range(robots)),
        radii=np.full(robots, RADIUS),
        rules=(RULES,) * robots,
        walls_w=WALLS_W,
        period_m=np.nan,
        updates=_updates(rng, update_times, update_robots, everyone, pipeline),
        contacts=_contacts(rng, times, poses_w),
        scans=kept,
        measures={"polarization": 0.9, "mmd_m": 1.0, "groups": 1.0},
        outcome=outcome,
        reason="" if outcome == "done" else "physics diverged at 0.3 s",
        timing={"build_s": 0.3, "loop_s": 0.3},
    )


def _poses(rng: np.random.Generator, times: Floats, robots: int) -> Floats:
    """(T, N, 3): forward at about 0.15 m/s, weaving; the second half of the robots falls behind a little."""
    phases = rng.uniform(0, 2 * np.pi, robots)
    lanes = np.linspace(-0.7, 0.7, robots) if robots > 1 else np.zeros(1)
    starts = rng.uniform(-0.4, 0.4, robots) - 1.2 * (np.arange(robots) % 2)
    speeds = 0.15 - 0.01 * (np.arange(robots) % 2)
    t = times[:, None]
    x = starts + speeds * t
    y = lanes + 0.15 * np.sin(0.4 * t + phases)
    heading = np.arctan2(0.06 * np.cos(0.4 * t + phases), speeds)
    return np.stack([x, y, heading], axis=2)


def _interpolated(times: Floats, poses_w: Floats, at: Floats) -> Floats:
    """(U, N, 3) poses of all robots at the given times."""
    low = np.clip(np.searchsorted(times, at, side="right") - 1, 0, max(len(times) - 2, 0))
    high = np.minimum(low + 1, len(times) - 1)
    share = ((at - times[low]) / 0.1)[:, None, None]
    return (1 - share) * poses_w[low] + share * poses_w[high]


def _odometry(rng: np.random.Generator, poses_w: Floats) -> Floats:
    """(T, N, 3) in the frame of each robot's start, drifting slowly."""
    moved = poses_w - poses_w[:1]
    c, s = np.cos(poses_w[0, :, 2]), np.sin(poses_w[0, :, 2])
    drift = 1.0 + rng.normal(0, 0.01, poses_w.shape[1])
    x = (c * moved[..., 0] + s * moved[..., 1]) * drift
    y = (-s * moved[..., 0] + c * moved[..., 1]) * drift
    return np.stack([x, y, moved[..., 2]], axis=2)


def _in_body(others_w: Floats, pose_w: Floats) -> Floats:
    """World positions (M, 2) in the body frame of a pose (3,)."""
    c, s = np.cos(pose_w[2]), np.sin(pose_w[2])
    d = others_w - pose_w[:2]
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]], axis=1)


def _updates(rng: np.random.Generator, times: Floats, robots: np.ndarray, everyone: Floats, pipeline: str) -> Updates:
    """Inputs: one a member (member-based) or some points on each (else), with false positives and misses."""
    count, members = everyone.shape[:2]
    starts, positions, owners = [0], [], []
    states = np.zeros((count, members), dtype=np.int8)
    kinds, rules = np.full(count, Kind.WAY_POINT, dtype=np.int64), np.zeros(count, dtype=np.int64)
    motions = np.full((count, 2), np.nan)
    for u, k in enumerate(robots):
        others = np.delete(np.arange(members), k)
        at = _in_body(everyone[u, others, :2], everyone[u, k])
        near = np.hypot(at[:, 0], at[:, 1]) < 3.0
        found = near & (rng.random(len(others)) > 0.1)
        states[u, others[near]] = MISSED
        states[u, others[found]] = DETECTED
        many = 1 if pipeline == "member-based" else 6
        points = np.repeat(at[found], many, axis=0) + rng.normal(0, 0.02, (found.sum() * many, 2))
        made_up = rng.uniform(-2, 2, (int(rng.random() < 0.05), 2))
        positions.append(np.concatenate([points, made_up]))
        owners.append(np.concatenate([np.repeat(others[found], many), np.full(len(made_up), -1)]))
        starts.append(starts[-1] + len(positions[-1]))
        if len(positions[-1]) == 0:
            kinds[u] = Kind.HOLD
            continue
        rules[u] = rng.choice([1, 2, 3], p=[0.5, 0.4, 0.1])
        nearest = positions[-1][np.argmin(np.hypot(*positions[-1].T))]
        motions[u] = 0.6 * nearest + rng.normal(0, 0.05, 2)
    lit = np.full(count, 60, dtype=np.int64)
    return Updates(
        times=times,
        robots=robots.astype(np.int64),
        kinds=kinds,
        rules=rules,
        motions=motions,
        poses_w=everyone[np.arange(count), robots] if count else np.empty((0, 3)),
        commands=np.stack([np.full(count, 0.15), rng.normal(0, 0.1, count)], axis=1),
        input_starts=np.array(starts, dtype=np.int64),
        input_positions=np.concatenate([np.empty((0, 2)), *positions]).astype(np.float32),
        input_owners=np.concatenate([np.empty(0), *owners]).astype(np.int16),
        input_selected=np.ones(starts[-1], dtype=np.bool_),
        member_states=states,
        beams_lit=lit,
        beams_missed=rng.integers(0, 10, count),
        beams_made_up=rng.integers(0, 3, count),
    )


def _scans(rng: np.random.Generator, times: Floats, robots: np.ndarray, everyone: Floats, which: str) -> Scans | None:
    """Beams against the walls and the other robots; codes for no return, too near and error among them."""
    if which == "none":
        return None
    members = everyone.shape[1]
    kept = np.ones(len(times), dtype=bool)
    if which == "some":
        rank = np.arange(len(times)) // members
        kept = rank % 5 == 0
    times, robots, everyone = times[kept], robots[kept], everyone[kept]
    poses = everyone[np.arange(len(times)), robots]
    ranges = np.full((len(times), len(ANGLES)), np.inf)
    material = np.zeros(ranges.shape)
    for s, (k, pose) in enumerate(zip(robots, poses, strict=True)):
        along = ANGLES + pose[2]
        rise = np.sin(along)
        with np.errstate(divide="ignore"):
            wall = (np.where(rise > 0, 1.155, -1.155) - pose[1]) / rise
        reading, made = wall, np.full(len(ANGLES), INTENSITIES["wall"])
        for other in np.delete(everyone[s, :, :2], k, axis=0) - pose[:2]:
            ahead = np.cos(along) * other[0] + np.sin(along) * other[1]
            aside = np.abs(-np.sin(along) * other[0] + np.cos(along) * other[1])
            hit = (aside < RADIUS) & (ahead > RADIUS)
            range_ = ahead - np.sqrt(np.maximum(RADIUS**2 - aside**2, 0))
            nearer = hit & (range_ < reading)
            reading = np.where(nearer, range_, reading)
            made = np.where(nearer, INTENSITIES["member"], made)
        reading = np.round(reading + rng.normal(0, 0.01, len(ANGLES)), 3)
        ranges[s] = np.where(reading > MAX_RANGE, np.inf, np.where(reading < 0.02, -np.inf, reading))
        material[s] = made / np.maximum(reading, 0.1) ** 2
        ranges[s, rng.integers(0, len(ANGLES), 2)] = np.nan
    return Scans(
        times=times,
        robots=robots.astype(np.int64),
        poses_w=poses,
        angles=ANGLES,
        ranges=ranges.astype(np.float32),
        intensities=np.where(np.isfinite(ranges), material, np.nan).astype(np.float32),
    )


def _contacts(rng: np.random.Generator, times: Floats, poses_w: Floats) -> Contacts:
    """Now and then a touch: of a wall (−1) or of the next robot."""
    count = min(10, len(times) // 10)
    at = np.sort(rng.choice(len(times), count, replace=False))
    members = poses_w.shape[1]
    robots = rng.integers(0, members, count)
    others = np.where(robots + 1 < members, robots + 1, -1)
    others[::2] = -1
    return Contacts(
        times=times[at],
        robots=robots.astype(np.int64),
        others=others.astype(np.int64),
        points_w=poses_w[at, robots, :2] + np.array([RADIUS, 0.0]),
    )
