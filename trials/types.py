"""A trial before it runs and after it ran."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from flocking.types import Bools, Floats, Ints
from trials.spool import Rows

Value = bool | int | float | str


@dataclass(frozen=True)
class Group:
    """Members of one kind that run the same law on the same detection. Names, text and numbers only."""

    law: str
    """Name of a law, or the path of a user's own law file."""
    count: int
    pipeline: str
    name: str = "herd"
    """Keys of the group begin with it, as in `herd.count`."""
    selection: str = "all"
    law_source: str = ""
    """Text of the user's own law file: it travels with the trial."""
    law_parameters: Mapping[str, Value] = field(default_factory=dict)
    pipeline_parameters: Mapping[str, Value] = field(default_factory=dict)
    spread: Mapping[str, float] = field(default_factory=dict)
    """Name of a law's parameter → how far members differ in it, a share of its value (trials/simulations/spread.py)."""
    setup: Mapping[str, Value] = field(default_factory=dict)
    """Values that only the trial's simulation knows, by key without the group's name: `speed_m_s`, `sensors.dropout`.
    A key that is left out has the value that the simulation declares."""


@dataclass(frozen=True)
class Trial:
    """Everything that determines a trial: equal trials give equal results."""

    experiment: str
    repeat: int
    """From 1; trials of the same repeat share start and noise, whatever their conditions."""
    simulation: str
    """The simulation that runs it: a folder of `trials.simulations`."""
    world: str
    """Name of a world, or the path of a user's own file."""
    formation: str
    groups: tuple[Group, ...]
    index: int = 1
    """From 1."""
    seed: int = 1
    world_source: str = ""
    """Text of the user's own file of a world, whose path `world` is: it travels with the trial."""
    formation_source: str = ""
    """Likewise of a file of starting poses, whose path `formation` is."""
    task_source: str = ""
    """Likewise of a file of a task, whose path `task` of the setup is."""
    world_parameters: Mapping[str, Value] = field(default_factory=dict)
    formation_parameters: Mapping[str, Value] = field(default_factory=dict)
    setup: Mapping[str, Value] = field(default_factory=dict)
    """Values that only the simulation knows, by key: `duration_s`, `links.range_m`. A key that is left out has the
    value that the simulation declares."""
    conditions: Mapping[str, Value] = field(default_factory=dict)
    """The keys that the experiment, or a sweep, varies from trial to trial, with this trial's values."""

    def as_dict(self) -> dict[str, Any]:
        """As plain dicts and lists, for JSON; without a text of starting poses or of a task where there is none."""
        fields = dataclasses.asdict(self)
        for name in ("formation_source", "task_source"):
            if not fields[name]:  # so that the trials of earlier runs are still themselves
                del fields[name]
        return fields

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Trial:
        """The inverse of `as_dict`."""
        fields = dict(data)
        fields["groups"] = tuple(Group(**group) for group in fields["groups"])
        return Trial(**fields)


def compared(value: Any) -> Any:
    """A value of a trial's or a group's field to be hashed and compared, so that 1, 1.0 and true differ."""
    if isinstance(value, Mapping):
        return tuple((key, type(each), each) for key, each in value.items())
    return type(value), value


Kept = TypeVar("Kept", Group, Trial)


def with_setup(kept: Kept, values: Mapping[str, Value]) -> Kept:
    """A trial or a group with these values in its setup, in place of those that it has for the same keys."""
    return dataclasses.replace(kept, setup={**kept.setup, **values})


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
    """(U, 3) true pose of the focal member at the time of sensing."""
    commands: Floats
    """(U, 2) speed (m/s) and turn rate (rad/s) that it sent to its wheels."""
    input_starts: Ints
    """(U + 1,) rows `input_starts[u]:input_starts[u + 1]` of the inputs belong to update u."""
    input_positions: NDArray[np.float32]
    """(K, 2) m, body frame: every input that the member detection made."""
    input_owners: NDArray[np.int16]
    """(K,) which robot the input belongs to, −1 = nobody (a false positive)."""
    input_selected: Bools
    """(K,) whether the neighbour selection let the input through to the law, in any of the law's sets."""
    member_states: NDArray[np.int8]
    """(U, N) for each member: HIDDEN, DETECTED or MISSED (see `sensing.truth`); the focal member is HIDDEN."""
    beams_lit: Ints
    """(U,) beams that fell on members (ground truth)."""
    beams_missed: Ints
    """(U,) beams that fell on members and made no input."""
    beams_made_up: Ints
    """(U,) beams that made an input but belong to nobody."""

    def as_selected(self) -> Updates:
        """The same updates with those inputs alone that the neighbour selection let through."""
        kept = self.input_selected
        if kept.all():
            return self
        starts = np.append(0, np.cumsum(kept))[self.input_starts]
        return dataclasses.replace(
            self,
            input_starts=starts,
            input_positions=self.input_positions[kept],
            input_owners=self.input_owners[kept],
            input_selected=kept[kept],
        )


def no_updates(members: int) -> Updates:
    """The updates of a simulation whose members do not update one by one: none."""
    none, whole = np.empty(0), np.empty(0, np.int64)
    return Updates(
        times=none,
        robots=whole,
        kinds=whole,
        rules=whole,
        motions=np.empty((0, 2)),
        poses_w=np.empty((0, 3)),
        commands=np.empty((0, 2)),
        input_starts=np.zeros(1, np.int64),
        input_positions=np.empty((0, 2), np.float32),
        input_owners=np.empty(0, np.int16),
        input_selected=np.empty(0, np.bool_),
        member_states=np.empty((0, members), np.int8),
        beams_lit=whole,
        beams_missed=whole,
        beams_made_up=whole,
    )


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
    ranges: NDArray[np.float32] | Rows
    """(S, B) with the codes of `sensing.types.Scan`."""
    intensities: NDArray[np.float32] | Rows
    """(S, B); nan where none."""


@dataclass(frozen=True)
class Pictures:
    """What cameras saw, as far as it was kept for a recording; P rows."""

    times: Floats
    """(P,)."""
    robots: Ints
    """(P,)."""
    left: tuple[bytes, ...]
    """(P,) JPEG."""
    right: tuple[bytes, ...]
    found: NDArray[np.int16]
    """(P, 2 W) for each column of the left and then of the right image which input it made; −1 = none."""
    masks: tuple[tuple[bytes, bytes], ...]
    """(P,) PNG of the left and of the right image: the number of the colour that each pixel was taken for; 0 = none."""


@dataclass(frozen=True)
class Heard:
    """What sonars heard, as far as it was kept for a recording; P rows."""

    times: Floats
    """(P,)."""
    robots: Ints
    """(P,)."""
    poses_w: Floats
    """(P, 3) pose of the robot at that time."""
    rings: tuple[Floats, ...]
    """(P,) of (S, 3): x, y (m) and heading (rad) of each of its sonars in the body frame."""
    ranges: tuple[Floats, ...]
    """(P,) of (S,) m; inf = nothing heard."""
    obstacles: tuple[Floats, ...]
    """(P,) of (K, 2) m, body frame: the echoes that were taken for obstacles."""


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


def no_contacts() -> Contacts:
    """The contacts of a simulation whose members touch nothing: none."""
    whole = np.empty(0, np.int64)
    return Contacts(np.empty(0), whole, whole, np.empty((0, 2)))


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
    """For each robot the names of its rules: `Updates.rules` are indices into them."""
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
    """Wall time by part, s: `build_s` and `loop_s`. Not part of the result: it differs from run to run."""
    tables: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    """Arrays of a simulation whose trials are more than one herd's way, by name."""
    pictures: Pictures | None = None
    heard: Heard | None = None
