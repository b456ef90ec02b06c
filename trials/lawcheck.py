"""A user's law tried out before a batch starts, in a process of its own that can be stopped.

The law is called on a handful of situations, first as written, then compiled: a file that does not parse, lacks its
function, returns something else than a `Motion` or numbers that are not finite, indexes out of bounds or never
returns is refused in one line.
"""

from __future__ import annotations

import math
import queue
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import IO

import numpy as np

from flocking.errors import InputError

CALL_LIMIT_S = 5.0
"""Wall time that one call may take: some 10⁵ times what the project's laws need."""
IMPORTING, COMPILING = "importing", "compiling"
LIMITS_S = {IMPORTING: 20.0, COMPILING: 120.0}
"""Wall time that importing the file, or compiling the law, may take."""
_ERROR, _STAGE = "error: ", "stage: "


def check(path: str) -> None:
    """Raises `InputError` naming the file, and the member or the situation, if the law cannot be used."""
    from flocking.lawentry import read_source

    read_source(path)
    process = subprocess.Popen(
        [sys.executable, "-m", "trials.lawcheck", path],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        stdin=subprocess.DEVNULL,
        text=True,
    )
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(process.stdout, lines), daemon=True).start()
    stage, limit = IMPORTING, LIMITS_S[IMPORTING]
    try:
        while True:
            try:
                line = lines.get(timeout=limit)
            except queue.Empty:
                raise InputError(f"law file {path!r} did not return within {limit:g} s ({stage})") from None
            if line is None:
                break
            if line.startswith(_ERROR):
                raise InputError(line.removeprefix(_ERROR))
            if line.startswith(_STAGE):
                stage = line.removeprefix(_STAGE)
                limit = LIMITS_S.get(stage, CALL_LIMIT_S)
        if process.wait(timeout=CALL_LIMIT_S) != 0:
            raise InputError(f"law file {path!r} ended its process with code {process.returncode} ({stage})")
    finally:
        process.kill()
        process.wait()


def _listen(stream: IO[str] | None, lines: queue.SimpleQueue[str | None]) -> None:
    """Hands on each line as it comes, and None at the end."""
    assert stream is not None
    for line in stream:
        lines.put(line.rstrip("\n"))
    lines.put(None)


def situations() -> dict[str, np.ndarray]:
    """Positions (M, 2) of neighbours that any law must bear."""
    rng = np.random.default_rng(0)
    return {
        "no neighbour": np.empty((0, 2)),
        "one neighbour": np.array([[1.5, 0.4]]),
        "two neighbours": np.array([[1.0, 0.5], [2.0, -0.5]]),
        "coincident neighbours": np.array([[1.0, 0.5], [1.0, 0.5], [1.0, 0.5]]),
        "a neighbour nearby": np.array([[0.34, 0.0], [2.0, 0.0]]),
        "sixty neighbours": rng.uniform(-5.0, 5.0, size=(60, 2)),
    }


def try_out(path: str) -> None:
    """In the process of its own: raises `InputError` at the first fault, prints each stage as it begins."""
    from flocking import lawentry
    from flocking.types import NO_OBSTACLES, Kind, Motion, Own, members_at

    source = lawentry.read_source(path)
    module = lawentry.module_of(path, source)
    parameters = module.Parameters()
    sets = len(tuple(getattr(module, "SETS", ("neighbours",))))
    memory, draws = int(getattr(module, "MEMORY", 0)), int(getattr(module, "DRAWS", 0))
    rules = tuple(getattr(module, "RULES", ("law",)))
    own = Own(np.array([0.2, 0.0]), 0.0, math.nan, np.full(2, math.nan), np.zeros(2, dtype=bool), 0.1, 0, 0)

    def judged(motion: object, case: str) -> None:
        if not isinstance(motion, Motion):
            shape = f" of {len(motion)}" if isinstance(motion, tuple) else ""
            raise InputError(
                f"law file {path!r} returned {type(motion).__name__}{shape} for member 1 with {case}; "
                "expected Motion(kind, x, y, rule)"
            )
        numbers = [float(value) for value in motion]
        still = numbers[0] in (Kind.HOLD, Kind.STOP)
        if numbers[0] not in list(Kind) or not (still or all(map(math.isfinite, numbers[1:3]))):
            raise InputError(
                f"law file {path!r} returned kind {numbers[0]:g}, x {numbers[1]:g}, y {numbers[2]:g} for member 1 "
                f"with {case}; expected a kind of 0 to {len(Kind) - 1} and finite numbers"
            )
        if not 0 <= numbers[3] < len(rules):
            raise InputError(f"law file {path!r} returned rule {numbers[3]:g} with {case}; RULES has {len(rules)}")

    def tried(call: Callable[..., object], how: str) -> None:
        for case, positions in situations().items():
            print(f"{_STAGE}{how}member 1 with {case}", flush=True)
            mask = np.ones((sets, len(positions)), dtype=np.bool_)
            members, numbers = members_at(positions), np.full(draws, 0.3)
            try:
                motion = call(own, members, mask, NO_OBSTACLES, parameters, np.zeros(memory), numbers)
            except Exception as error:
                frames = traceback.extract_tb(error.__traceback__)
                line = next((f"line {f.lineno}: " for f in reversed(frames) if f.filename == module.__file__), "")
                raise InputError(
                    f"law file {path!r} failed for member 1 with {case}: {line}{type(error).__name__}: {error}"
                ) from None
            judged(motion, case)

    tried(module.law, "")
    print(f"{_STAGE}{COMPILING}", flush=True)
    tried(lawentry.load(path, source).decide, "compiled, ")


def _main(path: str) -> int:
    try:
        try_out(path)
    except InputError as error:
        print(f"{_ERROR}{' '.join(str(error).split())}", flush=True)
        return 2
    except Exception as error:
        print(
            f"{_ERROR}law file {Path(path).name!r}: {type(error).__name__}: {' '.join(str(error).split())}",
            flush=True,
        )
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1]))
