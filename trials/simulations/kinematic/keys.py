"""The dotted keys of a kinematic trial and of its groups."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flocking import lawentry
from flocking.parameters import declared, filled
from trials.rows import Section, section
from trials.simulations import judged, spread
from trials.simulations.kinematic import fields, flocks, links
from trials.types import Group, Trial


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of a kinematic trial, or of one of its groups."""
    if group is None:
        world, formation = fields.world_parameters(trial), fields.formation_parameters(trial)
        first, at_start = trial.groups[0], trial.formation_parameters
        return [
            _open("", fields.TrialFields, lambda: _of_trial(trial), first, trial.setup),
            _open(
                "", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}, first, vars(trial)
            ),
            _open("world.", world, lambda: fields.world_of(trial)._asdict(), first, trial.world_parameters),
            _open("formation.", formation, lambda: fields.formation_of(trial)._asdict(), first, at_start),
            section(fields.LINKS, links.Parameters, lambda: _shown(fields.links_of(trial))),
            section(fields.FLOCKS, flocks.Parameters, lambda: _shown(fields.flocks_of(trial))),
            *judged.sections(trial),
        ]
    law = lawentry.module_of(group.law, group.law_source)
    return [
        section("", fields.GroupNames, lambda: {name: getattr(group, name) for name in fields.GroupNames._fields}),
        _open("", fields.GroupFields, lambda: _of_group(group), group, group.setup),
        section("law.", law.Parameters, lambda: filled(law.Parameters, group.law_parameters)._asdict()),
        spread.section_of(group),
    ]


def _open(
    prefix: str, parameters: type, values: Callable[[], Mapping[str, Any]], group: Group, given: Mapping[str, Any]
) -> Section:
    """A section whose open values are those of the herd of a group's law, or a choice where its file declares none."""
    words = fields.words_of(parameters, group)
    left_open = {name: about for name, about in words.items() if name not in given or given[name] == fields.OWN_SPACE}
    return Section(prefix, declared(parameters), values, left_open)


def _of_trial(trial: Trial) -> dict[str, Any]:
    """The values of a trial; its behaviour only where it has one."""
    values = fields.of_trial(trial)._asdict()
    return {key: value for key, value in values.items() if (key, value) != ("behaviour", judged.NONE)}


def _of_group(group: Group) -> dict[str, Any]:
    """The values of a group that are at work: those of the shared avoidance only where obstacles are not left to it,
    those of failures only where some member may fail."""
    values = fields.of_group(group)._asdict()
    if (values["failure_probability"], values["failure_time_s"]) == (0.0, fields.NEVER):
        values = {name: value for name, value in values.items() if not name.startswith("failure_")}
    if values["obstacles"] == fields.AS_LAW:
        values = {name: value for name, value in values.items() if name not in fields.OF_AVOIDANCE}
    return values


def _shown(measured: Any) -> dict[str, Any]:
    """The values of what is measured beside the rest; none where it is not."""
    return {} if measured is None else dict(measured._asdict())
