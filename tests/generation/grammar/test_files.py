"""Grammar files: what is wrong with one is told in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from flocking.errors import InputError
from generation import found
from generation.grammar import files
from generation.grammar.ending import offspring

GOOD = """
about = "Squares in a row"
terminals = ["wall"]
nonterminals = ["frame"]
markers = ["start"]
labels = ["front"]
start = "square"
limit = { lines = 10 }
under = ["translation", "rotation"]

[shapes.square]
lines.frame = [[[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]]
labels.front = [[2, 1]]
[shapes.branch]
lines.wall = [[[0, 0], [4, 0]]]
parts = [{ shape = "square", at = [4, 0] }]

[[rules]]
name = "grow"
left = "square"
right = "branch"
probability = 0.75
[[rules]]
name = "stop"
left = "square"
right = []
probability = 0.25
"""


def test_a_good_file_is_read() -> None:
    made = files.from_text(GOOD)
    assert [rule.name for _, rule in made.rules] == ["grow", "stop"]
    assert made.limit == ("lines", 10, 10, True)
    assert len(made.start.kinds) == 4


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('left = "square"\nright = "branch"', 'left = "sqare"\nright = "branch"', "unknown shape 'sqare'"),
        ('right = "branch"', 'right = "brunch"', "unknown shape 'brunch'; did you mean branch"),
        ('start = "square"', 'start = "squares"', "unknown shape 'squares'; did you mean square"),
        ("lines.wall", "lines.wal", "unknown kind of line in shapes.branch 'wal'; did you mean wall"),
        ("labels.front", "labels.frond", "unknown label in shapes.square 'frond'; did you mean front"),
        ("probability = 0.75", "probability = 0.8", "probabilities 0.8 + 0.25 = 1.05; expected a sum of 1"),
        ("probability = 0.75", "probability = 1.75", "rule 'grow' = 1.75: expected a number from 0 to 1"),
        ("probability = 0.75", "probability = nan", "probability of rule 'grow': nan: expected a finite number"),
        ("probability = 0.75", 'probability = "half"', "expected a finite number"),
        ("probability = 0.75", "", "some have a probability and some have none"),
        ("probability = 0.75", 'under = ["translation"]\nprobability = 0.75', "under differs from that of another"),
        ("limit = { lines = 10 }", "limit = { line = 10 }", "unknown limit 'line'; did you mean lines"),
        ("limit = { lines = 10 }", "limit = { lines = 0 }", "expected whole numbers from 1 to 10000"),
        ("limit = { lines = 10 }", "limit = { lines = [5, 3] }", "expected whole numbers"),
        ("limit = { lines = 10 }", "limit = 10", "limit = 10: expected steps or lines"),
        ('"rotation"]', '"rotations"]', "unknown transformation in under 'rotations'; did you mean rotation"),
        ("about", "abuot", "unknown entry 'abuot'; did you mean about"),
        ("about", "#about", "about is missing"),
        ('labels = ["front"]', 'labels = ["front", "start"]', "'start' stands in markers and in labels"),
        ('terminals = ["wall"]', "terminals = []", "terminals is empty"),
        ('name = "stop"', 'name = "grow"', "rule 'grow' stands there twice"),
        ("right = []", 'right = "square"', "rule 'stop' changes nothing"),
        ("right = []", 'right = { at = [1, 1] }', "expected the name of a shape in it"),
        ("right = []", 'right = { shape = "square", turn = 3 }', "unknown entry of right side of rule 'stop' 'turn'"),
        ("right = []", 'right = { shape = "square", scale = 0 }', "expected a number from 0.001 to 1000"),
        ("right = []", 'right = { shape = "square", mirror = 1 }', "mirror = 1: expected true or false"),
        ("right = []", "", "rule 2 lacks right"),
        ("[[0, 0], [4, 0]]", "[[0, 0], [0, 0]]", "shorter than 0.001 m"),
        ("[[0, 0], [4, 0]]", "[[0, 0]]", "expected two places"),
        ("[[0, 0], [4, 0]]", "[[0, 0], [4]]", "expected a place [x, y]"),
        ("[[0, 0], [4, 0]]", "[[0, 0], [inf, 0]]", "expected a place [x, y]"),
        ("[[0, 0], [4, 0]]", "[[0, 0], [4e7, 0]]", "reaches farther than"),
        ('"square", at', '"branch", at', "shape 'branch' is made of itself: branch -> branch"),
        ("labels.front = [[2, 1]]", "labels.front = [[2, 1, 0, 0]]", "expected a place [x, y] or [x, y, heading_deg]"),
        ("[shapes.square]\n", "[shapes.square\n", "no TOML"),
    ],
)  # fmt: skip
def test_a_bad_file_is_refused_in_one_line(old: str, new: str, told: str) -> None:
    assert old in GOOD
    text = GOOD.replace(old, new, 1)
    with pytest.raises(InputError) as caught:
        files.from_text(text)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_left_side_with_no_line_and_no_label_is_refused() -> None:
    text = GOOD.replace('left = "square"\nright = []', 'left = "nothing"\nright = "square"')
    with pytest.raises(InputError, match="left side 'nothing' has no line and no label"):
        files.from_text(text.replace("0.75", "1.0").replace("0.25", "1.0") + "[shapes.nothing]\n")


def test_rules_that_never_end_need_a_limit() -> None:
    endless = GOOD.replace("0.75", "1.0").replace("0.25", "0.0")
    files.from_text(endless)
    with pytest.raises(InputError, match=r"the rules of 'square' never end: .* expected a limit"):
        files.from_text(endless.replace("limit", "#limit"))


def test_a_process_with_mean_offspring_below_one_needs_no_limit_and_one_at_or_above_it_does() -> None:
    files.from_text(GOOD.replace("limit", "#limit"))
    assert offspring(files.from_text(GOOD)) == pytest.approx(0.75)
    twice = GOOD.replace('right = "branch"', 'right = ["branch", { shape = "branch", turn_deg = 90 }]')
    assert offspring(files.from_text(twice)) == pytest.approx(1.5)
    for chances, mean in (((0.75, 0.25), "1.5"), ((0.5, 0.5), "1")):
        text = twice.replace("0.75", str(chances[0])).replace("0.25", str(chances[1])).replace("limit", "#limit")
        with pytest.raises(InputError, match=f"no mean length: a left side brings {mean} others on average"):
            files.from_text(text)
    files.from_text(twice.replace("0.75", "0.4").replace("0.25", "0.6").replace("limit", "#limit"))


def test_the_splitting_process_is_critical() -> None:
    assert offspring(files.read(found.FOLDER / "splitting.toml")) == pytest.approx(1.0)


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist; expected a TOML file"):
        files.read(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read"):
        files.read(tmp_path)
    (tmp_path / "data.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="is no text"):
        files.read(tmp_path / "data.toml")
    (tmp_path / "large.toml").write_bytes(b"#" * 2_000_000)
    with pytest.raises(InputError, match="is larger than"):
        files.read(tmp_path / "large.toml")


def test_shapes_of_shapes_of_shapes_do_not_grow_without_bound() -> None:
    """Ten levels, each ten times the one below: 10^10 lines."""
    levels = ""
    for k in range(1, 11):
        parts = ", ".join(f'{{ shape = "s{k - 1}", at = [{n}, {n * 10**k}] }}' for n in range(10))
        levels += f"[shapes.s{k}]\nparts = [{parts}]\n"
    text = GOOD + "[shapes.s0]\nlines.wall = [[[0, 0], [2, 0]]]\n" + levels
    with pytest.raises(InputError, match="has more than 1000 lines and labels"):
        files.from_text(text)
