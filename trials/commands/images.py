"""`herd images`: a labelled set of what robots' cameras see, for those who train and test trackers."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from typer import Option

from flocking.errors import InputError
from trials.commands.arguments import Body, Experiment, Settings, whole


def images(
    experiment: Experiment,
    out: Annotated[Path, Option(metavar="DIR", help="A new folder for images and labels.")],
    trial: Annotated[int, Option(parser=whole(1), metavar="K", help="Which trial of the experiment.")] = 1,
    every: Annotated[float, Option(metavar="S", help="Seconds between two moments.")] = 1.0,
    body: Body = None,
    settings: Settings = None,
) -> None:
    """Writes what robots' cameras see as a labelled image set in COCO's format.

    PNG images, and labels.json with masks, boxes, bearings and distances of every cone and robot.
    """
    from trials.commands import options

    _write(str(experiment), trial, every, options.settings(settings or []), out, body)


def _write(
    experiment: str, number: int, every_s: float, settings: Mapping[str, Any], out: Path, body: str | None
) -> None:
    from trials import simulations
    from trials.design import plan

    if not every_s > 0.0:
        raise InputError(f"--every {every_s:g}: expected a time above 0 s")
    if os.path.lexists(out):
        raise InputError(f"--out {out}: there is such a file or folder; expected a new one")
    made = plan(experiment, settings=settings, body=body)
    if not 1 <= number <= len(made.trials):
        raise InputError(f"--trial {number}: {experiment} has trials 1 to {len(made.trials)}")
    trial = made.trials[number - 1]
    own = simulations.of(trial)
    if own.write_images is None:
        raise InputError(f"experiment {experiment!r} has no robots in MuJoCo; expected one that has, as follow-1")
    simulations.check(trial)
    out.mkdir(parents=True)
    count = 0
    try:
        count = own.write_images(trial, out, every_s)
    finally:
        if count == 0 and not any(out.iterdir()):
            out.rmdir()
    print(f"{count} images and labels.json are in {out}")
