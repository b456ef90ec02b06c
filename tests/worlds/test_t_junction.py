"""The T-junction as a world is the schema's workspace with the schema's wall."""

from __future__ import annotations

import numpy as np

from generation.found import load
from worlds import known


def test_the_junction_with_its_wall_is_what_dirt_generates() -> None:
    schema = load("dirt")
    made = schema.generate(schema.parameters(210.0, 3.0, 2), schema.workspace(), np.random.default_rng(1))
    given = {"wall": True, "angle_deg": 210.0, "length_m": 3.0, "anchor": 2}
    world = known.environment_of("t-junction", "", given)
    np.testing.assert_array_equal(world.walls(), made.walls())
    assert world.markers == made.markers


def test_without_a_wall_it_is_the_workspace_alone() -> None:
    world = known.environment_of("t-junction", "", {})
    assert not world.construct
    np.testing.assert_array_equal(world.walls(), load("dirt").workspace().walls())
