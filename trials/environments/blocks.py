"""Validation shared among worker processes: each takes blocks of environments, and numbers are those of all of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from flocking import users_files
from flocking.errors import InputError
from flocking.found import is_path
from generation.environment import Environment
from generation.group import Group
from generation.validation.kinematic import KinematicGroup
from generation.validation.robustness import Robustness, robustness
from generation.validation.validate import AT_A_TIME, Plan, Validated, validate
from trials.environments.hands import LIMIT_S, in_order
from trials.environments.limits import loaded

USERS_S, USERS_EACH_S = 10.0, 2.0
"""Processor time that a block may take where a behaviour is a file of the user's own, which need not return: once, and
for each of its simulations. Each call of the behaviour may take the first."""


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
    if not _ends_by_itself(behaviour, group):
        limit_s = USERS_S + USERS_EACH_S * simulations * min(block, len(environments))
    elif jobs == 1 or len(environments) <= block:
        with users_files.executed(True):
            judging = loaded(behaviour, USERS_S)
            parameters = judging.filled(given)
        yield from validate(environments, judging, group, plan, parameters)
        return
    else:
        limit_s = LIMIT_S
    calls = [
        (environments[first : first + block], first, behaviour, group, plan, dict(given or {}))
        for first in range(0, len(environments), block)
    ]
    for outcomes, error in in_order(_block, calls, jobs, prepared, limit_s):
        yield from outcomes
        if error:
            raise InputError(error)


def robustnesses(
    environments: Sequence[tuple[int, Environment]],
    behaviour: str,
    group: Group,
    plan: Plan,
    epsilon_m: float,
    others: Mapping[str, Group],
    given: Mapping[str, Any] | None = None,
    jobs: int = 1,
) -> Iterator[Robustness]:
    """`generation.validation.robustness` of environments by their numbers, in so many processes."""
    calls = [
        (environment, number, behaviour, group, plan, epsilon_m, dict(others), dict(given or {}))
        for number, environment in environments
    ]
    simulations = 2 * plan.repeats * (2 if plan.mirror else 1) * (2 + len(others))
    if not _ends_by_itself(behaviour, group):
        yield from in_order(_robustness, calls, jobs, prepared, USERS_S + USERS_EACH_S * simulations)
    elif jobs == 1 or len(calls) < 2:
        with users_files.executed(True):
            yield from (_robustness(*call) for call in calls)
    else:
        yield from in_order(_robustness, calls, jobs)


def prepared() -> None:
    """Imports the kernel of kinematic herds, which compiles it where this machine has not yet: no block's limit counts
    that."""
    import flocking.kinematic.kernel  # noqa: F401


def _ends_by_itself(behaviour: str, group: Group) -> bool:
    """Whether no code of the user's own runs that no other watch ends: robots' trials have one of their own, and a
    behaviour a limit for each call."""
    return not is_path(behaviour) or not isinstance(group, KinematicGroup)


def _robustness(
    environment: Environment,
    number: int,
    behaviour: str,
    group: Group,
    plan: Plan,
    epsilon_m: float,
    others: Mapping[str, Group],
    given: Mapping[str, Any],
) -> Robustness:
    judging = loaded(behaviour, USERS_S)
    return robustness(environment, number, judging, group, plan, epsilon_m, others, judging.filled(given))


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
        judging = loaded(behaviour, USERS_S)
        for one in validate(environments, judging, group, plan, judging.filled(given), first):
            found.append(one)
    except InputError as error:
        return found, str(error)
    return found, ""
