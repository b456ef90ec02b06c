"""The text of a law's file: read, executed as a module, and kept where Python and Numba find what comes of it."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import os
import stat
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import ModuleType

from flocking import found, users_files
from flocking.compilation import cache_folder
from flocking.errors import InputError, StorageError


def names() -> list[str]:
    """Names of the laws that come with the project."""
    return sorted(found.modules("flocking.laws"))


MOST_BYTES = 1_000_000
"""Of a user's law file: some hundred times what the longest of the project's has."""


def read_source(path: str) -> str:
    """The text of a user's law file; `InputError` if it cannot be read."""
    try:
        path.encode()
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"law file {path!r} is no file; expected a Python file")
        if status.st_size > MOST_BYTES:
            raise InputError(f"law file {path!r} has {status.st_size} bytes; expected at most {MOST_BYTES}")
        return Path(path).read_text(encoding="utf-8")
    except UnicodeEncodeError:
        raise InputError(f"law file {path!a}: expected a name in UTF-8") from None
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(
            f"law file {path!r} does not exist; expected a Python file or one of {', '.join(names())}"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"law file {path!r} cannot be read: {error}") from None


def executed(name: str, source: str) -> tuple[ModuleType, Path]:
    """A user's law as a module, and the file that it was executed from. Raises `InputError`."""
    if not users_files.are_executed():
        raise InputError(f"law file {name!r}: this process does not execute it, and does not know what it declares")
    return _executed(name, source)


@cache
def _executed(name: str, source: str) -> tuple[ModuleType, Path]:
    try:
        ast.parse(source)
    except SyntaxError as error:
        raise InputError(f"law file {name!r} does not parse: line {error.lineno}: {error.msg}") from None
    except ValueError as error:
        raise InputError(f"law file {name!r} does not parse: {error}") from None
    stem = f"user_law_{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    path = written(stem, source)
    spec = importlib.util.spec_from_file_location(stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[stem] = module
    try:
        spec.loader.exec_module(module)
    except StorageError:
        raise
    except Exception as error:
        raise InputError(f"law file {name!r} cannot be imported: {first_line(error)}") from None
    for wanted in ("law", "Parameters"):
        if not callable(getattr(module, wanted, None)):
            raise InputError(f"law file {name!r} lacks {wanted}; expected law(...) and Parameters, see flocking/laws")
    return module, path


def written(stem: str, text: str) -> Path:
    """`text` as stem.py in the cache folder, written once: Numba's cache goes by the file's time.

    Raises `StorageError` if the disk does not take it.
    """
    folder = cache_folder() / "laws"
    path = folder / f"{stem}.py"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if path.exists() and path.read_bytes() == text.encode():
            return path
        handle, temporary = tempfile.mkstemp(dir=folder, suffix=".tmp")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(text.encode())
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise StorageError(f"cannot write {path}: {error.strerror or error}") from error
    return path


def first_line(error: Exception) -> str:
    """The most telling line of an error; Numba puts it after its headings."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    telling = [line for line in lines if not line.startswith(("Failed in", "During", "File", "def ", "<source"))]
    return (telling or lines or [type(error).__name__])[0]
