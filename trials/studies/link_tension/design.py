"""What the links of a law are, and the trials whose links are measured.

A law's links have a range and a rest length in its own parameters. A spring's stiffness at rest is the slope there of
what one member of a pair at rest feels (1/s², unit mass); a law whose steering has no slope there has none.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from flocking import lawentry
from flocking.errors import InputError
from flocking.laws.olfati_saber import bump, sigma_norm
from flocking.parameters import filled
from trials.rows import below
from trials.simulations.kinematic import fields
from trials.simulations.kinematic.links import HORIZONS, STARTS
from trials.simulations.kinematic.links import Parameters as Links
from trials.types import Trial

SPACINGS_A_UNIT = 3.0
"""Spacings that a member at the herd's own speed passes in one unit of time: with beta = 3 and d = 1 m it is 1 s."""
KEPT_A_UNIT = 4
"""Moments that a trial's series keeps of a unit of time."""


class Linked(NamedTuple):
    """The names of a law's range and rest length, and its stiffness at rest."""

    range_m: str
    rest_m: str
    stiffness: Callable[[Any], float] | None = None


def _olfati_saber(given: Any) -> float:
    epsilon = given.epsilon_per_m2
    along = given.spacing_m / math.sqrt(1.0 + epsilon * given.spacing_m**2)
    norm, part = sigma_norm.py_func, bump.py_func  # a handful of numbers: nothing worth compiling
    weight = part(norm(given.spacing_m, epsilon) / norm(given.range_m, epsilon), given.h)
    c = abs(given.a - given.b) / math.sqrt(4.0 * given.a * given.b)
    return float(weight * 0.5 * (given.a + given.b) * (1.0 + c * c) ** -1.5 * along**2)


LINKED: Mapping[str, Linked] = {
    "akama-naruse": Linked("range_m", "length_m", lambda given: float(given.spring_per_s2 / given.mass)),
    "olfati-saber": Linked("range_m", "spacing_m", _olfati_saber),
    "tanner-switching": Linked(
        "range_m", "spacing_m", lambda given: 4.0 * float(given.strength_m2_s2) / float(given.spacing_m) ** 2
    ),
    "couzin": Linked("rho_m", "alpha_m"),
    "reynolds-opensteer": Linked("cohesion_m", "separation_m"),
}
"""Laws whose links are known. Couzin et al. rest where repulsion ends, OpenSteer's boids where separation does."""


def with_links(trial: Trial) -> Trial:
    """`trial` with its links by its law, and as long as the last horizon takes; what is already set stays."""
    (group,) = trial.groups
    if group.law not in LINKED:
        raise InputError(f"law {group.law!r}: its links are not known; expected {' or '.join(LINKED)}")
    names = LINKED[group.law]
    law = filled(lawentry.module_of(group.law).Parameters, group.law_parameters)
    own = fields.own_herd(group)
    links = {
        "range_m": float(getattr(law, names.range_m)),
        "rest_m": float(getattr(law, names.rest_m)),
        "stiffness_per_s2": names.stiffness(law) if names.stiffness else 0.0,
        "unit_s": SPACINGS_A_UNIT * own.spacing_m / own.speed_m_s,
    } | below(trial.setup, fields.LINKS)
    unit = float(filled(Links, links).unit_s) / fields.of_trial(trial).timestep_s
    steps = math.ceil((max(STARTS) + max(HORIZONS)) * unit)
    length = {"steps": steps, "every": max(1, round(unit / KEPT_A_UNIT))}
    setup = {**length, **{f"{fields.LINKS}{name}": value for name, value in links.items()}, **trial.setup}
    return dataclasses.replace(trial, setup=setup)
