"""Two configurations that hardly differ and whose outcomes do: how small a perturbation flips what the herd does.

Source: Fine 2015, figure 7.7, which shows the workspace alone and two such environments.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from generation.maps.trees import ParameterMap


def flip(map_: ParameterMap) -> tuple[int, int] | None:
    """The numbers of the two nearest configurations of which one is successful and the other reliably fails.

    Near is in shares of the box's sides; reliably fails who has at most as small a share of successes as the successful
    have of failures. None where there are no such two.
    """
    judged = map_.judged
    fails = map_.possible & (judged.trials - judged.successes >= map_.reliable * judged.trials - 1e-9)
    good, bad = np.flatnonzero(map_.successful), np.flatnonzero(fails)
    if not len(good) or not len(bad):
        return None
    places = (map_.points - map_.box.lows) / map_.box.spans
    turns = np.where(map_.box.wraps, 1.0, 4.0)  # a period of four sides joins nothing
    distances, nearest = cKDTree(np.mod(places[bad], turns), boxsize=turns).query(np.mod(places[good], turns))
    best = int(np.argmin(distances))
    return int(good[best]), int(bad[nearest[best]])
