"""Generated environments validated by simulation (Fine 2015, section 7.2): tables 7.1 and 7.2 with their controls.

A trial generates 100 environments of a grammar, filters them, and puts 25 members into each that passes and into the
empty plane in its place, from the same start and with the same random numbers; ten repeats make the publication's 1000.
The rates of table 7.2 say nothing of environments without that control: what counts is the uplift.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.studies.environments import design
from trials.studies.environments.claims import claims
from trials.studies.environments.design import cells, finish
from trials.studies.environments.figures import figures
from trials.types import Trial

REPEATS = 10
RECORD = "first"
CONDITIONS = {
    design.WORLD: ("splitting", "weiring"),
    design.BEHAVIOUR: tuple(design.OF_BEHAVIOURS),
    design.LAW: design.LAWS,
    design.SIZE: tuple(preset.size_m for preset in design.PRESETS),
    design.SPEED: tuple(preset.speed_m_s for preset in design.PRESETS),
    design.TURN: (0.5,),
}
KEY_MEASURES = ("pass_rate", "valid_rate", "control_rate", "uplift", "tightness")
SOURCES = {
    "herd.count": Parameter("members", "Fine 2015, section 7.2", published=True),
    design.SPEED: Parameter("m/s", "not published; one of two presets"),
    design.TURN: Parameter("rad/s", "not published; a choice"),
    "herd.obstacles": Parameter("", "Fine 2015, section 6.3.3: the plus of RM+ and SNN+", published=True),
}


def base(repeat: int) -> Trial:
    """A hundred splitting environments for BOIDS."""
    return design.base("maebe", repeat)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
