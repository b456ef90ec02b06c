"""The part of `herd bench` on cameras: pairs of images a second, and what a pair costs beyond its rendering."""

from __future__ import annotations

import dataclasses

import numpy as np

from flocking.errors import InputError
from sensing.camera import opengl
from sensing.camera.lens import remap, remap_tables
from trials.commands.bench_figures import Figure, processor_s, repeated, timed
from trials.design import plan
from trials.simulations.robots.herd import Herd, assemble
from trials.simulations.robots.log import Log
from trials.simulations.robots.loop import run
from trials.types import Trial, with_setup

SECONDS = 6.0
"""Simulated seconds of a run: sixty pairs."""
CALLS = 50
BODY = "create-with-cameras"


def figures() -> list[Figure]:
    """The loop of a Create that follows another by equal-angle images, and of a pair all but its rendering.

    None where nothing renders.
    """
    try:
        opengl.library()
    except InputError:
        return []
    rates = tuple(1.0 / each for each in repeated(_seconds_a_pair, following()))
    return [
        Figure("a robot with two cameras, whole loop", "pairs/s", rates, 30.0),
        Figure("a pair beyond its rendering", "ms", _beyond_rendering(), 6.0, at_least=False),
    ]


def following() -> Trial:
    """A Create that follows another by its two cameras; what images truly show is not rendered besides."""
    made = next(each for each in plan("follow-1", repeats=1).trials if each.groups[0].setup["body"] == BODY)
    herd, lead = (with_setup(each, {"cameras.judged": False}) for each in made.groups)
    return with_setup(dataclasses.replace(made, groups=(herd, lead)), {"duration_s": SECONDS})


def _seconds_a_pair(trial: Trial) -> float:
    """Processor time of the loop, without building the world, for each pair of images."""
    herd = assemble(trial, record=False)
    log = Log(trial, len(herd.robots), "none")
    seconds = processor_s(lambda: run(herd, log, last=round(SECONDS / herd.timestep)))
    return seconds / _pairs(herd)


def _pairs(herd: Herd) -> int:
    """Pairs that the one robot with open eyes has taken."""
    return round(SECONDS / herd.timestep / herd.robots[0].period)


def _beyond_rendering() -> tuple[float, ...]:
    """ms of a pair: remapping both images, segmentation and runs, control."""
    herd = assemble(following(), record=False)
    robot, data = herd.robots[0], herd.world.data
    cameras = robot.cameras
    assert cameras is not None
    lens = cameras.lenses[robot.index]
    assert lens is not None
    tables = remap_tables(lens)
    rendering = np.zeros((tables.rendered_height, tables.rendered_width, 3), np.uint8)
    senses, _ = robot.sense(data, data.time, None, record=False)

    def update() -> None:
        remap(rendering[::-1], tables)
        remap(rendering[::-1], tables)
        detection = robot.heed(robot.detect(senses))
        robot.drive(robot.avoid(robot.decide(detection, robot.select(detection.members)), detection))

    return tuple(each / 1e3 for each in timed(update, CALLS))
