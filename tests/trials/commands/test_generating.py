"""`herd generate`: what it writes, what it says, and what it refuses."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from flocking.errors import InputError
from generation import files, filters, found
from generation.candidates import candidate
from trials.commands import listing
from trials.commands.generating import SHEET, Asked, generate

NOTHING = """'''Nothing.'''
from typing import NamedTuple
class Parameters(NamedTuple):
    pass
def passes(environment, parameters):
    return {value}
"""


def made(folder: Path):
    return [files.read(path) for path in sorted(folder.glob("*.json"))]


def test_environments_are_the_same_however_many_there_are(tmp_path):
    few, many = tmp_path / "few", tmp_path / "many"
    generate(Asked("weiring", 3, 7, few))
    told = generate(Asked("weiring", 12, 7, many))
    assert [path.name for path in sorted(few.iterdir())] == ["0001.json", "0002.json", "0003.json", SHEET]
    assert made(few) == made(many)[:3]
    assert (many / SHEET).read_bytes().startswith(b"\x89PNG")
    assert "weiring: 12 of " in told
    assert made(few) != made(many)[3:6]


def test_a_sheet_that_is_drawn_beside_is_that_which_is_drawn_afterwards(tmp_path):
    for count in (100, 101):
        generate(Asked("weiring", count, 7, tmp_path / str(count)))
    assert (tmp_path / "100" / SHEET).read_bytes() == (tmp_path / "101" / SHEET).read_bytes()


def black(picture):
    """(H, W) of a picture (H, W, 3)."""
    return picture.max(axis=2) < 100


@pytest.mark.parametrize(("count", "columns", "rows"), [(3, 2, 2), (12, 4, 3), (104, 10, 10)])
def test_the_contact_sheet_shows_each_environment_up_to_a_hundred(tmp_path, count, columns, rows):
    generate(Asked("weiring", count, 7, tmp_path))
    picture = cv2.imread(str(tmp_path / SHEET))
    # below the title's 0.4 inches of 150 pixels the panels fill the height but for the bar, and are square
    title = 60
    side = (picture.shape[0] - title) / (rows + 0.07)
    left = (picture.shape[1] - columns * side) / 2
    panels = []
    for number in range(rows * columns):
        row, column = divmod(number, columns)
        # a twentieth at each edge keeps the largest apart; below the last row the bar reaches into it
        top, start = title + (row + 0.02) * side, left + column * side
        panel = picture[round(top) : round(top + 0.96 * side), round(start) : round(start + side)]
        corner = panel[: round(side / 8), : round(side / 8)]
        assert black(corner).any() == (number < count)  # its number
        corner[:] = 255
        panels.append(panel)
    shown = min(count, 100)
    assert all((panel == 255).all() for panel in panels[shown:])
    # constructs are black, workspaces grey and marks coloured: each construct has its own extent, all at one scale
    drawn = np.array([[np.ptp(where) for where in np.nonzero(black(panel))[::-1]] for panel in panels[:shown]])
    built = [each.construct_walls().reshape(-1, 2) for each in made(tmp_path)[:shown]]
    metres = np.array([np.ptp(each, axis=0) for each in built])
    scale = np.median(drawn / metres)
    assert len(np.unique(metres.round(6), axis=0)) > shown / 3
    np.testing.assert_allclose(drawn, scale * metres, atol=3.0)  # a line is 1.5 pixels wide, at either end
    assert black(picture[:title]).any()


def test_what_is_written_passes_the_filter_and_can_be_made_again_from_its_origin(tmp_path):
    generate(Asked("splitting", 5, 2, tmp_path / "out", {"filter.least": 4}))
    schema = found.load("splitting")
    for environment in made(tmp_path / "out"):
        assert filters.load("terminals").accepts(environment)
        assert len(environment.construct) >= 4
        told = environment.origin
        parameters = schema.parameters(**told["parameters"])
        again = candidate(schema, parameters, schema.workspace(), told["seed"], told["candidate"])
        assert again.construct == environment.construct


def test_varied_parameters_are_drawn_evenly_between_their_bounds(tmp_path):
    generate(Asked("dirt", 400, 1, tmp_path / "out", {"length_m": 2.0}, ["angle_deg", "anchor"]))
    drawn = [environment.origin["parameters"] for environment in made(tmp_path / "out")]
    angles = np.array([one["angle_deg"] for one in drawn])
    assert abs(angles.mean() - 180.0) < 4.0 * 360.0 / np.sqrt(12.0 * 400.0)  # four standard errors
    assert {one["length_m"] for one in drawn} == {2.0}
    counts = np.unique([one["anchor"] for one in drawn], return_counts=True)[1]
    assert (np.abs(counts - 100.0) < 4.0 * np.sqrt(400.0 * 0.25 * 0.75)).all()


def test_parameters_with_which_a_schema_cannot_build_are_drawn_again(tmp_path):
    generate(Asked("sirt", 60, 1, tmp_path / "out", {}, ["rule_1", "rule_2"]))
    sums = [e.origin["parameters"]["rule_1"] + e.origin["parameters"]["rule_2"] for e in made(tmp_path / "out")]
    assert len(sums) == 60
    assert max(sums) <= 1.0


def test_a_workspace_of_ones_own_is_built_in(tmp_path):
    first = tmp_path / "first"
    generate(Asked("itb", 1, 1, first, {"anchor": 1}))
    generate(Asked("itb", 1, 1, tmp_path / "second", {"anchor": 9}, workspace=first / "0001.json"))
    (both,) = made(tmp_path / "second")
    assert both.construct[0] == made(first)[0].construct[0]
    assert len(both.construct) == 2


def test_a_filter_that_passes_nothing_stops_and_says_the_rate(tmp_path):
    own = tmp_path / "nothing.py"
    own.write_text(NOTHING.format(value=False))
    with pytest.raises(InputError, match=r"the last 1000 environments .* 0 of 1000"):
        generate(Asked("weiring", 5, 1, tmp_path / "out", filter=str(own)))
    assert not (tmp_path / "out" / SHEET).exists()


def test_what_passed_before_a_filter_passes_nothing_more_is_kept(tmp_path):
    own = tmp_path / "three.py"
    own.write_text(NOTHING.format(value="environment.origin['candidate'] <= 3"))
    with pytest.raises(InputError, match=r"passed so far: 3 of 1003 .*the 3 in .*out are kept"):
        generate(Asked("weiring", 5, 1, tmp_path / "out", filter=str(own)))
    assert len(made(tmp_path / "out")) == 3
    assert (tmp_path / "out" / SHEET).exists()


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"schema": "dirtt"}, "did you mean dirt"),
        ({"schema": "dirt", "count": 2}, "--vary angle_deg,length_m,anchor"),
        ({"schema": "dirt", "vary": ["angle"]}, "did you mean angle_deg"),
        ({"schema": "dirt", "settings": {"angle_deg": 400}}, "from 0 to 360"),
        ({"schema": "dirt", "settings": {"filter.least": 4}}, "there is no filter"),
        ({"schema": "splitting", "settings": {"filter.lest": 4}}, "did you mean filter.least"),
        ({"schema": "splitting", "filter": "terminal"}, "did you mean terminals"),
        ({"schema": "galton", "settings": {"peg_m": 30.0}}, "pegs touch"),
        ({"schema": "dirt", "workspace": Path("none.json")}, "none.json"),
    ],
)
def test_bad_input_is_refused_before_anything_is_written(tmp_path, asked, told):
    with pytest.raises(InputError) as raised:
        generate(Asked(**{"count": 1, "seed": 1, "out": tmp_path / "out", **asked}))
    assert told in str(raised.value)
    assert not list((tmp_path / "out").glob("*")) if (tmp_path / "out").exists() else True


def test_a_folder_that_holds_something_is_refused(tmp_path):
    (tmp_path / "kept.txt").write_text("mine")
    with pytest.raises(InputError, match="expected a new or an empty folder"):
        generate(Asked("dirt", 1, 1, tmp_path))


@pytest.mark.parametrize("kind", ["schemas", "filters", "behaviours"])
def test_all_that_a_command_can_name_is_listed(kind):
    lines = listing.listing(kind).splitlines()
    assert len(lines) >= 4
    assert all(len(line.split(maxsplit=1)) == 2 for line in lines)
