"""Robot herds on made-up runs: what was published holds, the contrary does not; and what the experiments plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pytest

from flocking.laws import hodgins_brogan as law
from tests.trials.studies.judged import verdicts
from trials import design
from trials.simulations.running import fields, script
from trials.studies.robot_herds.design import (
    AHEAD,
    BODY,
    BREAKAWAY,
    EASIER_M,
    GAP,
    HERD,
    SELECTION,
    TESTS,
    VELOCITIES,
    VISIBLE,
)

WELL = {"falls": 0.0, "collisions_a_minute": 1.0}
BADLY = {"falls": 10.0, "collisions_a_minute": 30.0}


def robots(conditions: Mapping[str, Any]) -> bool:
    return bool(conditions[BODY] == "one-legged")


def test_steady_state() -> None:
    circle = {"aspect_start": 0.6, "aspect_end": 0.95, "radius_start": 8.7, "radius_end": 6.4}
    assert verdicts("herd-steady", lambda _: {**WELL, **circle}) == [True, True]
    oblong = {**circle, "aspect_end": 0.7}
    assert verdicts("herd-steady", lambda _: {**BADLY, **oblong}) == [False, False]
    wide = {**circle, "radius_end": 9.0}
    assert verdicts("herd-steady", lambda _: {**WELL, **wide}) == [True, False]


def test_acceleration() -> None:
    ahead = {"ahead_1": 0.0, "ahead_2": 0.3, "ahead_3": -0.3, "breakaways": 0.0}
    assert verdicts("herd-acceleration", lambda _: {**WELL, **ahead}) == [True, True]
    behind = {**ahead, "ahead_2": 0.0, "ahead_3": 0.0}
    assert verdicts("herd-acceleration", lambda _: {**WELL, **behind}) == [True, False]
    assert verdicts("herd-acceleration", lambda _: {**WELL, **ahead, "breakaways": 1.0}) == [True, False]


def test_zigzag() -> None:
    def published(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        own = robots(conditions)
        return {
            **WELL,
            "collisions": 8.0 * own,
            "user_away": 2.0 if own else 1.0,
            "off_course": 1.0,
            "lag_s": 2.0 * own,
            "aspect_end": 0.9,
            "unrest": 0.04 if own else 0.02,
        }

    assert verdicts("herd-zigzag", published) == [True] * 5
    alike = {"collisions": 0.0, "user_away": 1.0, "off_course": 1.0, "lag_s": 0.0, "aspect_end": 0.5, "unrest": 0.02}
    assert verdicts("herd-zigzag", lambda _: {**WELL, **alike}) == [True, False, False, False, False]


def test_obstacle() -> None:
    def published(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        own = robots(conditions) and conditions[AHEAD] < EASIER_M
        return {**WELL, "rejoin_s": 12.0 if own else 4.0, "first_hits": float(own), "obstacle_hits": 3.0}

    assert verdicts("herd-obstacle", published) == [True] * 6

    def reversed_(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        own = robots(conditions)
        return {**WELL, "rejoin_s": 4.0 if own else math.nan, "first_hits": 0.0, "obstacle_hits": 3.0 + 20.0 * own}

    assert verdicts("herd-obstacle", reversed_) == [True, False] * 3


def test_breakaway() -> None:
    def published(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        return {"breakaways": float(conditions[BREAKAWAY] > 30 or conditions[GAP] > 24.0)}

    assert verdicts("herd-breakaway", published) == [True]
    assert verdicts("herd-breakaway", lambda _: {"breakaways": 0.0}) == [False]
    assert verdicts("herd-breakaway", lambda _: {"breakaways": 1.0}) == [False]


def test_visible() -> None:
    def published(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        return {"unrest": 0.1 if robots(conditions) or conditions[VISIBLE] >= 30 else 0.4}

    assert verdicts("herd-visible", published) == [True]
    assert verdicts("herd-visible", lambda _: {"unrest": 0.2}) == [False]


def test_perception() -> None:
    def published(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        hidden, rear = (conditions[SELECTION].startswith(name) for name in ("unoccluded", "angle"))
        actual = robots(conditions) and conditions[VELOCITIES] == "actual"
        unrest = 0.4 if hidden and not robots(conditions) else 0.1
        return {"unrest": unrest, "speed_ratio": 3.0 if rear else 0.3 if actual else 1.0}

    assert verdicts("herd-perception", published) == [True] * 3
    assert verdicts("herd-perception", lambda _: {"unrest": 0.1, "speed_ratio": 1.0}) == [False] * 3

    def both_suffer(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        hidden = conditions[SELECTION].startswith("unoccluded")
        return {**published(conditions), "unrest": (0.4 if not robots(conditions) else 0.18) if hidden else 0.1}

    assert verdicts("herd-perception", both_suffer) == [True, False, True]


def test_the_law_has_the_published_numbers() -> None:
    given = law.Parameters()
    told = HERD["visible_n"], HERD["visible_radius_m"], HERD["desired_distance_m"], HERD["kp"], HERD["kv"]
    assert (given.visible, given.range_m, given.spacing_m, given.kp_per_s, given.kv) == told
    assert given.aim_radii == TESTS["obstacle"]["aim_at_radii"]
    assert fields.GroupFields().count == HERD["individuals"]


@pytest.mark.parametrize(
    ("name", "duration", "legs"),
    [
        ("herd-steady", 300.0, [(0.0, 2.0, 0.0)]),
        ("herd-acceleration", 390.0, [(0.0, 2.0, 0.0), (30.0, 3.0, 0.0), (60.0, 1.5, 0.0)]),
        (
            "herd-zigzag",
            115.0,
            [(0.0, 2.0, 0.0), (5.0, 1.41, 1.41), (25.0, 1.41, -1.41), (45.0, 1.41, 1.41), (65.0, 1.41, -1.41)],
        ),
    ],
)
def test_the_tests_are_those_of_the_publication(name: str, duration: float, legs: list[tuple[float, ...]]) -> None:
    trial = design.plan(name).trials[0]
    given, own = fields.of_trial(trial), fields.of_group(fields.group_of(trial))
    assert given.duration_s == duration
    assert [tuple(leg) for leg in script.parse(given.script)] == legs
    assert own.count == 105
    law = dict(fields.group_of(trial).law_parameters)
    assert law.get("visible", 30) == 30
    assert len(design.plan(name).trials) == 20
