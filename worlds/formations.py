"""Starting formations: where the members of a herd stand and which way they look at first.

Figure 2.5 of Fine 2015 draws three formations of six robots without numbers. `single-group` and `split-group` are names
of sections 4.2 and 4.3; the third is a choice. All are centred on the origin with x along the corridor, fit between its
walls, and differ from repeat to repeat by the trial's own stream.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.types import Floats

SPACING = 1.0
"""m between neighbours: about three robot diameters. A choice."""
JITTER = 0.05
"""m, standard deviation of each coordinate. A choice."""
HEADING_SPREAD = math.radians(30.0)
"""rad: headings are drawn uniformly within ± this about the formation's. A choice."""
SPLIT = 4.0
"""m between the centres of the two groups: within the laser's range, far beyond the repulsion distance. A choice."""
SCATTER_LENGTH = 6.0
"""m of corridor over which six scattered members stand (more members: as much longer). A choice."""
SCATTER_HALF_WIDTH = 0.75
"""m from the corridor's middle. A choice."""
SCATTER_GAP = 0.6
"""m between the centres of scattered members, at the least. A choice."""
_ATTEMPTS = 100_000


def single_group(count: int, rng: np.random.Generator) -> Floats:
    """Two columns side by side, all looking along the corridor."""
    return _jittered(_block(count), rng)


def split_group(count: int, rng: np.random.Generator) -> Floats:
    """Two groups of equal size, one behind the other, all looking along the corridor."""
    front = count // 2
    rear, ahead = _block(count - front), _block(front)
    extra = max(0.0, (np.ptp(rear[:, 0]) + (np.ptp(ahead[:, 0]) if front else 0.0)) / 2 - SPACING)
    rear[:, 0] -= (SPLIT + extra) / 2
    ahead[:, 0] += (SPLIT + extra) / 2
    return _jittered(np.vstack([rear, ahead]), rng)


def scattered(count: int, rng: np.random.Generator) -> Floats:
    """Uniformly over a stretch of the corridor, no two nearer than a gap, headings in all directions."""
    length = SCATTER_LENGTH * max(1.0, count / 6)
    poses = np.empty((count, 3))
    placed = 0
    for _ in range(_ATTEMPTS):
        if placed == count:
            break
        x = rng.uniform(-length / 2, length / 2)
        y = rng.uniform(-SCATTER_HALF_WIDTH, SCATTER_HALF_WIDTH)
        if np.all(np.hypot(poses[:placed, 0] - x, poses[:placed, 1] - y) >= SCATTER_GAP):
            poses[placed] = x, y, rng.uniform(-math.pi, math.pi)
            placed += 1
    if placed < count:
        raise InputError(f"formation 'scattered': no room for {count} members, only for {placed}")
    return poses


FORMATIONS: dict[str, Callable[[int, np.random.Generator], Floats]] = {
    "single-group": single_group,
    "split-group": split_group,
    "scattered": scattered,
}


def poses(formation: str, count: int, rng: np.random.Generator) -> Floats:
    """Starting poses (count, 3): x, y, heading. Raises `InputError` for an unknown formation."""
    if formation not in FORMATIONS:
        raise unknown_name("formation", formation, FORMATIONS)
    return FORMATIONS[formation](count, rng)


def _block(count: int) -> Floats:
    """Two columns, filled from the front, centred on the origin."""
    rows = math.ceil(count / 2)
    block = np.zeros((count, 3))
    for k in range(count):
        alone = k == count - 1 and count % 2 == 1
        block[k, 0] = (rows - 1) / 2 * SPACING - (k // 2) * SPACING
        block[k, 1] = 0.0 if alone else (0.5 - k % 2) * SPACING
    return block


def _jittered(block: Floats, rng: np.random.Generator) -> Floats:
    block[:, :2] += rng.normal(0.0, JITTER, size=(len(block), 2))
    block[:, 2] += rng.uniform(-HEADING_SPREAD, HEADING_SPREAD, size=len(block))
    return block
