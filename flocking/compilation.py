"""How the hot paths are compiled: Numba, cached between runs, never stale.

Numba's own cache sees only the file of the function itself: after an edit to a helper in another file it would
return old results. So the cache's folder is named by a hash of every source file of ours, and what is compiled from
a file that is not ours, or may use one (a law), is not kept here.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from flocking.errors import InputError

PACKAGES = ("flocking", "generation", "robots", "sensing")
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

    Below `$CREATE_HERD_CACHE`, where that folder must then be writable and this user's alone (else `InputError`); or
    below the user's cache folder; or, where that cannot be written, below a folder for temporary files. What is not
    this user's alone is not used: code in it might be another's. The last resort is a new folder, which this process
    and those that it starts use.
    """
    digest = sources_digest()
    named = os.environ.get(CACHE_VARIABLE)
    if named:
        if not _writable(Path(named) / digest):
            raise InputError(f"{CACHE_VARIABLE} = {named!r} cannot be written; expected a folder for compiled code")
        if not _own(Path(named) / digest):
            raise InputError(
                f"{CACHE_VARIABLE} = {named!r}: {digest} in it is not this user's alone; expected a folder that no one "
                "else may write to"
            )
        return Path(named) / digest
    users = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "create-herd"
    for base in (users, Path(tempfile.gettempdir()) / f"create-herd-{os.geteuid()}"):
        if _own(base) and _own(base / digest):
            return base / digest
    fresh = tempfile.mkdtemp(prefix="create-herd-")
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    os.environ[CACHE_VARIABLE] = fresh
    return cache_folder.__wrapped__()


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _own(folder: Path) -> bool:
    """Makes a folder that only this user may enter; whether it is there, takes files, and only this user writes to it.

    A link is none: it may lead anywhere.
    """
    if not _writable(folder):
        return False
    found = folder.lstat()
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid() and not found.st_mode & 0o022


# also where it is set already: a folder that another state of the sources has filled would be stale
os.environ["NUMBA_CACHE_DIR"] = str(cache_folder())

import numba  # noqa: E402 (the cache's folder must be set before Numba is imported)
from numba.core.errors import NumbaExperimentalFeatureWarning  # noqa: E402

from flocking.compiled_cache import compiled_now, kept_between_runs  # noqa: E402 (it imports Numba)

# a record that begins with all fields of another may stand for it: bodies' fleets and their gears
warnings.filterwarnings("ignore", category=NumbaExperimentalFeatureWarning)


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
    return _dispatcher(function)


def compiled_for(signature: Any, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """As `compiled`, at once and for one signature of Numba's; `options` of Numba's too."""

    def decorated(function: Callable[..., Any]) -> Any:
        return compiled_now(_dispatcher(function, **options), signature)

    return decorated


def borrowing(function: Callable[..., Any]) -> Any:
    """The same for inner loops that allocate nothing: no references are counted.

    What such a function calls is compiled likewise, but for what is `allocating`.
    """
    return _dispatcher(function, _nrt=False)


def inlined(function: Callable[..., Any]) -> Any:
    """The same as `borrowing`, put in place of each call: for stages that hand on a great many arrays."""
    return _dispatcher(function, _nrt=False, forceinline=True)


def allocating(function: Callable[..., Any]) -> Any:
    """The same as `compiled` for what makes arrays or lists, though it may be called by what is `borrowing`."""
    return _dispatcher(function, _nrt=True)


def _dispatcher(function: Callable[..., Any], **options: Any) -> Any:
    made = numba.njit(error_model="numpy", **options)(function)
    return kept_between_runs(made) if _kept(function) else made
