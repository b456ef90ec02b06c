"""What holds of the groups of a trial in every simulation."""

from __future__ import annotations

import re

from flocking.errors import InputError
from trials.types import Trial

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9-]*")
RESERVED = frozenset({"world", "formation", "links"})
"""Words with which keys of the trial itself begin."""


def check_names(trial: Trial) -> None:
    """Refuses groups whose names cannot begin their keys, or are not their own: `InputError`."""
    names = [group.name for group in trial.groups]
    for name in names:
        if not _NAME.fullmatch(name) or name in RESERVED:
            raise InputError(
                f"group {name!r}: expected a name of letters, digits and hyphens other than "
                f"{', '.join(sorted(RESERVED))}"
            )
        if names.count(name) > 1:
            raise InputError(f"two groups are called {name!r}: expected a name of its own for each")
