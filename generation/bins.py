"""What falls through a Galton board, and in which bins it ends, beside the binomial distribution.

Frame and sizes are those of the schema `galton`: down is -y, the first peg stands at the origin. The binomial is that
of a grain which turns left or right at each row with equal chance, whatever it did before.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from scipy import stats

from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import Floats, Ints
from generation.environment import Environment
from generation.primitives import Circle, Polygon, Segment

NOWHERE = -1
"""The bin of what is in none."""


class Grains(NamedTuple):
    """Discs without friction or spin that fall, each alone, and bounce off pegs and side walls."""

    radius_m: Annotated[float, Parameter("m", "a choice: two thirds of the way between default pegs", low=0.0)] = 9.5

    gravity_m_s2: Annotated[float, Parameter("m/s²", "standard gravity", low=0.01)] = 9.81
    restitution: Annotated[float, Parameter("", "a choice: steel on wood, about", low=0.0, high=1.0)] = 0.4
    """Of the speed along a peg's normal, how much is left after a bounce."""
    scatter_rad: Annotated[float, Parameter("rad", "a choice: pegs and grains are rough", low=0.0, high=3.0)] = 0.5
    """Standard deviation of the angle by which a bounce's normal is turned."""
    dt_s: Annotated[float, Parameter("s", "a choice", low=1e-5, high=0.1)] = 0.01
    most_s: Annotated[float, Parameter("s", "a choice", low=0.1)] = 200.0
    """Who has not fallen through by then stays in no bin."""


class Comparison(NamedTuple):
    """Members in bins, beside the binomial distribution."""

    counts: Ints
    """(B,) in each bin, from the left."""
    nowhere: int
    """In none."""
    distance: float
    """Total variation distance of the shares from the binomial: 0 where they are it, at most 1; nan without members."""
    p: float
    """Of a chi-square test that independent members are dealt out so; bins with fewer than five expected are joined.

    Members of a flock are not independent: there it says no more than that they are not grains. Nan where too few fell.
    """


def fallen(environment: Environment, count: int, rng: np.random.Generator, given: Grains = Grains()) -> Ints:  # noqa: B008
    """(count,) the bins of grains, from 0 on the left, that start at rest anywhere in the funnel's opening.

    Raises `InputError` for what is no Galton board, and where they do not fit between its pegs or into its funnel.
    """
    areas, pegs, half, gap, mouth = _board(environment)
    reach, half, gap = pegs[:, 2] + given.radius_m, half - given.radius_m, gap - 2.0 * given.radius_m
    if gap <= 0.0:
        raise InputError(f"grains of radius {given.radius_m:g} m do not fit the funnel's opening")
    edges = np.array([areas[0][0], *(right for _, right, _ in areas)])
    top = areas[0][2]
    x, y = rng.uniform(-gap / 2, gap / 2, count), np.full(count, mouth)
    vx, vy = np.zeros(count), np.zeros(count)
    found = np.full(count, NOWHERE, dtype=np.int64)
    left = np.arange(count)
    for _ in range(round(given.most_s / given.dt_s)):
        x, vy = x + vx * given.dt_s, vy - given.gravity_m_s2 * given.dt_s
        y = y + vy * given.dt_s
        vx = np.where(np.abs(x) > half, -np.sign(x) * np.abs(vx) * given.restitution, vx)
        x = np.clip(x, -half, half)
        dx, dy = x[:, None] - pegs[:, 0], y[:, None] - pegs[:, 1]
        row, peg = np.nonzero(dx * dx + dy * dy < reach**2)
        away = np.maximum(np.hypot(dx[row, peg], dy[row, peg]), 1e-12)
        nx, ny = dx[row, peg] / away, dy[row, peg] / away
        x[row], y[row] = pegs[peg, 0] + reach[peg] * nx, pegs[peg, 1] + reach[peg] * ny
        turned = given.scatter_rad * rng.standard_normal(len(row))
        c, s = np.cos(turned), np.sin(turned)
        nx, ny = c * nx - s * ny, s * nx + c * ny
        towards = np.minimum(vx[row] * nx + vy[row] * ny, 0.0) * (1.0 + given.restitution)
        vx[row] -= towards * nx
        vy[row] -= towards * ny
        through = y < top
        found[left[through]] = np.clip(np.searchsorted(edges, x[through], side="right") - 1, 0, len(areas) - 1)
        x, y, vx, vy = (each[~through] for each in (x, y, vx, vy))
        left = left[~through]
        if len(left) == 0:
            break
    return found


def sunk(environment: Environment, count: int, rng: np.random.Generator, radius_m: float = Grains().radius_m) -> Ints:
    """(count,) the bins of grains without inertia, as in syrup: they sink, and go round each peg that they meet.

    Whether to its left or to its right is even chance. They start anywhere in the funnel's opening. A grain meets one
    peg in each row where the radii of peg and grain are more than a quarter of the spacing together. Raises
    `InputError` as `fallen`.
    """
    areas, pegs, _, gap, mouth = _board(environment)
    reach = pegs[:, 2] + radius_m
    if gap <= 2.0 * radius_m:
        raise InputError(f"grains of radius {radius_m:g} m do not fit the funnel's opening")
    edges = np.array([areas[0][0], *(right for _, right, _ in areas)])
    x, y = rng.uniform(-gap / 2 + radius_m, gap / 2 - radius_m, count), np.full(count, mouth)
    while True:
        meets = (np.abs(x[:, None] - pegs[:, 0]) < reach - 1e-9) & (pegs[:, 1] < y[:, None])
        height = np.where(meets, pegs[:, 1], -np.inf)
        first, met = height.argmax(axis=1), meets.any(axis=1)
        if not met.any():
            return np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(areas) - 1)
        side = np.where(rng.random(count) < 0.5, -1.0, 1.0)
        x = np.where(met, pegs[first, 0] + side * reach[first], x)
        y = np.where(met, pegs[first, 1], y)


def bins_of(environment: Environment, positions: Floats) -> Ints:
    """(N,) the bin of each member (N, 2), from 0 on the left; `NOWHERE` of those in none."""
    found = np.full(len(positions), NOWHERE, dtype=np.int64)
    for number, (left, right, top) in enumerate(_areas(environment)):
        x, y = positions.T
        found[(x >= left) & (x < right) & (y <= top)] = number
    return found


def compared(bins: Ints, count: int) -> Comparison:
    """Members' bins (N,) beside the binomial distribution over `count` bins, that of one row less."""
    counts = np.bincount(bins[bins >= 0], minlength=count)
    total = int(counts.sum())
    expected = stats.binom.pmf(np.arange(count), count - 1, 0.5)
    if total == 0:
        return Comparison(counts, len(bins), np.nan, np.nan)
    distance = float(np.abs(counts / total - expected).sum() / 2)
    return Comparison(counts, len(bins) - total, distance, _chi_square(counts, total * expected))


def _chi_square(counts: Ints, expected: Floats) -> float:
    """The test's p; the outer bins are joined with their neighbours until at least five are expected in each."""
    seen, awaited = list(map(float, counts)), list(map(float, expected))
    for end, inner in ((0, 1), (-1, -2)):
        while len(awaited) > 1 and awaited[end] < 5.0:
            seen[inner] += seen[end]
            awaited[inner] += awaited[end]
            del seen[end], awaited[end]
    return float(stats.chisquare(seen, awaited).pvalue) if len(awaited) > 1 else np.nan


def _areas(environment: Environment) -> list[tuple[float, float, float]]:
    """Left edge, right edge and top of each bin, from the left."""
    areas = [mark for name, mark in environment.markers.items() if name.startswith("bin-")]
    found = [np.array(area.corners_m) for area in areas if isinstance(area, Polygon)]
    if len(found) < 2:
        raise InputError("the environment has no bins; expected areas bin-1, bin-2 … as of the schema galton")
    boxes = [(*corners.min(axis=0), *corners.max(axis=0)) for corners in found]
    return sorted((float(left), float(right), float(top)) for left, _, right, top in boxes)


def _board(environment: Environment) -> tuple[list[tuple[float, float, float]], Floats, float, float, float]:
    """Bins; pegs (P, 3) x, y, radius; half the width; the funnel's opening and where it is along y."""
    areas = _areas(environment)
    pegs = np.array([(peg.x_m, peg.y_m, peg.radius_m) for peg in environment.construct if isinstance(peg, Circle)])
    sides = [part for part in environment.construct if isinstance(part, Segment) and part.x0_m != part.x1_m]
    if len(pegs) == 0 or len(sides) != 2:
        raise InputError("the environment has no pegs or no funnel; expected a board of the schema galton")
    gap = 2.0 * min(abs(part.x1_m) for part in sides)
    return areas, pegs, areas[-1][1], gap, sides[0].y1_m
