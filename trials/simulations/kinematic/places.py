"""What the worlds and the starting formations of kinematic members can be given, with units and sources."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from trials.simulations.kinematic import lattice_starts

OPEN = math.nan
"""A value that is left to the law's own herd."""
OF_LAW = "the law's own herd: HERD in its file"


class SpaceParameters(NamedTuple):
    """A square with walls around it."""

    size_m: Annotated[
        float,
        Parameter("m", f"side of the square; {OF_LAW}, its spacing times the root of the count", low=1e-6, high=1e9),
    ] = OPEN


class PeriodicParameters(SpaceParameters):
    """A square whose opposite sides are one."""


class ObstacleParameters(NamedTuple):
    """A bounded square with pieces of wall scattered in it."""

    size_m: Annotated[
        float,
        Parameter("m", f"side of the square; {OF_LAW}, its spacing times the root of the count", low=1e-6, high=1e9),
    ] = OPEN
    walls: Annotated[
        int, Parameter("", "a choice: straight pieces, uniformly placed and turned", low=0, high=10_000)
    ] = 10
    length_m: Annotated[float, Parameter("m", "a choice: of each; open: a tenth of the side", low=1e-6)] = OPEN


class UniformParameters(NamedTuple):
    """Uniformly over the whole of a sized world, or over a square in unbounded space."""

    spacing_m: Annotated[
        float, Parameter("m", f"side of that square over the root of the count; {OF_LAW}", low=1e-6, high=1e9)
    ] = OPEN
    heading_spread_deg: Annotated[
        float, Parameter("deg", "headings are drawn within ± this; 180 = all", low=0.0, high=180.0)
    ] = 180.0


class GroupParameters(UniformParameters):
    """One group, uniformly over a square in the middle of the world."""


class SplitParameters(NamedTuple):
    """Two equal groups side by side along x, each uniformly over a square."""

    spacing_m: Annotated[
        float, Parameter("m", f"side of a group's square over the root of its count; {OF_LAW}", low=1e-6, high=1e9)
    ] = OPEN
    gap_m: Annotated[
        float, Parameter("m", "between the groups' centres: twice the spread that table 4.1 gives two groups", low=0.0)
    ] = 9.9
    heading_spread_deg: Annotated[
        float, Parameter("deg", "headings are drawn within ± this; 180 = all", low=0.0, high=180.0)
    ] = 180.0


class LatticeParameters(NamedTuple):
    """A lattice of squares, centred, as square as the count permits."""

    spacing_m: Annotated[float, Parameter("m", f"between neighbours; {OF_LAW}", low=1e-6, high=1e9)] = OPEN
    jitter_m: Annotated[float, Parameter("m", "a choice: shifts are drawn within ± this in x and y", low=0.0)] = 0.0
    heading_spread_deg: Annotated[
        float, Parameter("deg", "headings are drawn within ± this; 180 = all", low=0.0, high=180.0)
    ] = 180.0


class TriangularParameters(LatticeParameters):
    """A lattice of equilateral triangles, centred, as square as the count permits."""


class NoParameters(NamedTuple):
    """The plane without a border."""


WORLD_PARAMETERS: dict[str, type] = {
    "unbounded": NoParameters,
    "bounded": SpaceParameters,
    "periodic": PeriodicParameters,
    "obstacles": ObstacleParameters,
}
FORMATION_PARAMETERS: dict[str, type] = {
    "uniform": UniformParameters,
    "single-group": GroupParameters,
    "split-group": SplitParameters,
    "triangular-lattice": TriangularParameters,
    "square-lattice": LatticeParameters,
    **dict.fromkeys(lattice_starts.NAMES, lattice_starts.Parameters),
}
