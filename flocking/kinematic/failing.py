"""Members of a kinematic herd that fail: from then on they stand for good, and the others still see them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats, Ints


class Failures(NamedTuple):
    """Which members of a herd of N fail, and when."""

    steps: Ints
    """(N,) the step, from 0, at whose begin each fails; those who never do have one beyond the last."""
    middles: Sequence[tuple[int, Ints]] = ()
    """Steps, from 0, and members: at the begin of each that of these fails which still works and is the nearest to the
    middle of those who do. Its step is then written to `steps`."""

    def due(self, step: int, working: Bools, positions: Floats) -> Ints:
        """The members of those `working` (N,) that fail at the begin of this step, or failed before."""
        for at, members in self.middles:
            left = members[working[members]]
            if at == step and len(left):
                places = positions[left]
                self.steps[left[np.hypot(*(places - places.mean(axis=0)).T).argmin()]] = step
        return np.flatnonzero(working & (self.steps <= step))

    def until_next(self, step: int) -> int:
        """Steps from this one, whose failures are done, to the next at whose begin somebody may fail."""
        later = [*self.steps[self.steps > step].tolist(), *(at for at, _ in self.middles if at > step)]
        return min(later) - step if later else np.iinfo(np.int64).max
