"""One-legged robots that run over open ground, as `herd bench` times them: with the control in the loop, with the
herding law too, and without."""

from __future__ import annotations

from time import process_time

import mujoco
import numpy as np

from flocking.herding.loop import no_touching
from robots.one_legged.ground import Ground, build
from trials.design import plan
from trials.simulations.running import fields, loop
from trials.simulations.running.creatures import Legged

HERD = 105
"""Robots of the published herd."""
SIZES = (15, 240)
"""Between which the cost of a robot is compared."""
WARM_S = 1.0
"""Simulated seconds before a run is timed: by then the robots hop out of step."""


def running(count: int) -> Ground:
    """Robots on a grid, 3 m apart, that run at 2 m/s and were let fall from different heights."""
    side = int(np.ceil(np.sqrt(count)))
    places = 3.0 * np.stack(np.divmod(np.arange(count), side), axis=1)
    poses_w = np.hstack([places, np.zeros((count, 1))])
    ground = build(poses_w, np.random.default_rng(1).uniform(0.0, 0.15, count))
    ground.fleet.desire_all(np.tile([2.0, 0.0], (count, 1)))
    ground.run(WARM_S)
    return ground


def whole_and_bare(count: int, seconds: float) -> tuple[float, float]:
    """Processor time (s) of that much of a run with its control, and of bare `mj_step` with the same controls."""
    ground = running(count)
    model, data = ground.model, ground.data
    again = mujoco.MjData(model)
    mujoco.mj_copyData(again, model, data)
    controls = np.empty((round(seconds / model.opt.timestep), model.nu))
    started = process_time()
    for row in controls:
        ground.step()
        row[:] = data.ctrl
    whole = process_time() - started
    ctrl, step = again.ctrl, mujoco.mj_step
    started = process_time()
    for row in controls:
        ctrl[:] = row
        step(model, again)
    return whole, process_time() - started


def herding_and_bare(seconds: float) -> tuple[float, float]:
    """Likewise of the published herd behind its user's creature: control and herding in the loop, from the start on."""
    settings = {"herd.body": "one-legged", "herd.count": HERD, "duration_s": seconds}
    trial = plan("herd-steady", repeats=1, settings=settings).trials[0]
    given = fields.of_trial(trial)
    creatures, touching = loop.built(trial), no_touching(HERD, given.collision_m)
    started = process_time()
    loop.run(trial, creatures, touching)
    whole = process_time() - started
    again, bare = loop.built(trial), loop.built(trial)
    assert isinstance(again, Legged)
    assert isinstance(bare, Legged)
    controls = np.empty((fields.steps_of(trial), again.model.nu))
    again.mind.send(0, np.array([2.0, 0.0]))
    for number, row in enumerate(controls):
        if number % given.refresh_steps == 0:
            again.mind.look()
        again.advance(number, np.empty((1, HERD, again.mind.law.draws)), touching)
        row[:] = again.data.ctrl
    model, data, ctrl, step = bare.model, bare.data, bare.data.ctrl, mujoco.mj_step
    started = process_time()
    for row in controls:
        ctrl[:] = row
        step(model, data)
    return whole, process_time() - started


def measured(repeats: int, seconds: float) -> dict[str, tuple[float, ...]]:
    """Times real time of one robot and of the herd, the whole against bare stepping, both with the herding law in the
    loop too, and the cost of a robot of a large herd against a small one's; each once a repeat, by turns, after one
    that is not counted."""
    found: dict[str, list[float]] = {"one": [], "herd": [], "bare": [], "herding": [], "of herding": [], "growth": []}
    for _ in range(repeats + 1):
        one, _ = whole_and_bare(1, 4.0 * seconds)
        herd, bare = whole_and_bare(HERD, seconds)
        small, large = (whole_and_bare(count, 0.5 * seconds)[0] / count for count in SIZES)
        found["one"].append(4.0 * seconds / one)
        found["herd"].append(seconds / herd)
        found["bare"].append(herd / bare)
        whole, alone = herding_and_bare(seconds)
        found["herding"].append(seconds / whole)
        found["of herding"].append(whole / alone)
        found["growth"].append(large / small)
    return {name: tuple(runs[1:]) for name, runs in found.items()}
