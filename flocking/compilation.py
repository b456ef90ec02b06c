"""How the hot paths are compiled: Numba, cached between runs, never stale.

Numba's own cache sees only the file of the function itself: after an edit to a helper in another file it would
return old results. So the cache's folder is named by a hash of every source file of ours, and what is compiled from
a file that is not ours, or may use one (a law), is not kept here.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from flocking.errors import InputError

PACKAGES = ("flocking", "robots", "sensing")
"""Packages that may hold compiled code: a test sees to it that no other does."""
LAWS = "flocking/laws"
CACHE_VARIABLE = "CREATE_HERD_CACHE"


@cache
def sources_digest(packages: tuple[str, ...] = PACKAGES) -> str:
    """A hash over the names and texts of all Python files of these packages: those that hold compiled code."""
    digest = hashlib.sha256()
    home = Path(__file__).resolve().parent.parent
    for package in packages:
        for path in sorted((home / package).rglob("*.py")):
            digest.update(path.relative_to(home).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """Where compiled code is kept, in a folder named by the sources' hash.

    Below `$CREATE_HERD_CACHE`, which must then be writable (else `InputError`), or the user's cache folder, or, where
    that cannot be written, a folder for temporary files.
    """
    digest = sources_digest()
    named = os.environ.get(CACHE_VARIABLE)
    if named:
        if not _writable(Path(named) / digest):
            raise InputError(f"{CACHE_VARIABLE} = {named!r} cannot be written; expected a folder for compiled code")
        return Path(named) / digest
    users = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "create-herd" / digest
    if _writable(users):
        return users
    return Path(tempfile.gettempdir()) / f"create-herd-{os.getuid()}" / digest


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


# also where it is set already: a folder that another state of the sources has filled would be stale
os.environ["NUMBA_CACHE_DIR"] = str(cache_folder())

import numba  # noqa: E402 (the cache's folder must be set before Numba is imported)


def _kept(function: Callable[..., Any]) -> bool:
    """Whether all that `function` may call is ours: it is not a user's, nor a law's, which may import a user's."""
    home = Path(__file__).resolve().parent.parent
    path = Path(function.__code__.co_filename).resolve()
    ours = any(path.is_relative_to(home / package) for package in PACKAGES)
    return ours and not path.is_relative_to(home / LAWS)


def compiled(function: Callable[..., Any]) -> Any:
    """`function`, compiled without Python objects on first use and, if it is ours, cached between runs.

    `.py_func` is the plain one.
    """
    return numba.njit(cache=_kept(function), error_model="numpy")(function)


def borrowing(function: Callable[..., Any]) -> Any:
    """The same for inner loops that allocate nothing: no references are counted.

    What such a function calls is compiled likewise, but for what is `allocating`.
    """
    return numba.njit(cache=_kept(function), error_model="numpy", _nrt=False)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """The same as `borrowing`, put in place of each call: for stages that hand on a great many arrays."""
    return numba.njit(cache=_kept(function), error_model="numpy", _nrt=False, forceinline=True)(function)


def allocating(function: Callable[..., Any]) -> Any:
    """The same as `compiled` for what makes arrays or lists, though it may be called by what is `borrowing`."""
    return numba.njit(cache=_kept(function), error_model="numpy", _nrt=True)(function)
