"""Stage 3: every perception function but the Voronoi neighbours on a closed form, plain and as the program's step."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking import lawentry, lawsource, perception, selection
from flocking.errors import InputError
from flocking.kinematic import Band, Space
from flocking.kinematic.herd import KinematicHerd
from flocking.perception import ARGUMENTS, Step
from flocking.types import Bools, Ints, Members
from tests.flocking.kinematic.herds import TOLD, law_of


def members_at(positions: object, ids: object = None) -> Members:
    places = np.asarray(positions, dtype=float).reshape(-1, 2)
    count = len(places)
    return Members(
        places,
        np.arctan2(places[:, 1], places[:, 0]),
        np.zeros(count),
        np.zeros((count, 2)),
        np.arange(count) if ids is None else np.array(ids, dtype=np.int64),
    )


def kept(text: str, members: Members, linked: Bools | None = None) -> list[int]:
    """Rows that the plain functions keep; the compiled program is held against them."""
    steps = selection.parse(text)
    mask = selection.select(steps, members, linked)
    if all(step is not Step.VORONOI for step, _ in steps):
        assert_array_equal(by_program(steps, members, linked), mask)
    return [int(row) for row in np.flatnonzero(mask)]


def by_program(steps: list[selection.Chosen], members: Members, linked: Bools | None = None) -> Bools:
    program = selection.program([steps], ())
    count = len(members.ids)
    mask = np.ones(count, dtype=np.bool_)
    none = np.zeros(count, dtype=np.bool_)
    for step, given in zip(program.steps[0], program.given[0], strict=True):
        if step != Step.ALL:
            perception.keep(
                step,
                given,
                members.positions,
                members.bearings,
                members.ids,
                none if linked is None else linked,
                none,
                mask,
            )
    return mask


CROSS = members_at([[1.0, 0.0], [0.0, 2.0], [-3.0, 0.0], [0.0, -4.0], [5.0, 5.0]])


class TestClosedForms:
    @pytest.mark.parametrize(
        ("text", "rows"),
        [
            ("all", [0, 1, 2, 3, 4]),
            ("fixed-set(0)", [0]),
            ("fixed-set(3, 1, 77)", [1, 3]),
            ("distance-based(0, 0)", []),
            ("distance-based(1, 3)", [0, 1]),
            ("distance-based(3, 7.08)", [2, 3, 4]),
            ("nearest", [0]),
            ("k-nearest(1)", [0]),
            ("k-nearest(3)", [0, 1, 2]),
            ("k-nearest(99)", [0, 1, 2, 3, 4]),
            ("k-nearest(1e300)", [0, 1, 2, 3, 4]),
            ("bounding-box(-3, -4, 1, 2)", [0, 1, 2, 3]),
            ("bounding-box(0, 0, 9, 9)", [0, 1, 4]),
            ("bounding-box(0.5, -1, 0.9, 1)", []),
            ("angle(90)", [0, 4]),
            ("angle(90.001)", [0, 1, 3, 4]),
            ("angle(0)", []),
            ("angle(180)", [0, 1, 3, 4]),
            ("field-of-view(180)", [0, 1, 3, 4]),
            ("field-of-view(179.99)", [0, 4]),
            ("field-of-view(0)", [0]),
            ("field-of-view(360)", [0, 1, 2, 3, 4]),
            ("sector(0, 90)", [0, 4]),
            ("sector(45, 180)", [1, 4]),
            ("sector(45, 180.1)", [1, 2, 4]),
            ("sector(170, -80)", [2, 3]),
            ("sector(-90, 0)", [3]),
            ("sector(270, 360)", [3]),
            ("sector(0, 0)", []),
            ("sector(-180, 180)", [0, 1, 2, 3, 4]),
            ("sector(0, 360)", [0, 1, 2, 3, 4]),
            ("sector(180, -180)", []),
            ("unoccluded(0)", [0, 1, 2, 3, 4]),
            ("unoccluded(1)", [0, 1, 2, 3]),
            ("densest-distance(0)", [0]),
            ("densest-distance(2.3)", [0, 1]),
            ("densest-distance(4.2)", [0, 1, 2, 3]),
            ("densest-angle(44)", [0]),
            ("densest-angle(46)", [0, 1, 4]),
            ("densest-angle(90.01)", [0, 1, 2, 3, 4]),
        ],
    )
    def test_keeps(self, text: str, rows: list[int]) -> None:
        assert kept(text, CROSS) == rows

    @pytest.mark.parametrize("name", [name for name in selection.SELECTIONS if name not in ("fixed-set",)])
    def test_nobody_is_legal(self, name: str) -> None:
        numbers = {0: "", 1: "(1)", 2: "(1, 2)", 4: "(1, 1, 2, 2)"}[selection.SELECTIONS[name].arguments]
        assert kept(name + numbers, members_at([])) == []

    def test_a_graph_is_followed(self) -> None:
        linked = np.array([True, False, False, True, False])
        assert kept("fixed-set", CROSS, linked) == [0, 3]
        assert kept("fixed-set & nearest", CROSS, linked) == [0]
        with pytest.raises(InputError, match="this group has no graph"):
            selection.select(selection.parse("fixed-set"), CROSS)

    def test_anonymous_members_are_in_no_fixed_set(self) -> None:
        assert kept("fixed-set(0, 1)", members_at([[1.0, 0.0], [2.0, 0.0]], [-1, 1])) == [1]

    @pytest.mark.parametrize("distance", [1.0, 0.1, 3.3, 1e-3])
    def test_the_limits_of_a_distance(self, distance: float) -> None:
        place = members_at([[distance, 0.0]])
        assert kept(f"distance-based({distance!r}, 99)", place) == [0]
        assert kept(f"distance-based(0, {distance!r})", place) == []
        assert kept(f"distance-based(0, {float(np.nextafter(distance, 9.0))!r})", place) == [0]

    def test_the_near_one_hides_the_far_one_and_not_the_other_way_round(self) -> None:
        # centres in a line, and one seen past the first by 0.3 at its distance of 1
        row = members_at([[1.0, 0.0], [2.0, 0.0], [2.0, 0.6 + 1e-9], [-2.0, 0.0]])
        assert kept("unoccluded(0.25)", row) == [0, 2, 3]
        assert kept("unoccluded(0.29)", row) == [0, 3]

    @pytest.mark.parametrize("angle_deg", [0.0, 30.0, 90.0, 135.0, 180.0])
    def test_a_cone_by_positions_is_an_angle_by_bearings(self, angle_deg: float) -> None:
        positions = np.random.default_rng(5).normal(size=(500, 2))
        positions[:4] = [[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 2.0]]
        by_bearing, by_position = np.ones(500, dtype=np.bool_), np.ones(500, dtype=np.bool_)
        perception.keep_angle(np.arctan2(positions[:, 1], positions[:, 0]), math.radians(angle_deg), by_bearing)
        perception.keep_cone(positions, math.cos(math.radians(angle_deg)), by_position)
        by_bearing[3] = by_position[3]  # on the border of 90 degrees both are right
        assert_array_equal(by_position, by_bearing)

    def test_what_is_as_far_away_hides_nothing(self) -> None:
        ring = members_at([[3.0, 4.0], [4.0, 3.0], [5.0, 0.0], [4.0, -3.0]])
        assert kept("unoccluded(4)", ring) == [0, 1, 2, 3]

    def test_a_disc_farther_than_a_member_does_not_hide_it_though_it_reaches_across(self) -> None:
        # the second centre lies 0.99 along the line of sight to the first, but 1.1 away
        pair = members_at([[1.0, 0.0], [0.99, 0.48]])
        assert kept("unoccluded(0.5)", pair) == [0]
        pair = members_at([[1.0, 0.0], [0.5, 0.48]])
        assert kept("unoccluded(0.5)", pair) == [1]

    def test_the_denser_of_two_groups_then_the_nearer(self) -> None:
        wide = [[5.0, 0.0], [6.0, 0.0], [7.0, 0.0]]
        narrow = [[-9.0, 0.0], [-9.5, 0.0], [-10.0, 0.0]]
        assert kept("densest-distance(1)", members_at(wide + narrow)) == [3, 4, 5]
        assert kept("densest-distance(1)", members_at(wide + [[x + 15.5, y] for x, y in narrow[:2]])) == [0, 1, 2, 3, 4]
        assert kept("densest-distance(1)", members_at([[5.0, 0], [6.0, 0], [-7.0, 0], [-8.0, 0]])) == [0, 1]
        assert kept("densest-angle(20)", members_at([*wide, [0.0, 1.0], [0.0, 2.0]])) == [0, 1, 2]

    def test_bearings_are_linked_over_the_seam(self) -> None:
        behind = members_at([(math.cos(a), math.sin(a)) for a in np.radians([170.0, -175.0, 5.0])])
        assert kept("densest-angle(16)", behind) == [0, 1]


def everyone_of(count: int, rng: np.random.Generator) -> Members:
    """Members with coincident, equally far and collinear ones among them."""
    places = rng.uniform(-3.0, 3.0, (count, 2))
    places[: count // 4] = np.round(places[: count // 4])
    places[1] = places[0]
    places[2] = -places[3]
    return members_at(places, rng.permutation(count))


TEXTS = [
    "fixed-set(0, 3, 5, 8)",
    "distance-based(1, 2.5)",
    "nearest",
    "k-nearest(4)",
    "bounding-box(-1, -2, 2, 2)",
    "angle(100)",
    "sector(-30, 200)",
    "field-of-view(220)",
    "unoccluded(0.3)",
    "densest-distance(0.8)",
    "densest-angle(15)",
]


class TestAnyMembers:
    @pytest.mark.parametrize("text", [*TEXTS, "voronoi"])
    def test_their_order_does_not_matter(self, text: str) -> None:
        rng = np.random.default_rng(0)
        steps = selection.parse(text)
        for count in (2, 5, 12, 30):
            for _ in range(8):
                members = everyone_of(max(count, 4), rng)
                order = rng.permutation(len(members.ids))
                moved = Members._make(column[order] for column in members)
                # coincident members stand for one another
                assert places(members, selection.select(steps, members)) == places(
                    moved, selection.select(steps, moved)
                )

    @pytest.mark.parametrize(("first", "second"), list(itertools.permutations(TEXTS, 2)))
    def test_in_succession_the_second_sees_what_the_first_has_kept(self, first: str, second: str) -> None:
        members = everyone_of(20, np.random.default_rng(1))
        once = kept(first, members)
        expected = [once[row] for row in kept(second, Members._make(column[once] for column in members))]
        assert kept(f"{first} & {second}", members) == expected

    @pytest.mark.parametrize("text", ["nearest & angle(60)", "angle(60) & nearest"])
    def test_the_order_of_steps_matters(self, text: str) -> None:
        members = members_at([[-1.0, 0.0], [2.0, 0.0]])
        assert kept(text, members) == ([] if text.startswith("nearest") else [1])

    def test_side_by_side_each_set_has_its_own(self) -> None:
        sets = {"repulsion": "distance-based(0, near_m)", "attraction": "all"}
        values = {"near_m": 2.5}
        for text, expected in (
            ("all", [[0, 1], [0, 1, 2, 3, 4]]),
            ("angle(91)", [[0, 1], [0, 1, 3, 4]]),
            ("repulsion: nearest", [[0], [0, 1, 2, 3, 4]]),
            ("attraction: distance-based(near_m, 9); repulsion: k-nearest(2)", [[0, 1], [2, 3, 4]]),
        ):
            steps = selection.parse_sets(text, sets, values)
            masks = [selection.select(selection.resolved(each, values), CROSS) for each in steps]
            assert [np.flatnonzero(mask).tolist() for mask in masks] == expected

    def test_reach_holds_all_that_can_matter(self) -> None:
        """Without the members beyond it the selection is the same."""
        rng = np.random.default_rng(2)
        for first, second in itertools.permutations([*TEXTS, "distance-based(0, 1.5)"], 2):
            steps = selection.parse(f"{first} & {second}")
            reach = selection.reach(steps, {})
            if reach == math.inf:
                continue
            members = everyone_of(30, rng)
            near = np.flatnonzero(np.hypot(*members.positions.T) <= reach)
            mask = selection.select(steps, Members._make(column[near] for column in members))
            assert near[mask].tolist() == np.flatnonzero(selection.select(steps, members)).tolist()

    def test_reach_is_what_distances_say_and_no_more(self) -> None:
        values = {"r": 3.0}

        def reach(text: str) -> float:
            return selection.reach(selection.parse(text, values), values)

        assert reach("distance-based(0, r)") == 3.0
        assert reach("nearest & distance-based(1, 2) & distance-based(0, r)") == 2.0
        assert reach("distance-based(0, 2) & densest-distance(1)") == 2.0
        assert reach("all") == reach("densest-distance(1) & distance-based(0, 2)") == math.inf


def places(members: Members, mask: Bools) -> list[tuple[float, float]]:
    return sorted(map(tuple, members.positions[mask].tolist()))


class TestProgram:
    def test_of_several_sets_is_filled_up_with_all(self) -> None:
        sets = [selection.parse("angle(30) & k-nearest(n)", ["m", "n"]), selection.parse("all")]
        program = selection.program(sets, ["m", "n"])
        assert program.steps.tolist() == [[Step.ANGLE, Step.K_NEAREST], [Step.ALL, Step.ALL]]
        assert program.given[0, 0, 0] == 30.0
        assert program.named[0, 1, 0] == 1
        assert (program.named[0, 0] == -1).all()
        assert program.given.shape == (2, 2, ARGUMENTS)

    @pytest.mark.parametrize("text", TEXTS)
    def test_the_herd_selects_as_the_plain_functions_do(self, text: str) -> None:
        """A law that writes down whom it got: its memory has a number for each id."""
        writing = TOLD.replace("MEMORY = 1", "MEMORY = 12").replace(
            "    memory[0] += 1.0\n",
            "    for j in range(len(members.ids)):\n        memory[members.ids[j]] = 1.0 if sets[0, j] else 0.0\n",
        )
        rng = np.random.default_rng(7)
        start = np.column_stack([rng.uniform(-3.0, 3.0, (12, 2)), rng.uniform(-3.0, 3.0, 12)])
        band = Band(law_of(writing), 12, selection=f"neighbours: {text}")
        herd = KinematicHerd([band], start, Space(), None, 1.0, rng)
        herd.advance(1, np.empty((1, 12, 5)), 1, 0, True)
        for i in range(12):
            others: Ints = np.delete(np.arange(12), i)
            c, s = math.cos(start[i, 2]), math.sin(start[i, 2])
            seen = members_at((start[others, :2] - start[i, :2]) @ np.array([[c, -s], [s, c]]), others)
            mask = selection.select(selection.parse(text), seen)
            assert np.flatnonzero(herd.bodies.memory[i]).tolist() == others[mask].tolist()

    @pytest.mark.parametrize("name", lawsource.names())
    def test_every_laws_sets_fit_the_program(self, name: str) -> None:
        module = lawentry.module_of(name)
        names = module.Parameters._fields
        sets = selection.parse_sets("all", lawentry.sets_of(module), names)
        assert selection.program(sets, names).steps.shape[0] == len(lawentry.sets_of(module))


class TestArguments:
    @pytest.mark.parametrize(
        "text",
        [
            "distance-based(1)",
            "distance-based(1, 2, 3)",
            "distance-based(2, 1)",
            "distance-based(-1, 1)",
            "k-nearest(1.5)",
            "k-nearest(-1)",
            "bounding-box(1, 0, 0, 1)",
            "angle(181)",
            "angle(-1)",
            "sector(0, 361)",
            "field-of-view(361)",
            "unoccluded(-0.1)",
            "densest-distance(-1)",
            "densest-angle(181)",
            "fixed-set(0.5)",
            "fixed-set(-1)",
            "fixed-set(0, 1, 2, 3, 4, 5, 6, 7, 8)",
            "nearest(1)",
            "voronoi(2)",
            "all & ",
            "& all",
            "k-nearest(inf)",
            "k-nearest((1))",
        ],
    )
    def test_that_cannot_be_are_refused_in_one_line(self, text: str) -> None:
        with pytest.raises(InputError, match="selection") as error:
            selection.parse(text)
        assert "\n" not in str(error.value)
