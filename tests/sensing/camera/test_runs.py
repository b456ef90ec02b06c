"""Algorithm 2 against the thesis's example and an oracle in plain Python."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensing.camera.runs import accepted, all_runs, longest, widest_at_columns


def row(*lengths: int) -> np.ndarray:
    """One row: so many orange, so many not, so many orange …"""
    return np.concatenate([np.full(n, (k + 1) % 2, np.uint8) for k, n in enumerate(lengths)])[None]


def plain_runs(labels: np.ndarray, colours: int, hole: int) -> list[tuple[int, int, int, int]]:
    """All runs by joining stretches of equal pixels, with none of the compiled code's states."""
    found = []
    for k in range(colours):
        for i, line in enumerate(labels):
            stretches: list[list[int]] = []
            for j in np.flatnonzero(line == k + 1):
                if stretches and j - stretches[-1][1] - 1 <= hole:
                    stretches[-1][1] = int(j)
                else:
                    stretches.append([int(j), int(j)])
            found += [(k, i, a, b) for a, b in stretches]
    return found


def test_twelve_orange_four_others_and_seven_orange_are_a_run_of_23():
    assert longest(row(12, 4, 7), 1).tolist() == [[0, 0, 0, 22]]


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [
        ((12, 5, 7), (0, 23)),  # a hole of five is allowed
        ((12, 6, 7), (0, 11)),  # one of six is not, and the run ends at its last orange pixel
        ((7, 6, 12), (13, 24)),  # a run that reaches the last column counts
        ((3, 3, 3, 3, 3), (0, 14)),  # consecutive: each hole is counted anew
        ((0, 4, 6, 20), (4, 9)),  # what follows the last orange pixel is no part of it
        ((5, 6, 5), (0, 4)),  # of equal ones, the first
        ((1,), (0, 0)),
    ],
)
def test_holes(lengths, expected):
    (run,) = longest(row(*lengths), 1)
    assert tuple(run[2:]) == expected


def test_runs_do_not_go_on_in_the_next_row_and_the_upper_of_equals_is_first():
    labels = np.zeros((3, 20), np.uint8)
    labels[0, 15:] = labels[1, :5] = labels[2, 3:8] = 1
    assert longest(labels, 1).tolist() == [[0, 0, 15, 19]]


def test_no_orange_is_no_run():
    assert longest(np.zeros((4, 9), np.uint8), 2)[:, 1].tolist() == [-1, -1]
    assert accepted(np.zeros((4, 9), np.uint8), 1, 5, 1).shape == (0, 4)
    assert np.all(widest_at_columns(np.zeros((4, 9), np.uint8), 1, 5)[:, 1] == -1)


masks = st.builds(
    lambda seed, height, width, colours, density: (
        np.where(
            np.random.default_rng(seed).random((height, width)) < density,
            np.random.default_rng(seed + 1).integers(1, colours + 1, (height, width)),
            0,
        ).astype(np.uint8),
        colours,
    ),
    st.integers(0, 10**6),
    st.integers(1, 6),
    st.integers(1, 40),
    st.integers(1, 3),
    st.sampled_from([0.05, 0.2, 0.5, 0.9]),
)


@settings(max_examples=300, deadline=None)
@given(masks, st.integers(0, 6), st.integers(1, 6))
def test_all_forms_are_those_of_plain_python(mask, hole, minimum):
    labels, colours = mask
    expected = plain_runs(labels, colours, hole)
    for k, run in enumerate(longest(labels, colours, hole)):
        mine = [r for r in expected if r[0] == k]
        best = max(mine, key=lambda r: (r[3] - r[2], -r[1], -r[2]), default=None)
        assert (run[1] == -1) if best is None else (tuple(run) == best)
    long_enough = [r for r in expected if r[3] - r[2] + 1 >= minimum]
    assert sorted(map(tuple, all_runs(labels, colours, hole, minimum).tolist())) == sorted(long_enough)

    kept: list[tuple[int, int, int, int]] = []
    for run in sorted(long_enough, key=lambda r: r[2] - r[3]):
        if all(o[0] != run[0] or o[3] < run[2] or run[3] < o[2] for o in kept):
            kept.append(run)
    got = [tuple(r) for r in accepted(labels, colours, hole, minimum).tolist()]
    lengths = [r[3] - r[2] for r in got]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[:1] == [r[3] - r[2] for r in kept][:1]
    for k in range(colours):
        by_rows = sorted((r for r in long_enough if r[0] == k), key=lambda r: (r[2] - r[3], r[1], r[2]))
        mine = []
        for run in by_rows:
            if all(o[3] < run[2] or run[3] < o[2] for o in mine):
                mine.append(run)
        assert [r for r in got if r[0] == k] == mine

    for j, run in enumerate(widest_at_columns(labels, colours, hole).tolist()):
        over = [r for r in expected if r[2] <= j <= r[3] and labels[r[1], j] == r[0] + 1]
        assert (run[1] == -1) == (not over) == (not labels[:, j].any())
        if over:
            assert tuple(run) in over
            assert run[3] - run[2] == max(r[3] - r[2] for r in over)


def test_a_mirrored_image_has_the_mirrored_runs():
    labels = (np.random.default_rng(3).random((30, 50)) < 0.4).astype(np.uint8)
    plain = {(r, a, b) for _, r, a, b in all_runs(labels, 1, 2, 1).tolist()}
    turned = {(r, 49 - b, 49 - a) for _, r, a, b in all_runs(np.ascontiguousarray(labels[:, ::-1]), 1, 2, 1).tolist()}
    assert plain == turned
