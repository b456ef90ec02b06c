"""What is kept of a trial while it runs, and the `TrialResult` made of it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from flocking.types import Bools, Floats, Motion, Obstacles
from sensing.types import Detection, Echoes, Scan
from trials.simulations.robots.measures_velocities import Told
from trials.simulations.robots.pictures import Kept
from trials.spool import Column, Rows
from trials.types import Contacts, Heard, Scans, Trial, TrialResult, Updates

SAMPLE_S = 0.1
"""Time between samples of the true poses."""
SCANS_EVERY_S = 0.5
"""Time between the scans of one robot that a recording keeps by default (2 Hz)."""
PACKED_AT = 4096
"""Updates and samples that wait as rows: then arrays are made of them, which take a fifth of the memory."""
SAMPLED: dict[str, tuple[Any, int]] = {
    "poses_w": (np.float64, 3),
    "odometry": (np.float64, 3),
    "bumpers": (np.bool_, 2),
}
"""Type and width of what a sample holds of each robot."""


@dataclass
class Log:
    """Collects rows while a trial runs; makes arrays of them at the end."""

    trial: Trial
    robots: int
    keep_scans: str
    """`none`, `some` (2 Hz) or `all`."""
    folder: Path | None = None
    """Where long columns and the numbers of scans are kept; None: where the system keeps temporary files."""
    samples: list[tuple[float, Floats, Floats, Bools]] = field(default_factory=list)
    updates: list[tuple[float, ...]] = field(default_factory=list)
    inputs: list[Floats] = field(default_factory=list)
    owners: list[Any] = field(default_factory=list)
    selected: list[Bools] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)
    scans: list[tuple[float, ...]] = field(default_factory=list)
    pictures: Kept = field(default_factory=Kept)
    heard: list[tuple[float, int, Floats, Floats, Floats, Floats]] = field(default_factory=list)
    _told: list[Floats] = field(default_factory=list)
    _inputs_told: int = 0
    _inputs_dropped: int = 0
    _columns: dict[str, Column] = field(default_factory=dict)
    _angles: Floats | None = None
    _ranges: Rows | None = None
    _intensities: Rows | None = None
    _next_scan: dict[int, float] = field(default_factory=dict)

    def sample(self, time: float, poses_w: Floats, odometry: Floats, bumpers: Bools) -> None:
        """Adds the true state at one moment."""
        self.samples.append((time, poses_w.copy(), odometry.copy(), bumpers.copy()))
        if len(self.samples) == PACKED_AT:
            self._pack_samples()

    def update(
        self,
        time: float,
        robot: int,
        pose_w: Floats,
        detection: Detection,
        selected: Bools,
        judgement: tuple[Any, Any, int, int, int],
        motion: Motion,
        command: tuple[float, float],
    ) -> None:
        """Adds one robot's update; `selected` (M,) members of the detection; `judgement` as `sensing.truth.judge`."""
        owners, states, lit, missed, made_up = judgement
        self.updates.append(
            (
                time,
                robot,
                motion.kind,
                motion.rule,
                motion.x,
                motion.y,
                *pose_w.tolist(),
                *command,
                lit,
                missed,
                made_up,
            )
        )
        self.inputs.append(detection.members.positions)
        self.owners.append(owners)
        self.selected.append(selected)
        self.states.append(states)
        if len(self.updates) == PACKED_AT:
            self._pack_updates()

    def told(self, told_w: Floats, owners: Any, actual_w: Floats, desired_w: Floats, dropped: int) -> None:
        """Notes the velocities (M, 2) that a robot is told of its inputs beside those (N, 2) of all robots and what
        these desire, m/s in the world; `owners` (M,) of the inputs, `dropped`: those of which none is known."""
        self._inputs_told += len(owners)
        self._inputs_dropped += dropped
        members = owners >= 0
        whose = owners[members]
        self._told.append(np.hstack([told_w[members], actual_w[whose], desired_w[whose]]))
        if len(self._told) == PACKED_AT:
            self._pack_told()

    def velocities(self) -> Told:
        """What was noted of velocities."""
        self._pack_told()
        return Told(self._whole("told"), self._inputs_told, self._inputs_dropped)

    def scan(self, time: float, robot: int, pose_w: Floats, scan: Scan) -> None:
        """Keeps a scan for the recording. Raises `StorageError` if the disk does not take it."""
        if self._ranges is None or self._intensities is None:
            width = len(scan.angles)
            self._angles, self._ranges, self._intensities = (
                scan.angles,
                Rows(width, self.folder),
                Rows(width, self.folder),
            )
        self.scans.append((time, robot, *pose_w.tolist()))
        if len(self.scans) == PACKED_AT:
            self._pack_scans()
        self._ranges.append(scan.ranges)
        self._intensities.append(scan.intensities)

    def listened(self, time: float, robot: int, pose_w: Floats, echoes: Echoes, obstacles: Obstacles) -> None:
        """Keeps what a robot's sonars heard for the recording, and what of that it took for obstacles."""
        self.heard.append((time, robot, pose_w.copy(), echoes.ring, echoes.ranges, obstacles.points))

    def wants_scan(self, robot: int, time: float) -> bool:
        """Whether the recording keeps this robot's next scan."""
        if self.keep_scans != "some":
            return self.keep_scans == "all"
        if time + 1e-9 < self._next_scan.get(robot, 0.0):
            return False
        self._next_scan[robot] = time + SCANS_EVERY_S
        return True

    def result(
        self,
        *,
        names: tuple[str, ...],
        radii: Floats,
        rules: tuple[tuple[str, ...], ...],
        walls_w: Floats,
        contacts: list[tuple[float, ...]],
        outcome: str,
        reason: str,
        timing: dict[str, float],
    ) -> TrialResult:
        """Everything as arrays; measures are left empty."""
        self._pack_samples()
        self._pack_updates()
        return TrialResult(
            trial=self.trial,
            times=self._whole("sample_times"),
            poses_w=_unwrapped(self._whole("sample_poses_w")),
            odometry=self._whole("sample_odometry"),
            bumpers=self._whole("sample_bumpers"),
            robot_names=names,
            radii=radii,
            rules=rules,
            walls_w=walls_w,
            period_m=np.nan,
            updates=self._updates(),
            contacts=_contacts(contacts),
            scans=self._scans(),
            measures={},
            outcome=outcome,
            reason=reason,
            timing=timing,
            pictures=self.pictures.whole(),
            heard=self._heard(),
        )

    def _pack_samples(self) -> None:
        """Makes arrays of the samples that wait."""
        self._add("sample_times", np.float64, (), [row[0] for row in self.samples])
        for at, (name, (dtype, width)) in enumerate(SAMPLED.items(), start=1):
            self._add(f"sample_{name}", dtype, (self.robots, width), [row[at] for row in self.samples])
        self.samples.clear()

    def _pack_updates(self) -> None:
        """Makes arrays of the updates that wait."""
        table = np.array(self.updates, dtype=np.float64).reshape(-1, 14)
        self._add("times", np.float64, (), table[:, 0])
        for name, at in (("robots", 1), ("kinds", 2), ("rules", 3)):
            self._add(name, np.int64, (), table[:, at])
        for name, first, last in (("motions", 4, 6), ("poses_w", 6, 9), ("commands", 9, 11)):
            self._add(name, np.float64, (last - first,), table[:, first:last])
        for name, at in (("beams_lit", 11), ("beams_missed", 12), ("beams_made_up", 13)):
            self._add(name, np.int64, (), table[:, at])
        self._add("counts", np.int64, (), [len(rows) for rows in self.inputs])
        self._add("input_positions", np.float32, (2,), np.concatenate([np.empty((0, 2)), *self.inputs]))
        self._add("input_owners", np.int16, (), np.concatenate([np.empty(0), *self.owners]))
        self._add("input_selected", np.bool_, (), np.concatenate([np.empty(0, np.bool_), *self.selected]))
        self._add("member_states", np.int8, (self.robots,), self.states)
        for rows in (self.updates, self.inputs, self.owners, self.selected, self.states):
            rows.clear()

    def _pack_told(self) -> None:
        """Makes an array of the velocities that wait."""
        self._add("told", np.float64, (6,), np.concatenate([np.empty((0, 6)), *self._told]))
        self._told.clear()

    def _pack_scans(self) -> None:
        """Makes arrays of where and when the scans were taken that wait."""
        table = np.array(self.scans, dtype=np.float64).reshape(-1, 5)
        self._add("scan_times", np.float64, (), table[:, 0])
        self._add("scan_robots", np.int64, (), table[:, 1])
        self._add("scan_poses_w", np.float64, (3,), table[:, 2:])
        self.scans.clear()

    def _add(self, name: str, dtype: Any, shape: tuple[int, ...], block: Any) -> None:
        if name not in self._columns:
            self._columns[name] = Column(dtype, shape, self.folder)
        self._columns[name].append(block)

    def _whole(self, name: str) -> Any:
        return self._columns.pop(name).whole()

    def _updates(self) -> Updates:
        starts = np.append(0, np.cumsum(self._whole("counts")))
        others = {part.name: self._whole(part.name) for part in fields(Updates) if part.name != "input_starts"}
        return Updates(input_starts=starts, **others)

    def _heard(self) -> Heard | None:
        if not self.heard:
            return None
        times, robots, poses, rings, ranges, obstacles = zip(*self.heard, strict=True)
        return Heard(np.array(times), np.array(robots, np.int64), np.array(poses), rings, ranges, obstacles)

    def _scans(self) -> Scans | None:
        if self._angles is None or self._ranges is None or self._intensities is None:
            return None
        self._pack_scans()
        return Scans(
            times=self._whole("scan_times"),
            robots=self._whole("scan_robots"),
            poses_w=self._whole("scan_poses_w"),
            angles=self._angles,
            ranges=self._ranges,
            intensities=self._intensities,
        )


def _unwrapped(poses_w: Floats) -> Floats:
    if len(poses_w):
        poses_w[:, :, 2] = np.unwrap(poses_w[:, :, 2], axis=0)
    return poses_w


def _contacts(rows: list[tuple[float, ...]]) -> Contacts:
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    return Contacts(
        times=table[:, 0].copy(),
        robots=table[:, 1].astype(np.int64),
        others=table[:, 2].astype(np.int64),
        points_w=table[:, 3:5].copy(),
    )
