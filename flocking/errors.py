"""Errors that a user can mend."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable


class InputError(ValueError):
    """Something from outside (a file, a flag, a model, a law) is not what was expected.

    The message is one line: what was given, what was expected, the nearest valid choice.
    The command line prints it as it is and exits with code 2.
    """


class StorageError(InputError):
    """The disk does not take a file. No trial is at fault: a batch stops, and what was stored is kept."""


_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def has_controls(text: str) -> bool:
    """Whether text from outside would act on a terminal when it is printed."""
    return _CONTROLS.search(text) is not None


def printable(text: str) -> str:
    """`text` with a replacement character for each that would act on a terminal, or that no encoding has."""
    return _CONTROLS.sub("\N{REPLACEMENT CHARACTER}", text).encode(errors="replace").decode()


def unknown_name(kind: str, given: object, valid: Iterable[str]) -> InputError:
    """The error for a name that does not exist, offering the nearest ones that do."""
    names = sorted(valid)
    near = difflib.get_close_matches(str(given), names, n=3, cutoff=0.5)
    if near:
        advice = f"did you mean {' or '.join(near)}?"
    else:
        advice = f"valid: {', '.join(names)}" if names else "there is none"
    return InputError(f"unknown {kind} {str(given)!r}; {advice}")
