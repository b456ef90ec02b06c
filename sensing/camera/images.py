"""The two images of a robot, taken together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
"""(H, W, 3) red, green, blue; row 0 is the top, column 0 the left."""


class Images(NamedTuple):
    """What the cameras of one robot gave at one update."""

    time: float
    """s, when the left image was taken."""
    left: Picture
    """(H, W, 3) RGB of the left camera."""
    right: Picture
    """(H, W, 3) RGB of the right camera."""
