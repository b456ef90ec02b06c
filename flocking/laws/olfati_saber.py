"""Flocking towards alpha-lattices, with a goal as gamma-agent.

Source: Olfati-Saber 2006, "Flocking for multi-agent dynamic systems: algorithms and theory", algorithms 1 and 2; Fine
2015, table A.1. Point masses of unit mass; metres and seconds, which the publication leaves open.

Acceleration = the sum over the neighbours j of phi(|r_j - r_i|_sigma) n_ij + a_ij (v_j - v_i), plus the feedback
-c1 (r_i - r_goal) - c2 v_i. The sigma-norm is |z|_sigma = (sqrt(1 + eps |z|²) - 1)/eps, n_ij = (r_j - r_i) /
sqrt(1 + eps |r_j - r_i|²), a_ij = bump(|r_j - r_i|_sigma / |range|_sigma), and phi(z) = a_ij ((a + b) s(z - |d|_sigma +
c) + a - b)/2 with s(z) = z / sqrt(1 + z²) and c = |a - b| / sqrt(4 a b). The bump is 1 up to h and falls to 0 at 1. A
pair at the distance d exerts no force; potentials and kinetic energy together never grow.

Needs positions and velocities; a member without a goal has no feedback (algorithm 1, under which groups fall apart). No
neighbours and no goal: the member keeps its velocity. Obstacles act as the shared virtual members, not by a law of
their own as the publication's beta-agents do.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Olfati-Saber 2006"

NEEDS = frozenset({"positions", "velocities", "goal"})
RULES = ("none", "flock", "goal", "flock to goal")
SETS = {"neighbours": "distance-based(0, range_m)"}
RELATIONS = ("spacing_m at most range_m",)
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "all", False, True, False, True)
VALIDATION = Validation("MS", True, "global", "global", "global", "unbounded obstacles")
FILLED = (
    Filled(
        "member detection",
        "table 3.2 has it avoid everything, by virtual members; table A.1 prints no such term",
        "virtual members are the mechanism that all laws share (obstacles as virtual members); off unless asked for",
    ),
    Filled(
        "sensing",
        "table 3.2 lists orientation and no velocity, and discrete time",
        "the rows are given as printed; the law reads velocities, no orientation, and is an acceleration",
    ),
    Filled(
        "motion computation",
        "table A.1 prints phi with x + w3 in place of x - |d|_sigma + c, so that no distance is at rest",
        "the original's, with rest at d",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table A.1 prints the sum as the new velocity",
        "it is the acceleration, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "the goal moves with a velocity that every member knows",
        "a member knows where its goal is, not how it moves: the goal counts as resting",
    ),
    Filled(
        "motion computation",
        "the gains of the goal's feedback",
        "c1 is a choice and c2 = 2 sqrt(c1), at which the centre comes to the goal without overshooting",
    ),
)
HERD = Herd(spacing_m=7.0, speed_m_s=1.5, dt_s=0.02)
CREATE = {"range_m": 1.2, "spacing_m": 0.8, "a": 0.5, "b": 0.5, "c1_per_s2": 0.01, "c2_per_s": 0.2}


class Parameters(NamedTuple):
    """Of Olfati-Saber's alpha-agents."""

    range_m: Annotated[float, Parameter("m", f"{SOURCE}: 1.2 times the spacing", published=True, low=1e-3)] = 8.4
    spacing_m: Annotated[float, Parameter("m", f"{SOURCE}: d", published=True, low=1e-3)] = 7.0
    a: Annotated[float, Parameter("m/s²", f"{SOURCE}: bound of the attraction", published=True, low=1e-6)] = 5.0
    b: Annotated[float, Parameter("m/s²", f"{SOURCE}: bound of the repulsion", published=True, low=1e-6)] = 5.0
    epsilon_per_m2: Annotated[float, Parameter("1/m²", f"{SOURCE}: epsilon", published=True, low=1e-6)] = 0.1
    h: Annotated[float, Parameter("", f"{SOURCE}: h of the alpha-agents", published=True, low=0.0, high=0.999)] = 0.2
    c1_per_s2: Annotated[float, Parameter("1/s²", "our choice: pull towards the goal", low=0.0)] = 0.1
    c2_per_s: Annotated[float, Parameter("1/s", "our choice: 2 sqrt(c1)", low=0.0)] = 0.632


@compiled
def sigma_norm(length: float, epsilon: float) -> float:
    """The sigma-norm of a vector of that length: smooth at 0, of slope 1/sqrt(epsilon) far out."""
    return (math.sqrt(1.0 + epsilon * length * length) - 1.0) / epsilon


@compiled
def bump(share: float, h: float) -> float:
    """1 up to h, from there a half wave of a cosine down to 0 at 1."""
    if share < h:
        return 1.0
    if share > 1.0:
        return 0.0
    return 0.5 * (1.0 + math.cos(math.pi * (share - h) / (1.0 - h)))


@compiled
def action(z: float, z_rest: float, a: float, b: float) -> float:
    """The force of a pair before the bump: 0 at z_rest, between -b and a."""
    shifted = z - z_rest + abs(a - b) / math.sqrt(4.0 * a * b)
    return 0.5 * ((a + b) * shifted / math.sqrt(1.0 + shifted * shifted) + a - b)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by gradient, consensus and goal."""
    epsilon = parameters.epsilon_per_m2
    z_range = sigma_norm(parameters.range_m, epsilon)
    z_rest = sigma_norm(parameters.spacing_m, epsilon)
    rule, ax, ay = 0, 0.0, 0.0
    for j in range(len(members.ids)):
        if not sets[0, j]:
            continue
        rule = 1
        x, y = members.positions[j, 0], members.positions[j, 1]
        length = math.hypot(x, y)
        z = sigma_norm(length, epsilon)
        weight = bump(z / z_range, parameters.h)
        pull = weight * action(z, z_rest, parameters.a, parameters.b) / math.sqrt(1.0 + epsilon * length * length)
        ax += pull * x + weight * (members.velocities[j, 0] - own.velocity[0])
        ay += pull * y + weight * (members.velocities[j, 1] - own.velocity[1])
    if not math.isnan(own.goal[0]):
        rule += 2
        ax += parameters.c1_per_s2 * own.goal[0] - parameters.c2_per_s * own.velocity[0]
        ay += parameters.c1_per_s2 * own.goal[1] - parameters.c2_per_s * own.velocity[1]
    if rule == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    return Motion(Kind.ACCELERATION, ax, ay, rule)
