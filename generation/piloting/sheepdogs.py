"""Where sheepdog robots drive to: two rules of the field, beside which formations along walls can be held.

Neither is of Fine 2015. Both know where everybody is. What they do about several dogs, and all lengths, are our
choices: sheep are larger than Creates. Where a direction is not defined (the herd's centre is the goal) a dog stays.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.types import Floats
from generation.piloting.formations import assigned
from generation.piloting.members import SEPARATION_M

VAUGHAN, STROMBOM = RULES = ("vaughan", "strombom")


class Vaughan(NamedTuple):
    """Gains of `vaughan`. All are our choices: on the line from the goal a dog is at rest 1 m behind the centre."""

    attraction: float = 1.0
    """To the flock's centre, m a m of distance."""
    goal_m: float = 0.5
    """Away from the goal, at every distance."""
    repulsion_m3: float = 0.5
    """Away from the flock's centre, by the square of the distance."""
    apart_m3: float = 0.1
    """Away from each other dog, by the square of the distance: as much as the goal's at 0.45 m."""
    longest_m: float = 1.0
    """Longest way that is asked for at once: the terms grow without bound near and far."""


class Strombom(NamedTuple):
    """Lengths of `strombom`."""

    r_a_m: float = SEPARATION_M
    """Distance below which members keep apart: 2 m between sheep as published, here that of the herd's BOIDS."""
    apart_m: float = 0.5
    """Between dogs that drive side by side, our choice: three radii of a Create."""


_VAUGHAN, _STROMBOM = Vaughan(), Strombom()


def vaughan(dogs: Floats, herd: Floats, goal: Floats, parameters: Vaughan = _VAUGHAN) -> Floats:
    """(D, 2) where dogs at (D, 2) drive to next, m, for a herd at (M, 2), M > 0, that is to go to a goal (2,).

    Vaughan, Sumpter, Henderson, Frost and Cameron 2000, "Experiments in automatic flock control", Robotics and
    Autonomous Systems 31: a robot goes by the sum of potential terms that are drawn to the flock, more the farther it
    is, and pushed off the flock and off the goal. So it comes to rest on the flock's far side from the goal, and the
    flock that moves away from it moves to the goal. The terms are those for which the rule is known; their exponents,
    their gains and that the sum is a way rather than a velocity are our choices.

    One robot is published. Several push one another off by a term of their own, as replications with several shepherds
    do (El-Fiqi and others 2020): no dog need know its number, and they spread about the place of one.
    """
    given = parameters
    centre = herd.mean(axis=0)
    to_centre, from_goal = centre - dogs, _units(dogs - goal)
    away = -_units(to_centre)
    away[~to_centre.any(axis=1)] = _units((centre - goal)[None])[0]  # a dog at the centre leaves it behind
    near = np.maximum(np.hypot(*to_centre.T), 1e-3)[:, None]
    ways = given.attraction * to_centre + given.repulsion_m3 * away / near**2 + given.goal_m * from_goal
    apart = dogs[:, None] - dogs[None]
    far = np.maximum(np.hypot(*apart.transpose(2, 0, 1)), 1e-3)[:, :, None]
    ways += (given.apart_m3 * apart / far**3).sum(axis=1)
    lengths = np.hypot(*ways.T)[:, None]
    return np.asarray(dogs + ways * np.minimum(1.0, given.longest_m / np.maximum(lengths, given.longest_m)))


def strombom(dogs: Floats, herd: Floats, goal: Floats, parameters: Strombom = _STROMBOM) -> Floats:
    """(D, 2) where dogs at (D, 2) drive to next, m, for a herd at (M, 2), M > 0, that is to go to a goal (2,).

    Strömbom and others 2014, "Solving the shepherding problem", Journal of the Royal Society Interface 11: 20140719.
    While a member is farther from the centre than f(M) = r_a M^(2/3) the dog collects the farthest: it goes to the
    place r_a beyond it, as seen from the centre. Else it drives: it goes to the place r_a sqrt(M) behind the centre, as
    seen from the goal. Left out are the dog's noise and that it slows down near members: a Create has one speed here.

    One dog is published. Of several each collects a member that is too far off, the farthest first, so that no two go
    for the same one; those left over drive side by side, on the circle about the centre (our choice). Places are given
    to dogs so that the sum of their ways is least.
    """
    given, count = parameters, len(herd)
    centre = herd.mean(axis=0)
    offsets = herd - centre
    far = np.hypot(*offsets.T)
    order = np.argsort(-far, kind="stable")
    strays = order[far[order] > given.r_a_m * count ** (2.0 / 3.0)][: len(dogs)]
    beyond = herd[strays] + given.r_a_m * _units(offsets[strays])
    behind = _units((centre - goal)[None])[0]
    drivers = len(dogs) - len(strays)
    if drivers and not behind.any():
        found = dogs.copy()
        found[assigned(dogs, beyond)] = beyond
        return found
    places = np.concatenate([beyond, centre + _abreast(behind, given.r_a_m * math.sqrt(count), drivers, given.apart_m)])
    found = np.empty_like(dogs)
    found[assigned(dogs, places)] = places
    return found


def _abreast(way: Floats, radius: float, count: int, apart: float) -> Floats:
    """(count, 2) places on a circle about the origin, m, side by side about a direction (2,), at that distance."""
    step = 2.0 * math.asin(min(1.0, apart / (2.0 * radius)))
    step = min(step, 2.0 * math.pi / max(count, 1))
    angles = step * (np.arange(count) - (count - 1) / 2.0)
    side = np.array([-way[1], way[0]])
    return np.asarray(radius * (np.cos(angles)[:, None] * way + np.sin(angles)[:, None] * side))


def _units(vectors: Floats) -> Floats:
    """(K, 2) the directions of vectors (K, 2); zero for those without one."""
    lengths = np.hypot(*vectors.T)[:, None]
    return np.asarray(np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0))


def targets(rule: str, dogs: Floats, herd: Floats, goal: Floats) -> Floats:
    """(D, 2) by the rule of that name, with its own parameters."""
    return (vaughan if rule == VAUGHAN else strombom)(dogs, herd, goal)
