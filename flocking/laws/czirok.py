"""Spontaneously ordered motion of self-propelled particles: Vicsek's rule at a lower density and a higher speed.

Source: Czirok, Stanley and Vicsek 1997 (Journal of Physics A 30); Fine 2015, table A.1, which gives it one row with
Vicsek et al. 1995. The velocity's direction is that of the summed velocities within the radius, oneself included,
turned by a number drawn evenly from [-noise/2, noise/2]; at a constant speed that is Vicsek's mean heading. Radians,
metres, metres per second.

Needs positions (to select) and headings. No neighbours: straight on, with noise alone. As in `vicsek`
members of a kinematic herd move by the old velocity.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws.vicsek import FILLED as FILLED
from flocking.laws.vicsek import law as law
from flocking.parameters import Parameter
from flocking.taxonomy import Herd, Taxonomy, Validation

NEEDS = frozenset({"headings"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("S", True, "global", "global", "global", "periodic free")
HERD = Herd(spacing_m=1.58, speed_m_s=0.1, dt_s=1.0, space="periodic", updating="forward")
CREATE = {"range_m": 2.0, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of Vicsek's rule, as Czirok et al. use it."""

    range_m: Annotated[float, Parameter("m", "Czirok et al. 1997: the unit of length", published=True, low=0.0)] = 1.0
    speed_m_s: Annotated[
        float, Parameter("m/s", "our choice: a tenth of the radius a step, small against the radius", low=0.0)
    ] = 0.1
    noise_rad: Annotated[float, Parameter("rad", "our choice: in the ordered phase; swept there", low=0.0)] = 1.0
