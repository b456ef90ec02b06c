"""The dotted keys of a kinematic trial and of its groups."""

from __future__ import annotations

from typing import Any

from flocking import lawentry
from flocking.parameters import filled
from trials.rows import Section, section
from trials.simulations import spread
from trials.simulations.kinematic import fields, links
from trials.types import Group, Trial


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of a kinematic trial, or of one of its groups."""
    if group is None:
        world, formation = fields.world_parameters(trial), fields.formation_parameters(trial)
        return [
            section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
            section("", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}),
            section("world.", world, lambda: fields.world_of(trial)._asdict()),
            section("formation.", formation, lambda: fields.formation_of(trial)._asdict()),
            section(fields.LINKS, links.Parameters, lambda: _links_shown(trial)),
        ]
    law = lawentry.module_of(group.law, group.law_source)
    return [
        section("", fields.GroupNames, lambda: {name: getattr(group, name) for name in fields.GroupNames._fields}),
        section("", fields.GroupFields, lambda: fields.of_group(group)._asdict()),
        section("law.", law.Parameters, lambda: filled(law.Parameters, group.law_parameters)._asdict()),
        spread.section_of(group),
    ]


def _links_shown(trial: Trial) -> dict[str, Any]:
    measured = fields.links_of(trial)
    return {} if measured is None else measured._asdict()
