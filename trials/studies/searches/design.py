"""The herd of this study: seven BOIDS in corridors of 2 m, as in the study of parameter-space maps."""

from __future__ import annotations

from trials.simulations.kinematic.fields import group
from trials.types import Group

METHOD, WORLD = "method", "world"
METHODS = ("random", "cma-es", "cma-me", "map-elites")
MEMBERS = 7
COUNTS = "5, 7, 9"
SPEED_M_S = 0.1
"""Per step of one second."""


def herd(count: int = MEMBERS) -> Group:
    """BOIDS that keep away from the nearest wall."""
    return group(
        "reynolds-boids",
        count,
        law_parameters={"range_m": 3.0, "separation_m": 1.0, "speed_m_s": SPEED_M_S},
        speed_m_s=SPEED_M_S,
        cruise_m_s=SPEED_M_S,
        max_turn_rate_rad_s=0.5,
        obstacles="avoid",
        obstacle_selection="nearest",
        look_ahead_m=0.75,
        margin_m=0.28,
    )
