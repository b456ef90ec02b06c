"""Validation shared among worker processes: each takes blocks of environments, and numbers are those of all of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from flocking import users_files
from flocking.errors import InputError
from generation import behaviours
from generation.environment import Environment
from generation.group import Group
from generation.validation.validate import AT_A_TIME, Plan, Validated, validate
from trials.environments.hands import in_order


def validated(
    environments: Sequence[Environment],
    behaviour: str,
    group: Group,
    plan: Plan,
    given: Mapping[str, Any] | None = None,
    jobs: int = 1,
) -> Iterator[Validated]:
    """`generation.validation.validate` in so many processes, with the same results; `behaviour` by name or path.

    `given`: values of the behaviour's parameters. Raises `InputError` as it does.
    """
    simulations = 2 * plan.repeats * (2 if plan.mirror else 1)
    block = max(1, AT_A_TIME // simulations)
    if jobs == 1 or len(environments) <= block:
        with users_files.executed(True):
            loaded = behaviours.load(behaviour)
            parameters = loaded.filled(given)
        yield from validate(environments, loaded, group, plan, parameters)
        return
    calls = [
        (environments[first : first + block], first, behaviour, group, plan, dict(given or {}))
        for first in range(0, len(environments), block)
    ]
    for outcomes, error in in_order(_block, calls, jobs):
        yield from outcomes
        if error:
            raise InputError(error)


def _block(
    environments: Sequence[Environment],
    first: int,
    behaviour: str,
    group: Group,
    plan: Plan,
    given: Mapping[str, Any],
) -> tuple[list[Validated], str]:
    """The outcomes of a block, and why it ended before its end."""
    found: list[Validated] = []
    try:
        loaded = behaviours.load(behaviour)
        for one in validate(environments, loaded, group, plan, loaded.filled(given), first):
            found.append(one)
    except InputError as error:
        return found, str(error)
    return found, ""
