"""Commands as they are printed: they work as they stand, typed into the shell from which this process was called."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import sys
from pathlib import Path
from typing import Any

MODULE = "trials.commands.cli"
_BARE = re.compile(r"[A-Za-z_.~/][\w./~+-]*")


def command(*words: str) -> str:
    """A command of `herd` with these words, quoted for a shell."""
    return f"{herd()} {shlex.join(words)}".rstrip()


def herd() -> str:
    """What to type for `herd`: the name alone where the shell finds this installation by it, else a path to it.

    A process that was started as a module is started so again; one that is no command at all (a notebook, a test) has
    the command beside its Python.
    """
    called = Path(sys.argv[0] if sys.argv else "")
    own = called if called.name == "herd" and called.is_file() else Path(sys.executable).with_name("herd")
    if called.name == "cli.py" or not own.is_file():
        return f"{shlex.quote(sys.executable)} -m {MODULE}"
    known = shutil.which("herd")
    return "herd" if known and Path(known).resolve() == own.resolve() else shlex.quote(str(own))


def spelled(value: Any) -> str:
    """A value as `--set KEY=VALUE` takes it: TOML, or a bare word."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        bare = _BARE.fullmatch(value) and value not in ("true", "false", "inf", "nan")
        return value if bare else json.dumps(value, ensure_ascii=False)
    return repr(value)
