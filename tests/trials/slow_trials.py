"""Real trials in a worker that starts slowly, as one that compiles does, for tests of the watch."""

from __future__ import annotations

import sys
import time
from typing import Any

from trials.batch import worker
from trials.batch.folders import Files
from trials.batch.worker import WorkerOutput

SLOW_S = 2.5
KERNEL = "flocking.kinematic.kernel"


class SlowKernel:
    """A finder of modules that waits when asked for the kernel, and finds nothing."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> None:
        if name == KERNEL:
            time.sleep(SLOW_S)


def run(trial: dict[str, Any], scans: str, files: Files) -> WorkerOutput:
    """The trial; its kernel takes long to import, its robots take long to detect for the first time."""
    assert KERNEL not in sys.modules
    sys.meta_path.insert(0, SlowKernel())  # type: ignore[arg-type]
    if trial["simulation"] == "robots":
        from trials.simulations.robots.robot import Robot

        quick = Robot.detect

        def detect(robot: Robot, senses: Any) -> Any:
            time.sleep(SLOW_S)
            Robot.detect = quick  # type: ignore[method-assign]
            return quick(robot, senses)

        Robot.detect = detect  # type: ignore[method-assign]
    return worker.run_and_write(trial, scans, files)
