"""The links of a kinematic trial, and how well the link tension index foretold which break.

Source: Akama and Naruse 2014, equations 2 and 6 to 8, tables 1 and 2. Metres, seconds; N members at T times.

The index of every link is taken at two moments, by one or more readings of mass over stiffness. At several horizons
after each, the links of each bin of the index that are longer than the range are counted: `apart` are longer at that
moment, as the publication counts; `ever` were longer at any moment until then, which is what the index foretells.
The counts are measures of the trial whose names have a slash; those that are 0 are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, NamedTuple

import numpy as np

from flocking.measures.links import Outcomes, link_lengths, link_tension, links_within
from flocking.measures.space import shortest
from flocking.parameters import Parameter
from flocking.types import Floats, Ints
from trials.types import Measure

SOURCE = "Akama and Naruse 2014"
STARTS = (0, 1)
"""Moments at which the index is taken, in units of time."""
HORIZONS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Times after such a moment at which links are counted, in units of time."""
KINDS = ("apart", "ever")
READINGS = ("printed", "spring", "reduced")
EDGES = (-0.6, -0.4, -0.2, 0.0, 0.2, 0.5, 1.0, 2.0, 4.0)
"""Edges between the bins of the index, in rest lengths; an edge belongs to the bin below, as 0 foretells no break."""
BINS = len(EDGES) + 1
POSITIVE = EDGES.index(0.0) + 1
"""The first bin that foretells a break."""
WITHIN = 1.0 - 1e-9
"""Part of the range within which members are linked: the laws do not select members exactly at the range, as a lattice
may have them."""
MOST_HELD = 5_000_000
"""Lengths held at a time."""

ABOUT: dict[str, Measure] = {
    "links": Measure("", "links at the start: pairs of members within the range"),
    "links_foretold": Measure("", "share of these links of which the index, as printed, foretells that they break"),
    "links_broken": Measure("", "share of these links that are longer than the range after one unit of time"),
    "link_precision": Measure("", "share of the links foretold to break that are so broken"),
    "link_recall": Measure("", "share of the links so broken that were foretold to break"),
}


class Parameters(NamedTuple):
    """How the links of a trial are measured; only a trial that is given one of these has them measured."""

    range_m: Annotated[float, Parameter("m", f"{SOURCE}, equation 2: r", low=1e-9, plausible=())] = 1.6
    rest_m: Annotated[float, Parameter("m", f"{SOURCE}: the stable distance d", published=True, low=1e-9)] = 1.0
    stiffness_per_s2: Annotated[
        float,
        Parameter(
            "1/s²",
            "k_p over the mass of a member: what equation 7 drops; 0 = the law is no spring",
            low=0.0,
            plausible=(),
        ),
    ] = 0.0
    unit_s: Annotated[float, Parameter("s", f"{SOURCE}: from t = 0 to t = 1", published=True, low=1e-9)] = 1.0


class Counts(NamedTuple):
    """Links of one trial, moment, horizon and reading, by bin of the index."""

    links: Floats
    """(BINS,) all."""
    broken: Floats
    """(BINS,) those that broke."""

    def outcomes(self) -> Outcomes:
        """The contingency, as in tables 1 and 2."""
        negative, positive = slice(None, POSITIVE), slice(POSITIVE, None)
        held = self.links - self.broken
        numbers = (self.broken[positive], self.broken[negative], held[positive], held[negative])
        return Outcomes(*(round(float(number.sum())) for number in numbers))


def inertias(stiffness_per_s2: float) -> dict[str, float]:
    """Mass over stiffness, s², by reading: as printed it is 1; the spring's, with the mass of one member; and with the
    reduced mass of two free members, which is half of that."""
    if stiffness_per_s2 == 0.0:
        return {"printed": 1.0}
    return {"printed": 1.0, "spring": 1.0 / stiffness_per_s2, "reduced": 0.5 / stiffness_per_s2}


def measure(
    times: Floats, positions: Floats, velocities: Floats, given: Parameters, period_m: float | None
) -> dict[str, float]:
    """The measures of `ABOUT` and the counts of one trial, of every step of it: (T,), (T, N, 2), (T, N, 2)."""
    found: dict[str, float] = {}
    dt = float(times[1] - times[0]) if len(times) > 1 else math.inf
    for start in STARTS:
        first = round(start * given.unit_s / dt)
        if first >= len(times):
            break
        links = links_within(positions[first], given.range_m * WITHIN, period_m)
        if start == 0:
            found["links"] = float(len(links))
        bins = {}
        for reading, inertia in inertias(given.stiffness_per_s2).items():
            index = link_tension(
                positions[first], velocities[first], links, given.range_m, given.rest_m, inertia, period_m=period_m
            )
            bins[reading] = binned(index, given.rest_m)
            found |= _named(f"links/{start}/{reading}", bins[reading], BINS)
        for horizon, apart, ever in _longer(positions, links, first, given, dt, period_m):
            found[f"links/{start}/{horizon:g}"] = float(len(links))
            for kind, broken in zip(KINDS, (apart, ever), strict=True):
                for reading, of_link in bins.items():
                    found |= _named(f"links/{start}/{reading}/{horizon:g}/{kind}", of_link[broken], BINS)
    return _first_look(found) | found


def binned(index: Floats, rest_m: float) -> Ints:
    """The bin of each index (L,): (L,)."""
    return np.digitize(index / rest_m, EDGES, right=True).astype(np.int64)


def counts(
    measures: Mapping[str, float], start: int, horizon: float, kind: str = "apart", reading: str = "printed"
) -> Counts | None:
    """The counts that `measure` named; None where the trial ended before."""
    if f"links/{start}/{horizon:g}" not in measures:
        return None
    links = _read(measures, f"links/{start}/{reading}")
    return Counts(links, _read(measures, f"links/{start}/{reading}/{horizon:g}/{kind}"))


def share(part: float, whole: float) -> float:
    """`part` / `whole`; nan where `whole` is 0."""
    return part / whole if whole > 0.0 else math.nan


def _longer(
    positions: Floats, links: Ints, first: int, given: Parameters, dt: float, period_m: float | None
) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
    """For each horizon within the trial: which links (L,) are longer than the range then, and which ever were."""
    ever = np.zeros(len(links), np.bool_)
    done, limit = first, given.range_m**2
    for horizon in HORIZONS:
        last = first + max(1, round(horizon * given.unit_s / dt))
        if last >= len(positions):
            return
        x, y = np.ascontiguousarray(positions[done + 1 : last + 1].transpose(2, 1, 0))
        held = max(1, MOST_HELD // (last - done))
        for some in np.array_split(np.arange(len(links)), -(-len(links) // held) or 1):
            pairs = links[some].T
            across, up = (shortest(axis[pairs[1]] - axis[pairs[0]], period_m) for axis in (x, y))
            ever[some] |= (across * across + up * up > limit).any(axis=1)
        done = last
        apart = link_lengths(positions[last], links, period_m) > given.range_m
        yield horizon, apart, ever.copy()


def _first_look(found: Mapping[str, float]) -> dict[str, float]:
    """The measures of `ABOUT` from the counts."""
    one = counts(found, 0, 1.0)
    if one is None:
        return dict.fromkeys(ABOUT, math.nan)
    made = one.outcomes()
    foretold, broken = (
        made.broken_broken + made.intact_predicted_broken,
        made.broken_broken + made.broken_predicted_intact,
    )
    return {
        "links_foretold": share(foretold, sum(made)),
        "links_broken": share(broken, sum(made)),
        "link_precision": share(made.broken_broken, foretold),
        "link_recall": share(made.broken_broken, broken),
    }


def _named(name: str, of_link: Ints, bins: int) -> dict[str, float]:
    """How many links are in each bin, of the bins that have any."""
    numbers = np.bincount(of_link, minlength=bins)
    return {f"{name}/{b}": float(n) for b, n in enumerate(numbers) if n}


def _read(measures: Mapping[str, float], name: str) -> Floats:
    return np.array([measures.get(f"{name}/{b}", 0.0) for b in range(BINS)])
