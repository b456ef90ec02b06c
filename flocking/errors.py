"""Errors that a user can mend."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Something from outside (a file, a flag, a model, a law) is not what was expected.

    The message is one line: what was given, what was expected, the nearest valid choice.
    The command line prints it as it is and exits with code 2.
    """


class StorageError(InputError):
    """The disk does not take a file. No trial is at fault: a batch stops, and what was stored is kept."""


def unknown_name(kind: str, given: object, valid: Iterable[str]) -> InputError:
    """The error for a name that does not exist, offering the nearest ones that do."""
    names = sorted(valid)
    near = difflib.get_close_matches(str(given), names, n=3, cutoff=0.5)
    if near:
        advice = f"did you mean {' or '.join(near)}?"
    else:
        advice = f"valid: {', '.join(names)}" if names else "there is none"
    return InputError(f"unknown {kind} {str(given)!r}; {advice}")
