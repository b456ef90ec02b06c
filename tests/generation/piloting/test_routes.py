"""Routes over a grid of the free space, against ways whose lengths are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.types import Floats
from generation.environment import Environment
from generation.free_space import distance, in_solid
from generation.piloting import task as tasks
from generation.piloting.routes import CELL_M, CLEAR_M, Ground, ground, route
from generation.primitives import Polygon, Segment

RADIUS_M, ROOM_M = 0.165, 0.45
NOBODY = np.empty((0, 2))
DIAGONAL = 1.0 / math.cos(math.pi / 8.0)
"""How much longer a way in steps of an eighth of a turn can be than the straight one."""


def box(x0: float, y0: float, x1: float, y1: float, free: str = "outside") -> Polygon:
    return Polygon(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), free)  # type: ignore[arg-type]


STREET = Environment((box(0.0, 0.0, 10.0, 1.5, "inside"),))
BLOCK = Environment((box(0.0, 0.0, 10.0, 6.0, "inside"), box(1.5, 1.5, 8.5, 3.0)))
"""A block with a street of 1.5 m south, east and west of it, and one of 3 m to its north."""
SOUTH_WEST, SOUTH_EAST = np.array([0.75, 0.75]), np.array([9.25, 0.75])


def length(way: Floats) -> float:
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def test_cells_are_free_where_a_disc_touches_no_wall() -> None:
    over = ground(BLOCK, RADIUS_M)
    centres = over.centres.reshape(-1, 2)
    for place, free in zip(centres, over.free.ravel(), strict=True):
        inside = 0.0 < place[0] < 10.0 and 0.0 < place[1] < 6.0
        in_block = 1.5 < place[0] < 8.5 and 1.5 < place[1] < 3.0
        assert free == (inside and not in_block and distance(BLOCK.walls(), place[None])[0] >= RADIUS_M)


@pytest.mark.parametrize("ends", [((0.75, 0.75), (9.25, 0.75)), ((9.3, 0.5), (2.02, 0.5))])
def test_along_a_straight_street_the_way_is_the_distance(ends: tuple[tuple[float, float], tuple[float, float]]) -> None:
    start, goal = np.array(ends)
    way = route(ground(STREET, RADIUS_M), start, goal, NOBODY, NOBODY, ROOM_M)
    assert_array_equal(way[0], start)
    assert_array_equal(way[-1], goal)
    straight = float(np.hypot(*(goal - start)))
    # to the next row of cells and back
    assert straight <= length(way) <= straight + CELL_M


def test_across_an_open_floor_the_way_is_at_most_that_in_eight_directions() -> None:
    over = ground(Environment((box(0.0, 0.0, 6.0, 6.0, "inside"),)), RADIUS_M)
    rng = np.random.default_rng(4)
    for start, goal in rng.uniform(0.3, 5.7, (20, 2, 2)):
        straight = float(np.hypot(*(goal - start)))
        # from the places to their cells and back, at the most half a cell's diagonal at each end, twice
        assert length(route(over, start, goal, NOBODY, NOBODY, ROOM_M)) <= DIAGONAL * straight + 3.0 * CELL_M


def test_a_way_goes_round_a_block_and_keeps_clear_of_all_walls() -> None:
    over = ground(BLOCK, RADIUS_M)
    way = route(over, np.array([5.0, 0.75]), np.array([5.0, 4.5]), NOBODY, NOBODY, ROOM_M)
    assert distance(BLOCK.walls(), way).min() >= RADIUS_M
    assert not in_solid(BLOCK, way).any()
    # the shortest way that there is touches the block's corners; in eight directions, a radius clear of them
    least = length(np.array([[5.0, 0.75], [1.5, 1.5], [1.5, 3.0], [5.0, 4.5]]))
    legs = [[5.0, 0.75], [1.5 - RADIUS_M, 1.5 - RADIUS_M], [1.5 - RADIUS_M, 3.0 + RADIUS_M], [5.0, 4.5]]
    assert least < length(way) <= DIAGONAL * length(np.array(legs)) + 6.0 * CELL_M


@pytest.mark.parametrize("herd", [[(5.0, 0.75)], [(4.0, 0.6), (4.5, 0.9), (6.0, 0.75), (5.2, 0.5)]])
def test_with_a_herd_in_the_short_street_the_way_leads_by_the_long_one(herd: list[tuple[float, float]]) -> None:
    over = ground(BLOCK, RADIUS_M)
    short = route(over, SOUTH_WEST, SOUTH_EAST, NOBODY, NOBODY, ROOM_M)
    assert short[:, 1].max() < 1.5
    long = route(over, SOUTH_WEST, SOUTH_EAST, np.array(herd), NOBODY, ROOM_M)
    assert long[:, 1].max() > 3.0
    assert np.hypot(*(long[:, None] - np.array(herd)).transpose(2, 0, 1)).min() > CLEAR_M


def test_a_robot_that_stands_in_the_short_street_is_gone_round_as_well() -> None:
    standing = np.array([[5.0, 0.75]])
    way = route(ground(BLOCK, RADIUS_M), SOUTH_WEST, SOUTH_EAST, NOBODY, standing, ROOM_M)
    assert np.hypot(*(way - standing[0]).T).min() >= ROOM_M
    assert length(way) > length(np.array([SOUTH_WEST, SOUTH_EAST]))


def test_where_no_way_is_open_there_is_none() -> None:
    two_rooms = Environment((box(0.0, 0.0, 10.0, 1.5, "inside"), box(4.5, -1.0, 5.5, 3.0)))
    over = ground(two_rooms, RADIUS_M)
    assert route(over, SOUTH_WEST, SOUTH_EAST, NOBODY, NOBODY, ROOM_M).shape == (0, 2)
    fence = ground(Environment(STREET.workspace, (Segment(5.0, 0.0, 5.0, 1.5),)), RADIUS_M)
    assert route(fence, SOUTH_WEST, SOUTH_EAST, NOBODY, NOBODY, ROOM_M).shape == (0, 2)
    whole = ground(STREET, RADIUS_M)
    assert len(route(whole, SOUTH_WEST, SOUTH_EAST, NOBODY, NOBODY, ROOM_M))
    crowd = np.column_stack([np.full(4, 5.0), np.linspace(0.2, 1.3, 4)])
    for herd, blocked in ((crowd, NOBODY), (NOBODY, crowd)):
        assert route(whole, SOUTH_WEST, SOUTH_EAST, herd, blocked, ROOM_M).shape == (0, 2)


def test_from_a_place_to_itself_the_way_has_no_length() -> None:
    way = route(ground(STREET, RADIUS_M), SOUTH_WEST, SOUTH_WEST, NOBODY, NOBODY, ROOM_M)
    assert length(way) == 0.0


def test_who_stands_among_others_and_is_sent_among_others_gets_away_and_there() -> None:
    """Cells beside the start and the goal are open whoever stands there."""
    others = np.array([(0.75, 1.1), (9.25, 0.4)])
    over = ground(STREET, RADIUS_M)
    assert len(route(over, SOUTH_WEST, SOUTH_EAST, others, NOBODY, ROOM_M)) > 0
    assert len(route(over, SOUTH_WEST, SOUTH_EAST, NOBODY, others, ROOM_M)) > 0


@pytest.mark.parametrize("name", tasks.names())
def test_all_of_a_tasks_streets_can_be_reached_from_one_another(name: str) -> None:
    task = tasks.load(name)
    over = ground(task.environment, RADIUS_M)
    for corner in task.trajectory[1:]:
        assert len(route(over, task.trajectory[0], corner, NOBODY, NOBODY, ROOM_M)) > 0


def test_the_nearest_free_cell_is_the_nearest() -> None:
    over: Ground = ground(BLOCK, RADIUS_M)
    free = over.centres[over.free]
    for place in np.random.default_rng(5).uniform(0.0, 6.0, (20, 2)):
        assert np.hypot(*(over.centres[over.cell(place)] - place)) == np.hypot(*(free - place).T).min()


def test_into_a_place_between_a_wall_and_a_neighbour_the_way_leads_no_nearer_by_it_than_the_place_is() -> None:
    """So that a robot need not wait for ever before a neighbour that it could go round: seen in task 2."""
    over = ground(STREET, 0.175)
    goal, neighbour = np.array([0.25, 0.9]), np.array([0.58, 0.89])
    for start in (np.array([0.53, 0.55]), np.array([0.8, 0.9])):
        way = route(over, start, goal, NOBODY, neighbour[None], ROOM_M)
        own = min(float(np.hypot(*(place - neighbour))) for place in (start, goal))
        # the centre of the cell before the place may be nearer by a part of a cell
        assert np.hypot(*(way - neighbour).T).min() >= own - CELL_M / 4.0
