"""What constructs are told apart by in an archive: their length, direction and place. Metres, degrees, world frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.types import Floats
from generation.environment import Environment
from generation.primitives import places
from generation.searches.spaces import Space

SAMPLES = 512
"""Constructs at random points of a space, by which the bounds of an archive are found. A choice; none is simulated."""
TURN_DEG = 360.0


def _fence_m(environment: Environment) -> float:
    return environment.fence_length()


def _angle_deg(environment: Environment) -> float:
    if not environment.construct:
        return math.nan
    x, y = places(environment.construct[-1])[-1] - places(environment.construct[0])[0]
    return math.degrees(math.atan2(y, x)) % TURN_DEG


def _centre(environment: Environment) -> Floats:
    walls = environment.construct_walls()
    lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
    if not lengths.sum() > 0.0:
        return np.full(2, math.nan)
    middles = (walls[:, :2] + walls[:, 2:]) / 2.0
    return np.asarray(lengths @ middles / lengths.sum())


DESCRIPTORS: Mapping[str, Callable[[Environment], float]] = MappingProxyType(
    {
        "fence_m": _fence_m,
        "angle_deg": _angle_deg,
        "centre_x_m": lambda environment: float(_centre(environment)[0]),
        "centre_y_m": lambda environment: float(_centre(environment)[1]),
    }
)
"""By name: length of fence; direction from the construct's first place to its last, 0 to 360; mean place of its fence.
nan of an empty construct, but for the length."""


def checked(names: Sequence[str]) -> tuple[str, ...]:
    """Two or more names of descriptors. Raises `InputError`."""
    for name in names:
        if name not in DESCRIPTORS:
            raise unknown_name("descriptor", name, DESCRIPTORS)
    if len(names) < 2 or len(set(names)) < len(names):
        raise InputError(
            f"descriptors = {','.join(names)}: expected two or more different ones of {', '.join(DESCRIPTORS)}"
        )
    return tuple(names)


def described(environment: Environment, names: Sequence[str]) -> list[float]:
    """The descriptors of an environment's construct."""
    return [DESCRIPTORS[name](environment) for name in names]


def mean(each: Floats, names: Sequence[str]) -> Floats:
    """(D,) mean of the descriptors (K, D) of several constructs, over those that have them; angles as directions."""
    found = np.empty(len(names))
    for column, name in enumerate(names):
        values = each[np.isfinite(each[:, column]), column]
        if len(values) == 0:
            found[column] = math.nan
        elif name.endswith("_deg"):
            angles = np.radians(values)
            found[column] = math.degrees(math.atan2(np.sin(angles).mean(), np.cos(angles).mean())) % TURN_DEG
        else:
            found[column] = values.mean()
    return found


def bounds(space: Space, environment_at: Callable[[Floats, int], Environment | None], names: Sequence[str],
           rng: np.random.Generator) -> Floats:  # fmt: skip
    """(D, 2) lowest and highest value of each descriptor over `SAMPLES` random points of a space; angles: a full turn.

    `environment_at`: of a point (d,) and a number, an environment, or None where the schema makes nothing of the point.
    Raises `InputError` where no point has a construct.
    """
    made = [environment_at(point, k) for k, point in enumerate(rng.random((SAMPLES, len(space.axes))))]
    values = np.array([described(each, names) for each in made if each is not None]).reshape(-1, len(names))
    finite = values[np.isfinite(values).all(axis=1)]
    if len(finite) == 0:
        raise InputError(f"the schema made no construct at {SAMPLES} random points: expected another space")
    found = np.column_stack([finite.min(axis=0), finite.max(axis=0)])
    for column, name in enumerate(names):
        if name.endswith("_deg"):
            found[column] = 0.0, TURN_DEG
    flat = found[:, 1] - found[:, 0] < 1e-9
    found[flat] += np.array([-0.5, 0.5])
    return found
