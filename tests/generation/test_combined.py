"""Combined schemas: what is placed where, stages, and files of parts."""

import itertools
import math

import numpy as np
import pytest

from flocking.errors import InputError
from generation import behaviours, filters, found
from generation.combined import Part, combined, fitness_of, read, stage
from generation.environment import Environment
from generation.primitives import Point, Polygon, Segment
from generation.schemas import cattle


def made(*parts, seed=1):
    return combined(parts, np.random.default_rng(seed))


def test_a_part_that_is_not_moved_is_its_schema_alone():
    schema = found.load("weiring")
    alone = schema.generate(schema.parameters(), schema.workspace(), np.random.default_rng(1))
    both = made(Part("weiring"))
    assert both.construct == alone.construct
    assert stage(both, 1).markers["origin"] == alone.markers["origin"]


def test_parts_are_scaled_turned_and_shifted():
    (wall,) = made(
        Part("itb", {"anchor": 5, "angle_deg": 0.0, "length_m": 2.0}, x_m=10.0, y_m=-3.0, turn_deg=90.0, scale=3.0)
    ).construct
    assert np.allclose(wall, (10.0, -3.0, 10.0, 3.0), rtol=0.0, atol=1e-12)  # cos 90 degrees


def test_parts_stand_in_sequence_each_with_its_own_markers():
    both = made(Part("dirt"), Part("dsdr", y_m=50.0), Part("galton", x_m=500.0))
    assert len(both.workspace) == 2  # the board has none
    assert both.markers["start"] == both.markers["stage-1-start"]
    assert both.markers["stage-2-anchor-1"].y_m == 50.0
    assert stage(both, 3).markers["bin-1"] == both.markers["stage-3-bin-1"]
    assert made(Part("dirt", walls=False)).workspace == ()


def test_hierarchical_schemas_combine_hierarchical_ones():
    inner = Part("hierarchical")
    assert len(made(inner, inner).construct) > len(made(inner).construct)


def test_a_stage_is_judged_until_the_herd_leaves_its_area_for_the_last_time():
    parts = [Part("dsdr", behaviour="reduce-x-deviation", walls=False)]
    area = Polygon(((-5.0, 0.0), (5.0, 0.0), (5.0, 2.5), (-5.0, 2.5)), "both")
    environment = Environment(markers={"stage-1-area": area})
    y, half = np.arange(5.0)[:, None], np.array([2.0, 1.5, 1.0, 8.0, 9.0])[:, None]
    positions = np.stack([np.hstack([-half, half]), np.hstack([y, y])], axis=-1)
    assert fitness_of(parts, positions, environment) == [0.5]
    assert fitness_of(parts, positions + np.array([0.0, 10.0]), environment) == [0.0]


def test_a_stage_that_is_not_there_is_told():
    with pytest.raises(InputError, match="no stage 2"):
        stage(made(Part("dirt")), 2)


def walk(*places, steps=60):
    """One member along straight lines through places: (T, 2)."""
    corners = np.array(places, dtype=float)
    return np.concatenate([np.linspace(a, b, steps) for a, b in itertools.pairwise(corners)])


def test_cattle_that_go_their_ways_are_corralled_lined_up_and_sorted():
    environment = cattle.generate(cattle.Parameters(), cattle.workspace(), np.random.default_rng(1))
    parts = cattle.parts(cattle.Parameters())
    ways = [
        walk((x, -26.0), (x, -12.0), (x / 8, -7.0), (x / 8, 0.0), (side * 4.0, 1.0))
        for x, side in ((-1.0, -1), (1.0, -1), (-1.0, 1), (1.0, 1))
    ]
    positions = np.stack(ways, axis=1)
    corralled, lined_up, sorted_ = fitness_of(parts, positions, environment)
    assert (corralled, sorted_) == (1.0, 1.0)
    assert lined_up == pytest.approx(1.0 - 1.0 / 8, abs=1e-9)  # sums
    standing = np.repeat(positions[:1], len(positions), axis=0)
    assert fitness_of(parts, standing, environment) == [0.0, 0.0, 0.0]


def test_the_walls_of_cattle_lie_in_its_workspace():
    environment = cattle.generate(cattle.Parameters(), cattle.workspace(), np.random.default_rng(1))
    assert len(environment.construct) == 5
    left, right = environment.construct[2:4]
    assert left.x0_m == -cattle.HALF_M
    assert right.x1_m == pytest.approx(-left.x1_m, abs=1e-9)  # cos 45 and cos 135
    assert filters.load("passage").accepts(environment)
    blocked = cattle.generate(cattle.Parameters(corral_m=8.0), cattle.workspace(), np.random.default_rng(1))
    closed = cattle.generate(
        cattle.Parameters(corral_deg=0.0, corral_m=6.0), cattle.workspace(), np.random.default_rng(1)
    )
    assert filters.load("passage").accepts(blocked) == (2 * (6.0 - 8.0 * math.cos(math.pi / 4)) >= 0.4)
    assert not filters.load("passage").accepts(closed)


@pytest.mark.parametrize(("crossing", "expected"), [((1, 1, 0, 0), 1.0), ((0, 0, 1, 1), 1.0), ((1, 0, 1, 0), 0.0)])
def test_sorting_is_the_difference_of_the_classes(crossing, expected):
    positions = np.zeros((2, 4, 2))
    positions[1, :, 0] = crossing
    environment = Environment(markers={"goal": Segment(0.5, -1.0, 0.5, 1.0), "start": Point()})
    behaviour = behaviours.load("sorting")
    assert behaviour.judged(positions, environment) == expected
    with pytest.raises(InputError, match="0 of 4 members are of the first class"):
        behaviour.judged(positions, environment, behaviour.filled({"first": 0.0}))


def test_parts_are_read_from_a_file(tmp_path):
    path = tmp_path / "parts.toml"
    path.write_text('[[part]]\nschema = "weiring"\n[[part]]\nschema = "dirt"\nx_m = 9\nsettings = { length_m = 1.0 }\n')
    parts = read(str(path))
    assert parts == [Part("weiring"), Part("dirt", {"length_m": 1.0}, x_m=9)]
    schema = found.load("hierarchical")
    environment = schema.generate(schema.parameters(str(path)), schema.workspace(), np.random.default_rng(1))
    assert environment.construct == made(*parts).construct


@pytest.mark.parametrize(
    ("text", "told"),
    [("", "expected 1 to 100"), ("[[part]]\nx_m = 1", "expected a table with schema"), ("a =", "cannot be read"),
     ('[[part]]\nschema = "dirt"\nx = 1', "did you mean x_m"), ('[[part]]\nschema = "dirt"\nscale = 0', "above 0"),
     ('[[part]]\nschema = "dirt"\nx_m = nan', "a finite number"), ('[[part]]\nschema = "dirt"\nwalls = 1', "true or")],
)  # fmt: skip
def test_a_bad_file_of_parts_is_told(tmp_path, text, told):
    path = tmp_path / "parts.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        read(str(path))


def test_parts_that_hold_themselves_are_told(tmp_path):
    path = tmp_path / "parts.toml"
    path.write_text(f'[[part]]\nschema = "hierarchical"\nsettings = {{ parts = "{path}" }}\n')
    with pytest.raises(InputError, match="more than 10 deep"):
        combined(read(str(path)), np.random.default_rng(1))
