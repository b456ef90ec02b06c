"""Fences as thin boxes: where they stand, that their corners are tight, and that faces keep theirs."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from generation.environment import Environment
from generation.files import to_json
from generation.primitives import Arc, Circle, Polygon, Polyline, Segment
from worlds import assemble
from worlds.walls import FENCE, HEIGHT, Walls, add_walls, fence_overlaps, walls_of

ROUNDING = 1e-9
"""m: a ray against a box is exact to rounding."""


def ray(environment: Environment, start: tuple[float, float], direction: tuple[float, float]) -> float:
    """How far MuJoCo's own ray goes from a place in the plane of the walls' middle, m; −1 = nothing is met."""
    spec = mujoco.MjSpec()
    add_walls(spec, walls_of(environment))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    along = np.array([*direction, 0.0]) / math.hypot(*direction)
    return mujoco.mj_ray(
        model, data, np.array([*start, HEIGHT / 2]), along, None, 1, -1, np.array([-1], dtype=np.int32)
    )


def test_a_fence_is_met_half_its_thickness_before_its_line_from_both_sides() -> None:
    fence = Environment((Segment(-1.0, 0.0, 1.0, 0.0),))
    for side in (-1.0, 1.0):
        assert ray(fence, (0.3, side), (0.0, -side)) == pytest.approx(1.0 - FENCE / 2, abs=ROUNDING)


def test_a_free_end_is_where_the_line_ends() -> None:
    fence = Environment((Segment(-1.0, 0.0, 1.0, 0.0),))
    assert ray(fence, (3.0, 0.0), (-1.0, 0.0)) == pytest.approx(2.0, abs=ROUNDING)
    assert ray(fence, (1.0 + 1e-6, 1.0), (0.0, -1.0)) == -1.0


@pytest.mark.parametrize("turn_deg", [5.0, 45.0, 90.0, 135.0, 170.0, -60.0])
def test_no_ray_gets_through_a_corner(turn_deg: float) -> None:
    """From all around a corner, along lines that pass within 2 mm of it: the boxes have no gap there."""
    turn = math.radians(turn_deg)
    corner = Environment((Polyline(((-1.0, 0.0), (0.0, 0.0), (math.cos(turn), math.sin(turn)))),))
    for angle in np.linspace(0.0, 2.0 * math.pi, 48, endpoint=False):
        way = math.cos(angle), math.sin(angle)
        for aside in (-0.002, 0.0, 0.002):
            start = (-2.0 * way[0] - aside * way[1], -2.0 * way[1] + aside * way[0])
            assert 0.0 <= ray(corner, start, way) <= 2.0 + FENCE, (angle, aside)


@pytest.mark.parametrize("turn_deg", [10.0, 60.0, 90.0])
def test_at_a_corner_the_outer_sides_meet_and_reach_no_farther(turn_deg: float) -> None:
    """Of a turn by t each box reaches FENCE / 2 · tan(t / 2) past the corner."""
    turn = math.radians(turn_deg)
    fences = walls_of(Environment((Polyline(((-1, 0), (0, 0), (math.cos(turn), math.sin(turn)))),))).fences
    needed = FENCE / 2 * math.tan(turn / 2)
    np.testing.assert_allclose(fence_overlaps(fences), [[0.0, needed], [needed, 0.0]], atol=1e-12)


def test_at_a_sharp_corner_boxes_reach_half_a_thickness() -> None:
    fences = np.array([[-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.1]])
    np.testing.assert_allclose(fence_overlaps(fences), [[0.0, FENCE / 2], [FENCE / 2, 0.0]], atol=1e-12)


def test_faces_and_fences_of_an_environment_are_told_apart() -> None:
    room, pillar = Polygon(((-4, -4), (4, -4), (4, 4), (-4, 4)), "inside"), Circle(1, 1, 0.5)
    both = Polygon(((0, 0), (0, -1), (-1, 0)), "both")
    walls = walls_of(Environment((room, both), (pillar, Arc(-2.0, 2.0, 1.0))))
    alone = walls_of(Environment((room, pillar)))
    np.testing.assert_array_equal(walls.segments, alone.segments)
    assert len(walls.fences) > 3
    assert len(walls.all) == len(walls.segments) + len(walls.fences)
    assert alone.all is alone.segments


def test_a_fence_without_a_length_is_refused() -> None:
    with pytest.raises(InputError, match=r"fence 1 at \(1, 2\) m has no length"):
        add_walls(mujoco.MjSpec(), Walls(np.empty((0, 4)), 0.8, np.array([[1.0, 2.0, 1.0, 2.0]])))


@pytest.mark.parametrize("beside", [0, 40])
def test_a_robot_that_drives_against_a_fence_is_stopped_and_touches_a_wall(beside: int) -> None:
    """Whether each box is tried or, among many, the tree of boxes is asked."""
    others = tuple(Segment(5.0 + 0.1 * k, -1.0, 5.0 + 0.1 * k, 1.0) for k in range(beside))
    fence = Segment(1.0, -1.0, 1.0, 1.0)
    text = to_json(Environment((fence, *others)))
    world = assemble.build("a.json", {}, ["create"], ["herd-1"], np.zeros((1, 3)), 0.01, text)
    world.fleet.command(0, 0.3, 0.0)
    world.advance(to=800)
    radius = world.bodies[0].radius
    # the bumper's travel and a press into the box of some millimetres
    assert world.fleet.poses(world.data)[0, 0] == pytest.approx(1.0 - FENCE / 2 - radius, abs=0.01)
    assert [row[2] for row in world.contacts][:1] == [-1.0]
    assert (world.model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_MIDPHASE == 0) == (beside > 0)
