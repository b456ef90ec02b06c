"""The ways of a trial's herd through its environments. Trials that differ in the behaviour alone share them.

A behaviour only judges what a herd does. The herd of the last trial that a process ran is remembered, so that the same
herd is not simulated anew for another behaviour: simple and balanced split of table 7.2 are two judgements of one herd.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Sequence

from flocking.types import Floats
from generation.environment import Environment
from trials.simulations.environments import fields, herds
from trials.simulations.environments.members import Members
from trials.types import Trial

MOST_NUMBERS = 8_000_000
"""Coordinates that are remembered at most: 64 MB."""
JUDGING = ("behaviour", "examples")
"""Keys that say nothing of the herd, nor do those of the behaviour's parameters."""


class _Last:
    """What is remembered of the last trial's herd."""

    herd = ""
    numbers = 0
    positions: dict[tuple[int, bool], Floats] = {}  # noqa: RUF012 (one for the process)


def of(
    trial: Trial,
    environments: Sequence[tuple[int, Environment]],
    chosen: fields.Chosen,
    group: Members,
    *,
    is_control: bool = False,
) -> Iterator[tuple[int, Environment, Floats]]:
    """(number, environment, positions (T, N, 2) of the herd in it) for each of the environments, in their order.

    Raises `LawFailedError`.
    """
    herd = f"{shares(trial)} for {chosen.iterations} iterations"
    if herd != _Last.herd:
        _Last.herd, _Last.numbers, _Last.positions = herd, 0, {}
    if all((number, is_control) in _Last.positions for number, _ in environments):
        for number, whole in environments:
            yield number, whole, _Last.positions[number, is_control].copy()
        return
    jobs = [herds.job(trial, number, whole) for number, whole in environments]
    for (number, whole), positions in zip(environments, group.trajectories(jobs, chosen.iterations), strict=True):
        if _Last.numbers + positions.size <= MOST_NUMBERS:
            _Last.numbers += positions.size
            _Last.positions[number, is_control] = positions.copy()
        yield number, whole, positions


def shares(trial: Trial) -> str:
    """Equal for trials whose herds are the same in the same environments as long as they run, whatever judges them."""
    setup = {
        key: value for key, value in trial.setup.items() if key not in JUDGING and not key.startswith(fields.BEHAVIOUR)
    }
    same = dataclasses.replace(trial, experiment="", index=1, conditions={}, setup=setup)
    return json.dumps(same.as_dict(), sort_keys=True)
