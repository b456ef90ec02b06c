"""Figures 1.2 and 5.1 of Fine 2015: whether a herd is corralled by the same environments depends on its size.

A trial generates 50 environments of the weiring grammar; the kinematic herd has 1 to 50 members. One Create and four of
them are tried by `corral-group-size-robots`.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.environments.fields import trial
from trials.studies.environments import design
from trials.studies.environments.design import finish
from trials.studies.environments.size_claims import COUNTS, KEYS, claims, figures
from trials.types import Trial

REPEATS = 10
RECORD = "first"
CONDITIONS = {KEYS[0]: COUNTS}
KEY_MEASURES = ("valid_rate", "control_rate", "uplift")
SOURCES = {"herd.count": Parameter("members", "Fine 2015, figures 1.2 and 5.1, without numbers")}


def base(repeat: int) -> Trial:
    """BOIDS at the second preset in fifty environments that are to corral them.

    At the first no herd is corralled, whatever its size: `--set formation.size_m=40 --set herd.cruise_m_s=2`.
    """
    preset = design.SMALL
    herd = design.herd()
    made = trial(
        "corral-group-size", repeat, [herd], "weiring", environments=50, behaviour="corralling",
        formation_parameters={"size_m": preset.size_m},
    )  # fmt: skip
    return design.with_bodies(made, preset)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
