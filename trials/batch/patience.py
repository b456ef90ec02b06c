"""How long another process is waited for: by the processor time that it uses, so that a busy machine ends none."""

from __future__ import annotations

from time import monotonic

import psutil

STILL_S = 60.0
"""Wall time in which a process that waits, and uses no processor time, counts as hung."""
LEAST_S = 0.02
"""Processor time that counts as some: twice the unit in which the system counts it."""
_WAITING = (psutil.STATUS_SLEEPING, psutil.STATUS_STOPPED, psutil.STATUS_IDLE)


class Patience:
    """What a process has used since `begin`."""

    def __init__(self, pid: int) -> None:
        self._process = psutil.Process(pid)
        self.begin()

    def begin(self) -> None:
        """Counts from now on."""
        self._begun_s = self._moved_s = self.clock_s()
        self._moved = monotonic()

    def clock_s(self) -> float:
        """Processor time of all its threads, in its own code and in the system's; nan once it has ended."""
        try:
            times = self._process.cpu_times()
        except psutil.Error:
            return float("nan")
        return float(times.user + times.system)

    def used_s(self) -> float:
        """Processor time since `begin`; nan once it has ended."""
        return self.clock_s() - self._begun_s

    def still_s(self) -> float:
        """Wall time for which it has waited without using processor time, as far as it was asked; 0 if it works."""
        try:
            status = self._process.status()
        except psutil.Error:
            return 0.0
        now = self.clock_s()
        if not now - self._moved_s < LEAST_S or status not in _WAITING:
            self._moved_s, self._moved = now, monotonic()
        return monotonic() - self._moved
