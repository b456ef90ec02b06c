"""A floor plan of many rooms with a few Creates in it, as `herd bench` times it."""

from __future__ import annotations

import dataclasses
from time import process_time

import mujoco
import numpy as np

from flocking.types import Floats
from generation.environment import START, Environment
from generation.files import to_json
from generation.primitives import Point, Segment
from sensing.laser.hokuyo import SETTINGS, Lasers
from trials.simulations.robots.fields import group, of_trial, trial
from trials.simulations.robots.herd import Herd, assemble
from trials.simulations.robots.log import Log
from trials.simulations.robots.loop import run
from trials.types import Trial
from worlds.assemble import prefix

ROOMS, ROOM_M, DOOR_M = 14, 3.0, 1.0
"""Rooms along a side of the plan, the side of one, and the width of the doors between them."""
ROBOTS = 4


def floor_plan() -> Environment:
    """Square rooms with a door in each inner wall, of straight pieces a door apart."""
    size = ROOMS * ROOM_M
    walls: list[Segment] = []
    for line in np.arange(ROOMS + 1) * ROOM_M:
        inner = 0.0 < line < size
        pieces = [(0.0, DOOR_M), (ROOM_M - DOOR_M, ROOM_M)] if inner else [(0.0, ROOM_M)]
        for room in np.arange(ROOMS) * ROOM_M:
            for start, end in pieces:
                walls.append(Segment(line, room + start, line, room + end))
                walls.append(Segment(room + start, line, room + end, line))
    middle = (ROOMS // 2 + 0.5) * ROOM_M
    return Environment(tuple(walls), (), {START: Point(middle, middle)})


def creates(seconds: float) -> Trial:
    """Creates that go about the plan at random and keep away from walls."""
    herd = group("random-motion", ROBOTS, obstacles="avoid")
    start = {"gap_m": 0.5, "length_m": 2.0, "half_width_m": 1.0}
    made = trial("bench", 1, [herd], world="plan.json", formation="scattered", formation_parameters=start)
    return dataclasses.replace(made, world_source=to_json(floor_plan()), setup={"duration_s": seconds}, seed=1)


def loop_seconds(made: Trial) -> tuple[float, float]:
    """Processor time (s) of the whole loop of a trial, and that of its physics and scans alone."""
    herd = assemble(made, record=False)
    controls: list[Floats] = []
    herd.world.observers.append(lambda data: controls.append(data.ctrl.copy()))
    log = Log(made, len(herd.robots), "none")
    given = of_trial(made)
    started = process_time()
    run(herd, log, last=round(given.duration_s / given.timestep_s))
    whole = process_time() - started
    return whole, _physics_and_scans(herd, controls, round(given.duration_s * 10.0))


def _physics_and_scans(herd: Herd, controls: list[Floats], scans: int) -> float:
    """Time of bare steps through the same controls from the same start, and of all robots' scans at 10 Hz."""
    model, data = herd.world.model, mujoco.MjData(herd.world.model)
    mujoco.mj_forward(model, data)
    every, names = max(1, len(controls) // scans), herd.world.names
    sites, roots = [f"{prefix(name)}laser" for name in names], [int(root) for root in herd.world.fleet.root_bodies]
    lasers = Lasers(herd.world.whole, sites, roots, [SETTINGS["ideal"]] * len(names))
    started = process_time()
    for step, row in enumerate(controls):
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
        if step % every == 0:
            for robot in range(len(names)):
                lasers.trace(data, robot)
    return process_time() - started
