"""Kirchner 2006, sections 3.5 and 3.6.6 to 3.6.8: the message, the controller, and the readings of its equations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.laws import moshtagh_kirchner as kirchner
from flocking.message import NOBODY, Message
from flocking.types import NO_OBSTACLES, Kind, Members, Own
from robots import body as bodies
from tests.flocking.laws.asking import ask

INCH = 0.0254
DT = 0.1
NAME = "moshtagh-kirchner"


def memory_at(speed: float, turn_rate: float = 0.0) -> Any:
    memory = np.zeros(kirchner.MEMORY)
    memory[kirchner.SPEED], memory[kirchner.STARTED], memory[kirchner.TURN] = speed, 1.0, turn_rate
    return memory


def control(told: Message, memory: Any, u: float = 0.5, dt: float = DT, **given: Any) -> tuple[Any, str]:
    """What the controller makes of the message, not compiled."""
    parameters = lawentry.load(NAME).parameters(given)
    motion = kirchner.controlled.py_func(told, dt, parameters, memory, np.array([u]))
    return motion, kirchner.RULES[motion.rule]


def seen(positions: Any, velocities: Any, turn_rate: float = 0.0, own_velocity: Any = (0.0, 0.0), **given: Any) -> Any:
    """The image process's message, not compiled."""
    places = np.array(positions, dtype=float).reshape(-1, 2)
    count = len(places)
    speeds = np.broadcast_to(np.array(velocities, dtype=float), (count, 2)).copy()
    unknown = np.full(count, math.nan)
    members = Members(places, np.arctan2(places[:, 1], places[:, 0]), unknown, speeds, np.arange(count))
    own = Own(np.array(own_velocity), turn_rate, math.nan, np.full(2, math.nan), np.zeros(2, bool), DT, 0, 0)
    sets = np.ones((1, count), dtype=bool)
    return kirchner.message.py_func(own, members, sets, NO_OBSTACLES, lawentry.load(NAME).parameters(given))


class TestMessage:
    def test_it_is_equations_3_7_and_3_8_of_the_nearest(self) -> None:
        x, y, vx, vy = 1.5, -0.8, 0.2, 0.35
        moment = 1e-6
        distance, bearing = math.hypot(x, y), -math.atan2(y, x)  # clockwise, as the cameras' angles are added
        later_x, later_y = x + vx * moment, y + vy * moment
        bearing_rate = (-math.atan2(later_y, later_x) - bearing) / moment
        closure = (math.hypot(later_x, later_y) - distance) / moment
        impact_s = -distance / closure
        omega = -2.0 * bearing_rate / 2.0 * math.sqrt(1.0 + 1.0 / (impact_s * bearing_rate) ** 2)
        found = seen([[x, y], [3.0, 0.0]], [[vx + 0.3, vy], [1.0, 1.0]], own_velocity=(0.3, 0.0), coupling=2.0)
        assert found == pytest.approx((omega, closure, distance, -bearing), rel=1e-5)

    def test_all_of_them_add_up_to_omega_and_the_nearest_is_the_rest(self) -> None:
        positions, velocities = [[1.0, 0.2], [0.0, 1.5], [2.0, -1.0]], [[0.1, 0.2], [-0.2, 0.1], [0.0, -0.3]]
        each = [seen([p], [v]) for p, v in zip(positions, velocities, strict=True)]
        both = seen(positions, velocities, nearest_only=False)
        assert both.omega == pytest.approx(sum(one.omega for one in each))
        assert both[1:] == each[0][1:]
        assert seen(positions, velocities) == each[0]

    @pytest.mark.parametrize("nearest_only", [True, False])
    def test_one_seen_for_the_first_time_has_a_distance_and_a_bearing(self, nearest_only: bool) -> None:
        told = seen([[0.2, 0.1], [2.0, 0.0]], [[math.nan, math.nan], [0.1, 0.3]], nearest_only=nearest_only)
        alone = seen([[2.0, 0.0]], [[0.1, 0.3]], nearest_only=False)
        assert told == (0.0 if nearest_only else alone.omega, 0.0, math.hypot(0.2, 0.1), math.atan2(0.1, 0.2))
        _, rule = control(told, memory_at(0.3))
        assert rule == "danger"  # it stops without knowing whether the other closes in

    def test_nobody_is_no_distance(self) -> None:
        assert seen([], (0.0, 0.0)) == pytest.approx(tuple(NOBODY), nan_ok=True)
        assert math.isnan(NOBODY.distance)

    def test_with_the_own_turning_the_bearing_turns_by_it(self) -> None:
        """A member that stands still, seen by one that turns on the spot to the left: it moves to the right."""
        assert seen([[1.0, 0.0]], [[0.0, 0.0]], turn_rate=0.4).omega == 0.0
        assert seen([[1.0, 0.0]], [[0.0, 0.0]], turn_rate=0.4, own_turning=True, coupling=1.0).omega == -0.2

    def test_one_that_comes_straight_on_asks_for_no_turn(self) -> None:
        """Its bearing keeps, but for rounding, whose sign would decide the side of a large turn."""
        for angle in np.linspace(-1.4, 1.4, 29):
            x, y = 1.3 * math.cos(angle), 1.3 * math.sin(angle)
            assert seen([[x, y]], [[-0.5 * math.cos(angle), -0.5 * math.sin(angle)]]).omega == 0.0

    @pytest.mark.parametrize("offset", [0.0, 1e-170, 1e-12])
    def test_a_member_on_the_own_place_is_finite(self, offset: float) -> None:
        for nearest_only in (True, False):
            found = seen([[offset, 0.0]] * 2, [[0.1, 0.0]], nearest_only=nearest_only)
            assert all(map(math.isfinite, found))


class TestSpeed:
    @pytest.mark.parametrize(
        ("growth", "closing", "apart"), [(0, 0.0, 1.0), (1, 1.0, 1.0), (2, -1.0, 1.0)], ids=["apart", "abs", "signed"]
    )
    def test_equation_3_17_by_its_three_readings(self, growth: int, closing: float, apart: float) -> None:
        """An inch nearer or farther since the last update: a 150th of a metre a second."""
        for sign, change in ((-1.0, closing), (1.0, apart)):
            told = Message(0.0, sign * INCH / DT, 50.0 * INCH, 0.0)
            motion, _ = control(told, memory_at(0.4), growth=growth)
            assert motion.y == pytest.approx(0.4 + change / 150.0)

    def test_the_closure_rate_of_a_second_does_not_know_the_frame_rate(self) -> None:
        told = Message(0.0, INCH, 50.0 * INCH, 0.0)
        for dt in (0.05, 0.1):
            assert control(told, memory_at(0.4), dt=dt, growth_per_update=False)[0].y == pytest.approx(0.4 + 1.0 / 150)
            assert control(told, memory_at(0.4), dt=dt)[0].y == pytest.approx(0.4 + dt / 150.0)

    def test_it_keeps_between_the_least_and_the_top_speed(self) -> None:
        fast = Message(0.0, 50.0, 2.0, 0.0)
        assert control(fast, memory_at(0.7))[0].y == 0.8
        assert control(fast._replace(closure=-50.0), memory_at(0.3), growth=2)[0].y == 0.1
        assert control(fast._replace(closure=-50.0), memory_at(0.05), growth=2)[0].y == 0.05  # no faster than it was

    def test_at_the_ideal_distance_it_keeps_its_speed(self) -> None:
        assert control(Message(0.0, 0.2, 36.0 * INCH, 0.0), memory_at(0.4), ideal_m=36.0 * INCH)[0].y == 0.4

    def test_too_near_it_slows_down_whether_it_closes_in_or_not(self) -> None:
        for closure in (-0.3, 0.3):
            motion, rule = control(Message(0.1, closure, 30.0 * INCH, 0.2), memory_at(0.4))
            assert (rule, motion.y) == ("flock", pytest.approx(0.4 - 0.2 * DT))
            assert motion.x == pytest.approx(0.1 * DT)


class TestTurningAway:
    @pytest.mark.parametrize(
        ("inches", "speed", "closure", "rule"),
        [
            (30.0, 0.1, -0.1, "turn away"),
            (30.0, 0.1, 0.1, "flock"),
            (30.0, 0.1, 0.0, "flock"),
            (30.0, 0.3, -0.1, "flock"),
            (37.0, 0.1, -0.1, "flock"),
            (9.9, 0.3, 0.1, "danger"),
            (10.1, 0.3, -0.1, "flock"),
        ],
    )
    def test_only_too_near_at_the_least_speed_and_still_closing(
        self, inches: float, speed: float, closure: float, rule: str
    ) -> None:
        motion, said = control(Message(0.3, closure, inches * INCH, 0.4), memory_at(speed))
        assert said == rule
        assert (motion.x < 0.0) == (rule != "flock")  # the other is to the left, and ω turns to the left
        assert (motion.y == 0.0) == (rule == "danger")

    def test_equation_3_18_replaces_the_turn_rate_or_adds_to_it(self) -> None:
        told = Message(0.0, -0.1, 23.0 * INCH, math.radians(-55.0))  # ten degrees a second
        ten = math.radians(10.0)
        memory = memory_at(0.1, turn_rate=0.05)
        turns = [control(told, memory)[0].x for _ in range(3)]
        assert turns == pytest.approx([ten * DT] * 3)
        memory = memory_at(0.1, turn_rate=0.05)
        turns = [control(told, memory, turn_adds=True)[0].x for _ in range(20)]
        assert turns[:3] == pytest.approx([(0.05 + n * ten) * DT for n in (1, 2, 3)])
        assert turns[-1] == 2.0 * DT  # never faster than it can

    @pytest.mark.parametrize("bearing", [0.0, -0.0, math.pi, -math.pi])
    def test_the_side_is_drawn_where_there_is_none(self, bearing: float) -> None:
        told = Message(0.0, -0.1, 0.5, bearing)
        assert control(told, memory_at(0.1), u=0.2)[0].x < 0.0 < control(told, memory_at(0.1), u=0.8)[0].x

    def test_after_a_stop_it_goes_on_or_stands(self) -> None:
        near = Message(0.0, 0.1, 0.2, 0.3)
        for kept, speed in ((False, 0.28), (True, 0.0)):
            memory = memory_at(0.3)
            assert control(near, memory, stop_is_kept=kept)[0].y == 0.0
            motion, rule = control(NOBODY, memory, stop_is_kept=kept)
            assert (rule, motion.x, motion.y) == ("straight ahead", 0.0, pytest.approx(speed))


class TestTurning:
    def test_omega_is_a_turn_rate_or_an_angular_acceleration(self) -> None:
        told = Message(0.5, 0.0, 2.0, 0.1)
        memory, faster = memory_at(0.3), memory_at(0.3)
        assert [control(told, memory)[0].x for _ in range(3)] == pytest.approx([0.5 * DT] * 3)
        turns = [control(told, faster, omega_accelerates=True)[0].x for _ in range(100)]
        assert turns[:3] == pytest.approx([0.5 * n * DT * DT for n in (1, 2, 3)])
        assert turns[-1] == 2.0 * DT
        assert control(NOBODY, faster, omega_accelerates=True)[0].x == 0.0  # straight ahead
        assert control(told, faster, omega_accelerates=True)[0].x == pytest.approx(0.5 * DT * DT)

    @pytest.mark.parametrize("body", ["create", "pioneer"])
    @pytest.mark.parametrize("rate", [-0.9, -0.2, 0.03, 0.2, 0.7])
    def test_with_an_aim_ahead_bodies_turn_at_the_very_rate(self, body: str, rate: float) -> None:
        given = lawentry.load(NAME).create
        motion, _ = control(Message(rate, 0.0, 2.0, 0.1), memory_at(0.2), **given)
        assert motion.kind == Kind.VELOCITY
        speed, turned = bodies.load(body).follow(motion.kind, motion.x, motion.y, 0.25, 0.2, 0.0, DT)
        assert turned == pytest.approx(rate, rel=1e-9)
        assert speed == pytest.approx(0.2 * math.cos(0.5 * rate))

    @pytest.mark.parametrize("degrees", [0.0, 60.0, 105.0])
    def test_a_stopped_body_turns_away_at_the_very_rate(self, degrees: float) -> None:
        given = lawentry.load(NAME).create
        motion, rule = control(Message(0.0, 0.1, 9.0 * INCH, math.radians(-degrees)), memory_at(0.0), u=0.9, **given)
        assert (rule, motion.kind, motion.y) == ("danger", Kind.HEADING, 0.0)
        speed, turned = bodies.load("create").follow(motion.kind, motion.x, motion.y, 0.25, 0.0, 0.0, DT)
        assert (speed, turned) == (
            0.0,
            pytest.approx(kirchner.turn_away_rate.py_func(9.0 * INCH, math.radians(degrees))),
        )

    def test_an_aim_never_lies_behind(self) -> None:
        motion, _ = control(Message(9.0, 0.0, 2.0, 0.1), memory_at(0.2), aim_s=3.0)
        assert motion.x > 0.0


def test_the_law_is_the_controllers_answer_to_the_message() -> None:
    positions, velocities = [[0.5, 0.2], [1.0, 1.5]], [[0.1, 0.2], [-0.2, 0.1]]
    for given in ({}, {"nearest_only": False, "omega_accelerates": True}, {"own_turning": True, "turn_adds": True}):
        one, other = memory_at(0.2, 0.1), memory_at(0.2, 0.1)
        motion, _ = ask(NAME, positions, velocities=velocities, turn_rate=0.3, memory=one, **given)
        answer, _ = control(seen(positions, velocities, turn_rate=0.3, **given), other, **given)
        assert motion == answer
        np.testing.assert_array_equal(one, other)
