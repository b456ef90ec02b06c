"""One robot of a trial: the five stages as methods, called by the loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from flocking import selection
from flocking.lawentry import MOTIONS_WITHOUT_NUMBERS, OWN_SIZE, Law
from flocking.types import Bools, Floats, Kind, Members, Motion, Own
from robots.body import Body, Fleet
from sensing.association import Association, known
from sensing.camera import imperfections as camera_imperfections
from sensing.camera.rendering import Cameras
from sensing.laser.draws import intensity_draws, range_draws
from sensing.laser.hokuyo import PERIOD_S, Lasers
from sensing.types import Detection, Echoes, PipelineState, Scan, ScanTruth, Senses, WorldTruth
from trials.simulations.robots import desires
from trials.simulations.robots.knowledge import COMPASS, GOAL, Knowledge
from trials.simulations.robots.link import Link
from trials.simulations.robots.obstacle_stage import AVOIDING, ObstacleStage

_AHEAD = 64
"""Updates for which a law's random numbers are drawn at once."""


@cache
def _everyone(sets: int, members: int) -> Bools:
    """Masks that keep all members; made once and shared, since laws do not write to their sets."""
    return np.ones((sets, members), dtype=np.bool_)


class LawError(ValueError):
    """A law failed, or returned what is no motion."""


@dataclass
class Robot:
    """One robot: its clock, its stages, and what it remembers between updates."""

    index: int
    name: str
    cruise_m_s: float
    """Speed towards a way-point."""
    period: int
    """Ticks between updates."""
    latency: int
    """Ticks from sensing to acting."""
    next_tick: int
    pipeline: ModuleType
    pipeline_state: PipelineState
    selections: list[list[selection.Chosen]]
    law: Law
    law_parameters: Floats
    law_rng: np.random.Generator
    range_rng: np.random.Generator
    intensity_rng: np.random.Generator
    reads: frozenset[str]
    """What its pipeline reads."""
    body: Body
    fleet: Fleet
    lasers: Lasers | None
    cameras: Cameras | None
    """Where its pipeline reads images."""
    listen: Callable[[Any], Echoes] | None
    """What its sonars hear, where its pipeline makes obstacles of that and somebody asks for them."""
    judged: bool
    """Whether what the images show is rendered for the log."""
    imperfections: camera_imperfections.Parameters
    image_rng: np.random.Generator
    needs: tuple[bool, bool]
    """Whether its law needs velocities, and headings: a cone just seen has none."""
    told_desired: bool
    """Whether it is told of desired velocities in place of actual ones."""
    knowledge: Knowledge
    association: Association | None
    """Infers what the law needs and detections lack; None where they lack nothing."""
    obstacle_stage: ObstacleStage
    role: int
    memory: Floats
    dt: float
    link: Link | None = None
    """Where its controller is a process of its own: it then decides in the law's place."""
    command: tuple[float, float] = (0.0, 0.0)
    """Speed (m/s) and turn rate (rad/s) decided last."""
    own: Own | None = None
    dropped: int = 0
    """Inputs of its last detection of which something that its law needs was not known."""
    _own_row: Floats = field(default_factory=lambda: np.full(OWN_SIZE, np.nan))
    _contacts: Bools = field(default_factory=lambda: np.zeros(2, dtype=np.bool_))
    _last_scan: tuple[Scan, ScanTruth] | None = None
    _scanned: float = -math.inf
    """Time of its last scan, s."""
    _sensed: float = 0.0
    """Time of its last update, s."""
    _camera_memory: camera_imperfections.Memory | None = None
    _shown: ScanTruth | None = None
    """What the images that it saw last show."""
    _draws: Floats = field(default_factory=lambda: np.empty((0, 0)))
    _drawn: int = 0
    _motion_row: Floats = field(default_factory=lambda: np.zeros(4))

    def __post_init__(self) -> None:
        self._followed = frozenset(int(kind) for kind in self.body.follows)
        self._velocity, self._goal = self._own_row[0:2], self._own_row[GOAL]
        self._reads_intensity = "intensity" in self.reads
        self._reads_owners = "owners" in self.reads
        self._reads_scan = self._reads_intensity or "scan" in self.reads
        self._range_draws, self._intensity_draws = range_draws(self.range_rng), intensity_draws(self.intensity_rng)
        lasers = self.lasers
        self._free_intensity = lasers is not None and lasers.parameters[self.index].intensity_mode == "ideal"
        self._own_row[8], self._own_row[9], self._own_row[10] = self.dt, self.index, self.role

    def sense(
        self, data: Any, time: float, truth: WorldTruth | None, *, record: bool
    ) -> tuple[Senses, ScanTruth | None]:
        """Stage 1, sensing. The second value is ground truth, for the log alone.

        A robot that is due again before its laser has made another scan acts on the last one. What neither the pipeline
        nor the recording reads is not sensed. In the laser's modes other than `ideal`, intensities cost ranges: a
        recording then goes without them, so that recording does not change what the robot sees.
        """
        row, contacts = self._own_row, self._contacts
        self.fleet.own(self.index, row, contacts)
        row[6], row[7] = contacts
        self.knowledge.tell(data, time - self._sensed, row, truth)
        self._sensed = time
        self.own = Own(
            self._velocity, float(row[2]), float(row[COMPASS]), self._goal, contacts, self.dt, self.index, self.role
        )
        if self.cameras is not None:
            return self._look(data, time, truth)
        if self.lasers is None or not (record or self._reads_scan):
            return Senses(None, truth), None
        if time - self._scanned < PERIOD_S - 1e-9 and self._last_scan is not None:
            scan, scan_truth = self._last_scan
            return Senses(scan, truth, scan_truth.owners if self._reads_owners else None), scan_truth
        light = self._intensity_draws if self._reads_intensity or (record and self._free_intensity) else None
        scan, scan_truth = self._last_scan = self.lasers.read(
            data, self.index, time, self._range_draws, light, exact=False
        )
        self._scanned = time
        return Senses(scan, truth, scan_truth.owners if self._reads_owners else None), scan_truth

    def _look(self, data: Any, time: float, truth: WorldTruth | None) -> tuple[Senses, ScanTruth | None]:
        """Stage 1 by cameras, and by sonar at that moment; what the images show goes past the robot. A pair that is not
        due is not rendered."""
        assert self.cameras is not None
        given, image = self.imperfections, None
        if self._camera_memory is None:
            height_px, width_px = self.cameras.size(self.index)
            self._camera_memory = camera_imperfections.begun(given, self.image_rng, height_px, width_px)
        if camera_imperfections.due(given, self._camera_memory, time):
            image = self.cameras.look(data, self.index, time, given.capture_offset_s)
        images, self._camera_memory = camera_imperfections.seen(image, given, self._camera_memory, self.image_rng)
        if images is not None:
            if self.judged and image is not None and images.time == image.time:  # and that pair was not lost
                self._shown = self.cameras.truth(data, self.index, given.capture_offset_s)
            self._scanned = images.time
        echoes = None if self.listen is None else self.listen(data)
        return Senses(None, truth, images=images, echoes=echoes), self._shown

    def taken_for(self) -> tuple[Any, Any] | None:
        """The number of the colour that each pixel of its last images was taken for, (H, W) each; None where its
        pipeline does not say."""
        return getattr(self.pipeline_state, "labels", None)

    def detect(self, senses: Senses) -> Detection:
        """Stage 2, member detection and obstacle detection, with what association infers from the detection before."""
        detection, self.pipeline_state = self.pipeline.detect(senses, self.own, self.pipeline_state)
        made = len(detection.members.ids)
        if self.association is not None:
            time = self._scanned if self._reads_scan or self.cameras is not None else self._sensed
            detection = self.association.infer(detection, time, self.knowledge.pose_w)
        elif self.cameras is not None:
            detection = known(detection, *self.needs)
        elif self.told_desired and senses.truth is not None:
            detection = self._told_desired(detection, senses.truth)
        self.dropped = made - len(detection.members.ids)
        return detection

    def _told_desired(self, detection: Detection, truth: WorldTruth) -> Detection:
        """The detection with desired velocities; its own velocity is shifted as they are."""
        by = desires.shift(detection, truth)
        self._velocity += by
        members = detection.members
        return detection._replace(members=members._replace(velocities=members.velocities + by))

    def heed(self, detection: Detection) -> Detection:
        """Stage 7, obstacle selection; adds the virtual members that obstacles make, where the group has them."""
        return self.obstacle_stage.heeded(detection, self._velocity) if self.obstacle_stage.acts else detection

    def select(self, members: Members) -> Bools:
        """Stage 3, neighbour selection: masks (S, M)."""
        if not any(self.selections):
            return _everyone(len(self.selections), len(members.ids))
        sets = np.ones((len(self.selections), len(members.ids)), dtype=np.bool_)
        for s, steps in enumerate(self.selections):
            if steps:
                sets[s] = selection.select(steps, members)
        return sets

    def decide(self, detection: Detection, sets: Bools) -> Motion:
        """Stage 4, motion computation. Raises `LawError` if the law fails or returns what is no motion."""
        draws = self._draw()
        row = self._motion_row
        members = detection.members
        entry = self.law.entry if self.link is None else self.link.at(self._sensed)
        try:
            entry(
                self._own_row,
                members.positions,
                members.bearings,
                members.headings,
                members.velocities,
                members.ids,
                sets,
                detection.obstacles.points,
                self.law_parameters,
                self.memory,
                draws,
                row,
            )
        except Exception as error:
            raise LawError(f"law {self.law.name!r} failed for {self.name}: {type(error).__name__}: {error}") from error
        kind, x, y, rule = row.tolist()
        finite = kind in MOTIONS_WITHOUT_NUMBERS or abs(x) + abs(y) < np.inf
        if not (finite and 0 <= kind < len(Kind) and 0 <= rule < len(self.law.rules)):
            raise LawError(
                f"law {self.law.name!r} returned kind {kind:g}, x {x:g}, y {y:g}, rule {rule:g} for {self.name}"
            )
        if int(kind) not in self._followed:
            raise LawError(
                f"law {self.law.name!r} returned {Kind(int(kind)).name.lower()} for {self.name}, a motion that body "
                f"{self.body.name!r} does not follow"
            )
        return Motion(int(kind), x, y, int(rule))

    def avoid(self, motion: Motion, detection: Detection) -> Motion:
        """The law's motion, changed by the avoidance of obstacles where the group has it added."""
        if not self.obstacle_stage.avoids:
            return motion
        return self.obstacle_stage.avoided(motion, self._velocity, self.dt, detection.obstacles, len(self.law.rules))

    @property
    def rules(self) -> tuple[str, ...]:
        """The names that `Motion.rule` is an index into: the law's, and that of the avoidance where it is added."""
        return (*self.law.rules, AVOIDING) if self.obstacle_stage.avoids else self.law.rules

    def _draw(self) -> Floats:
        """The next uniform numbers (DRAWS,) of the law's stream, drawn many at a time."""
        if self._drawn == len(self._draws):
            self._draws, self._drawn = self.law_rng.random((_AHEAD, self.law.draws)), 0
        self._drawn += 1
        draws: Floats = self._draws[self._drawn - 1]
        return draws

    def drive(self, motion: Motion) -> tuple[float, float]:
        """Stage 5, first half: the command for the wheels, which `apply` gives to them after the latency."""
        self.command = self.body.follow(
            motion.kind, motion.x, motion.y, self.cruise_m_s, self.command[0], self.command[1], self.dt
        )
        return self.command

    def apply(self, command: tuple[float, float]) -> None:
        """Stage 5, second half: the command reaches the wheels."""
        self.fleet.command(self.index, command[0], command[1])
