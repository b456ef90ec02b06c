"""Buckland's boids by hand: each force in pixels, their order, half a disc of sight, and the turn rate.

A pixel is 0.008 m, the tweaker 200 px/s², the strongest force 400 px/s².
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.selection import parse_sets, resolved, select
from flocking.types import Kind, Members, Obstacles, Own
from tests.flocking.laws.asking import run

PX = 0.008
DT = 0.01
LAW = lawentry.load("buckland-boids")
STILL = {"wander_weight": 0.0, "turn_rate_rad_s": 0.0}
"""Nothing but the force that is asked for, which acts at once."""


def force(
    places: object = (),
    velocities: object = (0.0, 0.0),
    headings: object = 0.0,
    *,
    selection: str = "all",
    own: tuple[float, float] = (0.0, 0.0),
    walls: object = (),
    turn_rate: float = 0.0,
    u: tuple[float, float] = (0.5, 0.5),
    **given: Any,
) -> tuple[np.ndarray, str]:
    """The acceleration, px/s², of a robot with that velocity, px/s, among others at `places`, px; and the rule.

    `walls`: their nearest points, px.
    """
    positions = PX * np.array(places, dtype=float).reshape(-1, 2)
    count = len(positions)
    members = Members(
        positions,
        np.arctan2(positions[:, 1], positions[:, 0]),
        np.broadcast_to(np.array(headings, dtype=float), count).copy(),
        PX * np.broadcast_to(np.array(velocities, dtype=float), (count, 2)),
        np.arange(1, count + 1),
    )
    parameters = LAW.parameters({**STILL, **given})
    steps = parse_sets(selection, LAW.sets, LAW.parameter_names)
    sets = [select(resolved(each, parameters._asdict()), members) for each in steps]
    points = Obstacles(PX * np.array(walls, dtype=float).reshape(-1, 2))
    velocity = PX * np.array(own)
    of_itself = Own(velocity, turn_rate, math.nan, np.full(2, math.nan), np.zeros(2, np.bool_), DT, 0, 0)
    masks = np.array(sets, dtype=np.bool_).reshape(len(steps), count)
    motion = LAW.function(of_itself, members, masks, points, parameters, np.zeros(2), np.array(u))
    assert motion.kind == Kind.HEADING
    after = motion.y * np.array([math.cos(motion.x), math.sin(motion.x)])
    return (after - velocity) / DT / PX, LAW.rules[motion.rule]


ONE = {"alignment_weight": 0.0, "cohesion_weight": 0.0}


def test_separation_is_the_sum_of_the_ways_away_over_the_squares_of_the_distances() -> None:
    found, rule = force([(10.0, 0.0), (0.1, 20.0)], **ONE)
    square = 0.1**2 + 20.0**2
    np.testing.assert_allclose(found, 200.0 * np.array([-0.1 - 0.1 / square, -20.0 / square]), rtol=1e-9)
    assert rule == "flock"


def test_alignment_is_the_mean_heading_less_the_own_one() -> None:
    given = {"separation_weight": 0.0, "cohesion_weight": 0.0}
    up_and_ahead = force([(5.0, 1.0), (5.0, -1.0)], [(0.0, 70.0), (20.0, 0.0)], **given)[0]
    np.testing.assert_allclose(up_and_ahead, 200.0 * (np.array([0.5, 0.5]) - [1.0, 0.0]), rtol=1e-9)
    at_rest = force([(5.0, 1.0)], (0.0, 0.0), math.pi / 2.0, **given)[0]
    np.testing.assert_allclose(at_rest, [-200.0, 200.0], rtol=1e-9)


def test_cohesion_is_a_unit_vector_of_the_velocity_that_lacks_towards_the_centre() -> None:
    given = {"separation_weight": 0.0, "alignment_weight": 0.0}
    np.testing.assert_allclose(
        force([(30.0, 0.0), (0.1, 40.0)], **given)[0],
        400.0 * np.array([30.1, 40.0]) / math.hypot(30.1, 40.0),
        rtol=1e-9,
    )
    sideways = force([(1e-9, 10.0)], own=(60.0, 0.0), **given)[0]
    np.testing.assert_allclose(sideways, 400.0 * np.array([-60.0, 100.0]) / math.hypot(60.0, 100.0), rtol=1e-6)


def test_wandering_leads_to_a_point_on_the_circle_ahead() -> None:
    given = {"wander_weight": 0.5, "wander_jitter_px_s": 0.0}
    for turn in (0.0, 0.2, 0.5):
        found, rule = force(u=(turn, 0.5), **given)
        angle = 2.0 * math.pi * turn
        np.testing.assert_allclose(
            found, 100.0 * np.array([2.0 + 1.2 * math.cos(angle), 1.2 * math.sin(angle)]), rtol=1e-9
        )
        assert rule == "wander"


def test_evading_leads_away_from_where_the_threat_will_be() -> None:
    """It is 100 px ahead and comes at 70 px/s to the left: in 100 / (100 + 70) s it is there."""
    threatened = "threats: fixed-set(1)"
    found, rule = force([(100.0, 0.0)], (0.0, 70.0), selection=threatened, own=(50.0, 0.0))
    there = np.array([100.0, 70.0 * 100.0 / 170.0])
    np.testing.assert_allclose(found, 2.0 * (-100.0 * there / np.hypot(*there) - [50.0, 0.0]), rtol=1e-9)
    assert rule == "evade"
    assert force([(100.0, 0.0)], (0.0, 70.0))[1] == "flock"


def test_a_threat_or_a_disc_is_no_flockmate() -> None:
    for kind in ("threats", "discs"):
        found, rule = force([(150.0, 90.0)], selection=f"{kind}: fixed-set(1)", evade_weight=0.0)
        assert (np.abs(found).max(), rule) == (0.0, "wander" if kind == "discs" else "evade")


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_disc_pushes_to_the_other_side_and_brakes(side: float) -> None:
    """Box of 80 px at top speed, disc of 20 px, body of 3 px: 8 px to the side and 30 px ahead."""
    found, rule = force([(30.0, 8.0 * side)], own=(100.0, 0.0), selection="discs: fixed-set(1)", obstacle_weight=0.01)
    across = (23.0 - 8.0) * (1.0 + (80.0 - 30.0) / 80.0)
    np.testing.assert_allclose(found, 2.0 * np.array([0.2 * (20.0 - 30.0), -side * across]), rtol=1e-9)
    assert rule == "obstacle"


@pytest.mark.parametrize("place", [(30.0, 24.0), (-1.0, 0.0), (101.0, 0.0)])
def test_a_disc_that_is_beside_behind_or_beyond_the_box_is_none(place: tuple[float, float]) -> None:
    assert force([place], own=(100.0, 0.0), selection="discs: fixed-set(1)")[1] == "wander"


@pytest.mark.parametrize(
    ("wall", "through"),
    [((30.0, 0.0), 10.0), ((0.0, 10.0), 20.0 - 10.0 * math.sqrt(2.0)), ((0.0, -10.0), 20.0 - 10.0 * math.sqrt(2.0))],
)
def test_a_wall_pushes_by_how_far_a_feeler_reaches_through_it(wall: tuple[float, float], through: float) -> None:
    """40 px ahead, 20 px at 45 degrees."""
    found, rule = force(walls=[wall], wall_weight=0.1)
    np.testing.assert_allclose(found, -20.0 * through * np.array(wall) / np.hypot(*wall), rtol=1e-9, atol=1e-9)
    assert rule == "wall"


def test_of_two_walls_the_one_that_is_met_first_pushes() -> None:
    found, _ = force(walls=[(35.0, 0.0), (20.0, 20.0)], wall_weight=0.1)
    np.testing.assert_allclose(found, [-20.0 * 5.0, 0.0], atol=1e-9)  # the feeler ahead meets the other after 40 px
    assert force(walls=[(41.0, 0.0), (0.0, 15.0)])[1] == "wander"


def test_forces_are_added_in_order_until_the_strongest() -> None:
    """A wall alone takes all 400 px/s²; 250 of it leave 150 to the flock."""
    walled = {"walls": [(30.0, 0.0)], "alignment_weight": 0.0, "separation_weight": 0.0}
    np.testing.assert_allclose(force([(0.1, 50.0)], **walled)[0], [-400.0, 0.0], atol=1e-9)
    some = force([(1e-6, 50.0)], **walled, wall_weight=0.125)[0]
    np.testing.assert_allclose(some, [-250.0, 150.0], atol=1e-4)


@pytest.mark.parametrize(
    ("place", "seen"),
    [((0.1, 200.0), True), ((200.9, 0.0), True), ((201.1, 0.0), False), ((-0.1, 50.0), False), ((0.1, -50.0), True)],
)
def test_sight_is_half_a_disc_ahead(place: tuple[float, float], seen: bool) -> None:
    assert force([place])[1] == ("flock" if seen else "wander")


class TestTurnRate:
    def test_it_bounds_the_turn_and_what_lies_across_the_nose_is_lost(self) -> None:
        found = force(walls=[(0.0, 10.0)], own=(100.0, 0.0), turn_rate_rad_s=2.0)[0]
        turn = -2.0 * DT
        after = np.array([100.0, -400.0 * DT])
        after *= 100.0 / np.hypot(*after)
        nose = np.array([math.cos(turn), math.sin(turn)])
        np.testing.assert_allclose(found, ((after @ nose) * nose - [100.0, 0.0]) / DT, rtol=1e-9)

    @pytest.mark.parametrize("before", [0.7, -0.7])
    def test_who_is_pushed_back_goes_on_turning(self, before: float) -> None:
        """At rest before a wall, a little to the left of it: it would turn right, and then left again."""
        parameters = {**STILL, "turn_rate_rad_s": 2.0}
        wall = PX * np.array([30.0, -1.0])
        own = Own(np.zeros(2), before, math.nan, np.full(2, math.nan), np.zeros(2, np.bool_), DT, 0, 0)
        nobody = Members(np.empty((0, 2)), np.empty(0), np.empty(0), np.empty((0, 2)), np.empty(0, np.int64))
        none = np.empty((3, 0), np.bool_)
        made = LAW.parameters(parameters)
        motion = LAW.function(own, nobody, none, Obstacles(wall[None]), made, np.zeros(2), np.full(2, 0.5))
        assert motion.x == pytest.approx(math.copysign(2.0 * DT, before))
        assert motion.y == 0.0


def test_two_that_see_one_another_come_to_fly_side_by_side() -> None:
    poses = np.array([[0.0, 0.0, 0.2], [0.4, 0.3, -0.2]])
    found = run("buckland-boids", poses, steps=900, dt=1.0 / 30.0, speed=0.8)
    late = found.positions_w[-300:]
    gaps = np.hypot(*(late[:, 0] - late[:, 1]).T) / PX
    assert gaps.max() < 48.0
    assert np.cos(found.headings_w[-300:, 0] - found.headings_w[-300:, 1]).mean() > 0.95
    speeds = np.hypot(*np.moveaxis(found.velocities_w, -1, 0))
    assert speeds.max() <= 0.8 * (1.0 + 1e-9)
    turns = np.diff(np.unwrap(found.headings_w, axis=0), axis=0)
    assert np.abs(turns).max() <= 2.0 / 30.0 + 1e-9
