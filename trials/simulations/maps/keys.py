"""The dotted keys of a trial that maps a schema, and of its groups."""

from __future__ import annotations

from flocking.parameters import filled
from trials.rows import Section, below, section
from trials.simulations.kinematic import keys as of_members
from trials.simulations.maps import fields
from trials.types import Group, Trial


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of such a trial, or of one of its groups: those of a kinematic group."""
    if group is not None:
        return of_members.keys_of(trial, group)
    fields.check_formation(trial)
    schema, behaviour = fields.schema_of(trial), fields.behaviour_of(trial)
    placed, given = filled(fields.FormationParameters, trial.formation_parameters, prefix="formation."), trial.setup
    return [
        section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
        section("", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}),
        section("world.", schema.parameters, lambda: _of_schema(trial)),
        section("formation.", fields.FormationParameters, placed._asdict),
        section(fields.BOX, fields.BoxFields, lambda: _bounds(trial)),
        section(
            fields.BEHAVIOUR,
            behaviour.parameters,
            lambda: filled(behaviour.parameters, below(given, fields.BEHAVIOUR), fields.BEHAVIOUR)._asdict(),
        ),
    ]


def _of_schema(trial: Trial) -> dict[str, object]:
    """The values of the schema's parameters that do not vary."""
    parameters = fields.schema_of(trial).parameters
    values = filled(parameters, trial.world_parameters, prefix="world.")._asdict()
    return {name: value for name, value in values.items() if name not in fields.refined_of(trial)}


def _bounds(trial: Trial) -> dict[str, object]:
    return {name: value for name, value in fields.box_fields(trial)._asdict().items() if value == value}
