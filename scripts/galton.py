"""A Galton board beside the binomial distribution: coins, grains, and flocks that come through the funnel.

    python -m scripts.galton [--grains 5000] [--herds 20] [--members 25] [--laws A,B]

A flock is a kinematic herd that starts in the throat of the funnel, heading down: nothing else drives it. It is counted
after `ITERATIONS` at 2 m each. Members that are above the bins by then are in none. To flocks, pegs are polygons.
"""

from __future__ import annotations

import argparse
import dataclasses
import math

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


def flocks(environment: Environment, law: str, herds: int, members: int, seed: int) -> np.ndarray:
    """(herds * members,) the bins of the members of independent herds."""
    side = galton.Parameters().gap_m / 2
    throat = galton.Parameters().peg_m + galton.Parameters().row_m + side
    jobs = []
    for herd in range(herds):
        rng = np.random.default_rng([seed, herd])
        places = rng.uniform(-side, side, (members, 2)) + np.array([0.0, throat])
        jobs.append(Job(environment, np.column_stack([places, np.full(members, -math.pi / 2)]), (seed, herd)))
    group = kinematic(law, members)
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
    return f"{name:14} {counts}   none {found.nowhere:5d}   distance {found.distance:.3f}   p {found.p:.2g}"


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
    for law in given.laws.split(","):
        print(
            told(law, compared(flocks(with_corners(board), law, given.herds, given.members, given.seed), count)),
            flush=True,
        )


if __name__ == "__main__":
    main()
