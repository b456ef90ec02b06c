"""Sensor-based detection (Fine 2015, section 2.2): every reading above a threshold of intensity is an input.

Nothing is known of a member's shape. A reading without a range gives no input: there is no place to put it. One
without an intensity is neither foreground nor background. (Where the laser tells bright from dark by code 18 alone,
nothing is detected at all: its bright readings have no range.) Runs of background readings, split as segments are, give
the obstacles. Inputs are points on the surface, up to one body radius before the member's centre.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, NamedTuple

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.types import Floats, Ints, Members, Obstacles, Own, unknown
from sensing.shapes import recognition
from sensing.shapes.segments import beam_directions, laser_mount, split
from sensing.types import NOBODY, Detection, Senses

READS = frozenset({"scan", "intensity"})


class Parameters(NamedTuple):
    """What is bright; not published, so chosen on data of our own."""

    threshold: Annotated[float, Parameter("", "chosen: python -m scripts.calibrate_detection", low=0.0)] = 17.0
    """Least intensity of the foreground, relative to white paper seen head-on at 1 m."""
    split_m: Annotated[float, Parameter("m", "as in member-based detection; for obstacles only", low=0.0)] = (
        recognition.Parameters().split_m
    )
    """Consecutive background readings further apart than this belong to different obstacles."""


class State(NamedTuple):
    """The parameters and scratch space."""

    threshold: float
    split_m: float
    mount_x: float
    mount_y: float
    directions: Floats
    """(B, 2) of the beams."""
    points: Floats
    """(B, 2) scratch."""
    readings: Ints
    """(B,) scratch."""
    starts: Ints
    """(B + 1,) scratch."""


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> State:
    """Only the laser's place on the robot is taken from the model."""
    mount_x, mount_y, yaw = laser_mount(member_model)
    return State(
        float(parameters.threshold),
        float(parameters.split_m),
        mount_x,
        mount_y,
        beam_directions(angles, yaw),
        *_scratch(len(angles)),
    )


@cache
def _scratch(beams: int) -> tuple[Floats, Ints, Ints]:
    """One for all robots of a process: every scan writes it over, and it stays in the processor's cache."""
    return np.zeros((beams, 2)), np.zeros(beams, np.int64), np.zeros(beams + 1, np.int64)


def detect(senses: Senses, own: Own, state: State) -> tuple[Detection, State]:
    """One row a bright reading, in the order of the beams."""
    scan = senses.scan
    assert scan is not None
    positions, bearings, obstacles, beams = _detect(scan.ranges, scan.intensities, *state)
    members = Members(positions, bearings, *unknown(len(bearings)))
    return Detection(members, Obstacles(obstacles), beams), state


@compiled
def _detect(
    ranges: Floats,
    intensities: Floats,
    threshold: float,
    split_m: float,
    mount_x: float,
    mount_y: float,
    directions: Floats,
    points: Floats,
    readings: Ints,
    starts: Ints,
) -> tuple[Floats, Floats, Floats, Ints]:
    """Positions and bearings of the inputs, points of the obstacles, the row of each beam; all newly made."""
    segments, kept = split(ranges, directions, mount_x, mount_y, split_m, points, readings, starts)
    beams = np.full(len(ranges), NOBODY, np.int64)
    inputs = 0
    for k in range(kept):
        if intensities[readings[k]] >= threshold:
            beams[readings[k]] = inputs
            inputs += 1
    positions, bearings = np.empty((inputs, 2)), np.empty(inputs)
    nearest, obstacles = np.empty(kept, np.int64), 0
    for s in range(segments):
        background = False
        for k in range(starts[s], starts[s + 1]):
            beam = readings[k]
            row = beams[beam]
            if row >= 0:
                positions[row, 0] = points[beam, 0]
                positions[row, 1] = points[beam, 1]
                bearings[row] = math.atan2(points[beam, 1], points[beam, 0])
                background = False
            elif math.isnan(intensities[beam]):
                continue
            elif not background:
                nearest[obstacles] = beam
                obstacles += 1
                background = True
            elif ranges[beam] < ranges[nearest[obstacles - 1]]:
                nearest[obstacles - 1] = beam
    surfaces = np.empty((obstacles, 2))
    for k in range(obstacles):
        surfaces[k, 0] = points[nearest[k], 0]
        surfaces[k, 1] = points[nearest[k], 1]
    return (
        positions,
        bearings,
        surfaces,
        beams,
    )
