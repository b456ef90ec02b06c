"""Pilots on their ways, moved by a toy that drives straight to whatever place they are told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flocking.types import Floats
from generation.environment import Environment
from generation.free_space import distance
from generation.piloting import formations
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.pilots import ARRIVED_M, Pilots
from generation.piloting.routes import ground
from generation.primitives import Polygon

RADIUS_M, SPEED_M_S, DT_S = 0.165, 0.4, 0.1
NOBODY = np.empty((0, 2))


def box(x0: float, y0: float, x1: float, y1: float, free: str = "outside") -> Polygon:
    return Polygon(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), free)  # type: ignore[arg-type]


OPEN = Environment((box(0.0, 0.0, 6.0, 6.0, "inside"),))
STREET = Environment((box(0.0, 0.0, 10.0, 1.5, "inside"),))
BLOCKS = Environment((box(0.0, 0.0, 10.0, 6.0, "inside"), box(1.5, 1.5, 8.5, 4.5)))


def drive(
    place: Environment,
    starts: Floats,
    goals: Floats,
    seconds: float,
    herd: Callable[[float], Floats] = lambda time: NOBODY,
) -> tuple[Pilots, Floats]:
    """(T, R, 2) where pilots are at each step from the start on, until all have arrived or the time is over."""
    pilots = Pilots(ground(place, RADIUS_M), len(starts))
    pilots.send(np.arange(len(starts)), goals)
    found = [starts]
    for k in range(round(seconds / DT_S)):
        if pilots.arrived(found[-1]).all():
            break
        way = pilots.targets(k * DT_S, found[-1], herd(k * DT_S)) - found[-1]
        far = np.hypot(*way.T)[:, None]
        found.append(found[-1] + way * np.minimum(1.0, SPEED_M_S * DT_S / np.maximum(far, 1e-12)))
    return pilots, np.array(found)


def nearest(track: Floats) -> float:
    """The least distance of two robots at any time, m."""
    apart = np.hypot(*(track[:, :, None] - track[:, None]).transpose(3, 0, 1, 2))
    return float(apart[:, ~np.eye(track.shape[1], dtype=bool)].min())


def test_in_an_empty_workspace_pilots_arrive_about_as_soon_as_they_can() -> None:
    rng = np.random.default_rng(3)
    for start, goal in rng.uniform(0.3, 5.7, (10, 2, 2)):
        pilots, track = drive(OPEN, start[None], goal[None], 60.0)
        assert pilots.arrived(track[-1]).all()
        assert np.hypot(*(track[-1, 0] - goal)) <= ARRIVED_M
        # in eight directions a way is up to 1.09 times the straight one; and a second for the cells at its ends
        assert len(track) * DT_S <= 1.09 * np.hypot(*(goal - start)) / SPEED_M_S + 1.0


def test_pilots_go_round_a_block_and_touch_no_wall() -> None:
    pilots, track = drive(BLOCKS, np.array([[5.0, 0.75]]), np.array([[5.0, 5.25]]), 120.0)
    assert pilots.arrived(track[-1]).all()
    # between two cells a straight way may cut a corner by a little
    assert distance(BLOCKS.walls(), track[:, 0]).min() > RADIUS_M - 0.05


def test_those_without_a_place_stand_and_have_arrived() -> None:
    pilots = Pilots(ground(OPEN, RADIUS_M), 2)
    places = np.array([[1.0, 1.0], [3.0, 3.0]])
    assert pilots.arrived(places).all()
    assert_array_equal(pilots.targets(0.0, places, NOBODY), places)
    pilots.send(np.array([1]), np.array([[5.0, 5.0]]))
    assert pilots.arrived(places).tolist() == [True, False]
    found = pilots.targets(0.1, places, NOBODY)
    assert_array_equal(found[0], places[0])
    assert np.hypot(*(found[1] - [5.0, 5.0])) < np.hypot(2.0, 2.0)


def test_who_has_arrived_is_told_its_own_place() -> None:
    pilots = Pilots(ground(OPEN, RADIUS_M), 1)
    pilots.send(np.array([0]), np.array([[2.0, 2.0]]))
    assert_array_equal(pilots.targets(0.0, np.array([[2.05, 2.0]]), NOBODY), [[2.0, 2.0]])


@pytest.mark.parametrize(
    ("starts", "goals"),
    [
        ([(0.75, 0.75), (9.25, 0.75)], [(9.25, 0.75), (0.75, 0.75)]),
        ([(9.25, 0.75), (0.75, 0.75)], [(0.75, 0.75), (9.25, 0.75)]),
        ([(0.75, 0.6), (9.25, 0.9)], [(9.25, 0.6), (0.75, 0.9)]),
        ([(0.75, 1.0), (6.0, 0.75)], [(9.25, 0.75), (3.0, 1.0)]),
    ],
)
def test_two_that_meet_head_on_in_a_street_both_arrive_and_do_not_touch(
    starts: list[tuple[float, float]], goals: list[tuple[float, float]]
) -> None:
    pilots, track = drive(STREET, np.array(starts), np.array(goals), 180.0)
    assert pilots.arrived(track[-1]).all()
    assert nearest(track) > 2.0 * RADIUS_M


def test_two_that_meet_among_blocks_both_arrive_and_do_not_touch() -> None:
    starts, goals = np.array([(0.75, 0.75), (9.25, 0.75)]), np.array([(9.25, 0.75), (0.75, 0.75)])
    pilots, track = drive(BLOCKS, starts, goals, 180.0)
    assert pilots.arrived(track[-1]).all()
    assert nearest(track) > 2.0 * RADIUS_M


@pytest.mark.parametrize("seed", range(4))
def test_six_that_cross_an_open_floor_all_arrive_and_do_not_touch(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = np.array([(x, y) for x in np.arange(0.6, 5.8, 1.1) for y in np.arange(0.6, 5.8, 1.1)])
    starts, goals = (grid[rng.permutation(len(grid))[:6]] for _ in range(2))
    pilots, track = drive(OPEN, starts, goals, 180.0)
    assert pilots.arrived(track[-1]).all()
    assert nearest(track) > 2.0 * RADIUS_M


def test_a_pilot_waits_for_a_member_that_stands_before_it_and_goes_on_once_it_is_gone() -> None:
    """The street is too narrow to pass a herd member by the distance that is kept."""
    start, goal, member = np.array([[0.75, 0.75]]), np.array([[9.25, 0.75]]), np.array([[5.0, 0.75]])
    pilots, track = drive(STREET, start, goal, 60.0, lambda time: member)
    assert not pilots.arrived(track[-1]).any()
    assert np.hypot(*(track[:, 0] - member[0]).T).min() > 2.0 * RADIUS_M
    gone, free = drive(STREET, start, goal, 90.0, lambda time: member if time < 30.0 else NOBODY)
    assert gone.arrived(free[-1]).all()
    assert np.hypot(*(free[: round(30.0 / DT_S), 0] - member[0]).T).min() > 2.0 * RADIUS_M


def test_a_member_that_steps_before_a_pilot_is_waited_for() -> None:
    def herd(time: float) -> Floats:
        return np.array([[2.6, 3.0]]) if time >= 2.0 else np.array([[2.6, 5.5]])

    _, track = drive(OPEN, np.array([[1.0, 3.0]]), np.array([[5.0, 3.0]]), 2.5 + 1.5, herd)
    at = track[round(2.0 / DT_S), 0]
    assert np.hypot(*(track[20:, 0] - [2.6, 3.0]).T).min() > 2.0 * RADIUS_M
    assert at[0] < 2.0


def test_the_same_robots_go_the_same_ways_whatever_clocks_say() -> None:
    """To the bit; and from another moment on, in binary fractions of a second, as well."""
    starts, goals = np.array([(0.75, 0.75), (9.25, 0.75)]), np.array([(9.25, 0.75), (0.75, 0.75)])
    tracks = []
    for begun in (0.0, 0.0, 4096.0):
        pilots, places = Pilots(ground(STREET, RADIUS_M), 2), starts
        pilots.send(np.arange(2), goals)
        track = []
        for k in range(300):
            way = pilots.targets(begun + k / 8, places, NOBODY) - places
            far = np.hypot(*way.T)[:, None]
            places = places + way * np.minimum(1.0, SPEED_M_S / 8 / np.maximum(far, 1e-12))
            track.append(places)
        tracks.append(track)
    assert_array_equal(tracks[0], tracks[1])
    assert_array_equal(tracks[0], tracks[2])


def test_ways_turn_with_the_robots_places_alone() -> None:
    """A robot that has no other near is told places on its own route, at the most so far ahead as is asked for."""
    pilots = Pilots(ground(OPEN, RADIUS_M), 1)
    pilots.send(np.array([0]), np.array([[5.0, 1.0]]))
    place = np.array([[1.0, 1.0]])
    target = pilots.targets(0.0, place, NOBODY)
    assert_allclose(target[0, 1], 1.0, atol=0.15)  # a cell
    assert 0.2 < target[0, 0] - 1.0 <= 0.5 + 0.15


@pytest.mark.parametrize("name", tasks.names())
def test_six_pilots_change_through_all_formations_of_a_tasks_plan(name: str) -> None:
    """Without a herd in the way. Places along a wall of 1.06 m are 0.35 m apart; a Create is 0.33 m wide."""
    task = tasks.load(name)
    plan = replace(plans.shipped(name), static=False)
    over, places, held, pilots = ground(task.environment, RADIUS_M), formations.at_first(task, plan, 6), {}, None
    for passed in range(len(plan.walls)):
        change = formations.change(task, plan, passed, places, held)
        pilots, held = Pilots(over, 6), change.walls
        pilots.send(change.moving, change.places)
        for k in range(1200):
            if pilots.arrived(places).all():
                break
            way = pilots.targets(k * DT_S, places, NOBODY) - places
            far = np.hypot(*way.T)[:, None]
            places = places + way * np.minimum(1.0, SPEED_M_S * DT_S / np.maximum(far, 1e-12))
            # the way into a place 0.353 m beside another may lead 0.04 m nearer by who stands there
            assert nearest(places[None]) > 0.31, (passed, k)
        assert pilots.arrived(places).all(), passed
