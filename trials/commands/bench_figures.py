"""One measured figure of `herd bench`, and how a call is timed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np

REPEATS = 5
"""Runs of each figure, after one that is not counted."""


@dataclass(frozen=True)
class Figure:
    """One measured figure."""

    name: str
    unit: str
    runs: tuple[float, ...]
    target: float
    """nan = none."""
    at_least: bool = True
    """Whether the target is a lower bound."""

    @property
    def median(self) -> float:
        """Median of the runs."""
        return float(np.median(self.runs))

    @property
    def worst(self) -> float:
        """5th percentile where more is better, else the 95th."""
        return float(np.percentile(self.runs, 5 if self.at_least else 95))

    @property
    def met(self) -> bool | None:
        """Whether the median meets the target; None where there is none."""
        if math.isnan(self.target):
            return None
        return self.median >= self.target if self.at_least else self.median <= self.target

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        target = None if math.isnan(self.target) else self.target
        return {
            "name": self.name,
            "unit": self.unit,
            "median": self.median,
            "worst": self.worst,
            "runs": list(self.runs),
            "target": target,
            "at_least": self.at_least,
            "met": self.met,
        }


def repeated(call: Callable[..., float], *arguments: object) -> tuple[float, ...]:
    """What a call returns, `REPEATS` times after one that is not counted."""
    call(*arguments)
    return tuple(call(*arguments) for _ in range(REPEATS))


def processor_s(call: Callable[[], object]) -> float:
    """Processor time of this process, s."""
    started = process_time()
    call()
    return process_time() - started


def wall_s(call: Callable[[], object]) -> float:
    """Wall time, for work that other processes do, s."""
    started = perf_counter()
    call()
    return perf_counter() - started


def timed(call: Callable[[], object], calls: int) -> tuple[float, ...]:
    """Processor time of one call, µs."""

    def once() -> float:
        started = process_time()
        for _ in range(calls):
            call()
        return (process_time() - started) / calls * 1e6

    return repeated(once)
