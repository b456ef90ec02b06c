"""Maps by refinement around successes, in 2^d-trees, and by random sampling.

Source: Fine 2015, section 7.4.2: a grid-based search whose resolution is adjusted on the basis of success, similar to
the quad-trees of Samet 1980. The document leaves open what is split. Here it is each cell whose configuration, that in
its middle, was successful, and each cell that shares a face with such a one, so that a region can grow beyond the cells
that found it; but, as in a quad-tree, no cell that agrees with all its neighbours (`EDGES`), as it is told apart from
nothing. `ALL` splits successful cells inside of a region as well: four times as many configurations a level instead of
twice. A split cell is replaced by its 2^d halves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats, Ints
from generation.maps.spaces import Box

EDGES, ALL = SPLITS = ("edges", "all")
"""Which successful cells are split, and their neighbours with them: those at the edge of a region, or all."""
NOWHERE = -1
"""The level of a configuration that stands in no cell: one of random sampling."""


class Judged(NamedTuple):
    """What is known of C configurations."""

    trials: Ints
    """(C,) simulations; 0 where the schema makes nothing of the parameters."""
    successes: Ints
    """(C,) of them, those that showed the behaviour."""
    fitness: Floats
    """(C,) mean over the simulations; nan where there were none."""
    x_deviation: Floats
    """(C,) standard deviation of the members along x at the end, m, likewise."""


Judge = Callable[[Floats, Ints, Ints], Judged]
"""Points (C, d), their levels (C,), and their cells (C, d), which name their random numbers: what came of them."""


class StoppedError(Exception):
    """Somebody wants no more configurations judged: a map ends with the iterations before."""


@dataclass(frozen=True)
class ParameterMap:
    """C configurations of a box, in the order in which they were judged."""

    box: Box
    points: Floats
    """(C, d)."""
    levels: Ints
    """(C,) 0 = the first iteration; `NOWHERE` for a random one."""
    cells: Ints
    """(C, d) the cell at that level; a random one's number in the first place."""
    judged: Judged
    reliable: float
    """Share of successes from which a configuration is successful."""

    @property
    def possible(self) -> Bools:
        """(C,) whether the schema makes something of the parameters."""
        return self.judged.trials > 0

    @property
    def successful(self) -> Bools:
        """(C,) whether the behaviour shows reliably: + in the document's figures, the others are dots."""
        return is_reliable(self.judged, self.reliable)

    @property
    def finest(self) -> int:
        """The deepest level."""
        return max(0, int(self.levels.max(initial=0)))


def is_reliable(judged: Judged, reliable: float) -> Bools:
    """(C,) whether at least that share of the simulations showed the behaviour. Rounding is forgiven."""
    found: Bools = (judged.trials > 0) & (judged.successes >= reliable * judged.trials - 1e-9)
    return found


def refined(
    box: Box,
    judge: Judge,
    refinements: int,
    reliable: float,
    budget: int,
    rng: np.random.Generator,
    splits: str = EDGES,
) -> ParameterMap:
    """The map of the first iteration's grid and of so many refinements around successful configurations.

    `budget`: most configurations, 0 = any number. Where it does not reach for a level, those that it does reach for are
    drawn at random, so that no part of the space is preferred, and the map ends there. A `StoppedError` of `judge` ends
    it with the iterations before; in the first one it is raised on.
    """
    for level in (0, refinements):
        box.shape(level)
    leaves = _grid(box.shape(0))
    levels = np.zeros(len(leaves), np.int64)
    parts: list[tuple[Ints, Ints, Judged]] = []
    good = np.zeros(0, np.bool_)
    done = 0
    for level in range(refinements + 1):
        if level:
            split = _to_split(box, leaves, levels, good, level - 1, splits)
            if not split.any():
                break
            children, deeper = _halves(leaves[split]), np.repeat(levels[split] + 1, 2 ** len(box.axes))
            leaves, levels, good = leaves[~split], levels[~split], good[~split]
        else:
            children, deeper = leaves, levels
            leaves, levels = leaves[:0], levels[:0]
        short = bool(budget) and done + len(children) > budget
        if short:
            picked = np.sort(rng.permutation(len(children))[: budget - done])
            children, deeper = children[picked], deeper[picked]
        try:
            judged = judge(_middles(box, children, deeper), deeper, children)
        except StoppedError:
            if not parts:
                raise
            break
        parts.append((deeper, children, judged))
        done += len(children)
        leaves, levels = np.concatenate([leaves, children]), np.concatenate([levels, deeper])
        good = np.concatenate([good, is_reliable(judged, reliable)])
        if short:
            break
    levels, cells = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    judged = Judged(*(np.concatenate(arrays) for arrays in zip(*(part[2] for part in parts), strict=True)))
    return ParameterMap(box, _middles(box, cells, levels), levels, cells, judged, reliable)


def scattered(box: Box, judge: Judge, count: int, reliable: float, rng: np.random.Generator) -> ParameterMap:
    """The map of so many configurations drawn uniformly from the box."""
    points = box.lows + box.spans * rng.random((count, len(box.axes)))
    levels, cells = np.full(count, NOWHERE), np.zeros((count, len(box.axes)), np.int64)
    cells[:, 0] = np.arange(count)
    return ParameterMap(box, points, levels, cells, judge(points, levels, cells), reliable)


def _grid(shape: tuple[int, ...]) -> Ints:
    """(C, d) all cells, the last axis fastest."""
    return np.stack(np.unravel_index(np.arange(int(np.prod(shape))), shape), axis=-1).astype(np.int64)


def _middles(box: Box, cells: Ints, levels: Ints) -> Floats:
    found = np.empty(cells.shape)
    for level in np.unique(levels):
        at = levels == level
        found[at] = box.centres(int(level), cells[at])
    return found


def _halves(cells: Ints) -> Ints:
    """(C 2^d, d) the halves of cells (C, d), one level deeper."""
    found: Ints = (2 * cells[:, None, :] + _grid((2,) * cells.shape[1])).reshape(-1, cells.shape[1])
    return found


def painted(box: Box, cells: Ints, levels: Ints, level: int) -> Ints:
    """The number of the cell that covers each cell of a deeper level, -1 = none. Deeper cells cover shallower ones."""
    found = np.full(box.shape(level), -1, np.int64)
    d = cells.shape[1]
    for each in np.unique(levels):
        at = np.flatnonzero(levels == each)
        size = 1 << (level - int(each))
        offsets = _grid((size,) * d)
        places = cells[at][:, None, :] * size + offsets
        found[tuple(places.reshape(-1, d).T)] = np.repeat(at, len(offsets))
    return found


def _to_split(box: Box, leaves: Ints, levels: Ints, good: Bools, level: int, splits: str) -> Bools:
    """(C,) which leaves are successful or share a face with a successful one; with `EDGES`, only where both meet."""
    owner = painted(box, leaves, levels, level)
    success = np.append(good, False)[owner]
    if splits == ALL:
        chosen = success | _beside(box, success)
    else:
        chosen = (success & _beside(box, ~success & (owner >= 0))) | (~success & _beside(box, success))
    split = np.zeros(len(leaves) + 1, np.bool_)
    split[owner[chosen]] = True
    return split[:-1]


def _beside(box: Box, mask: Bools) -> Bools:
    """Which cells share a face with one of the mask's."""
    near = np.zeros_like(mask)
    for axis in range(mask.ndim):
        for step in (1, -1):
            moved = np.roll(mask, step, axis)
            if not box.axes[axis].wraps:
                edge = [slice(None)] * mask.ndim
                edge[axis] = slice(0, 1) if step == 1 else slice(-1, None)
                moved[tuple(edge)] = False
            near |= moved
    return near
