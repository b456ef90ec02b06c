"""`herd watch`: one running herd in MuJoCo's viewer, whose user's creature is steered by keys."""

from __future__ import annotations

import math
import time as clock
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from flocking.errors import InputError
from trials.commands.piloting import trial_of
from trials.simulations.contract import StoppedError

UP, DOWN, LEFT, RIGHT, SPACE, ESCAPE = 265, 264, 263, 262, 32, 256
"""Keys by GLFW's numbers."""
STEP_M_S, STEP_RAD = 0.25, math.radians(15.0)
"""What one press of an arrow changes. Choices."""
MOST_M_S = 3.5
"""The fastest that a user may ask for: what the one-legged robots can run. A choice."""


class Asked(NamedTuple):
    """How the creature is to run."""

    speed_m_s: float
    direction_rad: float
    """Counter-clockwise from the world's x axis."""

    @property
    def velocity(self) -> tuple[float, float]:
        """m/s, world axes; to the millimetre, as it is told in a script."""
        return (
            round(self.speed_m_s * math.cos(self.direction_rad), 3),
            round(self.speed_m_s * math.sin(self.direction_rad), 3),
        )


def pressed(asked: Asked, key: int) -> Asked:
    """What is asked for after a key was pressed; other keys change nothing."""
    speed, direction = asked
    if key in (UP, DOWN):
        speed = min(max(speed + (STEP_M_S if key == UP else -STEP_M_S), 0.0), MOST_M_S)
    elif key in (LEFT, RIGHT):
        direction = math.remainder(direction + (STEP_RAD if key == LEFT else -STEP_RAD), 2.0 * math.pi)
    elif key == SPACE:
        speed = 0.0
    return Asked(speed, direction)


class Window(Protocol):
    """A viewer at work, as MuJoCo's."""

    def is_running(self) -> bool: ...
    def sync(self) -> None: ...
    def close(self) -> None: ...


Opened = Callable[[Any, Any, Callable[[int], None]], Window]
"""(model, data, what each key is told to) → the window."""


def opened(model: Any, data: Any, on_key: Callable[[int], None]) -> Window:
    """MuJoCo's viewer beside this program. Raises `InputError` where there is no display."""
    import glfw
    import mujoco.viewer

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if not glfw.init():
            raise InputError("no display to show the herd on; expected one, or herd run with --set script=…")
    window: Window = mujoco.viewer.launch_passive(model, data, key_callback=on_key)
    return window


class Keys:
    """A person at a window: a `Rider`. Simulated time goes on so many times as fast as the clock, at most."""

    def __init__(self, times: float, start: Asked, opened: Opened) -> None:
        self._times, self._opened = times, opened
        self.asked = start
        self._ends = False
        self._window: Window | None = None
        self._began = math.nan

    def begin(self, model: Any, data: Any) -> None:
        """Opens the window."""
        self._window = self._opened(model, data, self.press)

    def press(self, key: int) -> None:
        """A key was pressed."""
        self._ends |= key == ESCAPE
        self.asked = pressed(self.asked, key)

    def velocity(self, time: float) -> tuple[float, float]:
        """Shows the herd, waits for the clock."""
        assert self._window is not None
        if self._ends or not self._window.is_running():
            raise StoppedError
        self._window.sync()
        if math.isnan(self._began):
            self._began = clock.monotonic() - time / self._times
        clock.sleep(max(0.0, self._began + time / self._times - clock.monotonic()))
        return self.asked.velocity

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            self._window.close()


def watch(
    experiment: str,
    number: int,
    times: float,
    settings: Mapping[str, Any],
    out: Path | None,
    opened: Opened = opened,
) -> None:
    """Steers the trial of that number of an experiment; `out` gets its recording. Raises `InputError`."""
    from trials import simulations

    trial = trial_of(experiment, number, settings)
    own = simulations.of(trial)
    if own.steered is None:
        raise InputError(f"experiment {experiment!r} has nobody to steer; expected a running herd, as herd-steady")
    if out is not None and (out.exists() or out.suffix != ".rrd" or not out.absolute().parent.is_dir()):
        raise InputError(f"--out {out}: expected a new name that ends in .rrd, in a folder that exists")
    keys = Keys(times, Asked(2.0, 0.0), opened)
    try:
        result = own.steered(trial, keys)
    finally:
        keys.close()
    if out is not None:
        own.record(result, out)
        print(f"recording   {out}")
    ridden = result.trial.setup
    print(f"{result.measures['upright']:.2f} of the herd upright, {result.measures['collisions']:.0f} collisions")
    print(
        f"again       herd run {experiment} --only {number} --set settle_s=0 --set duration_s={ridden['duration_s']:g} "
        f"--set 'script=\"{ridden['script']}\"'"
    )
