"""`herd watch`: keys steer the creature that a herd follows, and the ride can be run again."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from trials import simulations
from trials.commands import watching
from trials.commands.watching import DOWN, ESCAPE, LEFT, MOST_M_S, RIGHT, SPACE, STEP_M_S, STEP_RAD, UP, Asked, pressed
from trials.design import plan
from trials.types import Trial

TIMES = 1e6
"""Times real time: nobody waits for the clock."""


class Fingers:
    """A window at which keys are pressed at given looks; it closes after the last."""

    def __init__(self, presses: dict[int, int], looks: int) -> None:
        self.presses, self.looks, self.count, self.closed = presses, looks, 0, False
        self.places: list[Any] = []
        self.on_key: Callable[[int], None] = lambda key: None

    def opened(self, model: Any, data: Any, on_key: Callable[[int], None]) -> Fingers:
        self.model, self.data, self.on_key = model, data, on_key
        return self

    def is_running(self) -> bool:
        return self.count < self.looks

    def sync(self) -> None:
        self.places.append(self.data.mocap_pos.copy() if self.model.nmocap else self.data.qpos.copy())
        if self.count in self.presses:
            self.on_key(self.presses[self.count])
        self.count += 1

    def close(self) -> None:
        self.closed = True


def few(trial: Trial) -> Trial:
    """Twelve creatures."""
    return dataclasses.replace(trial, groups=(dataclasses.replace(trial.groups[0], count=12),))


class TestKeys:
    def test_arrows_change_speed_and_direction_within_bounds(self) -> None:
        asked = Asked(2.0, 0.0)
        assert pressed(asked, UP) == (2.0 + STEP_M_S, 0.0)
        assert pressed(asked, DOWN) == (2.0 - STEP_M_S, 0.0)
        assert pressed(asked, LEFT) == (2.0, STEP_RAD)
        assert pressed(pressed(asked, LEFT), RIGHT) == asked
        assert pressed(Asked(MOST_M_S, 0.0), UP).speed_m_s == MOST_M_S
        assert pressed(Asked(0.0, 0.0), DOWN).speed_m_s == 0.0
        assert pressed(asked, SPACE) == (0.0, 0.0)
        assert pressed(asked, ord("Q")) == asked

    def test_a_turn_to_the_left_is_counter_clockwise(self) -> None:
        x, y = Asked(1.0, math.pi / 2.0).velocity
        assert (x, y) == pytest.approx((0.0, 1.0), abs=1e-3)


def test_the_herd_is_shown_and_the_ride_can_be_run_again() -> None:
    trial = few(plan("herd-steady", repeats=1).trials[0])
    own = simulations.of(trial)
    assert own.steered is not None
    fingers = Fingers({3: LEFT, 6: UP, 30: ESCAPE}, looks=40)
    keys = watching.Keys(TIMES, Asked(2.0, 0.0), fingers.opened)
    result = own.steered(trial, keys)
    assert len(fingers.places) == 31  # Escape ends it at the next look
    assert np.abs(fingers.places[-1] - fingers.places[0]).max() > 1.0  # 1.5 s at 2 m/s
    assert result.trial.setup["script"].count(";") == 2
    again = simulations.run_trial(result.trial, reraise=True)
    np.testing.assert_array_equal(again.poses_w, result.poses_w)
    assert again.measures == pytest.approx(result.measures, nan_ok=True)


def test_robots_are_shown_in_their_own_world() -> None:
    trial = next(each for each in plan("herd-steady", repeats=1).trials if "one-legged" in each.conditions.values())
    own = simulations.of(trial)
    assert own.steered is not None
    fingers = Fingers({}, looks=5)
    result = own.steered(few(trial), watching.Keys(TIMES, Asked(0.0, 0.0), fingers.opened))
    assert fingers.model.nu > 0
    assert not np.array_equal(fingers.places[0], fingers.places[-1])
    assert result.measures["upright"] == 1.0


def test_the_command_tells_how_to_repeat_the_ride(capsys: pytest.CaptureFixture[str]) -> None:
    fingers = Fingers({1: SPACE}, looks=4)
    watching.watch("herd-steady", 1, TIMES, {"herd.count": 12}, None, fingers.opened)
    assert fingers.closed
    told = capsys.readouterr().out
    assert re.search(r"herd run herd-steady --only 1 .*script=\"0: 2, 0; 0.\d+: 0, 0\"", told)


@pytest.mark.parametrize(
    ("experiment", "number", "words"),
    [("follow-1", 1, "nobody to steer"), ("herd-steady", 999, "--trial 999")],
)
def test_what_cannot_be_steered_is_refused(experiment: str, number: int, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        watching.watch(experiment, number, 1.0, {}, None, Fingers({}, 1).opened)
    assert "\n" not in str(refused.value)


def test_without_a_display_there_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    glfw = pytest.importorskip("glfw")
    monkeypatch.setattr(glfw, "init", lambda: False)
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    with pytest.raises(InputError, match="no display"):
        watching.opened(model, mujoco.MjData(model), lambda key: None)
