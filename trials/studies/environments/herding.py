"""The herds that `tightness` and `cattle-stages` try schemas with: one for each scale that schemas are made for.

Fine 2015 gives neither starts nor speeds. Grammars in units have the herd of `maebe`'s first preset; schemas in the
metres of the T-junction have the one that maps them; cattle are two classes. All numbers are choices.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple

from trials.simulations.environments.fields import ALL
from trials.simulations.kinematic.fields import group
from trials.simulations.maps.fields import herd as of_junction
from trials.studies.environments import design
from trials.types import Group, Trial, Value, with_setup

BOIDS = design.LAWS[0]
CLASSES = ("herd", "others")
"""Names of the groups of cattle; the first is the experiment's own."""
EACH = 5
"""Members of a class."""
FLIGHT_M = {"herd": (0.1, 0.3), "others": (0.4, 0.8)}
"""How near to walls a class goes, and how far ahead it looks for them: tame and shy animals. Nothing else differs."""
DRIVEN: Mapping[str, Value] = {"informed_share": 1.0, "goal_x_m": 0.0, "goal_y_m": 1e9}
"""Cattle prefer the direction along y, in which the schema's stages follow one another."""
CATTLE_ITERATIONS = 600
"""At 0.1 m an iteration, twice the way from the start of the cattle schema to its goal line."""


class Herding(NamedTuple):
    """How a schema's environments are tried."""

    groups: tuple[Group, ...]
    size_m: float
    """Side of the square in which the herd starts."""
    spread_deg: float
    setup: Mapping[str, Value] = {}
    """Of the trial."""


def _in_units() -> Group:
    """BOIDS at the first preset of `maebe`."""
    preset = design.LARGE
    own: dict[str, Value] = {"cruise_m_s": preset.speed_m_s, "max_turn_rate_rad_s": preset.turn_rad_s}
    (made,) = design.finish(Trial("", 1, "", "", "", (with_setup(design.herd(), own),))).groups
    return made


def _cattle(name: str) -> Group:
    """One class: Couzin's law, whose members all prefer one direction, in a corridor's scale."""
    margin, ahead = FLIGHT_M[name]
    body = of_junction(EACH).setup
    return group(
        "couzin",
        EACH,
        name=name,
        law_parameters={"alpha_m": 0.3, "rho_m": 1.0, "omega": 1.0, "speed_m_s": float(body["speed_m_s"])},
        **{**body, **DRIVEN, "margin_m": margin, "look_ahead_m": ahead},  # type: ignore[arg-type]
    )


def herding(schema: str) -> Herding:
    """How a schema's environments are tried; of a schema that is not known here, as those of the T-junction.

    Its parameters are drawn anew for each environment: all of them between their bounds, or between narrower ones where
    bounds only say what can be built.
    """
    units, junction = Herding((_in_units(),), design.LARGE.size_m, 180.0), Herding((of_junction(7),), 1.3, 20.0)
    cattle = Herding(
        tuple(map(_cattle, CLASSES)), 10.0, 20.0,
        {"varied": ALL, "iterations": CATTLE_ITERATIONS, "behaviour.within": CATTLE_ITERATIONS, "environments": 20},
    )  # fmt: skip
    known = {
        "splitting": units,
        "weiring": units,
        "hierarchical": units,
        "galton": units._replace(
            size_m=20.0, spread_deg=20.0, setup={"varied": "rows=1..3, peg_m=2..15, gap_m=5..60", "environments": 10}
        ),
        "dsdr": junction._replace(groups=(of_junction(10),), size_m=10.0, setup={"varied": ALL}),
        "points": junction._replace(setup={"varied": "probability_x, probability_y, probability_diagonal"}),
        "sirt": junction._replace(setup={"varied": "rule_1, rule_2, anchor"}),
        "cattle": cattle,
    }
    return known.get(schema, junction._replace(setup={"varied": ALL}))


def tried(trial: Trial) -> Trial:
    """The trial with its schema's herd, where the user sets nothing else.

    A law of the user's takes the place of the herd's own, with the same bodies and its own parameters.
    """
    own = herding(trial.world)
    (given,) = trial.groups
    first, *others = own.groups
    same_law = given.law == BOIDS
    chosen = dataclasses.replace(
        given,
        law=first.law if same_law else given.law,
        count=first.count if given.count == design.MEMBERS else given.count,
        law_parameters={**(first.law_parameters if same_law else {}), **given.law_parameters},
        setup={**first.setup, **given.setup},
    )
    formation: dict[str, Value] = {"size_m": own.size_m, "heading_spread_deg": own.spread_deg}
    trial = dataclasses.replace(
        trial, groups=(chosen, *others), formation_parameters={**formation, **trial.formation_parameters}
    )
    return with_setup(trial, {**own.setup, **trial.setup})
