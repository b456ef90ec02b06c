"""Lasers in small worlds, their streams of random numbers, and a wall before them. For the tests of the laser."""

import math

import numpy as np

from sensing.laser.draws import intensity_draws, range_draws
from sensing.laser.hokuyo import SETTINGS, Lasers

FRONT, BEAMS = 340, 682
IDEAL, SHEET, HARSH = SETTINGS["ideal"], SETTINGS["datasheet"], SETTINGS["harsh"]
STILL = SHEET._replace(dropout=0.0)
EXACT = 1e-9  # m; round-off of a cast


def lasers_of(scene, *parameters):
    each = parameters * len(scene.roots) if len(parameters) == 1 else parameters
    return Lasers(scene.model, scene.sites, scene.roots, each)


def for_ranges(seed=0):
    return range_draws(np.random.default_rng(seed))


def for_light(seed=0):
    return intensity_draws(np.random.default_rng(seed))


def wall_at(distance):
    """A wall across the x axis, `distance` from the laser of a robot at the origin."""
    return (0.1 + distance + 0.1, 0.0, math.pi / 2, 20.0, 0.1)
