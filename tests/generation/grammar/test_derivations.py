"""Derivations: the three kinds of rule, probabilities, limits, replays, drawings."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from scipy import stats

from flocking.errors import InputError
from generation.grammar import files, rules
from generation.grammar.derivations import Derivation, derive, replay
from generation.grammar.drawing import draw
from generation.grammar.rules import Grammar
from generation.grammar.shapes import Shape, Similarity, of_row, same

SCHEMAS = Path(files.__file__).parents[1] / "schemas"
FIGURE_B_1 = """
about = "Strings of a: figure B.1 of Fine 2015, written from left to right"
terminals = ["a"]
labels = ["S", "A"]
start = "S"
under = ["translation"]

[shapes.S]
labels.S = [[0, 0]]
[shapes.A]
labels.A = [[0, 0]]
[shapes.a]          # the n-th letter is a line at x = n
lines.a = [[[0, 0], [0, 1]]]
[shapes.aA]
parts = ["a", { shape = "A", at = [1, 0] }]

[[rules]]
left = "S"
right = "A"
[[rules]]
name = "r1"
left = "A"
right = "aA"
probability = 0.5
[[rules]]
name = "r2"
left = "A"
right = "a"
probability = 0.5
"""
FIGURE_6_2 = """
about = "The three kinds of rule of figure 6.2 of Fine 2015"
terminals = ["wall"]
start = "line"
limit = { steps = 24 }
under = ["translation", "rotation"]

[shapes.line]
lines.wall = [[[-1, 0], [1, 0]]]
[shapes.square]
lines.wall = [[[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]]

[[rules]]
left = "line"
right = RIGHT
"""
ADDED = '["line", { shape = "square", at = [0, 2] }]'
REPLACED = '"square"'
TURNED = '{ shape = "line", turn_deg = 15 }'


def grammar(text: str) -> Grammar:
    return files.from_text(text)


def end(shape: Shape) -> list[list[float]]:
    return sorted(np.round(shape.lines, 9).tolist())


@pytest.mark.parametrize(
    ("right", "kind"), [(ADDED, rules.ADDITION), (REPLACED, rules.SUBSTITUTION), (TURNED, rules.MODIFICATION)]
)
def test_the_kinds_of_rule_are_told_apart(right: str, kind: str) -> None:
    ((left, rule),) = grammar(FIGURE_6_2.replace("RIGHT", right)).rules
    assert rules.kind(left.shape, rule.right) == kind


def test_an_addition_keeps_its_left_side_and_a_substitution_takes_it_away() -> None:
    after = derive(grammar(FIGURE_6_2.replace("RIGHT", ADDED)), np.random.default_rng(1)).steps[1].shape
    assert len(after.kinds) == 5
    after = derive(grammar(FIGURE_6_2.replace("RIGHT", REPLACED)), np.random.default_rng(1)).steps[1].shape
    assert len(after.kinds) == 4
    assert np.abs(after.lines).ravel() == pytest.approx(1.0, abs=1e-12)


def test_a_modification_by_fifteen_degrees_is_a_full_turn_after_24_steps() -> None:
    derivation = derive(grammar(FIGURE_6_2.replace("RIGHT", TURNED)), np.random.default_rng(1))
    assert [step.rule for step in derivation.steps] == ["start"] + ["rule-1"] * 24
    assert derivation.ended == "limit of 24 steps"
    for before, after in pairwise(derivation.steps):
        assert len(after.shape.kinds) == 1
        (a,), (b,) = before.shape.lines, after.shape.lines
        angle = math.atan2(b[3] - b[1], b[2] - b[0]) - math.atan2(a[3] - a[1], a[2] - a[0])
        assert math.remainder(angle - math.radians(15), math.pi) == pytest.approx(0.0, abs=1e-9)  # rounding
    assert same(derivation.shape, derivation.steps[0].shape)


def test_a_rule_applies_to_a_part_of_a_line() -> None:
    """A line of 5: a part of 2 at one of its ends becomes a square, and 3 are left."""
    text = FIGURE_6_2.replace("RIGHT", REPLACED).replace('start = "line"', 'start = "long"')
    made = grammar(text + "\n[shapes.long]\nlines.wall = [[[0, 0], [5, 0]]]\n")
    once = derive(made, np.random.default_rng(2), 1, 1).shape
    lengths = np.hypot(once.lines[:, 2] - once.lines[:, 0], once.lines[:, 3] - once.lines[:, 1])
    assert sorted(lengths.round(9).tolist()) == [2.0, 2.0, 2.0, 2.0, 3.0]


def test_the_same_seed_gives_the_same_derivation_and_its_moves_give_it_again() -> None:
    for name in ("splitting", "weiring"):
        made = files.read(SCHEMAS / f"{name}.toml")
        for seed in range(20):
            first, second = (derive(made, np.random.default_rng(seed)) for _ in range(2))
            assert [end(s.shape) for s in first.steps] == [end(s.shape) for s in second.steps]
            again = replay(made, first.moves)
            assert [s.rule for s in again.steps] == [s.rule for s in first.steps]
            assert all(same(a.shape, b.shape) for a, b in zip(again.steps, first.steps, strict=True))


def test_a_replay_of_a_move_that_does_not_apply_is_refused() -> None:
    made = files.read(SCHEMAS / "splitting.toml")
    with pytest.raises(InputError, match="step 1: rule 'left' does not apply"):
        replay(made, [("left", Similarity(x_m=3.0))])
    with pytest.raises(InputError, match="did you mean left"):
        replay(made, [("lefd", Similarity())])


def test_a_derivation_can_start_elsewhere() -> None:
    made, at = files.read(SCHEMAS / "weiring.toml"), Similarity(1.0, 1.1, False, 30.0, -7.0)
    here, there = (derive(made, np.random.default_rng(4), at=where) for where in (None, at))
    assert [s.rule for s in here.steps] == [s.rule for s in there.steps]
    turned = replay(made, here.moves)
    back = np.sort(
        np.hypot(there.shape.lines[:, 2] - there.shape.lines[:, 0], there.shape.lines[:, 3] - there.shape.lines[:, 1])
    )
    lines = turned.shape.lines
    assert back == pytest.approx(np.sort(np.hypot(lines[:, 2] - lines[:, 0], lines[:, 3] - lines[:, 1])), abs=1e-9)


def test_rules_are_chosen_by_their_probabilities() -> None:
    made = files.read(SCHEMAS / "splitting.toml")
    rng, count = np.random.default_rng(11), 4000
    first = [derive(made, rng, 2, 2).steps[1].rule for _ in range(count)]
    observed = [first.count(name) for name in ("left", "right", "both", "stop")]
    assert stats.chisquare(observed).pvalue > 1e-3
    weights = {"left": 0.1, "right": 0.2, "both": 0.0, "stop": 0.2}
    first = [derive(made, rng, 2, 2, weights).steps[1].rule for _ in range(count)]
    assert "both" not in first
    observed = [first.count(name) for name in ("left", "right", "stop")]
    assert stats.chisquare(observed, [0.2 * count, 0.4 * count, 0.4 * count]).pvalue > 1e-3
    with pytest.raises(InputError, match="all probabilities are 0"):
        derive(made, rng, weights=dict.fromkeys(weights, 0.0))


def test_matches_are_equally_likely() -> None:
    """A line of 5, of which a part of 2 can be at either end, in either direction."""
    text = FIGURE_6_2.replace("RIGHT", ADDED).replace('start = "line"', 'start = "long"')
    made = grammar(text + "\n[shapes.long]\nlines.wall = [[[0, 0], [5, 0]]]\n")
    rng = np.random.default_rng(3)
    seen = [derive(made, rng, 1, 1).moves[0][1] for _ in range(2000)]
    keys = [(round(s.x_m, 6), round(math.cos(s.turn_rad))) for s in seen]
    counts = [keys.count(key) for key in sorted(set(keys))]
    assert len(counts) == 4
    assert stats.chisquare(counts).pvalue > 1e-3


def test_every_string_of_figure_b_1_appears_with_its_probability() -> None:
    """Fine 2015, appendix B, the third theorem: a string of n letters has the probability 2^-n, and its own place."""
    made, rng, count, longest = grammar(FIGURE_B_1), np.random.default_rng(5), 6000, 8
    strings = [derive(made, rng) for _ in range(count)]
    assert all(d.ended == "no rule applies" and not d.shape.labels.size for d in strings)
    lengths = [len(d.shape.kinds) for d in strings]
    for derivation, length in zip(strings, lengths, strict=True):
        assert sorted(derivation.shape.lines[:, 0].tolist()) == list(range(length))
    observed = [lengths.count(n) for n in range(1, longest)] + [sum(n >= longest for n in lengths)]
    expected = [count * 2.0**-n for n in range(1, longest)] + [count * 2.0 ** -(longest - 1)]
    assert min(observed) > 0
    assert stats.chisquare(observed, expected).pvalue > 1e-3


def test_limits_stop_a_derivation_and_say_so() -> None:
    made = files.read(SCHEMAS / "splitting.toml")
    rng = np.random.default_rng(6)
    for most in (1, 5, 30):
        made_of = [derive(made, rng, most, most) for _ in range(200)]
        assert max(made.built(d.shape) for d in made_of) <= most
        assert {d.ended for d in made_of} == {"no rule applies", f"limit of {most} lines"}
    weir = files.read(SCHEMAS / "weiring.toml")
    steps = [len(derive(weir, rng).steps) - 1 for _ in range(1200)]
    assert stats.chisquare([steps.count(n) for n in range(4, 10)]).pvalue > 1e-3
    assert set(steps) == set(range(4, 10))


def test_shapes_that_shrink_stop_at_a_millimetre() -> None:
    text = FIGURE_6_2.replace("RIGHT", '{ shape = "line", scale = 0.1 }').replace("24", "1000")
    text = text.replace('under = ["translation", "rotation"]', 'under = ["translation", "rotation", "scale"]')
    derivation = derive(grammar(text), np.random.default_rng(0))
    assert derivation.ended == "no rule applies"
    assert [round(math.log10(float(np.ptp(s.shape.lines)) / 2.0)) for s in derivation.steps] == [0, -1, -2, -3]


def test_a_derivation_is_drawn(tmp_path: Path) -> None:
    made = files.read(SCHEMAS / "weiring.toml")
    derivation = derive(made, np.random.default_rng(1))
    draw(derivation, tmp_path / "steps.png")
    picture = imread(tmp_path / "steps.png")
    assert picture.shape[0] > 300
    assert (picture[..., :3].sum(axis=2) < 0.1).sum() > 1000  # walls are black
    nothing = Derivation(made, derivation.steps[:1], "")
    draw(nothing, tmp_path / "start.png")
    assert imread(tmp_path / "start.png").shape[1] < picture.shape[1]


def test_a_similarity_and_its_numbers_say_the_same() -> None:
    given = Similarity(2.0, 0.5, True, 3.0, -4.0)
    assert of_row(given.row()) == pytest.approx(given)
