"""What a selection's text may say: numbers out of bounds and wrong sets are refused in one line."""

from __future__ import annotations

import numpy as np
import pytest

from flocking import lawentry, lawsource, obstacle_selection, selection
from flocking.errors import InputError
from flocking.parameters import declared
from flocking.types import Obstacles


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("k-nearest(0)", "at least 1"),
        ("k-nearest(1.5)", "whole"),
        ("distance-based(2, 1)", "low <= high"),
        ("distance-based(-1, 1)", "0 <= low"),
        ("angle(181)", "0 to 180"),
        ("angle(-1)", "0 to 180"),
        ("field-of-view(361)", "0 to 360"),
        ("sector(0, 400)", "-360 to 360"),
        ("fixed-set(0.5)", "whole ids"),
        ("fixed-set(-1)", "whole ids"),
        ("bounding-box(1, 0, 0, 1)", "x0 <= x1"),
        ("bounding-box(0, 1, 1, 0)", "y0 <= y1"),
        ("unoccluded(-0.1)", "at least 0"),
        ("densest-distance(-1)", "at least 0"),
        ("densest-angle(190)", "0 to 180"),
    ],
)
def test_numbers_out_of_bounds_are_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as told:
        selection.parse(f"all & {text}")
    assert text in str(told.value)


@pytest.mark.parametrize(
    "text",
    [
        "k-nearest(1)",
        "distance-based(1, 1)",
        "angle(180)",
        "field-of-view(360)",
        "sector(-90, 90)",
        "fixed-set(0, 7)",
        "bounding-box(-1, -1, -1, 1)",
        "unoccluded(0)",
        "densest-angle(0)",
    ],
)
def test_numbers_at_the_bounds_are_taken(text: str) -> None:
    assert len(selection.parse(text)) == 1


def test_a_parameter_in_place_of_a_number_is_checked_when_it_is_known() -> None:
    steps = selection.parse("distance-based(near_m, far_m)", ["near_m", "far_m"])
    assert selection.resolved(steps, {"near_m": 1.0, "far_m": 2.0})[0].given == (1.0, 2.0)
    with pytest.raises(InputError, match=r"distance-based\(2, 1\)"):
        selection.resolved(steps, {"near_m": 2.0, "far_m": 1.0})


@pytest.mark.parametrize("name", lawsource.names())
def test_every_laws_own_selections_hold_with_its_values(name: str) -> None:
    law = lawentry.module_of(name)
    for given in ({}, getattr(law, "CREATE", {})):
        values = law.Parameters(**given)._asdict()
        sets = selection.parse_sets("all", lawentry.sets_of(law), declared(law.Parameters))
        assert len([selection.resolved(steps, values) for steps in sets]) == len(lawentry.sets_of(law))


class TestObstacles:
    POINTS = Obstacles(np.array([[1.0, 0.0], [0.0, 0.5], [-2.0, 0.1], [3.0, 1.0]]))

    @pytest.mark.parametrize(
        ("text", "kept"),
        [
            ("all", [0, 1, 2, 3]),
            ("nearest", [1]),
            ("within(1.5)", [0, 1]),
            ("ahead(90)", [0, 3]),
            ("ahead(90) & nearest", [0]),
            ("nearest & ahead(90)", []),
            ("within(0)", []),
        ],
    )
    def test_keeps_what_it_says(self, text: str, kept: list[int]) -> None:
        out = obstacle_selection.select(obstacle_selection.parse(text), self.POINTS)
        np.testing.assert_array_equal(out.points, self.POINTS.points[kept])

    @pytest.mark.parametrize("text", ["", "nearst", "within", "within(-1)", "within(x)", "ahead(361)", "nearest(2)"])
    def test_refuses_what_is_no_selection(self, text: str) -> None:
        with pytest.raises(InputError, match="obstacle selection"):
            obstacle_selection.parse(text)
