"""Files of a user's own that are environments: what their text is as JSON, which then travels with each trial."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from flocking.errors import InputError
from generation import files
from generation.environment import Environment

JSON = ".json"
PLANS = (".svg", ".dxf", ".yaml", ".yml")
"""Of drawings and of ROS maps, whose libraries are imported only where there is one."""
SUFFIXES = (JSON, *PLANS)
"""Of the files that can be read, in small letters."""


def environment_text(path: str) -> str:
    """The environment of a file, as JSON text. Raises `InputError`."""
    return _read(path, *_state(path))[0]


def told(path: str) -> list[str]:
    """A line for each thing that was mended, or is to be known, of an environment's file. Raises `InputError`."""
    return list(_read(path, *_state(path))[1])


def environment(path: str) -> tuple[Environment, list[str]]:
    """The environment of a file, and a line for each thing that was mended or is to be known. Raises `InputError`."""
    return files.from_json(environment_text(path), path), told(path)


@lru_cache(maxsize=8)
def _read(path: str, changed_ns: int, size: int) -> tuple[str, tuple[str, ...]]:
    """The text and the lines of a file that last changed at that time, and has that size."""
    environment, lines = _environment(path)
    return files.to_json(environment), tuple(lines)


def _environment(path: str) -> tuple[Environment, list[str]]:
    """THE place where a file's suffix decides how it is read: plans of other formats are read here."""
    suffix = Path(path).suffix.lower()
    if suffix == JSON:
        return files.read_mended(path)
    if suffix in PLANS:
        from generation import plans

        return plans.read(path)
    raise InputError(f"environment file {path!r}: expected a name that ends in {' or '.join(SUFFIXES)}")


def _state(path: str) -> tuple[int, int]:
    try:
        found = os.stat(path)
    except (OSError, ValueError):  # told where it is read
        return 0, 0
    return found.st_mtime_ns, found.st_size
