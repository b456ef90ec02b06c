"""A trial before it runs and after it ran."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints

Value = bool | int | float | str


@dataclass(frozen=True)
class Group:
    """Robots of one kind that run the same mind. Names, text and numbers only."""

    name: str = "herd"
    count: int = 6
    body: str = "create"
    sensors: str = "datasheet"
    """Named setting of the laser: ideal, datasheet or harsh."""
    sensor_parameters: Mapping[str, Value] = field(default_factory=dict)
    pipeline: str = "member-based"
    pipeline_parameters: Mapping[str, Value] = field(default_factory=dict)
    selection: str = "all"
    law: str = "extended-hamilton"
    """Name of a law, or the path of a user's own law file."""
    law_source: str = ""
    """Text of the user's own law file: it travels with the trial."""
    law_parameters: Mapping[str, Value] = field(default_factory=dict)
    spread: Mapping[str, float] = field(default_factory=dict)
    """Name of a law's parameter → how far members differ in it, as a share of its value (`trials.simulations.spread`)."""
    speed_m_s: float = 0.25
    """Cruising speed towards a way-point."""
    rate_hz: float = 10.0
    phase: str = "random"
    """`random`: each robot's clock starts at its own moment; `together`: all at once (synchronous)."""
    latency_s: float = 0.04
    """From sensing to acting."""
    start_moving: bool = True
    """Whether the command that robots are given at the start, and keep while they see nobody, is to drive straight
    on at cruising speed; else it is to stand still."""
    role: int = 0
    """What its robots' laws are told of their role: 0 ordinary; 1 leader, informed or strong."""
    informed: int = 0
    """How many of its robots, the first ones, are given the goal; their role is 1."""
    goal_x_m: float = 0.0
    goal_y_m: float = 0.0
    """Where that goal is in the world; one far away is a preferred direction."""
    own_motion: str = "commands"
    """How its robots know their own motion: `commands`, `odometry` or `true`."""
    association: str = "two-scans"
    """How neighbours' velocities and headings come about where the pipeline gives none: `two-scans` or `none`."""
    association_parameters: Mapping[str, Value] = field(default_factory=dict)
    obstacles: str = "as-law"
    """What is done about obstacles beside what the law does: `as-law` (nothing), `avoid` or `virtual-members`."""
    obstacle_selection: str = "all"
    avoidance_parameters: Mapping[str, Value] = field(default_factory=dict)
    kinematics: Mapping[str, Value] = field(default_factory=dict)
    """Of a kinematic trial: what differs from the defaults of `trials.simulations.kinematic.fields.GroupFields`. Such a group has
    a count, a pipeline, a selection and a law; the other fields of a robot mean nothing to it."""


@dataclass(frozen=True)
class Trial:
    """Everything that decides a trial: the same `Trial` gives the same `TrialResult`."""

    experiment: str
    index: int
    """From 1."""
    seed: int
    repeat: int
    """From 1; trials of the same repeat share start and noise, whatever their conditions."""
    world: str
    formation: str
    duration_s: float
    """0 for a kinematic trial, which counts steps."""
    groups: tuple[Group, ...]
    world_parameters: Mapping[str, Value] = field(default_factory=dict)
    conditions: Mapping[str, Value] = field(default_factory=dict)
    """What the experiment (and a sweep) varies from trial to trial."""
    timestep_s: float = 0.01
    """Of physics."""
    simulation: str = "physics"
    """`physics`: robots in MuJoCo; `kinematic`: the compiled herd of `flocking.kinematic`."""
    formation_parameters: Mapping[str, Value] = field(default_factory=dict)
    kinematics: Mapping[str, Value] = field(default_factory=dict)
    """Of a kinematic trial: what differs from the defaults of `trials.simulations.kinematic.fields.TrialFields`; its length and
    time step are among them."""
    links: Mapping[str, Value] = field(default_factory=dict)
    """Of a kinematic trial: the `trials.simulations.kinematic.links.Parameters` with which its links are measured; {} = they are
    not."""

    def as_dict(self) -> dict[str, Any]:
        """As plain dicts and lists, for JSON."""
        return dataclasses.asdict(self)

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Trial:
        """The inverse of `as_dict`."""
        fields = dict(data)
        fields["groups"] = tuple(Group(**group) for group in fields["groups"])
        return Trial(**fields)


class Measure(NamedTuple):
    """Unit and meaning of one measure."""

    unit: str
    text: str


@dataclass(frozen=True)
class Updates:
    """One row for each robot update (stages 1 to 4 of one robot), in the order of time; U rows in all."""

    times: Floats
    """(U,) s."""
    robots: Ints
    """(U,) index of the focal member."""
    kinds: Ints
    """(U,) `flocking.types.Kind` of the motion."""
    rules: Ints
    """(U,) index into the rules of the robot's law (`TrialResult.rules`)."""
    motions: Floats
    """(U, 2) x and y of the motion (a way-point: m, body frame); nan where the kind has none."""
    poses_w: Floats
    """(U, 3) true pose of the focal member when it sensed."""
    commands: Floats
    """(U, 2) speed (m/s) and turn rate (rad/s) that it then sent to its wheels."""
    input_starts: Ints
    """(U + 1,) rows `input_starts[u]:input_starts[u + 1]` of the inputs belong to update u."""
    input_positions: NDArray[np.float32]
    """(K, 2) m, body frame: every input given to the law."""
    input_owners: NDArray[np.int16]
    """(K,) which robot the input belongs to, −1 = nobody (a false positive)."""
    member_states: NDArray[np.int8]
    """(U, N) for each member: HIDDEN, DETECTED or MISSED (see trials.truth); the focal member is HIDDEN."""
    beams_lit: Ints
    """(U,) beams that members made (ground truth)."""
    beams_missed: Ints
    """(U,) of these, beams that made no input."""
    beams_made_up: Ints
    """(U,) beams that made an input but belong to nobody."""


@dataclass(frozen=True)
class Scans:
    """The scans kept for a recording; S rows."""

    times: Floats
    """(S,)."""
    robots: Ints
    """(S,)."""
    poses_w: Floats
    """(S, 3) pose of the robot at the scan's time."""
    angles: Floats
    """(B,)."""
    ranges: NDArray[np.float32]
    """(S, B) with the codes of `sensing.types.Scan`."""
    intensities: NDArray[np.float32]
    """(S, B); nan where none."""


@dataclass(frozen=True)
class Contacts:
    """Where a robot began to touch something; C rows, one a touch (not one a step)."""

    times: Floats
    """(C,)."""
    robots: Ints
    """(C,)."""
    others: Ints
    """(C,) index of the other robot (each pair once, the smaller index in `robots`), −1 = a wall."""
    points_w: Floats
    """(C, 2)."""


@dataclass(frozen=True)
class TrialResult:
    """What was measured in one trial of N robots sampled at T times."""

    trial: Trial
    times: Floats
    """(T,) every 0.1 s from 0 to the end."""
    poses_w: Floats
    """(T, N, 3) true x, y, heading (unwrapped)."""
    odometry: Floats
    """(T, N, 3) pose by each robot's own odometry, in the frame of its start."""
    bumpers: Bools
    """(T, N, 2) left and right bumper pressed at the sample."""
    robot_names: tuple[str, ...]
    radii: Floats
    """(N,) m."""
    rules: tuple[tuple[str, ...], ...]
    """For each robot the names of its law's rules."""
    walls_w: Floats
    """(W, 4) segments, m."""
    period_m: float
    """Side of a periodic world; nan where there is none."""
    updates: Updates
    contacts: Contacts
    scans: Scans | None
    measures: Mapping[str, float]
    outcome: str
    """`done` or `failed`."""
    reason: str
    """Why it failed, one line; empty if done. A failed trial holds what was measured until then."""
    timing: Mapping[str, float]
    """Wall time by part, s: physics, and the rest. Not part of the result: it differs from run to run."""
