"""A Galton board: a funnel, rows of pegs in a triangle, and bins below them.

Source: Fine 2015, section 6.1.2 and figure 6.3, which is a picture without numbers: all values are a choice, in units
of the splitting grammar. The herd comes down, along -y, through the funnel onto the first peg, which stands at the
origin. A member that turns left or right at each peg with equal chance ends in a bin with its binomial probability.
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter
from generation.environment import START, Environment, Mark
from generation.primitives import Circle, Point, Polygon, Polyline, Segment
from generation.workspaces import built

CHOICE = "a choice: Fine 2015, figure 6.3, has no numbers"
FILTER = "passage"
BEHAVIOUR = "simple-split"


class Parameters(NamedTuple):
    """The board."""

    rows: Annotated[int, Parameter("", CHOICE, low=1, high=40)] = 6
    """Rows of pegs; there is one bin more."""
    spacing_m: Annotated[float, Parameter("m", CHOICE, low=0.1, high=1000.0)] = 40.0
    """From peg to peg in a row, and width of a bin."""
    row_m: Annotated[float, Parameter("m", CHOICE, low=0.1, high=1000.0)] = 34.64
    """From row to row: by default pegs stand in triangles of equal sides."""
    peg_m: Annotated[float, Parameter("m", CHOICE, low=0.001, high=500.0)] = 6.0
    """Radius of a peg: less than half the spacing."""
    gap_m: Annotated[float, Parameter("m", CHOICE, low=0.01, high=1000.0)] = 20.0
    """Opening of the funnel: at most the width of the board."""
    bin_m: Annotated[float, Parameter("m", CHOICE, low=0.01, high=1000.0)] = 60.0
    """Depth of the bins."""


def workspace() -> Environment:
    """Nothing stands there."""
    return Environment()


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The board, its bins as areas `bin-1` to `bin-N` from the left, a goal line across all; nothing is drawn.

    Raises `InputError` for pegs that touch and for a funnel that is wider than the board.
    """
    rows, spacing, row, peg, gap, depth = parameters
    if 2.0 * peg >= spacing:
        raise InputError(f"peg_m = {peg:g}: expected less than half of spacing_m ({spacing / 2:g}), or pegs touch")
    half = (rows + 1) * spacing / 2
    if gap > 2.0 * half:
        raise InputError(f"gap_m = {gap:g}: expected at most the width of the board ({2 * half:g} m)")
    pegs = [Circle((k - level / 2) * spacing, -level * row, peg) for level in range(rows) for k in range(level + 1)]
    mouth = peg + row
    top, bottom = mouth + half - gap / 2, -rows * row - depth
    edges = [k * spacing - half for k in range(rows + 2)]
    box = Polyline(((-half, top), (-half, bottom), (half, bottom), (half, top)))
    funnel = [Segment(side * half, top, side * gap / 2, mouth) for side in (-1.0, 1.0) if gap < 2.0 * half]
    dividers = [Segment(x, bottom, x, bottom + depth) for x in edges[1:-1]]
    bins: dict[str, Mark] = {
        f"bin-{number}": Polygon(
            ((left, bottom), (right, bottom), (right, bottom + depth), (left, bottom + depth)), "both"
        )
        for number, (left, right) in enumerate(itertools.pairwise(edges), 1)
    }
    goal = Segment(-half, bottom + depth / 2, half, bottom + depth / 2)
    markers = {START: Point(0.0, top, -math.pi / 2), "goal": goal, **bins}
    return built(Environment(workspace.workspace, workspace.construct, {**workspace.markers, **markers}), box, *funnel,
                 *pegs, *dividers)  # fmt: skip
