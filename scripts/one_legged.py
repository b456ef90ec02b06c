"""Measures the one-legged robot for docs/one_legged.md: real speed against commanded, and what disturbances it bears.

    python -m scripts.one_legged speeds | changes | disturbances | peaks

Each prints a table in Markdown. The whole takes about two minutes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np

from robots.one_legged.control import Gains
from robots.one_legged.ground import Ground, Surface, build
from robots.one_legged.imperfections import Imperfections

COUNT = 16
"""Robots a row, let fall from different heights so that they hop out of step."""
SPEEDS = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5)
SEED = 1


def side_by_side(timestep_s: float = 0.005, gains: Gains | None = None, **given: object) -> Ground:
    """The robots of a row, 3 m apart, at the left edge of the ground."""
    rng = np.random.default_rng(SEED)
    heights = rng.uniform(0.0, 0.15, COUNT)
    poses_w = np.column_stack([np.full(COUNT, -25.0), 3.0 * np.arange(COUNT) - 22.5, np.zeros(COUNT)])
    return build(poses_w, heights, gains or Gains(), timestep_s, rng=rng, **given)  # type: ignore[arg-type]


def told(ground: Ground, x: float, y: float = 0.0) -> None:
    """Tells all robots to run so, m/s."""
    ground.fleet.desire_all(np.tile([x, y], (COUNT, 1)))


def header(*columns: str) -> None:
    """Prints the head of a table."""
    print("|", " | ".join(columns), "|")
    print("|" + "---|" * len(columns))


def speeds() -> None:
    """A minute at each speed: 20 s to get there, 40 s that count."""
    header("commanded, m/s", "real, m/s", "ratio", "as seen in flight, m/s", "stance, s", "flight, s", "upright of 16")
    for speed in SPEEDS:
        ground, seen = side_by_side(), []
        told(ground, speed)
        ground.run(20.0)
        start = ground.fleet.poses(ground.data)
        for _ in range(400):
            ground.run(0.1)
            seen.append(ground.fleet.velocities(ground.data)[:, 0].mean())
        real = float((ground.fleet.poses(ground.data) - start)[:, 0].mean() / 40.0)
        stance, flight = ground.fleet.durations.mean(axis=0)
        ratio, upright = f"{real / speed:.3f}" if speed else "", ground.fleet.upright.sum()
        print(f"| {speed} | {real:.3f} | {ratio} | {np.mean(seen):.3f} | {stance:.3f} | {flight:.3f} | {upright} |")


def changes() -> None:
    """How long robots at a steady speed take until they run within 0.2 m/s of a new velocity."""
    header("from", "to", "time to within 0.2 m/s, s", "upright of 16")
    cases: list[tuple[tuple[float, float], tuple[float, float]]] = [
        ((0, 0), (2, 0)),
        ((2, 0), (3, 0)),
        ((3, 0), (1.5, 0)),
        ((2, 0), (0, 0)),
        ((2, 0), (1.41, 1.41)),
    ]
    cases += [((1.41, 1.41), (1.41, -1.41)), ((2, 0), (0, 2)), ((2, 0), (-2, 0)), ((3, 0), (-3, 0))]
    for before, after in cases:
        ground = side_by_side()
        told(ground, *before)
        ground.run(10.0)
        told(ground, *after)
        within = np.full(COUNT, np.nan)
        for step in range(4000):
            ground.step()
            error = np.hypot(*(ground.fleet.velocities(ground.data) - after).T)
            within = np.where(np.isnan(within) & (error < 0.2), 0.005 * (step + 1), within)
        print(f"| {before} | {after} | {np.nanmean(within):.1f} | {ground.fleet.upright.sum()} |")


def disturbances() -> None:
    """Runs of 20 s at 2 m/s, each with one disturbance."""
    header("disturbance", "upright of 16", "real, m/s", "first fall, s")
    rows: list[tuple[str, dict[str, object], float]] = [("none", {}, 0.0)]
    kinds = {
        "torque_n_m": ("hip torque at most {} N m", (20, 10, 5, 3)),
        "velocity_m_s": ("noise of {} m/s in the velocity", (0.2, 0.5, 1.0, 2.0)),
        "angle_rad": ("noise of {} rad in angles", (0.02, 0.05, 0.1, 0.2)),
        "rate_rad_s": ("noise of {} rad/s in turn rates", (0.3, 0.5, 1.0)),
        "delay_s": ("delay of {} s", (0.005, 0.01, 0.015, 0.02)),
    }
    for name, (words, values) in kinds.items():
        rows += [(words.format(v), {"imperfections": Imperfections(**{name: v})}, 0.0) for v in values]
    rows += [(f"push of {push} N s to the left after 6 s", {}, float(push)) for push in (20, 40, 60, 80, 120)]
    rows += [(f"friction {f}", {"surface": Surface(friction=f)}, 0.0) for f in (0.5, 0.3, 0.2, 0.15, 0.1)]
    uneven = (0.02, 0.05, 0.08, 0.12)
    rows += [(f"uneven by {u} m (std), bumps 2 m apart", {"surface": Surface(uneven_m=u)}, 0.0) for u in uneven]
    for words, given, push in rows:
        ground = side_by_side(**given)  # type: ignore[arg-type]
        told(ground, 2.0)
        ground.run(6.0)
        if push:
            for k in range(COUNT):
                ground.fleet.push(ground.data, k, (0.0, push, 0.0))
        ground.run(6.0)
        start = ground.fleet.poses(ground.data)
        ground.run(8.0)
        up = ground.fleet.upright
        real = f"{(ground.fleet.poses(ground.data) - start)[up, 0].mean() / 8.0:.2f}" if up.any() else ""
        first = f"{np.nanmin(ground.fleet.fallen_at):.1f}" if not up.all() else ""
        print(f"| {words} | {up.sum()} | {real} | {first} |")


def peaks() -> None:
    """Greatest torques (N m) and forces (N), lowest body (m), greatest tilt (rad) in a minute of sudden changes."""
    header("time step, s", "upright of 16", "hip x, y", "hip z", "leg", "lowest body", "tilt")
    for timestep_s in (0.005, 0.0025):
        ground, rng = side_by_side(timestep_s), np.random.default_rng(SEED)
        most, lowest, tilt = np.zeros(4), np.inf, 0.0
        for _ in range(15):
            angle, speed = rng.uniform(-np.pi, np.pi, COUNT), 3.5 * np.sqrt(rng.random(COUNT))
            ground.fleet.desire_all(np.column_stack([speed * np.cos(angle), speed * np.sin(angle)]))
            for _ in range(round(4.0 / timestep_s)):
                ground.step()
                most = np.maximum(most, np.abs(ground.data.ctrl.reshape(-1, 4)).max(axis=0))
                pose = ground.data.qpos.reshape(COUNT, -1)
                lowest = min(lowest, pose[:, 2].min())
                tilt = max(tilt, np.arccos(1.0 - 2.0 * (pose[:, 4] ** 2 + pose[:, 5] ** 2)).max())
        row = f"{most[:2].max():.0f} | {most[2]:.1f} | {most[3]:.0f} | {lowest:.2f} | {tilt:.2f}"
        print(f"| {timestep_s} | {ground.fleet.upright.sum()} | {row} |")


PARTS: dict[str, Callable[[], None]] = {
    "speeds": speeds,
    "changes": changes,
    "disturbances": disturbances,
    "peaks": peaks,
}


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    PARTS[parser.parse_args().part]()


if __name__ == "__main__":
    main()
