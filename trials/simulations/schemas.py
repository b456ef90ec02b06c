"""The schema that a trial's world names, for the simulations whose worlds are generated."""

from __future__ import annotations

from functools import cache

from flocking.errors import unknown_name
from generation.found import is_path, load, schemas
from generation.schema import Schema
from trials.types import Trial


def schema_of(trial: Trial) -> Schema:
    """The schema of a trial. Raises `InputError` with the nearest names if there is none."""
    if is_path(trial.world):
        return load(trial.world, trial.world_source)
    if trial.world.replace("_", "-") not in schemas():
        raise unknown_name("world", trial.world, schemas())
    return _named(trial.world)


@cache
def _named(name: str) -> Schema:
    """A schema of the product's; a plan asks for it thousands of times, and a grammar is long to read."""
    return load(name)
