"""`herd world`: an experiment's world as MJCF, with its robots at their start."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from trials import simulations
from trials.batch.asked import Asked, planned
from trials.batch.folders import write_whole
from trials.commands import lawcheck
from trials.invoked import command


def write(experiment: str, out: Path, repeat: int, world: str | None, settings: Mapping[str, Any]) -> None:
    """Writes the world to a new file, with the starting formation of that repeat, and says how to open it."""
    asked = Asked(experiment, repeats=repeat, settings=dict(settings), world=world)
    lawcheck.check_all(asked)
    made, _ = planned(asked)
    chosen = next(trial for trial in made.trials if trial.repeat == repeat)
    world_xml = simulations.of(chosen).world_xml
    if world_xml is None:
        raise InputError(
            f"experiment {experiment!r} is {chosen.simulation}: it has no world for MuJoCo; run it and see it with "
            f"{command('play')}"
        )
    if os.path.lexists(out):
        raise InputError(f"--out {out}: there is such a file; expected a new one")
    write_whole(out, world_xml(chosen).encode())
    print(f"{out}: open it with {shlex.join([sys.executable, '-m', 'mujoco.viewer', f'--mjcf={out}'])}")
