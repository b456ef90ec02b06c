"""How a search proposes points: at random, by CMA-ES, or by a quality-diversity archive.

Each method is a generator: it yields points (n, d) of the unit cube and is sent what came of them, their values (n,),
of which more is better, and their descriptors (n, D). It never ends: the budget does (`searching`).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from flocking.types import Floats
from generation.searches.spaces import Space

BATCH = 8
"""Points of one proposal of the random search and of each emitter. A choice: CMA-ES's own is 6 of two parameters."""
SIGMA = 0.3
"""First step of CMA-ES and of the emitters, of the unit cube: Hansen's tutorial (arXiv:1604.00772, section B.2)."""
MUTATION = 0.1
"""Standard deviation of a Gaussian emitter's steps, of the unit cube. A choice."""
EMITTERS = 2
"""Emitters of one archive. A choice: a budget of a few hundred points does not feed more."""
MOST_SEED = 2**31 - 1


class Answer(NamedTuple):
    """What came of n points."""

    values: Floats
    """(n,) more is better."""
    descriptors: Floats
    """(n, D) finite."""


class Grid(NamedTuple):
    """The cells of an archive."""

    bounds: Floats
    """(D, 2)."""
    cells: tuple[int, ...]
    """(D,) along each descriptor."""


Proposals = Generator[Floats, Answer, None]
Method = Callable[[Space, Grid, np.random.Generator], Proposals]


def uniform(space: Space, grid: Grid, rng: np.random.Generator) -> Proposals:
    """Uniformly at random: what each method is held against."""
    while True:
        yield rng.random((BATCH, len(space.axes)))


def cma_es(space: Space, grid: Grid, rng: np.random.Generator) -> Proposals:
    """CMA-ES (Hansen & Ostermeier 2001; library `cma`), begun anew at a random point wherever it has come to an end.

    One parameter alone gets a second coordinate that nothing depends on, as the library needs two.
    """
    import cma  # it takes a second

    d = len(space.axes)
    wraps = np.append(space.wraps, [False] * (d == 1))
    limits = [[None if wrap else bound for wrap in wraps] for bound in (0.0, 1.0)]
    options = {
        "bounds": limits, "randn": lambda *shape: rng.standard_normal(shape), "seed": np.nan, "verbose": -9,
        "verb_log": 0,
    }  # fmt: skip
    while True:
        strategy = cma.CMAEvolutionStrategy(rng.random(len(wraps)), SIGMA, options)
        while not strategy.stop():
            asked = np.array(strategy.ask())
            answer = yield space.folded(asked[:, :d])
            strategy.tell(list(asked), (-answer.values).tolist())


def cma_me(space: Space, grid: Grid, rng: np.random.Generator) -> Proposals:
    """CMA-ME (Fontaine et al. 2020; library `ribs`): each emitter is a CMA-ES that seeks to improve the archive."""
    from ribs.emitters import EvolutionStrategyEmitter

    def emitter(archive: Any, bounds: Any) -> Any:
        start = rng.random(len(space.axes))
        return EvolutionStrategyEmitter(
            archive, x0=start, sigma0=SIGMA, ranker="2imp", bounds=bounds, batch_size=BATCH, seed=_seed(rng)
        )

    return _archived(space, grid, rng, emitter)


def map_elites(space: Space, grid: Grid, rng: np.random.Generator) -> Proposals:
    """MAP-Elites (Mouret & Clune 2015; library `ribs`): elites are mutated by Gaussian steps, after a random batch."""
    from ribs.emitters import GaussianEmitter

    def emitter(archive: Any, bounds: Any) -> Any:
        start = rng.random((BATCH, len(space.axes)))
        return GaussianEmitter(
            archive, sigma=MUTATION, initial_solutions=start, bounds=bounds, batch_size=BATCH, seed=_seed(rng)
        )

    return _archived(space, grid, rng, emitter)


METHODS: Mapping[str, Method] = MappingProxyType(
    {"random": uniform, "cma-es": cma_es, "cma-me": cma_me, "map-elites": map_elites}
)
"""By name."""


def _archived(space: Space, grid: Grid, rng: np.random.Generator, emitter: Callable[[Any, Any], Any]) -> Proposals:
    from ribs.archives import GridArchive
    from ribs.schedulers import Scheduler

    archive = GridArchive(
        solution_dim=len(space.axes), dims=grid.cells, ranges=[tuple(pair) for pair in grid.bounds], seed=_seed(rng)
    )
    bounds = [(None, None) if wraps else (0.0, 1.0) for wraps in space.wraps]
    scheduler = Scheduler(archive, [emitter(archive, bounds) for _ in range(EMITTERS)])
    while True:
        answer = yield space.folded(scheduler.ask())
        scheduler.tell(answer.values, answer.descriptors)


def _seed(rng: np.random.Generator) -> int:
    return int(rng.integers(MOST_SEED))
