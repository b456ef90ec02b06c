"""A Galton board beside the binomial distribution: coins, grains, and flocks that come through the funnel.

    python -m scripts.galton [--grains 5000] [--herds 20] [--members 25] [--laws A,B]

A flock is a kinematic herd that starts in the throat of the funnel, heading down. Nothing else drives those of
`--laws`. Those of `DRIVEN` run Couzin's law, and all their members prefer the direction down: they see one another
as far as in the splitting grammar's herds or hardly at all, and go straight or turn at random at each step. Flocks are
counted after `ITERATIONS` at 2 m each. Members that are above the bins by then are in none. To flocks, pegs are
polygons.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
from typing import Any

import numpy as np

from generation.bins import Comparison, bins_of, compared, fallen, sunk
from generation.environment import Environment
from generation.group import Job
from generation.primitives import Circle, Polygon, Primitive
from generation.schemas import galton
from generation.validation.kinematic import kinematic

ITERATIONS = 200
CORNERS = 12
"""Of a peg as flocks meet it. A choice: the millimetre that circles are straightened to is no use at this scale."""


DOWN = {"goal_x_m": 0.0, "goal_y_m": -1e9}
"""A goal that far away is a direction."""
TOGETHER = {"alpha_m": 4.0, "rho_m": 25.0, "omega": 1.0, "speed_m_s": 2.0}
APART = {**TOGETHER, "alpha_m": 1.0, "rho_m": 1.0}
WAVERING = {"noise_rad": 0.5}
"""Standard deviation of each step's turn: a choice."""
DRIVEN = {
    "down, together": TOGETHER,
    "down, apart": APART,
    "wavering, together": {**TOGETHER, **WAVERING},
    "wavering, apart": {**APART, **WAVERING},
}
"""Parameters of Couzin's law, by the name of the flock. A choice; what members prefer counts as much as the others."""


def flocks(environment: Environment, law: str, herds: int, members: int, seed: int, **given: Any) -> np.ndarray:
    """(herds * members,) the bins of the members of independent herds; `given`: fields of its `Members`."""
    side = galton.Parameters().gap_m / 2
    throat = galton.Parameters().peg_m + galton.Parameters().row_m + side
    jobs = []
    for herd in range(herds):
        rng = np.random.default_rng([seed, herd])
        places = rng.uniform(-side, side, (members, 2)) + np.array([0.0, throat])
        jobs.append(Job(environment, np.column_stack([places, np.full(members, -math.pi / 2)]), (seed, herd)))
    group = kinematic(law, members, **given)
    ends = [positions[-1] for positions in group.trajectories(jobs, ITERATIONS)]
    return np.concatenate([bins_of(environment, end) for end in ends])


def with_corners(board: Environment) -> Environment:
    """The board with polygons in place of round pegs."""
    turns = 2.0 * np.pi * np.arange(CORNERS) / CORNERS

    def part(primitive: Primitive) -> Primitive:
        if not isinstance(primitive, Circle):
            return primitive
        x, y = primitive.x_m + primitive.radius_m * np.cos(turns), primitive.y_m + primitive.radius_m * np.sin(turns)
        return Polygon(tuple(zip(x.tolist(), y.tolist(), strict=True)), primitive.free)

    return dataclasses.replace(board, construct=tuple(map(part, board.construct)))


def told(name: str, found: Comparison) -> str:
    """One line of the table."""
    counts = " ".join(f"{count:5d}" for count in found.counts)
    return f"{name:26} {counts}   none {found.nowhere:5d}   distance {found.distance:.3f}   p {found.p:.2g}"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--grains", type=int, default=5000)
    parser.add_argument("--herds", type=int, default=20)
    parser.add_argument("--members", type=int, default=25)
    parser.add_argument("--laws", default="reynolds-boids,viscido-snn,random-motion")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    board = galton.generate(galton.Parameters(), galton.workspace(), np.random.default_rng(0))
    count = galton.Parameters().rows + 1
    ideal = np.random.default_rng([given.seed, 1]).binomial(count - 1, 0.5, given.grains)
    print(told("coins", compared(ideal, count)))
    print(told("sinking grains", compared(sunk(board, given.grains, np.random.default_rng([given.seed, 3])), count)))
    grains = fallen(board, given.grains, np.random.default_rng([given.seed, 2]))
    print(told("bouncing", compared(grains, count)))
    pegs = with_corners(board)
    for law in filter(None, given.laws.split(",")):
        print(told(law, compared(flocks(pegs, law, given.herds, given.members, given.seed), count)), flush=True)
    for name, parameters in DRIVEN.items():
        for members, herds in ((given.members, given.herds), (1, given.herds * given.members)):
            bins = flocks(pegs, "couzin", herds, members, given.seed, law_parameters=parameters, **DOWN)
            print(told(f"{name}, of {members}", compared(bins, count)), flush=True)


if __name__ == "__main__":
    main()
