"""A search of one budget: its points, its curve, its archive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats, Ints
from generation.searches.methods import Answer, Grid, Proposals

Judge = Callable[[Floats], Answer]
"""Points (n, d) of the unit cube → what came of them."""


@dataclass(frozen=True)
class Search:
    """P points in the order in which they were judged."""

    points: Floats
    """(P, d) of the unit cube."""
    values: Floats
    """(P,)."""
    descriptors: Floats
    """(P, D)."""

    @property
    def best(self) -> int:
        """The first of the best points."""
        return int(np.argmax(self.values))

    def incumbents(self) -> Ints:
        """(I,) the points that were better than all before them."""
        highest = np.maximum.accumulate(self.values)
        return np.flatnonzero(np.diff(highest, prepend=-np.inf) > 0.0)

    def holders(self) -> Ints:
        """(P,) of each moment of the search, which incumbent was the best so far: an index of `incumbents`."""
        return np.searchsorted(self.incumbents(), np.arange(len(self.values)), side="right") - 1

    def elites(self, grid: Grid) -> tuple[Ints, Ints]:
        """The filled cells (F,), numbered with the last descriptor fastest, and the best point (F,) of each."""
        cells = cells_of(self.descriptors, grid)
        order = np.lexsort((np.arange(len(cells)), -self.values, cells))
        filled, first = np.unique(cells[order], return_index=True)
        return filled, order[first]


def search(proposals: Proposals, judge: Judge, points: int) -> Search:
    """The search of exactly so many points. What a method proposes beyond them is cut off, and it is not told."""
    if points < 1:
        raise InputError(f"{points} points: expected a budget for at least 1")
    asked: list[Floats] = []
    answers: list[Answer] = []
    done, batch = 0, next(proposals)
    while True:
        batch = batch[: points - done]
        asked.append(batch)
        answers.append(judge(batch))
        done += len(batch)
        if done == points:
            break
        batch = proposals.send(answers[-1])
    proposals.close()
    return Search(
        np.concatenate(asked),
        np.concatenate([answer.values for answer in answers]),
        np.concatenate([answer.descriptors for answer in answers]),
    )


def cells_of(descriptors: Floats, grid: Grid) -> Ints:
    """(P,) the cell of each row of descriptors (P, D); what lies beyond the bounds is in the outermost cells."""
    low, high = grid.bounds.T
    cells = np.array(grid.cells)
    inside = np.clip(((descriptors - low) / (high - low) * cells).astype(np.int64), 0, cells - 1)
    return np.asarray(np.ravel_multi_index(tuple(inside.T), grid.cells), np.int64)


def coverage(filled: Ints, grid: Grid) -> float:
    """Share of an archive's cells that are filled."""
    return len(filled) / int(np.prod(grid.cells))


def qd_score(values: Floats) -> float:
    """Sum of the elites' values (F,), none of them negative (Pugh et al. 2016)."""
    return float(np.sum(values))
