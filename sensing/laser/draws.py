"""The random numbers of a laser's readings, drawn for many scans at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sensing.laser.planar import BEAMS

Draws16 = NDArray[np.uint16]
"""Equally likely whole numbers below 65536."""
AHEAD = 16
"""Scans for which numbers are drawn at once; with more, a scan's share of the call becomes hardly smaller."""


class Draws:
    """The numbers for one laser's scans, of ranges or of intensities, from a generator that nobody else uses.

    The numbers are those that as many calls a scan would give: each scan takes as many, whatever it sees.
    """

    def __init__(self, rng: np.random.Generator, a_beam: int, ahead: int = AHEAD) -> None:
        """`a_beam`: numbers for each beam. `ahead`: scans for which they are drawn at once; 1 for a generator that is
        shared."""
        self._bits = rng.bit_generator
        self._words = (a_beam * BEAMS + 3) // 4
        self._ahead = ahead
        self._drawn: Draws16 = np.empty((0, 0), np.uint16)
        self._next = 0

    def next_scan(self) -> Draws16:
        """(at least `a_beam` B,) the next scan's; they stay as they are."""
        if self._next == len(self._drawn):
            raw = self._bits.random_raw(self._ahead * self._words)
            self._drawn, self._next = raw.view(np.uint16).reshape(self._ahead, -1), 0
        self._next += 1
        drawn: Draws16 = self._drawn[self._next - 1]
        return drawn


def range_draws(rng: np.random.Generator, ahead: int = AHEAD) -> Draws:
    """For ranges: two numbers a beam, for the noise and for the drop-out."""
    return Draws(rng, 2, ahead)


def intensity_draws(rng: np.random.Generator, ahead: int = AHEAD) -> Draws:
    """For intensities: one number a beam, for the noise."""
    return Draws(rng, 1, ahead)
