"""Streams of random numbers: one for each purpose of each member of each repeat.

Two trials of the same repeat draw the same numbers whatever their conditions, so that conditions compare in pairs.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np


class Purpose(IntEnum):
    """What a stream is used for. The numbers are part of the seed, so none may ever change."""

    START = 0
    PHASE = 1
    RANGE_NOISE = 2
    INTENSITY_NOISE = 3
    LAW = 4
    ODOMETRY = 5
    RECORDING = 6
    WORLD = 7
    PARAMETERS = 8
    IMAGES = 9
    FAILURE = 20


def stream(seed: int, repeat: int, group: int, member: int, purpose: Purpose) -> np.random.Generator:
    """The generator of one purpose of one member."""
    sequence = np.random.SeedSequence([seed, repeat, group, member, int(purpose)])
    return np.random.Generator(np.random.SFC64(sequence))
