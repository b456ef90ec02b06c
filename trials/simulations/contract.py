"""What a simulation is: one way to run a trial. Each is a folder beside this file, with its own `SIMULATION`."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from trials.rows import Section
from trials.types import Group, Measure, Trial, TrialResult


class KeysOf(Protocol):
    """The keys of a trial, or of one of its groups."""

    def __call__(self, trial: Trial, group: Group | None = None) -> list[Section]: ...


Watcher = Callable[[float, int, int, int, int], bool]
"""(time in s, walls cleared so far, walls that are left, members past the next one or in the goal, members on their
course) → whether the next one is cleared now; not heeded where none is left. Raises `StoppedError` to end the trial."""


class Rider(Protocol):
    """Who steers the user's creature of a herd while it runs."""

    def begin(self, model: Any, data: Any) -> None:
        """Is handed the MuJoCo model and data to be looked at; what is in them changes as the trial runs."""

    def velocity(self, time: float) -> tuple[float, float]:
        """How the creature is to run from this time (s) on: m/s along the world's x and y.

        Raises `StoppedError` to end the trial."""


class StoppedError(Exception):
    """Who watches a trial has seen enough: it ends, and what was measured until then is kept."""


@dataclass(frozen=True)
class Simulation:
    """The functions and tables of a simulation. Functions that refuse what a user gave raise `InputError`."""

    keys_of: KeysOf
    """The sections of declared parameters: those of the trial, or those of a group. Values that are no fields of
    `Trial` or `Group` stand in their `setup`."""
    check: Callable[[Trial], None]
    """Refuses, before anything is run, a trial whose names and numbers do not fit one another. It may be asked of one
    repeat alone: what differs from repeat to repeat is `check_start`'s."""
    settled: Callable[[Trial], Trial]
    """The trial with the values that its names stand for written into it, so that its run's folder records them."""
    run_trial: Callable[[Trial, str, bool, Path | None], TrialResult]
    """(trial; scans to keep: none, some or all; whether to raise errors; folder for what is too large for the memory,
    None for the system's) → what was measured."""
    record: Callable[[TrialResult, Path], None]
    """Writes the recording of a finished trial, with its layout in the viewer."""
    measures: Mapping[str, Measure]
    """Unit and meaning of every measure, in the order in which they are shown."""
    key_measures: tuple[str, ...]
    """The measures that a first look at a report needs."""
    limit_s: Callable[[Trial], float]
    """Wall time (s) after which a trial counts as hung: some hundred times what it takes."""
    moment: Callable[[Trial], Trial]
    """The trial shortened to its first moment: running it takes all its code into use within a short time."""
    prepare: Callable[[], None]
    """Imports all that a trial needs, in a worker before its first trial."""
    at_step: Callable[[Trial, int], str]
    """A step as a moment in words: `at 0.50 s`."""
    listed: Callable[[str], Mapping[str, object]]
    """(kind: `bodies`, `worlds` or `formations`) → by the name that `herd list` shows, an object with a docstring."""
    constants: Callable[[Trial], list[str]]
    """Modules whose constants `herd show` lists with a trial."""
    check_start: Callable[[Trial], None] = lambda trial: None
    """Refuses a trial whose start, which its repeat's random numbers make, does not fit its world."""
    shares: Callable[[Trial], Hashable] = lambda trial: None
    """Equal for trials of which a process that has just run one needs less time for the next; None: for no others."""
    has_scans: bool = False
    """Whether there are scans that a recording can keep."""
    world_xml: Callable[[Trial], str] | None = None
    """The trial's world as MJCF; None if there is none."""
    watched: Callable[[Trial, str, Watcher], TrialResult] | None = None
    """(trial, scans to keep, who says when the herd has cleared what guides it) → what was measured. Refuses a trial in
    which nothing is to be said. None: there are no such trials."""
    steered: Callable[[Trial, Rider], TrialResult] | None = None
    """(trial, who steers its user's creature) → what was measured; the result's trial repeats the ride. None: there is
    nobody to steer."""
    reads_images: Callable[[Trial], bool] = lambda trial: False
    """Whether a trial renders images, for which OpenGL is needed."""
    write_images: Callable[[Trial, Path, float], int] | None = None
    """(trial, folder, time between two moments in s) → how many labelled images of what its robots' cameras see were
    written. None: there are no cameras."""
    headings: Mapping[str, str] = field(default_factory=dict)
    """The measures of the table on a terminal, with their headings; empty: the key measures."""
