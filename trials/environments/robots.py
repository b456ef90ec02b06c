"""Robots as a group that environments are validated with: each simulation is a trial in MuJoCo.

An environment's lengths are multiplied by a scale, from the units of Fine 2015's kinematic members to metres of robots,
and positions are divided by it, so that a behaviour judges both by the same numbers. An iteration takes as long as a
robot needs for the way that a kinematic member goes in one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking import lawentry, lawsource, parameters
from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import START, Environment
from generation.files import to_json
from generation.group import Job
from robots import body as bodies
from trials import simulations
from trials.environments.hands import in_order
from trials.simulations.robots import fields
from trials.types import Trial, Value

WORLD = "environment.json"
"""Path that a trial's world is named by; its text travels with the trial."""
SCALE = 0.05
"""Metres of robots in a unit of the document's simulations: its fragmentation threshold of 25 units is then 1.25 m,
within what the Create's laser sees of members, and its walls of 40 units are 2 m. A choice."""
STEP_UNITS = 2.0
"""Way of a kinematic member in one iteration, in units."""


PLACED = ("count", "body", "body_files", "law", "formation", "start_x_m", "start_y_m", "start_heading_deg")
"""Of what a group of robots can be given, what the group and its starts give."""


class Iterations(NamedTuple):
    """What a group of robots can be given beside `GroupFields`."""

    step_units: Annotated[
        float, Parameter("units", "a choice: way that an iteration is worth", low=0.01, high=1000.0)
    ] = STEP_UNITS


@dataclass(frozen=True)
class RobotGroup:
    """Robots of one kind in MuJoCo: a `generation.group.Group`."""

    law: str
    """A law's name, or the path of a user's own file."""
    count: int
    law_parameters: Mapping[str, Value] = field(default_factory=dict)
    """In metres of robots."""
    selection: str = "all"
    body: str = "create"
    pipeline: str = "member-based"
    scale: float = SCALE
    """Metres of robots in a unit of the environment."""
    step_units: float = STEP_UNITS
    """Way that an iteration is worth, in units of the environment."""
    setup: Mapping[str, Value] = field(default_factory=dict)
    """What else a group of robots can be given, by key: `speed_m_s`, `obstacles`, `sensors.dropout`."""
    law_source: str = ""
    jobs: int = 1
    """Worker processes; with one the trials run in this process."""

    @property
    def iteration_s(self) -> float:
        """Time that an iteration stands for, s."""
        speed = float(self.setup.get("speed_m_s", fields.GroupFields().speed_m_s))
        return self.step_units * self.scale / speed

    @property
    def apart_units(self) -> float:
        """Least distance of robots at the start, in units of the environment: two diameters."""
        return 4.0 * bodies.load(self.body).radius / self.scale

    def trial(self, job: Job, iterations: int) -> Trial:
        """One simulation as a trial. Each robot is a group of one, which stands where the job has it."""
        x, y, heading = job.poses_w.T
        given: dict[str, Any] = {"formation.jitter_m": 0.0, "formation.heading_spread_deg": 0.0, "obstacles": "avoid"}
        given |= self.setup
        groups = [
            fields.group(
                self.law,
                1,
                name=f"r{k + 1}",
                pipeline=self.pipeline,
                selection=self.selection,
                law_parameters=dict(self.law_parameters),
                body=self.body,
                formation="single-group",
                start_x_m=float(self.scale * x[k]),
                start_y_m=float(self.scale * y[k]),
                start_heading_deg=math.degrees(heading[k]),
                **given,
            )
            for k in range(self.count)
        ]
        trial = fields.trial(
            "validate",
            1,
            groups,
            world=WORLD,
            duration_s=max(0.1, math.ceil(10.0 * iterations * self.iteration_s) / 10.0),
        )
        seed = int(np.random.SeedSequence(job.seed).generate_state(1, np.uint32)[0])
        return replace(trial, seed=seed, world_source=_text(job.environment, self.scale))

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        """For each job, in their order, the positions (iterations + 1, N, 2) of its robots, in the environment's units.

        Raises `InputError` for a trial that cannot be set up, and for one that fails on its way.
        """
        trials = [self.trial(job, iterations) for job in jobs]
        if self.jobs > 1 and len(trials) > 1:
            limit = max(simulations.of(trial).limit_s(trial) for trial in trials)
            found = in_order(_run, [(trial,) for trial in trials], self.jobs, limit_s=limit)
        else:
            found = (_run(trial) for trial in trials)
        at = self.iteration_s * np.arange(iterations + 1)
        for times, places in found:
            positions = np.empty((iterations + 1, self.count, 2))
            for k in range(self.count):
                for axis in (0, 1):
                    positions[:, k, axis] = np.interp(at, times, places[:, k, axis]) / self.scale
            yield positions


def robots(law: str, count: int, **given: object) -> RobotGroup:
    """A group of robots; the text of a user's own law file is read. Raises `InputError`."""
    source = lawsource.read_source(law) if lawentry.is_path(law) else ""
    return RobotGroup(law, count, law_source=source, **given)  # type: ignore[arg-type]


def checked(given: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """What a user gives a group of robots, below `prefix`, checked: of `GroupFields`, of `Iterations`, or of a sensor
    and the like (`sensors.dropout`), which a trial's own check refuses. Raises `InputError`."""
    known = {**parameters.declared(fields.GroupFields), **parameters.declared(Iterations)}
    for name in PLACED:
        del known[name]
    for name in given:
        if name not in known and "." not in name:
            raise unknown_name("key", f"{prefix}{name}", [f"{prefix}{each}" for each in known])
    return {
        name: parameters.checked(f"{prefix}{name}", value, known[name]) if name in known else value
        for name, value in given.items()
    }


def _text(environment: Environment, scale: float) -> str:
    """The environment in metres of robots, as JSON. Its start is left out: robots stand where they are put."""
    moved = environment.moved(scale=scale)
    return to_json(replace(moved, markers={name: mark for name, mark in moved.markers.items() if name != START}))


def _run(trial: Trial) -> tuple[Floats, Floats]:
    """Times (T,) and positions (T, N, 2) of one trial, m. Raises `InputError` where it fails."""
    simulations.check(trial)
    result = simulations.run_trial(trial)
    if result.outcome != "done":
        raise InputError(f"a trial of robots failed: {result.reason}")
    return result.times, result.poses_w[..., :2]
