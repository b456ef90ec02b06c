"""What is kept of a trial while it runs, and the `TrialResult` made of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints, Motion
from sensing.types import Detection, Scan
from trials.spool import Rows
from trials.types import Contacts, Scans, Trial, TrialResult, Updates

SAMPLE_S = 0.1
"""Time between samples of the true poses."""
SCANS_EVERY_S = 0.5
"""Time between the scans of one robot that a recording keeps by default (2 Hz)."""
PACKED_AT = 4096
"""Updates that wait as rows: then arrays are made of them, which take a fifth of the memory."""


class Block(NamedTuple):
    """Some updates as arrays."""

    table: Floats
    """(U, 14) time, robot, kind, rule, motion (2), pose (3), command (2), beams lit, missed and made up."""
    counts: Ints
    """(U,) inputs."""
    positions: NDArray[np.float32]
    """(K, 2) of the inputs."""
    owners: NDArray[np.int16]
    """(K,)."""
    selected: Bools
    """(K,)."""
    states: NDArray[np.int8]
    """(U, N)."""


@dataclass
class Log:
    """Collects rows while a trial runs; makes arrays of them at the end."""

    trial: Trial
    robots: int
    keep_scans: str
    """`none`, `some` (2 Hz) or `all`."""
    times: list[float] = field(default_factory=list)
    poses_w: list[Floats] = field(default_factory=list)
    odometry: list[Floats] = field(default_factory=list)
    bumpers: list[Bools] = field(default_factory=list)
    updates: list[tuple[float, ...]] = field(default_factory=list)
    inputs: list[Floats] = field(default_factory=list)
    owners: list[Any] = field(default_factory=list)
    selected: list[Bools] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    scans: list[tuple[float, int, Floats]] = field(default_factory=list)
    folder: Path | None = None
    """Where the numbers of scans are kept; None: where the system keeps temporary files."""
    _angles: Floats | None = None
    _ranges: Rows | None = None
    _intensities: Rows | None = None
    _next_scan: dict[int, float] = field(default_factory=dict)

    def sample(self, time: float, poses_w: Floats, odometry: Floats, bumpers: Bools) -> None:
        """Adds the true state at one moment."""
        self.times.append(time)
        self.poses_w.append(poses_w.copy())
        self.odometry.append(odometry.copy())
        self.bumpers.append(bumpers.copy())

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
            self._pack()

    def scan(self, time: float, robot: int, pose_w: Floats, scan: Scan) -> None:
        """Keeps a scan for the recording. Raises `StorageError` if the disk does not take it."""
        if self._ranges is None or self._intensities is None:
            width = len(scan.angles)
            self._angles, self._ranges, self._intensities = (
                scan.angles,
                Rows(width, self.folder),
                Rows(width, self.folder),
            )
        self.scans.append((time, robot, pose_w.copy()))
        self._ranges.append(scan.ranges)
        self._intensities.append(scan.intensities)

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
        return TrialResult(
            trial=self.trial,
            times=np.array(self.times),
            poses_w=_unwrapped(np.array(self.poses_w).reshape(-1, self.robots, 3)),
            odometry=np.array(self.odometry).reshape(-1, self.robots, 3),
            bumpers=np.array(self.bumpers, dtype=np.bool_).reshape(-1, self.robots, 2),
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
        )

    def _pack(self) -> None:
        """Makes a block of the updates that wait."""
        self.blocks.append(
            Block(
                np.array(self.updates, dtype=np.float64).reshape(-1, 14),
                np.array([len(rows) for rows in self.inputs], dtype=np.int64),
                np.concatenate([np.empty((0, 2)), *self.inputs]).astype(np.float32),
                np.concatenate([np.empty(0), *self.owners]).astype(np.int16),
                np.concatenate([np.empty(0, np.bool_), *self.selected]),
                np.array(self.states, dtype=np.int8).reshape(-1, self.robots),
            )
        )
        for rows in (self.updates, self.inputs, self.owners, self.selected, self.states):
            rows.clear()

    def _updates(self) -> Updates:
        self._pack()
        whole_blocks = zip(*self.blocks, strict=True)
        table, counts, positions, owners, selected, states = (np.concatenate(parts) for parts in whole_blocks)
        self.blocks.clear()
        starts = np.zeros(len(counts) + 1, dtype=np.int64)
        np.cumsum(counts, out=starts[1:])
        whole = table[:, [1, 2, 3, 11, 12, 13]].astype(np.int64)
        return Updates(
            times=table[:, 0].copy(),
            robots=whole[:, 0].copy(),
            kinds=whole[:, 1].copy(),
            rules=whole[:, 2].copy(),
            motions=table[:, 4:6].copy(),
            poses_w=table[:, 6:9].copy(),
            commands=table[:, 9:11].copy(),
            input_starts=starts,
            input_positions=positions,
            input_owners=owners,
            input_selected=selected,
            member_states=states,
            beams_lit=whole[:, 3].copy(),
            beams_missed=whole[:, 4].copy(),
            beams_made_up=whole[:, 5].copy(),
        )

    def _scans(self) -> Scans | None:
        if self._angles is None or self._ranges is None or self._intensities is None:
            return None
        return Scans(
            times=np.array([row[0] for row in self.scans]),
            robots=np.array([row[1] for row in self.scans], dtype=np.int64),
            poses_w=np.array([row[2] for row in self.scans]),
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
