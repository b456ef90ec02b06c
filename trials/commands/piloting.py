"""`herd pilot`: one guided trial at a pace that a person can follow, who says when a wall has been cleared.

So did the user of Fine 2015, section 8.2, who triggered each change of formation "when the target group cleared the
current wall".
"""

from __future__ import annotations

import math
import select
import sys
import time as clock
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flocking.errors import InputError


def pilot(experiment: str, number: int, times: float, settings: Mapping[str, Any], out: Path | None) -> None:
    """Runs the trial of that number of an experiment; `out` gets its recording. Raises `InputError`."""
    from trials import simulations
    from trials.design import plan

    made = plan(experiment, settings=settings)
    if not 1 <= number <= len(made.trials):
        raise InputError(f"--trial {number}: {experiment} has trials 1 to {len(made.trials)}")
    trial = made.trials[number - 1]
    own = simulations.of(trial)
    if own.watched is None:
        raise InputError(f"experiment {experiment!r} has no task; expected one whose herd is guided, as piloting")
    if out is not None and out.exists():
        raise InputError(f"--out {out}: there is such a file; expected a new one")
    if out is not None and (out.suffix != ".rrd" or not out.absolute().parent.is_dir()):
        raise InputError(f"--out {out}: expected a name that ends in .rrd, in a folder that exists")
    told = ", ".join(f"{key} {value}" for key, value in trial.conditions.items())
    print(f"trial {number}, {told}: press Enter once the herd has cleared a wall")
    result = own.watched(trial, "some" if out is not None else "none", Watching(times))
    if result.reason:
        raise InputError(f"the trial ended: {result.reason}")
    print(f"{result.measures['arrived_share']:.2f} of the robots arrived")
    if out is not None:
        own.record(result, out)
        print(f"recording   {out}")


class Watching:
    """A person at a terminal: simulated time goes on so many times as fast as the clock, and Enter clears a wall."""

    def __init__(self, times: float) -> None:
        self.times = times
        self._began = math.nan
        self._told = -1.0

    def __call__(self, time: float, passed: int, through: int, on_course: int) -> bool:
        """Waits for the clock; whether Enter has been pressed."""
        if math.isnan(self._began):
            self._began = clock.monotonic() - time / self.times
        if time >= self._told + 1.0:
            self._told = time
            print(f"{time:5.0f} s  wall {passed + 1}: {through} past it, {on_course} on their course", flush=True)
        wait = max(0.0, self._began + time / self.times - clock.monotonic())
        ready, _, _ = select.select([sys.stdin], [], [], wait)
        if not ready:
            return False
        clock.sleep(max(0.0, self._began + time / self.times - clock.monotonic()))
        if sys.stdin.readline() == "":
            raise InputError("standard input has ended: expected a terminal, or a line for each wall")
        return True
