"""Trials of either simulation held against a behaviour, in the units of the environment's file."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from flocking.errors import InputError
from generation.environment import Environment
from generation.files import to_json
from generation.primitives import Point, Polygon, Segment
from trials import keys, simulations
from trials.simulations import judged
from trials.simulations.kinematic import fields as kinematic
from trials.simulations.robots import fields as robots
from trials.types import Trial

ROOM = Polygon(((0, 0), (60, 0), (60, 40), (0, 40)), "inside")
TEXT = to_json(
    Environment((ROOM,), (Segment(30, 0, 30, 10),), {"start": Point(10.0, 20.0), "origin": Point(10.0, 20.0)})
)


def walkers(**given: Any) -> Trial:
    """Members that stand: without an input the law keeps the last command, and speed 0 is one."""
    herd = kinematic.group("random-motion", 6, speed_m_s=0.0, cruise_m_s=1e-6)
    made = kinematic.trial("t", 1, [herd], steps=100, timestep_s=1.0, world="unbounded")
    return of(made, **{"formation.spacing_m": 1.0, **given})


def creates(**given: Any) -> Trial:
    made = robots.trial("t", 1, [robots.group("snn", 2, speed_m_s=0.1)], duration_s=4.0)
    return of(made, **{"world.scale": 0.1, "behaviour.iteration_s": 0.4, **given})


def of(made: Trial, **given: Any) -> Trial:
    made = dataclasses.replace(made, world="a.json", world_source=TEXT)
    for key, value in sorted({"behaviour": "corralling", **given}.items()):
        made = keys.put(made, key, value)
    return made


@pytest.mark.parametrize(("radius_m", "elicited"), [(5.0, 1.0), (1e-3, 0.0)])
def test_a_herd_that_stays_at_its_start_is_corralled_there(radius_m: float, elicited: float) -> None:
    result = simulations.run_trial(walkers(**{"behaviour.radius_m": radius_m}), reraise=True)
    assert result.measures["elicited"] == result.measures["fitness"] == elicited
    simulations.check(result.trial)


def test_all_steps_are_judged_whichever_are_kept() -> None:
    """Corralling wants 50 iterations in a row; of 100 steps only 11 are kept."""
    result = simulations.run_trial(walkers(every=10), reraise=True)
    assert result.measures["elicited"] == 1.0
    assert len(result.times) == 11


@pytest.mark.parametrize(("consecutive", "elicited"), [(10, 1.0), (11, 0.0)])
def test_robots_are_judged_once_an_iteration(consecutive: int, elicited: float) -> None:
    """4 s are 10 iterations of 0.4 s: ten can be in a row, eleven not."""
    made = creates(**{"behaviour.consecutive": consecutive, "behaviour.threshold_m": 30.0})
    assert simulations.run_trial(made, reraise=True).measures["elicited"] == elicited


def test_positions_are_judged_in_the_files_units() -> None:
    """Two robots about 1 m apart at a scale of 0.1 are about 10 units apart."""
    near, far = (creates(**{"behaviour.consecutive": 5, "behaviour.threshold_m": t}) for t in (3.0, 30.0))
    assert simulations.run_trial(near, reraise=True).measures["elicited"] == 0.0
    assert simulations.run_trial(far, reraise=True).measures["elicited"] == 1.0


def test_a_trial_without_a_behaviour_has_no_such_measures_and_shows_no_such_key() -> None:
    made = keys.put(walkers(), "behaviour", "none")
    assert not judged.ABOUT.keys() & simulations.run_trial(made, reraise=True).measures.keys()
    assert not [row.key for row in keys.rows(made) if row.key.startswith("behaviour")]
    shown = {row.key: row.value for row in keys.rows(creates())}
    assert shown["behaviour"] == "corralling"
    assert shown["behaviour.iteration_s"] == 0.4
    assert shown["behaviour.radius_m"] == 25.0


@pytest.mark.parametrize("made", [walkers, creates])
@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("behaviour", "coralling", "unknown behaviour 'coralling'; did you mean corralling"),
        ("behaviour.radius_m", -1.0, r"behaviour\.radius_m = -1"),
        ("behaviour.radius", 1.0, r"unknown parameter 'behaviour\.radius'; did you mean"),
    ],
)
def test_what_does_not_exist_is_refused(made: Any, key: str, value: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        keys.put(made(), key, value)


def test_a_missing_marker_is_refused_before_anything_runs() -> None:
    made = dataclasses.replace(
        walkers(), world_source=to_json(Environment((ROOM,), markers={"start": Point(10, 20), "origin": ROOM}))
    )
    with pytest.raises(InputError, match="behaviour corralling: marker 'origin' is a polygon; expected a point"):
        simulations.check(made)


def test_behaviours_are_those_of_the_folder() -> None:
    assert {"none", "corralling", "simple-split"} <= set(judged.names())
    assert np.isfinite(list(judged.measure(walkers(), "corralling", np.zeros((60, 6, 2))).values())).all()
