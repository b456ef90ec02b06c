"""How Ctrl-C ends a command that has kept something."""

from __future__ import annotations


class StoppedError(Exception):
    """Ctrl-C ended a command; the message says what is kept or missing. Typer would take a KeyboardInterrupt for
    itself."""
