"""A kinematic herd as the group that is put into environments."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flocking.kinematic import Band
from flocking.kinematic.many import Start, positions_of
from flocking.types import Floats
from generation.group import Job


@dataclass(frozen=True)
class Members:
    """Members of all groups of a trial. Walls hide what is behind them, as in `generation.validation.kinematic`."""

    bands: tuple[Band, ...]
    dt_s: float
    speeds_m_s: Floats
    """(N,) at the start, along the heading."""

    @property
    def count(self) -> int:
        """Number of members."""
        return sum(band.count for band in self.bands)

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        """For each job the positions (iterations + 1, N, 2) of the members. Raises `LawFailedError`."""
        starts = [Start(job.poses_w, job.environment.walls(), job.seed) for job in jobs]
        return positions_of(self.bands, starts, self.dt_s, iterations, self.speeds_m_s)
