"""Ground truth: cases worked out by hand, and a plain oracle on random ones."""

from __future__ import annotations

from collections import Counter

import numpy as np

from flocking.types import NO_OBSTACLES, members_at
from sensing.truth import DETECTED, HIDDEN, MISSED, judge
from sensing.types import NOBODY, Detection, ScanTruth


def detection(beams, inputs: int) -> Detection:
    return Detection(members_at(np.ones((inputs, 2))), NO_OBSTACLES, np.asarray(beams, dtype=np.int64))


def truth(owners, lit) -> ScanTruth:
    owners = np.asarray(owners, dtype=np.int64)
    return ScanTruth(owners, np.ones(len(owners)), np.asarray(lit, dtype=np.int64))


def test_one_found_one_missed_one_hidden_one_made_up():
    beams = [0, 0, 0, -1, -1, -1, 1, 1, -1, -1]
    owners = [1, 1, 1, -1, 2, 2, -1, -1, -1, -1]
    said = judge(detection(beams, 2), truth(owners, [0, 4, 2, 0]), focal=0, robots=4)
    assert said.owners.tolist() == [1, NOBODY]
    assert said.states.tolist() == [HIDDEN, DETECTED, MISSED, HIDDEN]
    assert (said.lit, said.missed, said.made_up) == (6, 3, 2)  # one of member 1's four beams was lost in the sensor
    assert said.owners.dtype == np.int16
    assert said.states.dtype == np.int8


def test_two_members_taken_for_one_leave_the_smaller_missed():
    said = judge(detection([0] * 5, 1), truth([1, 1, 2, 2, 2], [0, 2, 3]), focal=0, robots=3)
    assert said.owners.tolist() == [2]
    assert said.states.tolist() == [HIDDEN, MISSED, DETECTED]
    assert (said.lit, said.missed, said.made_up) == (5, 0, 0)


def test_an_input_mostly_of_a_wall_is_nobodys_and_a_tie_is_the_members():
    assert judge(detection([0, 0, 0], 1), truth([-1, 1, -1], [0, 1]), 0, 2).owners.tolist() == [NOBODY]
    assert judge(detection([0, 0], 1), truth([-1, 1], [0, 1]), 0, 2).owners.tolist() == [1]
    assert judge(detection([0, 0], 1), truth([2, 1], [0, 1, 1]), 0, 3).owners.tolist() == [1]


def test_an_input_a_beam_each_beam_its_owner():
    said = judge(detection([0, 1, -1, 2], 3), truth([0, -1, 0, 0], [3, 0]), focal=1, robots=2)
    assert said.owners.tolist() == [0, NOBODY, 0]
    assert said.states.tolist() == [DETECTED, HIDDEN]
    assert (said.lit, said.missed, said.made_up) == (3, 1, 1)


def test_nothing_detected_and_nothing_there():
    said = judge(detection([-1] * 4, 0), truth([-1] * 4, [0, 0]), focal=0, robots=2)
    assert said.owners.shape == (0,)
    assert said.states.tolist() == [HIDDEN, HIDDEN]
    assert said[2:] == (0, 0, 0)


def test_a_reading_at_an_edge_that_no_beam_lit_makes_up_for_no_other_member():
    # two edge readings are member 1's beside its one lit beam; member 2's two beams are missed all the same
    said = judge(detection([0, 0, 0, -1, -1], 1), truth([1, 1, 1, 2, 2], [0, 1, 2]), focal=0, robots=3)
    assert said.states.tolist() == [HIDDEN, DETECTED, MISSED]
    assert (said.lit, said.missed, said.made_up) == (3, 2, 0)


def test_without_beams_owners_are_the_ids():
    members = members_at(np.ones((2, 2)))._replace(ids=np.array([3, 1]))
    for known in (None, truth([], [0, 5, 5, 5])):
        said = judge(Detection(members, NO_OBSTACLES, np.empty(0, np.int64)), known, focal=0, robots=4)
        assert said.owners.tolist() == [3, 1]
        assert said.states.tolist() == [HIDDEN, DETECTED, HIDDEN, DETECTED]
        assert said[2:] == (0, 0, 0)


def test_it_equals_a_plain_count_whatever_the_order_of_the_beams():
    rng = np.random.default_rng(11)
    for _ in range(200):
        robots, inputs = int(rng.integers(2, 7)), int(rng.integers(0, 9))
        beams = rng.integers(-1, inputs, 40) if inputs else np.full(40, -1)
        owners = rng.integers(-1, robots, 40)
        owners[owners == 0] = NOBODY  # the focal member never sees itself
        lit = np.bincount(owners + 1, minlength=robots + 1)[1:]
        said = judge(detection(beams, inputs), truth(owners, lit), 0, robots)
        for row in range(inputs):
            counts = Counter(owners[beams == row].tolist())
            best = max(counts.values(), default=0)
            leaders = [owner for owner in counts if counts[owner] == best]
            named = [owner for owner in leaders if owner >= 0]
            assert said.owners[row] == (min(named) if named else NOBODY)
        for k in range(1, robots):
            found = k in said.owners.tolist()
            assert said.states[k] == (DETECTED if found else MISSED if lit[k] else HIDDEN)
        assert said.lit == np.sum(owners >= 0)
        assert said.missed == np.sum((owners >= 0) & (beams < 0))
        assert said.made_up == np.sum((owners < 0) & (beams >= 0))
        order = rng.permutation(40)
        again = judge(detection(beams[order], inputs), truth(owners[order], lit), 0, robots)
        assert np.array_equal(again.owners, said.owners)
