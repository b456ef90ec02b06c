"""The trials of the study: the herd of the publication, and the scripts of its user's creature."""

from __future__ import annotations

from collections.abc import Mapping

from flocking.parameters import Parameter
from trials.evidence.claims import published
from trials.simulations.running import fields
from trials.types import Trial, Value

SOURCE = "Hodgins and Brogan 1994"
BODY, VISIBLE, SELECTION, VELOCITIES = "herd.body", "herd.law.visible", "herd.selection", "herd.velocities"
AHEAD = "obstacle_ahead_m"
PARTICLES, ROBOTS = BODIES = ("particles", "one-legged")
TESTS = published(__package__, "hodgins1994", "tests")
HERD = published(__package__, "hodgins1994", "herd")
BREAKAWAY, GAP = "formation.breakaway", "formation.breakaway_m"
USUAL_M, EASIER_M, HARDER_M = 20.0, 28.0, 13.0
"""How far ahead the obstacle is. Choices."""
SOURCES: Mapping[str, Parameter] = {
    "herd.law.visible": Parameter("", f"{SOURCE}, section 3.1: n", published=True),
    "formation.speed_m_s": Parameter("m/s", f"{SOURCE}, section 5", published=True),
}
SETTLED_S = 30.0
"""How long the herd runs before a test that the publication begins with a steady run. A choice."""


def running(
    experiment: str,
    repeat: int,
    seconds: float,
    velocities: list[tuple[float, float, float]] | None = None,
    *,
    settle_s: float = 0.0,
    law_parameters: dict[str, Value] | None = None,
    **setup: Value,
) -> Trial:
    """The herd of the publication behind a creature that is told `velocities` (from s, x, y in m/s), for so many
    seconds of test after `settle_s`."""
    told = velocities or [(0.0, TESTS["steady_state"]["speed_m_s"], 0.0)]
    script = "; ".join(f"{at:g}: {x:g}, {y:g}" for at, x, y in told)
    return fields.trial(
        experiment,
        repeat,
        fields.herd(law_parameters=law_parameters),
        duration_s=settle_s + seconds,
        settle_s=settle_s,
        script=script,
        **setup,
    )


def accelerating() -> tuple[float, list[tuple[float, float, float]]]:
    """Seconds and velocities of the second test; before it the speed of the first is kept for as long, as a choice."""
    each = TESTS["acceleration"]["seconds_each"]
    speeds = [TESTS["steady_state"]["speed_m_s"], *TESTS["acceleration"]["speeds_m_s"]]
    return each * len(speeds), [(each * number, speed, 0.0) for number, speed in enumerate(speeds)]


def zigzag() -> tuple[float, list[tuple[float, float, float]]]:
    """Seconds and velocities of the third test."""
    told = TESTS["zigzag"]
    legs = [(0.0, told["speed_m_s"], 0.0)]
    for number, (x, y) in enumerate(told["leg_velocities_m_s"] * told["repeats"]):
        legs.append((told["straight_s"] + number * told["leg_s"], x, y))
    return legs[-1][0] + told["leg_s"], legs
