"""`herd pilot`: one guided trial at a pace that a person can follow, who says when a wall has been cleared.

So did the user of Fine 2015, section 8.2, who triggered each change of formation "when the target group cleared the
current wall".
"""

from __future__ import annotations

import math
import os
import select
import signal
import sys
import time as clock
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from trials.simulations.contract import StoppedError
from trials.types import Trial


def trial_of(experiment: str, number: int, settings: Mapping[str, Any]) -> Trial:
    """The trial of that number, from 1, of an experiment. Raises `InputError`."""
    from trials.design import plan

    made = plan(experiment, settings=settings)
    if not 1 <= number <= len(made.trials):
        raise InputError(f"--trial {number}: {experiment} has trials 1 to {len(made.trials)}")
    return made.trials[number - 1]


def pilot(experiment: str, number: int, times: float, settings: Mapping[str, Any], out: Path | None) -> None:
    """Runs the trial of that number of an experiment; `out` gets its recording. Raises `InputError`."""
    from trials import simulations

    trial = trial_of(experiment, number, settings)
    own = simulations.of(trial)
    if own.watched is None:
        raise InputError(f"experiment {experiment!r} has no task; expected one whose herd is guided, as piloting")
    if out is not None and out.exists():
        raise InputError(f"--out {out}: there is such a file; expected a new one")
    if out is not None and (out.suffix != ".rrd" or not out.absolute().parent.is_dir()):
        raise InputError(f"--out {out}: expected a name that ends in .rrd, in a folder that exists")
    told = ", ".join([f"trial {number}", *(f"{key} {value}" for key, value in trial.conditions.items())])
    watching = Watching(times, told)
    with watching.interrupted():
        result = own.watched(trial, "some" if out is not None else "none", watching)
    if out is not None and len(result.times):
        own.record(result, out)
        print(f"recording   {out}")
    if watching.is_interrupted:
        raise KeyboardInterrupt
    if result.outcome == "failed":
        raise InputError(f"the trial ended: {result.reason}")
    print(f"{result.measures['arrived_share']:.2f} of the robots arrived")


class Watching:
    """A person at a terminal: simulated time goes on so many times as fast as the clock, and Enter clears a wall.

    Once all are cleared, Enter ends the trial, as Ctrl-C does at any time.
    """

    def __init__(self, times: float, told: str) -> None:
        """`told`: what is said of the trial when it begins."""
        self.times, self.told = times, told
        self.is_interrupted = False
        self._began = math.nan
        self._told = -1.0
        self._ends = False

    @contextmanager
    def interrupted(self) -> Iterator[None]:
        """Ctrl-C ends the trial at its next sample; a second one all at once."""

        def on_interrupt(number: int, frame: object) -> None:
            if self.is_interrupted:
                raise KeyboardInterrupt
            self.is_interrupted = True

        before = signal.signal(signal.SIGINT, on_interrupt)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)

    def __call__(self, time: float, passed: int, left: int, through: int, on_course: int) -> bool:
        """Waits for the clock; whether Enter has been pressed."""
        if math.isnan(self._began):
            self._began = clock.monotonic() - time / self.times
            print(f"{self.told}: press Enter {'once the herd has cleared a wall' if left else 'to end it'}")
        elif left == 0 and not self._ends:
            print("all walls are cleared: press Enter to end the trial")
        self._ends = left == 0
        if time >= self._told + 1.0:
            self._told = time
            of = f"wall {passed + 1}: {through} past it" if left else f"the goal: {through} in it"
            print(f"{time:5.0f} s  {of}, {on_course} on their course", flush=True)
        is_pressed = self._is_pressed(time)
        if self.is_interrupted or (is_pressed and self._ends):
            raise StoppedError
        return is_pressed

    def _is_pressed(self, time: float) -> bool:
        wait = max(0.0, self._began + time / self.times - clock.monotonic())
        ready, _, _ = select.select([sys.stdin], [], [], wait)
        if not ready:
            return False
        clock.sleep(max(0.0, self._began + time / self.times - clock.monotonic()))
        has_line = _line()
        if not has_line and not self._ends:
            raise InputError("standard input has ended: expected a terminal, or a line for each wall")
        return has_line


def _line() -> bool:
    """Reads one line of standard input; False at its end. Unbuffered: `select` does not see lines in a buffer."""
    while (read := os.read(sys.stdin.fileno(), 1)) not in (b"\n", b""):
        pass
    return read != b""
