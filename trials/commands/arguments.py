"""Arguments and options that several commands share."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from flocking.errors import InputError

LONG = 60
"""Characters of a text that an error repeats."""


def whole(low: int, high: int | None = None) -> Callable[[str], int]:
    """A parser of whole numbers from `low` to `high`, whose error repeats the text that it was given."""

    def read(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = low - 1
        if number < low or (high is not None and number > high):
            most = f" and at most {high}" if high is not None else ""
            told = text if len(text) <= LONG else f"{text[:LONG]}…"
            raise ValueError(f"{told!r}: expected a whole number of at least {low}{most}")
        return number

    return read


Experiment = Annotated[
    str, Argument(help="Name of an experiment, see `herd list experiments`, or the path of your own file.")
]
Run = Annotated[Path | None, Argument(metavar="[DIR]", help="A run's folder; the newest one below runs/ by default.")]
Repeats = Annotated[
    int | None, Option(parser=whole(1), metavar="N", help="Repeats of each cell; the experiment's own by default.")
]
Seed = Annotated[int, Option(parser=whole(0, 2**63 - 1), metavar="S", help="Of all random numbers.")]
Jobs = Annotated[int | None, Option(parser=whole(1), metavar="J", help="Worker processes; all cores by default.")]
Cluster = Annotated[
    str | None,
    Option(metavar="ADDRESS", help="Of a Dask scheduler, whose workers run the trials: tcp://HOST:8786."),
]
Law = Annotated[str | None, Option(help="Another law: its name or the path of your own file.")]
Pipeline = Annotated[str | None, Option(help="Another member detection.")]
Body = Annotated[str | None, Option(help="Another robot: its name or the path of your own folder.")]
World = Annotated[
    str | None,
    Option(metavar="WORLD", help="Another world: its name, or the path of an environment, a plan or your own file."),
]
Settings = Annotated[
    list[str] | None, Option("--set", metavar="KEY=VALUE", help="Sets a parameter; VALUE is TOML. May be repeated.")
]
Sweeps = Annotated[
    list[str] | None, Option("--sweep", metavar="KEY=A,B,C", help="Runs all of it for each value. May be repeated.")
]
OwnExperiment = Annotated[
    Path | None, Option(metavar="FILE", help="Your own experiment's file, for its claims and figures.")
]


def jobs_of(jobs: int | None, cluster: str | None) -> int:
    """Worker processes of this machine: all cores by default."""
    if jobs is not None and cluster is not None:
        raise InputError(f"--jobs {jobs}: counts processes of this machine; expected --jobs or --cluster, not both")
    return jobs or len(os.sched_getaffinity(0))
