"""The group of agents (A of Fine 2015, section 5.4) as validation sees it: a black box in an environment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

from flocking.types import Floats
from generation.environment import Environment


class Job(NamedTuple):
    """One simulation of a group in an environment."""

    environment: Environment
    poses_w: Floats
    """(N, 3) where the members start: x, y (m), heading (rad)."""
    seed: tuple[int, ...]
    """Of the group's own random numbers: the same seed, the same draws, whatever the environment."""


class Group(Protocol):
    """Members that move somehow: any law, any body, any mix. Validation knows no more of them than this."""

    @property
    def count(self) -> int:
        """Number of members."""
        ...

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        """For each job, in their order, the positions (iterations + 1, N, 2) of its members, m, from the start on."""
        ...
