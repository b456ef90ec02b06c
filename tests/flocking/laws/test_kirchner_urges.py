"""Kirchner 2006, section 2.4: each urge in closed form, their weighted sum, and Lorek and White's hierarchy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking.types import Kind
from tests.flocking.laws.asking import ask, run

SUM, HIERARCHY = "kirchner-urges-sum", "lorek-white"
NONE: dict[str, Any] = dict.fromkeys(
    ("centring_weight", "separation_weight", "matching_weight", "obstacle_weight", "migration_weight"), 0.0
)
FREE: dict[str, Any] = {"top_acceleration_m_s2": 1e6, "top_speed_m_s": 1e6}
C1, C2 = 1.5, 0.4
PLACES, VELOCITIES = np.array([[0.6, 0.8], [1.2, -0.5]]), np.array([[0.3, 0.1], [-0.2, 0.4]])
DISTANCES = np.array([1.0, 1.3])
UNITS = PLACES / DISTANCES[:, None]
INFLUENCES = C1 * C2**DISTANCES


def alone(name: str, urge: str, weight: float = 1.0, **changes: Any) -> np.ndarray:
    """The acceleration by one urge alone, of the two flockmates unless others are given."""
    given = {"positions": PLACES, "velocities": VELOCITIES, "influence": C1, "decay": C2, **NONE, **FREE, **changes}
    motion, _ = ask(name, **{**given, f"{urge}_weight": weight})
    assert motion.kind == Kind.ACCELERATION
    return np.array([motion.x, motion.y])


@pytest.mark.parametrize("name", [SUM, HIERARCHY])
class TestUrges:
    def test_centring_is_2_1(self, name: str) -> None:
        np.testing.assert_allclose(alone(name, "centring", 2.0), 2.0 * INFLUENCES @ UNITS)

    def test_separation_is_2_2_turned_round(self, name: str) -> None:
        found = alone(name, "separation")
        np.testing.assert_allclose(found, -(INFLUENCES / DISTANCES**2) @ UNITS)
        assert found @ UNITS[0] < 0.0

    def test_matching_is_2_3(self, name: str) -> None:
        own = (0.2, -0.1)
        found = alone(name, "matching", own_velocity=own)
        np.testing.assert_allclose(found, INFLUENCES @ (VELOCITIES - own))
        directions = VELOCITIES / np.hypot(*VELOCITIES.T)[:, None]
        found = alone(name, "matching", own_velocity=own, match_speeds=False)
        np.testing.assert_allclose(found, INFLUENCES @ (directions - np.array(own) / np.hypot(*own)))

    def test_the_nearest_obstacle_alone_is_avoided(self, name: str) -> None:
        """2.4 as an urge away from it; a flockmate is one too, unless told otherwise."""
        points = [[0.0, 2.0], [0.0, -0.5], [2.0, 0.0]]
        near = C1 * C2**0.5
        np.testing.assert_allclose(alone(name, "obstacle", obstacles=points), [0.0, near])
        np.testing.assert_allclose(
            alone(name, "obstacle", obstacles=points, obstacle_as_printed=True), [0.0, 0.5 * near]
        )
        np.testing.assert_allclose(alone(name, "obstacle"), -INFLUENCES[0] * UNITS[0])
        np.testing.assert_allclose(alone(name, "obstacle", obstacles=[[0.0, 1.5]]), -INFLUENCES[0] * UNITS[0])
        far = alone(name, "obstacle", obstacles=[[0.0, 1.5]], mates_are_obstacles=False)
        np.testing.assert_allclose(far, [0.0, -C1 * C2**1.5])
        np.testing.assert_array_equal(alone(name, "obstacle", mates_are_obstacles=False), [0.0, 0.0])

    @pytest.mark.parametrize("point", [[-1.0, 0.0], [2.5, 0.0], [-0.6, 0.9]])
    def test_an_obstacle_outside_of_the_neighbourhood_is_none(self, name: str, point: list[float]) -> None:
        motion, rule = ask(name, obstacles=[point])
        assert (motion.kind, rule) == (Kind.HOLD, "alone")

    def test_migration_is_a_unit_vector_that_knows_no_influence(self, name: str) -> None:
        for distance in (0.01, 1.0, 300.0):
            found = alone(name, "migration", 0.7, goal=(-0.6 * distance, 0.8 * distance))
            np.testing.assert_allclose(found, [-0.42, 0.56])
        np.testing.assert_array_equal(alone(name, "migration"), [0.0, 0.0])
        np.testing.assert_array_equal(alone(name, "migration", goal=(0.0, 0.0)), [0.0, 0.0])

    def test_urges_within_the_limit_add_up(self, name: str) -> None:
        weights = {"centring": 0.3, "separation": 0.1, "matching": 0.5, "obstacle": 0.2, "migration": 0.1}
        about: dict[str, Any] = {"goal": (5.0, 1.0), "obstacles": [[0.4, 0.4]], "own_velocity": (0.1, 0.0)}
        parts = [alone(name, urge, weight, **about) for urge, weight in weights.items()]
        together = {f"{urge}_weight": weight for urge, weight in weights.items()}
        motion, _ = ask(name, PLACES, velocities=VELOCITIES, influence=C1, decay=C2, **FREE, **together, **about)
        np.testing.assert_allclose([motion.x, motion.y], np.sum(parts, axis=0))

    def test_the_limits_of_acceleration_and_speed_hold(self, name: str) -> None:
        pulled: dict[str, Any] = {**NONE, "migration_weight": 50.0, "goal": (3.0, 4.0)}
        motion, _ = ask(name, top_acceleration_m_s2=0.5, **pulled)
        np.testing.assert_allclose([motion.x, motion.y], [0.3, 0.4])
        motion, _ = ask(name, own_velocity=(0.48, 0.64), top_speed_m_s=0.8, **pulled)
        np.testing.assert_allclose([motion.x, motion.y], 0.0, atol=1e-12)

    def test_nobody_keeps_its_motion(self, name: str) -> None:
        for positions in ([], [[-1.0, 0.0]], [[2.5, 0.0]]):
            motion, rule = ask(name, positions, own_velocity=(0.3, 0.0))
            assert (motion.kind, rule) == (Kind.HOLD, "alone")

    def test_a_flockmate_on_the_own_place_asks_for_matching_alone(self, name: str) -> None:
        motion, _ = ask(name, [[0.0, 0.0]] * 2, velocities=[0.2, 0.1], **FREE)
        np.testing.assert_allclose([motion.x, motion.y], [0.5 * 0.4, 0.5 * 0.2])

    def test_two_keep_the_distance_of_section_3_6_8(self, name: str) -> None:
        for gap in (0.6, 1.6):
            poses = np.array([[0.0, 0.0, math.pi / 2.0], [gap, 0.0, math.pi / 2.0]])
            history = run(name, poses, steps=1200, dt=0.1, speed=0.3, given={"matching_weight": 2.0})
            found = np.hypot(*(history.positions_w[-1, 0] - history.positions_w[-1, 1]))
            assert found == pytest.approx(36.0 * 0.0254, rel=0.01)


class TestPriority:
    NEAR: tuple[float, float] = (0.12, 0.0)
    """A flockmate whose separation exceeds what a body can do."""

    def test_migration_cancels_a_strong_separation_in_the_sum_alone(self) -> None:
        """Equally strong urges apart: the sum drives on, the hierarchy avoids at its limit."""
        given = {**NONE, "separation_weight": 0.084, "influence": 1.0, "decay": 1.0, "top_acceleration_m_s2": 0.5}
        strong = 0.084 / self.NEAR[0] ** 2
        assert strong > 10 * 0.5
        for name, expected in ((SUM, 0.0), (HIERARCHY, -0.5)):
            motion, _ = ask(name, [self.NEAR], goal=(9.0, 0.0), **{**given, "migration_weight": strong})
            np.testing.assert_allclose([motion.x, motion.y], [expected, 0.0], atol=1e-12)

    def test_a_centring_that_outweighs_it_turns_the_sum_round(self) -> None:
        given = {**NONE, "separation_weight": 0.084, "centring_weight": 10.0, "top_acceleration_m_s2": 0.5}
        assert ask(SUM, [self.NEAR], **given)[0].x == pytest.approx(0.5)
        assert ask(HIERARCHY, [self.NEAR], **given)[0].x == pytest.approx(-0.5)

    @pytest.mark.parametrize(
        ("strong", "rule", "direction"),
        [
            ("obstacle_weight", "obstacle", (0.0, 1.0)),
            ("separation_weight", "separation", (-1.0, 0.0)),
            ("matching_weight", "matching", (0.0, -1.0)),
            ("centring_weight", "centring", (1.0, 0.0)),
            ("migration_weight", "all urges", (-0.6, -0.8)),
        ],
    )
    def test_what_comes_after_the_urge_that_exceeds_the_limit_is_left_out(
        self, strong: str, rule: str, direction: tuple[float, float]
    ) -> None:
        """All that come later are a thousand times stronger, and do not count; those before are weak."""
        order = ["obstacle_weight", "separation_weight", "matching_weight", "centring_weight", "migration_weight"]
        at = order.index(strong)
        weights = {name: 1e-9 if k < at else 1e3 if k == at else 1e6 for k, name in enumerate(order)}
        motion, said = ask(
            HIERARCHY,
            [[1.0, 0.0]],
            velocities=[0.0, -1.0],
            goal=(-3.0, -4.0),
            obstacles=[[0.0, -0.5]],
            top_acceleration_m_s2=0.5,
            top_speed_m_s=9.0,
            **weights,
        )
        assert said == rule
        np.testing.assert_allclose([motion.x, motion.y], 0.5 * np.array(direction), atol=1e-9)

    def test_below_the_limit_both_are_the_same(self) -> None:
        for scale in (0.5, 2.0):
            asked: dict[str, Any] = {"positions": scale * PLACES, "velocities": VELOCITIES, "goal": (4.0, 4.0)}
            assert ask(SUM, **asked, **FREE)[0][:3] == pytest.approx(ask(HIERARCHY, **asked, **FREE)[0][:3])
