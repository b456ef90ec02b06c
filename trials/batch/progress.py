"""The progress of a batch: a bar with rate and estimate on a terminal, plain lines elsewhere; both on stderr."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

from trials.batch.batch import Progress
from trials.batch.store import Row

LINE_EVERY_S = 5.0
"""Between two plain lines, so that a log of thousands of trials stays readable."""


@contextmanager
def shown(count: int, already: int = 0) -> Iterator[Progress]:
    """Progress of `count` trials, `already` of which had ended before."""
    if sys.stderr is not None and sys.stderr.isatty():
        with _bar(count, already) as bar:
            yield bar
    else:
        yield Lines(count, already)


class Rate:
    """Trials a second, counted from the end of the first trial: imports and compilation lie before it."""

    def __init__(self) -> None:
        self.kept, self.first = 0, 0.0

    def ended(self) -> float:
        """Counts a trial that ended; returns the rate, nan after the first trial."""
        now = monotonic()
        self.kept += 1
        if self.kept == 1:
            self.first = now
            return math.nan
        return (self.kept - 1) / max(now - self.first, 1e-9)


class Lines:
    """Progress in plain lines, one every `LINE_EVERY_S`, and one for each failed trial."""

    def __init__(self, count: int, already: int) -> None:
        self.count, self.done, self.rate = count, already, Rate()
        self.last = monotonic()

    def say(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    def goes_on(self, text: str, count: int) -> None:
        self.count = count
        self.say(text)

    def ended(self, row: Row) -> None:
        self.done += 1
        rate, now = self.rate.ended(), monotonic()
        if row.status != "done":
            self.say(failure(row))
        if self.done == self.count or now - self.last >= LINE_EVERY_S:
            self.last = now
            speed = "" if math.isnan(rate) else f", {_rate(rate)} a second"
            left = (
                f", about {duration((self.count - self.done) / rate)} left" if speed and self.done < self.count else ""
            )
            self.say(f"{self.done} of {self.count} trials{speed}{left}")


class _Bar:
    """Progress as a bar on a terminal."""

    def __init__(self, bar: Any, task: Any) -> None:
        self.bar, self.task, self.rate = bar, task, Rate()

    def say(self, text: str) -> None:
        self.bar.update(self.task, description=text)

    def goes_on(self, text: str, count: int) -> None:
        self.bar.console.print(text, markup=False, highlight=False)
        self.bar.update(self.task, total=count)

    def ended(self, row: Row) -> None:
        if row.status != "done":
            self.bar.console.print(failure(row), markup=False, highlight=False)
        rate = self.rate.ended()
        speed = "" if math.isnan(rate) else f"{_rate(rate)}/s"
        self.bar.update(self.task, advance=1, description="trials", rate=speed)


@contextmanager
def _bar(count: int, already: int) -> Iterator[_Bar]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Rich

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Rich(*columns, console=Console(stderr=True)) as bar:
        yield _Bar(bar, bar.add_task("starting", total=count, completed=already, rate=""))


def _rate(rate: float) -> str:
    """Two significant digits, or whole numbers."""
    return f"{rate:.0f}" if rate >= 100.0 else f"{rate:.2g}"


def failure(row: Row) -> str:
    """A failed trial in one line."""
    return f"trial {row.index} failed (seed {row.seed}, repeat {row.repeat}): {row.reason}"


def duration(seconds: float) -> str:
    """A span of time in words."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
