"""The check of a user's law before a batch starts, in a process of its own that can be stopped.

The law is called on a handful of situations, first as written, then compiled: a file that does not parse, lacks its
function, has values or selections that cannot be, returns something else than a `Motion` or numbers that are not
finite, indexes out of bounds or never returns is refused in one line. The law is given what it declares to need, and
nan for the rest, as on robots that sense no more.
"""

from __future__ import annotations

import json
import math
import queue
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import IO, TYPE_CHECKING, Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from trials.batch.patience import STILL_S, Patience

if TYPE_CHECKING:
    from trials.batch.asked import Asked

CALL_LIMIT_S = 5.0
"""Processor time that one call may take: some 10⁵ times what the project's laws need."""
IMPORTING, COMPILING = "importing", "compiling"
LIMITS_S = {IMPORTING: 20.0, COMPILING: 120.0}
"""Processor time that importing the file, or compiling the law, may take."""
POLL_S = 0.25
_ERROR, _STAGE, _DECLARED = "error: ", "stage: ", "declared: "


def check(path: str) -> None:
    """Has a law checked in a process of its own, and learns from there what it declares.

    Raises `InputError` naming the file, and the member or the situation, if the law cannot be used.
    """
    from flocking import lawentry, lawsource

    source = lawsource.read_source(path)
    process = subprocess.Popen(
        [sys.executable, "-m", "trials.commands.lawcheck", path],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        stdin=subprocess.DEVNULL,
        text=True,
    )
    try:
        declared = json.loads(_last_word(process, path))
    finally:
        process.kill()
        process.wait()
    if declared["source"] != source:
        raise InputError(f"law file {path!r} was changed while it was checked; start once more")
    lawentry.learn(path, source, declared["law"])


def _last_word(process: subprocess.Popen[str], path: str) -> str:
    """What the process says when it has found no fault. Raises `InputError` for a fault, or if it does not say it."""
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(process.stdout, lines), daemon=True).start()
    patience, stage, limit = Patience(process.pid), IMPORTING, LIMITS_S[IMPORTING]
    last = ""
    while True:
        try:
            line = lines.get(timeout=POLL_S)
        except queue.Empty:
            if patience.used_s() > limit:
                late = f"did not return within {limit:g} s of processor time ({stage})"
                raise InputError(f"law file {path!r} {late}") from None
            if patience.still_s() > STILL_S:
                late = f"waited for something that did not come within {STILL_S:g} s ({stage})"
                raise InputError(f"law file {path!r} {late}") from None
            continue
        if line is None:
            break
        if line.startswith(_ERROR):
            raise InputError(line.removeprefix(_ERROR))
        if line.startswith(_DECLARED):
            last = line.removeprefix(_DECLARED)
        if line.startswith(_STAGE):
            stage = line.removeprefix(_STAGE)
            limit = LIMITS_S.get(stage, CALL_LIMIT_S)
            patience.begin()
    if not last:
        code = process.wait()
        raise InputError(f"law file {path!r} ended its process with code {code} ({stage})")
    return last


def check_all(asked: Asked) -> None:
    """Checks each law that is a file of the user's own."""
    from trials.batch.asked import users_laws  # not at the top: the process of the check plans nothing

    for path in users_laws(asked):
        check(path)


def _listen(stream: IO[str] | None, lines: queue.SimpleQueue[str | None]) -> None:
    """Puts each line of the stream into the queue as it comes, and None at the end."""
    assert stream is not None
    for line in stream:
        lines.put(line.rstrip("\n"))
    lines.put(None)


class Call(NamedTuple):
    """What one call of the law is given, and the size of its memory, which is empty at each call."""

    case: str
    inputs: tuple[Any, ...]
    memory: int
    u: np.ndarray


def situations() -> dict[str, np.ndarray]:
    """Positions (M, 2) of neighbours with which every law must cope, by name."""
    rng = np.random.default_rng(0)
    return {
        "no neighbour": np.empty((0, 2)),
        "one neighbour": np.array([[1.5, 0.4]]),
        "two neighbours": np.array([[1.0, 0.5], [2.0, -0.5]]),
        "coincident neighbours": np.array([[1.0, 0.5], [1.0, 0.5], [1.0, 0.5]]),
        "a neighbour in its own place": np.array([[0.0, 0.0], [1.0, 0.5]]),
        "a neighbour nearby": np.array([[0.34, 0.0], [2.0, 0.0]]),
        "sixty neighbours": rng.uniform(-5.0, 5.0, size=(60, 2)),
    }


def try_out(path: str) -> None:
    """Runs in the separate process: prints each stage as it begins, and raises `InputError` at the first fault."""
    from flocking import lawdata, lawentry, lawsource

    source = lawsource.read_source(path)
    module = lawentry.module_of(path, source)
    values = _values(module, path)
    calls = [call for parameters in values for call in _calls(module, parameters, path)]
    declared = lawdata.as_data(path, module)
    _try(module.law, "", calls, module, path)
    print(f"{_STAGE}{COMPILING}", flush=True)
    _try(lawentry.load(path, source).decide, "compiled, ", calls, module, path)
    print(f"{_DECLARED}{json.dumps({'source': source, 'law': declared})}", flush=True)


def _values(module: ModuleType, path: str) -> list[Any]:
    """The parameters' defaults, and their values for Creates where these differ.

    Raises `InputError` for values out of bounds, or that the law's relations forbid together.
    """
    from flocking import lawentry
    from flocking.parameters import declared, filled

    usual = {name: parameter.default for name, parameter in declared(module.Parameters).items()}
    try:
        for_creates = {**usual, **getattr(module, "CREATE", {})}
        for given in (usual, for_creates):
            filled(module.Parameters, given, prefix="law.")
        lawentry.relations_of(module)
    except (InputError, TypeError) as error:
        raise InputError(f"law file {path!r}: {error}") from None
    values, creates = (lawentry.parameters_of(path, module, given) for given in (usual, for_creates))
    return [values] if values == creates else [values, creates]


def _calls(module: ModuleType, parameters: Any, path: str) -> list[Call]:
    """The calls of the law: in each situation with middling, the lowest and the highest random numbers."""
    from flocking import lawentry, selection
    from flocking.parameters import declared
    from flocking.types import NO_OBSTACLES, Members, Obstacles, Own, unknown

    try:
        texts, names = lawentry.sets_of(module), declared(module.Parameters)
        sets = [selection.resolved(steps, parameters._asdict()) for steps in selection.parse_sets("all", texts, names)]
    except InputError as error:
        raise InputError(f"law file {path!r}: SETS: {error}") from None
    needs = lawentry.needs_of(module) | selection.needs(step for steps in sets for step in steps)
    memory, draws = lawentry.room_of(path, module)
    rng = np.random.default_rng(1)
    found = []
    for case, positions in situations().items():
        count = len(positions)
        headings, velocities, ids = unknown(count)
        members = Members(
            positions,
            np.arctan2(positions[:, 1], positions[:, 0]),
            rng.uniform(-np.pi, np.pi, count) if "headings" in needs else headings,
            rng.uniform(-0.4, 0.4, (count, 2)) if "velocities" in needs else velocities,
            np.arange(1, count + 1) if "ids" in needs else ids,
        )
        linked = np.ones(count, dtype=np.bool_)
        mask = np.array([selection.select(steps, members, linked) for steps in sets]).reshape(len(sets), count)
        for u, speed, goal, walls in ((0.3, 0.2, math.nan, 2), (0.0, 0.0, 3.0, 0), (1.0 - 2.0**-53, 0.3, -1.0, 1)):
            own = Own(
                np.array([speed, 0.0]),
                speed,
                1.0 if "compass" in needs else math.nan,
                np.array([goal, 0.5 * goal]) if "goal" in needs else np.full(2, math.nan),
                np.array([walls > 0, walls > 1]) if "contacts" in needs else np.zeros(2, dtype=np.bool_),
                0.1,
                0,
                0,
            )
            points = np.array([[0.6, 0.3], [-0.2, -1.0]])[:walls]
            obstacles = Obstacles(points) if "obstacles" in needs else NO_OBSTACLES
            found.append(Call(case, (own, members, mask, obstacles, parameters), memory, np.full(draws, u)))
    return found


def _try(function: Callable[..., object], how: str, calls: list[Call], module: ModuleType, path: str) -> None:
    """Makes the calls. Raises `InputError` for one that fails or returns what is no motion."""
    rules = tuple(getattr(module, "RULES", ("law",)))
    for call in calls:
        print(f"{_STAGE}{how}member 1 with {call.case}", flush=True)
        try:
            motion = function(*call.inputs, np.zeros(call.memory), call.u)
        except Exception as error:
            frames = traceback.extract_tb(error.__traceback__)
            line = next((f"line {f.lineno}: " for f in reversed(frames) if f.filename == module.__file__), "")
            raise InputError(
                f"law file {path!r} failed for member 1 with {call.case}: {line}{type(error).__name__}: {error}"
            ) from None
        _judge(motion, call.case, rules, path)


def _judge(motion: object, case: str, rules: tuple[str, ...], path: str) -> None:
    from flocking.types import Kind, Motion

    if not isinstance(motion, Motion):
        shape = f" of {len(motion)}" if isinstance(motion, tuple) else ""
        raise InputError(
            f"law file {path!r} returned {type(motion).__name__}{shape} for member 1 with {case}; "
            "expected Motion(kind, x, y, rule)"
        )
    try:
        kind, x, y, rule = map(float, motion)
    except (TypeError, ValueError):
        raise InputError(
            f"law file {path!r} returned {tuple(motion)} for member 1 with {case}; expected four numbers"
        ) from None
    still = kind in (Kind.HOLD, Kind.STOP)
    if kind not in list(Kind) or not (still or (math.isfinite(x) and math.isfinite(y))):
        raise InputError(
            f"law file {path!r} returned kind {kind:g}, x {x:g}, y {y:g} for member 1 "
            f"with {case}; expected a kind of 0 to {len(Kind) - 1} and finite numbers"
        )
    if rule not in range(len(rules)):
        raise InputError(f"law file {path!r} returned rule {rule:g} for member 1 with {case}; RULES has {len(rules)}")


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
