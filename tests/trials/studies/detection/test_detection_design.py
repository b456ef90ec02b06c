"""Where the design of the detection case study repeats a published number, the two are equal."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from flocking.types import Own
from robots import body
from sensing.pipelines import perfect
from sensing.types import Senses, WorldTruth
from trials.design import plan
from trials.evidence.claims import published
from trials.simulations.robots.fields import of_group, of_trial
from trials.simulations.robots.starts import starting_poses
from trials.studies.detection import detection_abreast, detection_case_study
from trials.studies.detection.detection_case_study import FORMATIONS
from trials.studies.detection.judges import JUDGES
from trials.types import Trial
from worlds import corridor

STUDY = published("trials.studies.detection", "fine2015", "detection_case_study")


def test_the_case_study_is_as_large_as_the_publication() -> None:
    trials = plan("detection-case-study").trials
    assert len(trials) == STUDY["trials"]
    assert {sum(group.count for group in trial.groups) for trial in trials} == {STUDY["robots"]}
    assert len({trial.formation for trial in trials}) == STUDY["starting_formations"] == len(FORMATIONS)


def blind(trial: Trial) -> int:
    """How many robots see nobody at the start, knowing all that is within the laser's view and in sight."""
    poses_w = starting_poses(trial)
    own = Own(np.zeros(2), 0.0, math.nan, np.full(2, math.nan), np.zeros(2, dtype=np.bool_), 0.1, 0, 0)
    radii, none = np.full(len(poses_w), body.load("create").silhouette_radius), np.zeros((len(poses_w), 2))
    seen = [
        perfect.detect(Senses(None, WorldTruth(poses_w, none, radii, k, np.empty((0, 4)))), own, perfect.Parameters())
        for k in range(len(poses_w))
    ]
    return sum(len(detection.members.ids) == 0 for detection, _ in seen)


def test_somebody_sees_nobody_at_every_start() -> None:
    """Fine 2015, section 4.2: "directional motion occurs when one or more robots do not observe other robots"."""
    assert min(blind(detection_case_study.base(repeat)) for repeat in range(1, 61)) >= 1


def test_before_everybody_saw_somebody_in_two_formations_of_three() -> None:
    starts = [detection_abreast.base(repeat) for repeat in range(1, 61)]
    assert [start.formation for start in starts[:3]] == list(detection_abreast.FORMATIONS)
    assert max(blind(start) for start in starts if start.formation != "scattered") == 0


def test_who_goes_straight_on_meets_no_wall() -> None:
    """Section 2.3.1: a corridor free of obstacles, long enough to be considered infinite."""
    half_width = corridor.Parameters().width_m / 2.0 - body.load("create").radius
    for repeat in range(1, 61):
        trial = detection_case_study.base(repeat)
        way = of_trial(trial).duration_s * of_group(trial.groups[0]).speed_m_s
        _, y, heading = starting_poses(trial).T
        assert np.abs(y + way * np.sin(heading)).max() < half_width


def test_the_first_formations_are_an_arm_that_differs_in_nothing_else() -> None:
    now, before = detection_case_study.base(2), detection_abreast.base(2)
    assert dataclasses.replace(before, experiment=now.experiment, formation=now.formation) == now
    assert detection_abreast.REPEATS % len(detection_abreast.FORMATIONS) == 0


def test_its_exclusion_distances_are_the_published_ones() -> None:
    assert plan("detection-case-study").conditions["herd.law.exclusion_m"] == STUDY["exclusion_distances_m"]


def test_its_corridor_is_as_wide_as_published() -> None:
    width = STUDY["corridor_width_robot_diameters"] * 2.0 * body.load("create").radius
    assert corridor.Parameters().width_m == pytest.approx(width)


def test_every_claim_has_its_judge() -> None:
    assert len(JUDGES) == len(STUDY["claims"]) == len(STUDY["sections"]) == 13
