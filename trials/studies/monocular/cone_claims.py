"""What Kirchner 2006 says of distances and of segmentations, held against runs of the cone tests."""

from __future__ import annotations

from functools import partial

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, more, near
from trials.evidence.runs import Cells, Run
from trials.studies.monocular.design import FOOT
from trials.types import Value

DISTANCE, PROJECTION = "distance_m", "eyes.cameras.projection"
EQUAL_ANGLE, PINHOLE = "equal-angle", "pinhole"
PIPELINE, SEGMENTATION, RANGES = "eyes.pipeline", "eyes.pipeline.segmentation", "eyes.pipeline.ranges"
RUNS = "cone-member-based"
WITHIN = 0.06
"""Of the distance: the publication's own means err by up to 6.7 %, at a foot. A choice."""
BETTER = 0.1
"""Of a detection rate, or of a share of pixels, that would count as better: a choice."""
BY = {"detected": "detection rate", "pixels_found": "share of the cone's pixels"}
"""How segmentations are compared; the publication names no measure. A run needs only the outline's pixels in one row,
so that a cone is detected of which few pixels are found."""
NOMINAL: dict[str, Value] = {"light": 1.0, "distance_m": 1.5, "hidden": 0.0, "speed_m_s": 0.0}
AXES: dict[str, tuple[float, ...]] = {
    "light": (0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6),
    "distance_m": (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0),
    "hidden": (0.0, 0.25, 0.5, 0.75),
    "speed_m_s": (0.0, 0.4, 0.8, 1.6),
}
KINDS: dict[str, dict[str, Value]] = {
    f"{pipeline}, {kind}, {ranges}": {PIPELINE: pipeline, SEGMENTATION: kind, RANGES: ranges}
    for pipeline, kind, ranges in (
        (RUNS, "hsv", "calibrated"),
        (RUNS, "monochrome", "calibrated"),
        (RUNS, "rgb", "calibrated"),
        (RUNS, "hsv", "published"),
        (RUNS, "rgb", "published"),
        ("cone-blobs", "hsv", "calibrated"),
    )
}
KEYS = (PIPELINE, SEGMENTATION, RANGES, *AXES)


def distance_claims(run: Run) -> list[Entry]:
    """An entry for each distance of appendix A, and what either projection does to all of them."""
    return answers(run, (DISTANCE, PROJECTION), _distances)


def _distances(cells: Cells) -> list[Question]:
    table = published(__package__, "kirchner2006", "appendix_a")
    told = {round(row[0] * FOOT, 6): mean for row, mean in zip(table["rows"], table["means"], strict=True)}
    found, planned = [], cells.planned()
    for distance, projection in planned:
        if projection != EQUAL_ANGLE or distance not in told:
            continue
        feet = told[distance]
        found.append(
            Question(
                source="kirchner2006 appendix_a (appendix A)",
                quantity=f"a cone at {distance / FOOT:g} ft: distance, ft",
                claim=f"{feet:g} ft, the mean of five tests at {distance / FOOT:g} ft",
                judge=all_must_hold(f"within {WITHIN:.0%} of what is published", partial(_near, cells, distance, feet)),
                published=feet,
            )
        )
    for number, (projection, words, test) in enumerate(
        ((EQUAL_ANGLE, "every distance within", _right), (PINHOLE, "every distance off by more than", _wrong)), 1
    ):
        mine = [cell for cell in planned if cell[1] == projection]
        if mine:
            judge = all_must_hold(f"{words} {WITHIN:.0%} of the truth", partial(test, cells, mine))
            found.append(
                claim_of(__package__, "kirchner2006", "cone_claims", number, f"{projection}: relative error", judge)
            )
    return found


def _near(cells: Cells, distance: float, feet: float) -> list[Outcome]:
    feet_found = cells.array("distance", distance, EQUAL_ANGLE) / FOOT
    return [near("distance, ft", feet_found, feet, WITHIN * distance / FOOT)]


def _right(cells: Cells, mine: list[tuple[float, str]]) -> list[Outcome]:
    return [near(f"{cell[0] / FOOT:g} ft", cells.array("distance_error", *cell), 0.0, WITHIN) for cell in mine]


def _wrong(cells: Cells, mine: list[tuple[float, str]]) -> list[Outcome]:
    return [more(f"{cell[0] / FOOT:g} ft", np.abs(cells.array("distance_error", *cell)), WITHIN) for cell in mine]


def robustness_claims(run: Run) -> list[Entry]:
    """That HSV does better than RGB masks and than monochrome subtraction while the light varies, by two measures."""
    return answers(run, KEYS, _robustness)


def _robustness(cells: Cells) -> list[Question]:
    found = []
    for number, other in enumerate(("rgb", "monochrome"), 1):
        for measure, words in BY.items():
            test = f"{words}, mean over the lights: HSV less the other above {BETTER:g} (paired)"
            judge = all_must_hold(test, partial(_better, cells, measure, other))
            quantity = f"HSV less {other}: {words}"
            found.append(claim_of(__package__, "kirchner2006", "light_claims", number, quantity, judge))
    return found


def _better(cells: Cells, measure: str, other: str) -> list[Outcome]:
    return [more(f"HSV less {other}", over_lights(cells, measure, "hsv") - over_lights(cells, measure, other), BETTER)]


def over_lights(cells: Cells, measure: str, kind: str) -> Floats:
    """(R,) a measure of each repeat, mean over the lights, of a segmentation with calibrated ranges."""
    nominal = tuple(NOMINAL.values())
    rates = [
        cells.array(measure, *cell)
        for cell in cells.planned()
        if cell[:3] == (RUNS, kind, "calibrated") and cell[4:] == nominal[1:]
    ]
    return np.asarray(np.mean(rates, axis=0))
