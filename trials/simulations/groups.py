"""What is refused of a trial's groups and setups in every simulation."""

from __future__ import annotations

import dataclasses
import re

from flocking.errors import InputError, unknown_name
from trials.simulations.contract import KeysOf
from trials.types import Trial

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9-]*")
RESERVED = frozenset({"world", "formation", "links"})
"""Words with which keys of the trial itself begin."""


def check_names(trial: Trial) -> None:
    """Refuses groups whose names cannot begin a key, and groups of one name: `InputError`."""
    names = [group.name for group in trial.groups]
    for name in names:
        if not _NAME.fullmatch(name) or name in RESERVED:
            raise InputError(
                f"group {name!r}: expected a name of letters, digits and hyphens other than "
                f"{', '.join(sorted(RESERVED))}"
            )
        if names.count(name) > 1:
            raise InputError(f"two groups are called {name!r}: expected a name of its own for each")


def check_setup(trial: Trial, keys_of: KeysOf) -> None:
    """Refuses entries of a setup that the trial's simulation does not declare: `InputError` with the nearest keys."""
    for group in (None, *trial.groups):
        kept, start = (trial, "") if group is None else (group, f"{group.name}.")
        fields = {field.name for field in dataclasses.fields(kept)}
        declared = {f"{each.prefix}{name}" for each in keys_of(trial, group) for name in each.parameters} - fields
        for key in kept.setup.keys() - declared:
            raise unknown_name("entry of the setup", f"{start}{key}", [f"{start}{name}" for name in declared])
