"""The lines of `herd show`: what every key of a trial has, and how a key is given another value."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from flocking.errors import unknown_name
from flocking.parameters import Declared, Parameter, checked, declared


class Row(NamedTuple):
    """One line of `herd show`."""

    key: str
    value: Any
    unit: str
    source: str
    published: bool


def rows_of(parameters: type, prefix: str, given: Mapping[str, Any]) -> list[Row]:
    """A row for each declared parameter, with the value given or its default."""
    return [
        Row(f"{prefix}{d.name}", given.get(d.name, d.default), d.about.unit, d.about.source, d.about.published)
        for d in declared(parameters).values()
    ]


def added(
    given: Mapping[str, Any], key: str, name: str, value: Any, known: Mapping[str, Declared], keys: Iterable[str]
) -> dict[str, Any]:
    """`given` with one more value, checked. Raises `InputError`; `keys`: all that there are."""
    if name not in known:
        raise unknown_name("parameter", key, list(keys))
    return {**given, name: checked(key, value, known[name])}


def marked(row: Row, usual: Any) -> Row:
    """A row whose value was set by the user: no longer what its source gives."""
    if row.value == usual:
        return row
    return row._replace(source=f"set here in place of {usual}", published=False)


def told(row: Row, about: Parameter | None) -> Row:
    """A row in the experiment's own words."""
    return row if about is None else row._replace(source=about.source, published=about.published)
