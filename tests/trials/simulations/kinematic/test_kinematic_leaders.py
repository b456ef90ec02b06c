"""Leaders in kinematic herds: the first members of a group have another role, and nothing else of the herd changes."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.measures.formation import polarization
from trials import keys, simulations
from trials.simulations.kinematic import fields
from trials.simulations.kinematic.herd import assemble, check
from trials.types import Trial, Value

COUNT = 20


def herd(law: str, leaders: int | None, steps: int = 30, **more: Value) -> Trial:
    given: dict[str, Value] = {"informed_share": 0.3, **more, **({} if leaders is None else {"leaders": leaders})}
    return fields.trial("made-up", 1, [fields.group(law, COUNT, **given)], steps=steps)


@pytest.mark.parametrize("leaders", [1, 7, COUNT])
@pytest.mark.parametrize("law", ["reynolds-opensteer", "conradt"])
def test_a_law_that_knows_no_roles_moves_the_same_with_leaders(law: str, leaders: int) -> None:
    trial = herd(law, leaders)
    alike = simulations.run_trial(herd(law, 0))
    led = simulations.run_trial(trial)
    assert (led.poses_w == alike.poses_w).all()  # to the last bit: the same sums in the same order
    assert led.measures == pytest.approx(alike.measures, abs=0.0, nan_ok=True)


def test_a_law_that_knows_them_moves_otherwise() -> None:
    alike = simulations.run_trial(herd("jadbabaie-leader", 0)).poses_w
    led = simulations.run_trial(herd("jadbabaie-leader", 1)).poses_w
    assert (led[-1] != alike[-1]).any()
    assert np.ptp(led[:, 0, 2]) == 0.0  # the leader keeps its heading
    assert np.ptp(alike[:, 0, 2]) > 0.0


def test_followers_linked_to_a_leader_take_up_its_heading() -> None:
    """Jadbabaie, Lin and Morse 2003: all linked at all times, so every follower comes to the leader's heading."""
    trial = herd("jadbabaie-leader", 1, steps=1000)
    led = simulations.run_trial(keys.put(trial, "herd.law.range_m", 100.0))
    headings = led.poses_w[-1, :, 2]
    # each step takes 1/20 of the way from the others' mean to the leader: (1 - 1/20)^1000 = 5e-23
    assert np.cos(headings - headings[0]).min() == pytest.approx(1.0, abs=1e-12)
    assert polarization(headings[None])[0] == pytest.approx(1.0, abs=1e-12)


def test_goals_and_members_own_parameters_stay_with_their_members() -> None:
    spread = keys.put(herd("couzin", 0), "herd.spread.rho_m", 0.3)
    (whole,) = assemble(spread).bands
    first, others = assemble(keys.put(spread, "herd.leaders", 4)).bands
    assert (first.count, others.count) == (4, COUNT - 4)
    assert (first.role, others.role) == (1, 0)
    assert [*first.parameters, *others.parameters] == list(whole.parameters)
    assert first.goals_w is not None
    assert others.goals_w is not None
    np.testing.assert_array_equal(np.concatenate([first.goals_w, others.goals_w]), whole.goals_w)


def test_kinds_and_radii_are_those_of_the_groups() -> None:
    groups = [fields.group("couzin", 6, name=name, informed_share=0.5, radius_m=0.1) for name in ("first", "second")]
    trial = fields.trial("made-up", 1, groups, steps=2)
    led = keys.put(trial, "first.leaders", 2)
    assert len(assemble(led).bands) == 2  # leaders, and all others: such groups are one band
    np.testing.assert_array_equal(assemble(led).kinds, assemble(trial).kinds)
    assert simulations.run_trial(led).radii.tolist() == [0.1] * 12


@pytest.mark.parametrize(("law", "leaders"), [("jadbabaie-leader", 1), ("vicsek", 0), ("random-motion", 0)])
def test_a_law_has_the_leaders_of_its_own_herd_by_itself(law: str, leaders: int) -> None:
    trial = herd(law, None)
    assert sum(band.count for band in assemble(trial).bands if band.role == 1) == leaders
    (shown,) = [row.value for row in keys.rows(trial) if row.key == "herd.leaders"]
    assert shown == leaders


def test_a_herd_smaller_than_its_laws_leaders_consists_of_them() -> None:
    trial = fields.trial("made-up", 1, [fields.group("gueron", 3)], steps=2)
    (band,) = assemble(trial).bands
    assert (band.count, band.role) == (3, 1)


def test_more_leaders_than_members_are_refused() -> None:
    with pytest.raises(InputError, match=f"herd.leaders = {COUNT + 1}: expected at most the {COUNT} members"):
        check(herd("vicsek", COUNT + 1))
