"""The dotted keys of a trial: sections of declared parameters, and the lines of `herd show` about them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from flocking.parameters import Declared, Parameter, declared


class Section(NamedTuple):
    """Declared parameters that share a prefix of their keys."""

    prefix: str
    """Empty, or as in `world.`; in a section of a group it lacks the group's name."""
    parameters: Mapping[str, Declared]
    values: Callable[[], Mapping[str, Any]]
    """By name, the values that the trial will use of the parameters that are shown. Those that are not shown can be set
    as well."""
    words: Mapping[str, Parameter] = {}
    """By name, the source to show for a value in place of the declared one."""


OF_TRIAL: Mapping[str, str] = MappingProxyType({"world.": "world_parameters", "formation.": "formation_parameters"})
OF_GROUP: Mapping[str, str] = MappingProxyType(
    {"law.": "law_parameters", "pipeline.": "pipeline_parameters", "spread.": "spread"}
)
"""Prefixes whose values stand in a field of their own of a `Trial` or a `Group`; those of all others in its setup."""


class Row(NamedTuple):
    """One line of `herd show`."""

    key: str
    value: Any
    unit: str
    source: str
    published: bool


def section(prefix: str, parameters: type, values: Callable[[], Mapping[str, Any]]) -> Section:
    """The section of a named tuple of declared parameters."""
    return Section(prefix, declared(parameters), values)


def below(setup: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """The entries of a setup whose keys begin with `prefix`, without it; for an empty prefix those without a dot."""
    if not prefix:
        return {key: value for key, value in setup.items() if "." not in key}
    return {key.removeprefix(prefix): value for key, value in setup.items() if key.startswith(prefix)}


def rows_of(section: Section, group: str = "", given: Mapping[str, Any] = MappingProxyType({})) -> list[Row]:
    """A row for each shown parameter of a section.

    `group`: put before each key, as in `herd.`; `given`: by name, the values that the trial or the group has of its
    own: where one is not the default, the declared source is not its source.
    """
    values = section.values()
    found = []
    for name, parameter in section.parameters.items():
        if name in values:
            about = section.words.get(name, parameter.about)
            key = f"{group}{section.prefix}{name}"
            row = Row(key, values[name], parameter.about.unit, about.source, about.published)
            usual = parameter.default in ("", given.get(name, parameter.default))
            if name not in section.words and not usual:
                row = row._replace(source=f"set by the experiment{_in_place_of(parameter.default)}", published=False)
            found.append(row)
    return found


def _in_place_of(default: Any) -> str:
    """Of which default a value stands in place; nothing of one that is left open (nan)."""
    return "" if default != default else f" in place of {default}"


def marked(row: Row, usual: Any) -> Row:
    """A row of a key that the user set: its source says so, unless the value is the usual one."""
    if row.value == usual:
        return row
    return row._replace(source=f"set here in place of {usual}", published=False)


def in_words(row: Row, about: Parameter | None) -> Row:
    """A row with the source that the experiment gives for it, if it gives one."""
    return row if about is None else row._replace(source=about.source, published=about.published)
