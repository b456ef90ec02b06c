"""The pair force of Gregoire's two models and of Camperi's law: hard core, spring, constant attraction.

Source: Gregoire, Chate and Tu 2003; Fine 2015, table A.1. Along the line towards a neighbour at distance r:
minus infinity within the core; (r - equilibrium) / (attraction - equilibrium) / 4 up to the attraction distance;
1 beyond it. No unit.
"""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.taxonomy import Filled
from flocking.terms import unit
from flocking.types import Bools, Floats

ORDER = ("core_m at most equilibrium_m", "equilibrium_m below attraction_m")
"""What the laws' distances must keep to (their `RELATIONS`)."""
FOR_CREATES = {
    "range_m": 2.5,
    "core_m": 0.4,
    "equilibrium_m": 0.9,
    "attraction_m": 1.4,
    "speed_m_s": 0.25,
    "alignment_s_m": 7.0,
}
"""Parameter values that all of them have with iRobot Creates; the noise is each law's own."""
BRACKET = Filled(
    "motion computation",
    "table A.1 closes the bracket of the distance in the wrong place and calls the member's position a region",
    "a condition on the distance between the two",
    misprint=True,
)


@compiled
def spring(distance: float, equilibrium: float, attraction: float) -> float:
    """The finite part of the force at `distance` (m), positive towards the neighbour.

    None below an attraction distance that does not lie above the equilibrium.
    """
    if distance >= attraction:
        return 1.0
    if attraction <= equilibrium:
        return 0.0
    return 0.25 * (distance - equilibrium) / (attraction - equilibrium)


@compiled
def pair_forces(
    positions: Floats, chosen: Bools, core: float, equilibrium: float, attraction: float
) -> tuple[float, float, float, float]:
    """Direction away from the neighbours within the core, (0, 0) for none, and the sum of the finite forces.

    Infinite forces of several neighbours weigh alike. A neighbour at distance zero has no direction and exerts nothing.
    """
    away_x, away_y, force_x, force_y = 0.0, 0.0, 0.0, 0.0
    for j in range(len(chosen)):
        if not chosen[j]:
            continue
        x, y = positions[j, 0], positions[j, 1]
        distance = math.hypot(x, y)
        towards_x, towards_y = unit(x, y)
        if distance < core:
            away_x -= towards_x
            away_y -= towards_y
        else:
            pull = spring(distance, equilibrium, attraction)
            force_x += pull * towards_x
            force_y += pull * towards_y
    away_x, away_y = unit(away_x, away_y)
    return away_x, away_y, force_x, force_y
