"""How the flocks of Akama and Naruse 2014 start: lattices of regular triangles with varied velocities or positions.

Source: Akama and Naruse 2014, "Development of link tension index for flocking agents", sections 4.1 to 4.3. Metres,
seconds, radians; world frame, in unbounded space.

    velocity-variation   the lattice, each member with a random velocity below beta
    position-variation   the lattice, each member shifted in x and y by random values below gamma, at rest
    both-variations      shifts below gamma and velocities below beta, both of the same number: not in the publication,
                         whose table 2 counts links that its index cannot count of members at rest

The arrangement of the 100 members on the lattice, the signs of the shifts and the distribution of the velocities are
not published: they are parameters. The publication counts 262 links. Rows of ten have 261, and so has a rhombus of ten
by ten; the members nearest to a point within a triangle have 264. 262 are found in no block of rows of equal width, in
none whose rows are in turn one shorter and in no spiral about a member, but in 3 of 200 discs about random points.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import Floats

SOURCE = "Akama and Naruse 2014"
VELOCITY, POSITION, BOTH = "velocity-variation", "position-variation", "both-variations"
NAMES = (VELOCITY, POSITION, BOTH)
OPEN = math.nan
"""Left to the law's own herd, as in `trials.simulations.kinematic.fields`."""


class Parameters(NamedTuple):
    """The lattice of Akama and Naruse 2014, whose members differ in velocity, position or both."""

    spacing_m: Annotated[float, Parameter("m", "the stable distance d; HERD in the law's file", low=1e-6)] = OPEN
    strength: Annotated[
        float,
        Parameter(
            "m/s or m", f"{SOURCE}: beta or gamma, 1, 3 and 5; open: speed or spacing of the law's herd", low=0.0
        ),
    ] = OPEN
    factor: Annotated[float, Parameter("", "a choice: by which the strength is multiplied", low=0.0, plausible=())] = (
        1.0
    )
    arrangement: Annotated[
        str,
        Parameter(
            "",
            f"{SOURCE} gives none, a choice: rows as square as the count permits, a rhombus, or the nearest to a point",
            choices=("rows", "rhombus", "disc"),
            plausible=("rows", "rhombus", "disc"),
        ),
    ] = "rows"
    shifts: Annotated[
        str,
        Parameter(
            "",
            f"{SOURCE} gives no sign, a choice: within ± gamma or from 0 to gamma",
            choices=("both", "positive"),
            plausible=("both", "positive"),
        ),
    ] = "both"
    velocities: Annotated[
        str,
        Parameter(
            "",
            f"{SOURCE} gives no distribution below the norm beta, a choice: uniform over the disc, uniform in norm, "
            "all of norm beta, both components within ± beta, or both from 0 to beta",
            choices=("disc", "norm", "circle", "square", "quadrant"),
            plausible=("disc", "norm", "circle", "square", "quadrant"),
        ),
    ] = "disc"


def start(formation: str, given: Parameters, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """(count, 3) poses and (count,) speeds along their headings. The same numbers are drawn whatever is chosen."""
    strength = given.strength * given.factor
    shifts, numbers = rng.uniform(-1.0, 1.0, (count, 2)), rng.random((count, 2))
    places = arranged(given.arrangement, count, given.spacing_m)
    if formation in (POSITION, BOTH):
        places = places + strength * (shifts if given.shifts == "both" else 0.5 * (shifts + 1.0))
    velocities = _drawn(given.velocities, numbers) * (0.0 if formation == POSITION else strength)
    headings = np.arctan2(velocities[:, 1], velocities[:, 0])
    if formation == POSITION:
        headings = math.pi * (2.0 * numbers[:, 0] - 1.0)
    return np.column_stack([places, headings]), np.hypot(velocities[:, 0], velocities[:, 1])


def arranged(arrangement: str, count: int, spacing_m: float) -> Floats:
    """(count, 2) points of a lattice of regular triangles about the origin.

    Each row has as many as the whole number nearest to the root of the count.
    """
    height = math.sqrt(3.0) / 2.0
    if arrangement == "disc":
        reach = 2 + math.ceil(math.sqrt(2.0 * count))
        across, up = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1))
        places = np.column_stack([(across + 0.5 * up).ravel(), (up * height).ravel()])
        places -= np.array([0.375, 0.25 * height])  # off every axis of symmetry: no ties among the distances
        nearest = np.argsort(np.hypot(places[:, 0], places[:, 1]), kind="stable")[:count]
        return places[nearest] * spacing_m
    columns = max(1, round(math.sqrt(count)))
    numbers = np.arange(count)
    rows = numbers // columns
    shift = 0.5 * (rows if arrangement == "rhombus" else rows % 2)
    places = np.column_stack([numbers % columns + shift, rows * height]).astype(np.float64)
    centred: Floats = (places - places.mean(axis=0)) * spacing_m
    return centred


def check(world: str) -> None:
    """Refuses a world that is not unbounded: `InputError`."""
    if world != "unbounded":
        raise InputError(f"world {world!r}: these lattices stand in unbounded space; expected --set world=unbounded")


def _drawn(velocities: str, numbers: Floats) -> Floats:
    """(N, 2) velocities for a bound of 1 from numbers (N, 2) uniform in [0, 1)."""
    if velocities in ("square", "quadrant"):
        return 2.0 * numbers - 1.0 if velocities == "square" else numbers
    norms = {"disc": np.sqrt(numbers[:, 1]), "norm": numbers[:, 1], "circle": np.ones(len(numbers))}[velocities]
    angles = math.pi * (2.0 * numbers[:, 0] - 1.0)
    return norms[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
