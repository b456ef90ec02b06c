"""The dotted keys of a trial that searches a schema or decomposes a construct, and of its groups."""

from __future__ import annotations

from typing import Any

from flocking.parameters import filled
from trials.rows import Section, below, section
from trials.simulations.kinematic import keys as of_members
from trials.simulations.searches import fields
from trials.types import Group, Trial


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of such a trial, or of one of its groups: those of a kinematic group. Only those at work are shown."""
    if group is not None:
        return of_members.keys_of(trial, group)
    fields.check_formation(trial)
    schema, behaviour, setup = fields.schema_of(trial), fields.behaviour_of(trial), trial.setup
    placed = filled(fields.FormationParameters, trial.formation_parameters, prefix="formation.")
    return [
        section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
        section("", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}),
        section(fields.SEARCH, fields.SearchFields, lambda: _at_work(trial, fields.of_search(trial), True)),
        section(fields.PIECES, fields.PiecesFields, lambda: _at_work(trial, fields.of_pieces(trial), False)),
        section("world.", schema.parameters, lambda: _of_schema(trial)),
        section("formation.", fields.FormationParameters, placed._asdict),
        section(
            fields.BEHAVIOUR,
            behaviour.parameters,
            lambda: filled(behaviour.parameters, below(setup, fields.BEHAVIOUR), fields.BEHAVIOUR)._asdict(),
        ),
    ]


def _at_work(trial: Trial, given: Any, of_search: bool) -> dict[str, Any]:
    searches = fields.of_trial(trial).method != fields.DECOMPOSITION
    return dict(given._asdict()) if searches is of_search else {}


def _of_schema(trial: Trial) -> dict[str, Any]:
    """The values of the schema's parameters that do not vary."""
    values = filled(fields.schema_of(trial).parameters, trial.world_parameters, prefix="world.")._asdict()
    if fields.of_trial(trial).method == fields.DECOMPOSITION:
        return dict(values)
    searched = fields.searched_of(trial)
    return {name: value for name, value in values.items() if name not in searched}
