"""What Kirchner 2006, chapter IV, says of its robots, held against runs of the tests with two and with three."""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, near
from trials.evidence.runs import Cells, Run
from trials.studies.monocular.design import BODY, FOOT

KEYS = (BODY,)
A_FOOT = 1.0
"""ft. Section 4.4 calls a distance within a foot of the ideal one good; a distance within a foot of the published one
reproduces it."""
NONE = 0.05
"""Touches a trial: fewer than one in twenty trials are none."""


def following_claims(run: Run) -> list[Entry]:
    """Two entries for each body: the final distance, and that nobody ever touches another."""
    name = run.trials[0].experiment.replace("follow-", "test_")
    return answers(run, KEYS, partial(_following, name))


def three_claims(run: Run) -> list[Entry]:
    """Three entries for each body: both final distances, and that nobody ever touches another."""
    return answers(run, KEYS, _three)


def _following(test: str, cells: Cells) -> list[Question]:
    told = published(__package__, "kirchner2006", "tests")[test]["final_distance_ft"]
    found = []
    for (body,) in cells.planned():
        found += [_distance(cells, body, "final_distance", "final distance", told), _touches(cells, body)]
    return found


def _three(cells: Cells) -> list[Question]:
    most, least = published(__package__, "kirchner2006", "tests")["three_robots"]["final_distances_ft"]
    found = []
    for (body,) in cells.planned():
        for measure, words, feet in (
            ("final_distance_most", "the farther of the rear robots from the front one", most),
            ("final_distance_least", "the nearer of the rear robots from the front one", least),
        ):
            found.append(_distance(cells, body, measure, words, feet))
        found.append(_touches(cells, body))
    return found


def _distance(cells: Cells, body: object, measure: str, words: str, feet: float) -> Question:
    def judged() -> list[Outcome]:
        return [near(f"{words}, ft", cells.array(measure, body) / FOOT, feet, A_FOOT)]

    return Question(
        source="kirchner2006 tests (section 4.4)",
        quantity=f"{body}: {words}, ft",
        claim=f"a final distance of {feet:g} feet",
        judge=all_must_hold("within a foot of the published distance", judged),
        published=feet,
    )


def _touches(cells: Cells, body: object) -> Question:
    def judged() -> list[Outcome]:
        return [near("touches a trial", cells.array("member_collisions", body), 0.0, NONE)]

    judge = all_must_hold(f"touches between robots, a trial, within {NONE:g} of none", judged)
    return claim_of(__package__, "kirchner2006", "test_claims", 1, f"{body}: touches between robots", judge)
