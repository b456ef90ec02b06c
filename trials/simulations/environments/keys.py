"""The dotted keys of a trial of generated environments and of its groups."""

from __future__ import annotations

from flocking.parameters import filled
from trials.rows import Section, below, section
from trials.simulations.environments import fields
from trials.simulations.kinematic import keys as of_members
from trials.types import Group, Trial


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of such a trial, or of one of its groups: those of a kinematic group."""
    if group is not None:
        return of_members.keys_of(trial, group)
    fields.check_formation(trial)
    schema, behaviour, chosen = fields.schema_of(trial), fields.behaviour_of(trial), fields.filter_of(trial)
    given = trial.world_parameters
    found = [
        section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
        section("", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}),
        section("world.", schema.parameters, lambda: filled(schema.parameters, given, prefix="world.")._asdict()),
        section("formation.", fields.FormationParameters, lambda: fields.formation_of(trial)._asdict()),
        _named(trial, fields.BEHAVIOUR, behaviour.parameters),
    ]
    return found if chosen is None else [*found, _named(trial, fields.FILTER, chosen.parameters)]


def _named(trial: Trial, prefix: str, parameters: type) -> Section:
    return section(prefix, parameters, lambda: filled(parameters, below(trial.setup, prefix), prefix=prefix)._asdict())
