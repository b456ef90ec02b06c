"""Compiled code kept between runs, and what becomes of it when its files are damaged or the disk is full."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core.caching import FunctionCache

from flocking.errors import StorageError


class CompiledCache(FunctionCache):
    """Numba's cache of one function, in which a damaged file counts as a file that is not there.

    Raises `StorageError` where the disk does not take what was compiled.
    """

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code of that signature; None if it is not kept or cannot be read."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # cut short, emptied, unreadable: pickle raises whatever its bytes lead it to
            self._forget()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keeps compiled code."""
        try:
            try:
                super().save_overload(sig, data)
            except OSError:
                raise
            except Exception:  # the index is damaged
                self._forget()
                super().save_overload(sig, data)
        except OSError as error:
            raise StorageError(f"cannot keep compiled code in {self.cache_path}: {error.strerror or error}") from error

    def _forget(self) -> None:
        with suppress(OSError):
            Path(self._cache_file._index_path).unlink(missing_ok=True)


def kept_between_runs(dispatcher: Any) -> Any:
    """A function that Numba compiles, with its compiled code kept between runs.

    Itself where Numba is told to compile nothing (NUMBA_DISABLE_JIT) and hands back plain functions.
    """
    if hasattr(dispatcher, "py_func"):
        dispatcher._cache = CompiledCache(dispatcher.py_func)
    return dispatcher


def compiled_now(dispatcher: Any, signature: Any) -> Any:
    """A function that Numba compiles, compiled for one signature and for no other."""
    if hasattr(dispatcher, "py_func"):
        dispatcher.compile(signature)
        dispatcher.disable_compile()
    return dispatcher
