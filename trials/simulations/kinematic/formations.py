"""Where the members of a kinematic herd stand at the start, and where the walls of its world are. Metres, radians.

`single-group` and `split-group` are the starts of Fine 2015, section 4.3, which gives no numbers: the spread of table
4.1's two groups (4.95) is half the distance between them.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats


def poses(formation: str, parameters: tuple[float, ...], count: int, size_m: float, rng: np.random.Generator) -> Floats:
    """(count, 3) starting poses in the square [0, size_m]², or about the origin where `size_m` is not finite.

    `parameters` are those of the formation (`fields`). Raises `InputError` if it does not fit in.
    """
    named = parameters._asdict()  # type: ignore[attr-defined]
    if formation == "uniform":
        side = size_m if math.isfinite(size_m) else named["spacing_m"] * math.sqrt(count)
        places = _square(count, side, rng)
    elif formation == "single-group":
        places = _square(count, named["spacing_m"] * math.sqrt(count), rng)
    elif formation == "split-group":
        half = count // 2
        places = _square(count, 1.0, rng)
        places[:half] *= named["spacing_m"] * math.sqrt(max(half, 1))
        places[half:] *= named["spacing_m"] * math.sqrt(count - half)
        places[:half, 0] -= named["gap_m"] / 2.0
        places[half:, 0] += named["gap_m"] / 2.0
    else:
        places = lattice(count, named["spacing_m"], triangular=formation == "triangular-lattice")
        places += named["jitter_m"] * rng.uniform(-1.0, 1.0, (count, 2))
    spread = math.radians(named["heading_spread_deg"])
    headings = rng.uniform(-spread, spread, count)
    if math.isfinite(size_m):
        places += size_m / 2.0
        if (places < 0.0).any() or (places > size_m).any():
            needed = float(np.abs(places - size_m / 2.0).max()) * 2.0
            raise InputError(
                f"formation {formation!r} is {needed:.4g} m wide, the world {size_m:.4g} m; "
                f"expected a wider one: --set world.size_m={math.ceil(needed)}"
            )
    return np.column_stack([places, headings])


def widest_m(formation: str, parameters: tuple[float, ...], count: int) -> float:
    """The most that a formation can be wide or long about its world's centre, m: twice the farthest coordinate.

    Not of `uniform`, which fills its world, whatever that is.
    """
    named = parameters._asdict()  # type: ignore[attr-defined]
    spacing = float(named["spacing_m"])
    if formation == "single-group":
        return spacing * math.sqrt(count)
    if formation == "split-group":
        return float(named["gap_m"]) + spacing * math.sqrt(max(count - count // 2, 1))
    return 2.0 * (float(np.abs(lattice(count, spacing, formation == "triangular-lattice")).max()) + named["jitter_m"])


def lattice(count: int, spacing_m: float, triangular: bool) -> Floats:
    """(count, 2) points of a lattice about the origin, row by row, as square as the count permits."""
    height = math.sqrt(3.0) / 2.0 if triangular else 1.0
    columns = max(1, round(math.sqrt(count * height)))
    numbers = np.arange(count)
    rows = numbers // columns
    shift = 0.5 * (rows % 2) if triangular else 0.0
    places = np.column_stack([numbers % columns + shift, rows * height]).astype(np.float64)
    centred: Floats = (places - places.mean(axis=0)) * spacing_m
    return centred


def walls(count: int, length_m: float, size_m: float, rng: np.random.Generator) -> Floats:
    """(count, 4) pieces of wall in the square [0, size_m]², their middles uniform in it, in all directions."""
    middles, angles = rng.uniform(0.0, size_m, (count, 2)), rng.uniform(0.0, math.pi, count)
    along = 0.5 * length_m * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.clip(np.column_stack([middles - along, middles + along]), 0.0, size_m)


def _square(count: int, side: float, rng: np.random.Generator) -> Floats:
    return rng.uniform(-side / 2.0, side / 2.0, (count, 2))
