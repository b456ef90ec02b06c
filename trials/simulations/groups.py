"""What is refused of a trial's groups and setups in every simulation."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping
from typing import Any

from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared, checked
from trials.rows import OF_GROUP, OF_TRIAL
from trials.simulations.contract import KeysOf
from trials.types import Trial

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9-]*")


def check_groups(trial: Trial, keys_of: KeysOf) -> None:
    """Refuses a trial without groups, groups whose names cannot begin a key, and groups of one name: `InputError`."""
    if not trial.groups:
        raise InputError("the trial has no members: expected at least one group")
    reserved = sorted({section.prefix.rstrip(".") for section in keys_of(trial)} - {""})
    names = [group.name for group in trial.groups]
    for name in names:
        if not _NAME.fullmatch(name) or name in reserved:
            raise InputError(
                f"group {name!r}: expected a name of letters, digits and hyphens other than {', '.join(reserved)}"
            )
        if names.count(name) > 1:
            raise InputError(f"two groups are called {name!r}: expected a name of its own for each")


def check_given(trial: Trial, keys_of: KeysOf) -> None:
    """Refuses what a trial or a group is given and its simulation does not declare: `InputError` with the nearest keys.

    Names and values are held against the declared parameters, in the setup as in the parameters of world, formation,
    law and pipeline.
    """
    for group in (None, *trial.groups):
        kept, places, start = (trial, OF_TRIAL, "") if group is None else (group, OF_GROUP, f"{group.name}.")
        fields = {field.name for field in dataclasses.fields(kept)}
        sections = keys_of(trial, group)
        in_setup: dict[str, Declared] = {}
        for section in sections:
            if section.prefix not in places:
                in_setup |= {
                    f"{section.prefix}{name}": parameter
                    for name, parameter in section.parameters.items()
                    if section.prefix or name not in fields
                }
        _check_all(kept.setup, in_setup, start, "parameter")
        for prefix, field in places.items():
            own = [section.parameters for section in sections if section.prefix == prefix]
            known = {name: parameter for parameters in own for name, parameter in parameters.items()}
            _check_all(getattr(kept, field), known, f"{start}{prefix}", "parameter")


def _check_all(given: Mapping[str, Any], known: Mapping[str, Declared], start: str, kind: str) -> None:
    for name, value in given.items():
        if name not in known:
            raise unknown_name(kind, f"{start}{name}", [f"{start}{each}" for each in known])
        if not (isinstance(value, float) and math.isnan(value)):  # left open
            checked(f"{start}{name}", value, known[name])
