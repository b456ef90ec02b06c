"""Starting formations: where the members of a herd stand and which way they look at first.

Figure 2.5 of Fine 2015 draws three formations of six robots without numbers; `single-group` and `split-group` are names
of its sections 4.2 and 4.3. All are centred on the origin with x along the corridor, fit between its walls, and differ
from repeat to repeat by the trial's own stream. Their numbers are choices; docs/detection.md says which formations the
case study takes, and by which sentence.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, filled
from flocking.types import Floats
from worlds import start_poses

_ATTEMPTS = 100_000
_CHOICE = "a choice: Fine 2015, figure 2.5, is drawn without numbers"

# plausible: beyond the repulsion distance, up to where the view of the next but one closes
SpacingM = Annotated[
    float, Parameter("m", f"{_CHOICE}; about three robot diameters", low=0.01, high=100.0, plausible=(0.7, 1.5))
]
# plausible: from places marked on the floor to places taken by eye
JitterM = Annotated[
    float, Parameter("m", "a choice: standard deviation of each coordinate", low=0.0, high=10.0, plausible=(0.0, 0.1))
]
# plausible: seen beside the next ahead, and clear of the walls
AsideM = Annotated[
    float,
    Parameter(
        "m",
        "a choice: from the file's middle, by turns to the left and right",
        low=0.0,
        high=50.0,
        plausible=(0.1, 0.4),
    ),
]
HeadingSpreadDeg = Annotated[
    float,
    Parameter("deg", "a choice: headings are uniform within ± this about the corridor's", low=0.0, high=180.0),
]


class SingleGroup(NamedTuple):
    """Of two columns side by side."""

    spacing_m: SpacingM = 1.0
    """Between neighbours, along and across."""
    jitter_m: JitterM = 0.05
    heading_spread_deg: HeadingSpreadDeg = 30.0


class SplitGroup(NamedTuple):
    """Of two groups of two columns each."""

    spacing_m: SpacingM = 1.0
    split_m: Annotated[
        float,
        Parameter("m", "a choice: between the groups' centres, far beyond the repulsion distance", low=0.0, high=100.0),
    ] = 4.0
    """Of groups of two rows; longer groups stand as much farther apart."""
    jitter_m: JitterM = 0.05
    heading_spread_deg: HeadingSpreadDeg = 30.0


class Scattered(NamedTuple):
    """Of members scattered over a stretch of the corridor."""

    gap_m: Annotated[float, Parameter("m", "a choice: between two centres, at the least", low=0.0, high=10.0)] = 0.6
    length_m: Annotated[
        float, Parameter("m", "a choice: of the stretch for six members; for more as much longer", low=0.1, high=1000.0)
    ] = 6.0
    half_width_m: Annotated[
        float, Parameter("m", "a choice: how far from the corridor's middle", low=0.0, high=50.0)
    ] = 0.75
    heading_spread_deg: HeadingSpreadDeg = 180.0


class SingleFile(NamedTuple):
    """Of one behind the other."""

    spacing_m: SpacingM = 1.0
    """From one member to the next."""
    jitter_m: JitterM = 0.05
    heading_spread_deg: HeadingSpreadDeg = 2.0
    """A member that goes straight on for a minute at 0.25 m/s meets no wall of the corridor up to 3.8 degrees."""


class StaggeredFile(NamedTuple):
    """Of one behind the other, by turns on the left and on the right."""

    spacing_m: SpacingM = 1.0
    """From one member to the next, along the file."""
    aside_m: AsideM = 0.25
    jitter_m: JitterM = 0.05
    heading_spread_deg: HeadingSpreadDeg = 2.0
    """As of a single file: up to 2.8 degrees."""


class SplitFile(NamedTuple):
    """Of two staggered files, one behind the other."""

    spacing_m: SpacingM = 1.0
    """From one member of a file to the next, along the file."""
    gap_m: Annotated[
        float,
        Parameter(
            "m",
            "a choice: from the front file's last to the rear's first; as in a split group",
            low=0.01,
            plausible=(2.0, 4.0),
        ),
    ] = 3.0
    aside_m: AsideM = 0.25
    jitter_m: JitterM = 0.05
    heading_spread_deg: HeadingSpreadDeg = 2.0
    """As of a staggered file."""


def single_group(given: SingleGroup, count: int, rng: np.random.Generator) -> Floats:
    """Two columns side by side, all looking along the corridor."""
    return _drawn(_block(count, given.spacing_m), given.jitter_m, given.heading_spread_deg, rng)


def split_group(given: SplitGroup, count: int, rng: np.random.Generator) -> Floats:
    """Two groups of equal size, one behind the other, all looking along the corridor."""
    front = count // 2
    rear, ahead = _block(count - front, given.spacing_m), _block(front, given.spacing_m)
    extra = max(0.0, (np.ptp(rear[:, 0]) + (np.ptp(ahead[:, 0]) if front else 0.0)) / 2 - given.spacing_m)
    rear[:, 0] -= (given.split_m + extra) / 2
    ahead[:, 0] += (given.split_m + extra) / 2
    return _drawn(np.vstack([rear, ahead]), given.jitter_m, given.heading_spread_deg, rng)


def scattered(given: Scattered, count: int, rng: np.random.Generator) -> Floats:
    """Uniformly over a stretch of the corridor, no two nearer than a gap, headings in all directions."""
    length = given.length_m * max(1.0, count / 6)
    spread = math.radians(given.heading_spread_deg)
    poses = np.empty((count, 3))
    placed = 0
    for _ in range(_ATTEMPTS):
        if placed == count:
            break
        x = rng.uniform(-length / 2, length / 2)
        y = rng.uniform(-given.half_width_m, given.half_width_m)
        if np.all(np.hypot(poses[:placed, 0] - x, poses[:placed, 1] - y) >= given.gap_m):
            poses[placed] = x, y, rng.uniform(-spread, spread)
            placed += 1
    if placed < count:
        raise InputError(f"formation 'scattered': no room for {count} members, only for {placed}")
    return poses


def single_file(given: SingleFile, count: int, rng: np.random.Generator) -> Floats:
    """One behind the other, all looking along the corridor."""
    return _drawn(_file(count, given.spacing_m, 0.0), given.jitter_m, given.heading_spread_deg, rng)


def staggered_file(given: StaggeredFile, count: int, rng: np.random.Generator) -> Floats:
    """One behind the other, by turns on the left and on the right, all looking along the corridor."""
    return _drawn(_file(count, given.spacing_m, given.aside_m), given.jitter_m, given.heading_spread_deg, rng)


def split_file(given: SplitFile, count: int, rng: np.random.Generator) -> Floats:
    """Two staggered files of equal size, one behind the other, all looking along the corridor."""
    file = _file(count, given.spacing_m, given.aside_m)
    front = count // 2
    file[:front, 0] += (given.gap_m - given.spacing_m) / 2
    file[front:, 0] -= (given.gap_m - given.spacing_m) / 2
    return _drawn(file, given.jitter_m, given.heading_spread_deg, rng)


class Formation(NamedTuple):
    """A starting formation."""

    parameters: type
    place: Callable[[Any, int, np.random.Generator], Floats]
    """(its parameters, number of members, generator) → poses (count, 3)."""


FORMATIONS: dict[str, Formation] = {
    "single-group": Formation(SingleGroup, single_group),
    "split-group": Formation(SplitGroup, split_group),
    "scattered": Formation(Scattered, scattered),
    "single-file": Formation(SingleFile, single_file),
    "staggered-file": Formation(StaggeredFile, staggered_file),
    "split-file": Formation(SplitFile, split_file),
}


def parameters_of(formation: str) -> type:
    """The declared parameters of a formation; a file of poses has none. Raises `InputError` for an unknown one."""
    if start_poses.is_file(formation):
        return start_poses.Parameters
    if formation not in FORMATIONS:
        raise unknown_name("formation", formation, FORMATIONS)
    return FORMATIONS[formation].parameters


def poses(
    formation: str, given: Mapping[str, Any], count: int, rng: np.random.Generator, prefix: str = "formation."
) -> Floats:
    """Starting poses (count, 3): x, y (m) and heading (rad). `given`: values of its parameters, by name.

    Raises `InputError` for an unknown formation or parameter, whose key begins with `prefix`.
    """
    parameters = filled(parameters_of(formation), given, prefix=prefix)
    return FORMATIONS[formation].place(parameters, count, rng)


def _block(count: int, spacing: float) -> Floats:
    """Two columns, filled from the front, centred on the origin."""
    rows = math.ceil(count / 2)
    block = np.zeros((count, 3))
    for k in range(count):
        alone = k == count - 1 and count % 2 == 1
        block[k, 0] = (rows - 1) / 2 * spacing - (k // 2) * spacing
        block[k, 1] = 0.0 if alone else (0.5 - k % 2) * spacing
    return block


def _file(count: int, spacing: float, aside: float) -> Floats:
    """One column, filled from the front, by turns on the left and right, centred on the origin."""
    file, places = np.zeros((count, 3)), np.arange(count)
    file[:, 0] = spacing * ((count - 1) / 2 - places)
    file[:, 1] = aside * (1.0 - 2.0 * (places % 2))
    return file


def _drawn(block: Floats, jitter_m: float, heading_spread_deg: float, rng: np.random.Generator) -> Floats:
    """The block with every place and heading drawn about its own."""
    spread = math.radians(heading_spread_deg)
    block[:, :2] += rng.normal(0.0, jitter_m, size=(len(block), 2))
    block[:, 2] += rng.uniform(-spread, spread, size=len(block))
    return block
