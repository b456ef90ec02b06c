"""`herd generate`: environments of a schema that pass its filter, as files, and a contact sheet of them."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from flocking.parameters import declared, filled
from generation import contact_sheet, files, filters, found, sources
from generation.candidates import Tally, check_varied, draws_nothing, passing
from generation.environment import Environment
from generation.schema import Schema

SHEET = "contact-sheet.png"
FILTERS = "filter."
"""What keys of a filter's parameters begin with."""
NONE = "none"


@dataclass(frozen=True)
class Asked:
    """What `herd generate` was asked for."""

    schema: str
    count: int
    seed: int
    out: Path
    settings: Mapping[str, Any] = field(default_factory=dict)
    vary: Sequence[str] = ()
    filter: str | None = None
    """None: the schema's own."""
    workspace: Path | None = None
    """None: the schema's own."""


def generate(asked: Asked) -> str:
    """Writes the environments as they pass, then the contact sheet; returns what to say.

    Raises `InputError`, also where too many in a row do not pass; what was written by then is kept.
    """
    schema = found.load(asked.schema)
    name = schema.filter if asked.filter is None else asked.filter
    own = {key: value for key, value in asked.settings.items() if not key.startswith(FILTERS)}
    parameters = filled(schema.parameters, own)
    workspace = _workspace(schema, asked.workspace)
    check_varied(schema, asked.vary)
    _check_not_the_same(asked, schema, parameters, workspace)
    accepts = _accepts("" if name == NONE else name, asked.settings)
    _make(asked.out)
    sheet = _Sheet(asked.out / SHEET, f"{schema.name}, seed {asked.seed}, filter {name or NONE}")
    written: list[Environment] = []
    tally = Tally(0, 0)
    digits = max(4, len(str(asked.count)))
    try:
        for environment, tally in passing(schema, parameters, workspace, accepts, asked.count, asked.seed, asked.vary):
            files.write(environment, asked.out / f"{tally.passed:0{digits}}.json")
            written += [environment] if tally.passed <= contact_sheet.MOST else []
            if tally.passed == contact_sheet.MOST < asked.count:
                sheet.begin(written)
    except InputError as error:
        kept = f"; the {tally.passed} in {asked.out} are kept" if tally.passed else ""
        raise InputError(f"{error}{kept}") from None
    finally:
        if written:
            sheet.end(written)
    rate = f"{tally} the filter {name}" if name and name != NONE else "no filter"
    environments = f"{tally.passed} environment{'s' * (tally.passed != 1)}"
    shown = f", of which the sheet shows {len(written)}" if len(written) < tally.passed else ""
    return f"{schema.name}: {rate}\n{environments} in {asked.out}{shown}\n{asked.out / SHEET}"


class _Sheet:
    """The contact sheet, drawn in a process of its own while environments that it does not show are made."""

    def __init__(self, path: Path, title: str) -> None:
        self.path, self.title = path, title
        self._pool: ProcessPoolExecutor | None = None
        self._drawn: Future[None] | None = None

    def begin(self, written: Sequence[Environment]) -> None:
        """All that it shows is there."""
        self._pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        self._drawn = self._pool.submit(contact_sheet.write, list(written), self.path, self.title)

    def end(self, written: Sequence[Environment]) -> None:
        """Draws it here where that was not begun, or was ended with the command by Ctrl-C."""
        try:
            if self._drawn is not None:
                self._drawn.result()
                return
        except (BrokenProcessPool, KeyboardInterrupt):
            pass
        finally:
            if self._pool is not None:
                self._pool.shutdown()
        contact_sheet.write(written, self.path, self.title)


def _workspace(schema: Schema, path: Path | None) -> Environment:
    if path is None:
        return schema.workspace()
    environment, told = sources.environment(str(path))
    for line in told:
        print(f"herd: {line}", file=sys.stderr)
    return environment


def _accepts(name: str, settings: Mapping[str, Any]) -> Any:
    """The filter as a function of an environment; without a name, everything passes."""
    given = {key.removeprefix(FILTERS): value for key, value in settings.items() if key.startswith(FILTERS)}
    if not name:
        if given:
            raise InputError(f"{FILTERS}{next(iter(given))} is set, but there is no filter; expected --filter NAME")
        return lambda environment: True
    chosen = filters.load(name)
    values = filled(chosen.parameters, given, FILTERS)
    return lambda environment: chosen.accepts(environment, values)


def _check_not_the_same(asked: Asked, schema: Schema, parameters: Any, workspace: Environment) -> None:
    """Raises `InputError` where all environments would be the same one."""
    if asked.count > 1 and not asked.vary and draws_nothing(schema, parameters, workspace):
        names = ",".join(declared(schema.parameters))
        raise InputError(
            f"schema {schema.name} draws nothing at random: {asked.count} environments would be the same; expected "
            f"--count 1, or parameters to be drawn between their bounds, as in --vary {names}"
        )


def _make(folder: Path) -> None:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"--out {folder}: there is such a file or folder; expected a new or an empty folder")
    folder.mkdir(parents=True, exist_ok=True)
