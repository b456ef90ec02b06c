"""A kinematic herd as the group that is put into environments."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flocking.kinematic import Band, Schedule, Space, simulate
from flocking.types import Floats
from generation.group import Job


@dataclass(frozen=True)
class Members:
    """Members that move by their laws, within what their bodies can do."""

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
        for job in jobs:
            history = simulate(
                self.bands,
                job.poses_w,
                Schedule(self.dt_s, iterations),
                rng=np.random.default_rng(job.seed),
                space=Space(walls=job.environment.walls()),
                speeds_m_s=self.speeds_m_s,
            )
            yield history.positions_w
