"""What Kirchner 2006 reports of his simulation held against runs of its experiments.

A number that he gives is of one trial, or of one that he calls typical: ours is held to it by the mean over the seeds.
His words are read so: robots "formed highly cohesive flocks" where more than nine of ten of them are not by themselves;
a larger number of flocks is worse.
"""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, above, more, near, same
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.monocular.boids import (
    COUNT,
    HERD,
    NORMAL_M,
    PIXEL_M,
    SHORT_M,
    VIEW,
    WITH_OBSTACLES,
    WITH_PREDATOR,
)

SOURCE, TABLE = "kirchner2006", "simulation"
MIDDLE, CHANCE = f"{HERD}.failure_time_s", f"{HERD}.failure_probability"
KEYS = (COUNT, VIEW, WITH_PREDATOR, WITH_OBSTACLES)
FAILING = (COUNT, MIDDLE, CHANCE)
FLOCKS_MARGIN, SHARE_MARGIN = 0.5, 0.05
"""Choices: half a flock; a twentieth of the robots."""
FEW_FLOCKS, MANY_FLOCKS_MARGIN = 0.1, 1.0
"""Choices: the least differences in flocks that count of three and of twenty robots."""
TOGETHER = 0.9
"""A choice: share of the robots that are not by themselves."""
OF_NUMBER = 1.0 / 3.0
"""Margin about a published standard deviation, as a share of it; a choice."""
Cell = tuple[float, ...]
PUBLISHED = published(__package__, SOURCE, TABLE)


def claims(run: Run) -> list[Entry]:
    """The numbers after a minute, and two claims."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    three, twenty, short = (PUBLISHED[name] for name in ("three_robots", "twenty_robots", "twenty_robots_short_vision"))
    small, large = twenty["centroid_std_px"]
    normal_3, normal_20, short_20 = (3, NORMAL_M, 1, 0), (20, NORMAL_M, 1, 0), (20, SHORT_M, 1, 0)
    asked = [
        _number(cells, normal_3, "three robots", "flocks_end", three["flocks"], "flocks after one minute"),
        _number(cells, normal_3, "three robots", "flock_std_end", three["centroid_std_px"], f"px, {OF_CENTROID}"),
        _number(cells, normal_20, "twenty robots", "flocks_end", twenty["flocks"], "flocks after one minute"),
        _number(
            cells, normal_20, "twenty robots", "flock_std_largest", large, f"px in the larger flock, {OF_CENTROID}"
        ),
        _number(
            cells, normal_20, "twenty robots", "flock_std_others", small, f"px in the smaller flock, {OF_CENTROID}"
        ),
        _number(cells, short_20, "short sight", "flocks_end", short["flocks"], "flocks after one minute"),
        _number(cells, short_20, "short sight", "flock_std_end", short["mean_std_px"], f"px, mean {OF_CENTROID}"),
    ]
    together = f"more than {TOGETHER:g} of the robots not by themselves, in every setting with normal sight"
    worse = "paired differences in flocks, short less normal sight, of three and of twenty robots"
    return [
        *asked,
        claim_of(__package__, SOURCE, TABLE, 1, "after one minute", all_must_hold(together, partial(_together, cells))),
        claim_of(__package__, SOURCE, TABLE, 2, "after one minute", all_must_hold(worse, partial(_worse, cells))),
    ]


OF_CENTROID = "standard deviation of the distances from the flock's centroid"


def _number(cells: Cells, cell: Cell, robots: str, measure: str, number: float, words: str) -> Question:
    """A published number, to which the mean over the seeds is held."""
    margin = FLOCKS_MARGIN if measure == "flocks_end" else OF_NUMBER * number
    test = f"mean within ±{margin:.3g} of the number of one trial (two one-sided tests)"
    judge = all_must_hold(test, partial(_near, cells, cell, measure, number, margin))
    return Question(
        source=f"{SOURCE} {TABLE} (section 3.3)",
        quantity=robots,
        claim=f"{robots}: {number:g} {words}",
        judge=judge,
        published=float(number),
    )


def _near(cells: Cells, cell: Cell, measure: str, number: float, margin: float) -> list[Outcome]:
    if measure == "flocks_end":
        return [near("flocks", cells.array(measure, *cell), number, margin)]
    found = [near("px", cells.array(measure, *cell) / PIXEL_M, number, margin)]
    if measure == "flock_std_end":
        root = cells.array("flock_rms_end", *cell) / PIXEL_M
        found.append(near("px, root of their mean square instead", root, number, margin, decides=False))
    return found


def _together(cells: Cells) -> list[Outcome]:
    found = []
    for cell in cells.planned():
        count, view, predators, obstacles = cell
        if view != NORMAL_M:
            continue
        share = 1.0 - cells.array("alone_end", *cell) / count
        words = f"{count} robots, {predators} predator, {obstacles} obstacles: share not by themselves"
        found.append(above(words, share, TOGETHER, SHARE_MARGIN, bounds=(0.0, 1.0)))
    return found


def _worse(cells: Cells) -> list[Outcome]:
    changes = {n: cells.difference("flocks_end", (n, SHORT_M, 1, 0), (n, NORMAL_M, 1, 0)) for n in (3, 20)}
    both = min(map(len, changes.values()))
    return [
        more("flocks more with short sight, of three robots", changes[3], FEW_FLOCKS),
        more("flocks more with short sight, of twenty robots", changes[20], MANY_FLOCKS_MARGIN),
        more("the same, of twenty less of three", changes[20][:both] - changes[3][:both], FLOCKS_MARGIN),
    ]


def sight_claims(run: Run) -> list[Entry]:
    """The claim on twenty minutes."""
    test = f"paired differences above {FLOCKS_MARGIN:g} flocks, all must hold"
    return answers(
        run,
        (VIEW,),
        lambda cells: [
            claim_of(__package__, SOURCE, TABLE, 3, "twenty minutes", all_must_hold(test, partial(_never, cells)))
        ],
    )


def _never(cells: Cells) -> list[Outcome]:
    least, most = (cells.array(name, SHORT_M) for name in ("flocks_least", "flocks_most"))
    normal = cells.array("flocks_later", NORMAL_M)
    later = cells.array("flocks_later", SHORT_M)
    if len(least) != len(normal):
        raise UndecidedError("the run has not as many trials with short sight as with normal sight")
    return [
        more("the most flocks less the least, short sight", most - least, FLOCKS_MARGIN),
        more("the least flocks with short sight less the mean with normal sight", least - normal, FLOCKS_MARGIN),
        more("the mean with short sight less that with normal sight", later - normal, FLOCKS_MARGIN, decides=False),
    ]


def failure_claims(run: Run) -> list[Entry]:
    """The two claims on failures."""
    splits = (
        f"two flocks within ±{FLOCKS_MARGIN:g} (two one-sided tests), more than half of the robots not by themselves"
    )
    recover = f"flocks of the robots that work at the end as many as without failures, ±{FLOCKS_MARGIN:g}"
    return answers(
        run,
        FAILING,
        lambda cells: [
            claim_of(__package__, SOURCE, TABLE, 4, "one of nine", all_must_hold(splits, partial(_splits, cells))),
            claim_of(__package__, SOURCE, TABLE, 5, "0.01 % a step", all_must_hold(recover, partial(_recover, cells))),
        ],
    )


def _splits(cells: Cells) -> list[Outcome]:
    """Of the trials in which all nine were one flock before."""
    nine = next(
        (cell for cell in cells.planned() if cell[0] is not None and cell[1] is not None and cell[1] > 0.0), None
    )
    if nine is None:
        raise UndecidedError("the run has no trials with a failure in the middle")
    before, after, alone = (cells.array(name, *nine) for name in ("flocks_before", "flocks_after", "alone_after"))
    one = before == 1.0
    together = 1.0 - alone[one] / (nine[0] - 1)
    return [
        near("flocks 5 s after, of one before", after[one], 2.0, FLOCKS_MARGIN),
        above("share of the robots not by themselves", together, 0.5, SHARE_MARGIN, bounds=(0.0, 1.0)),
        above("share of these flocks that split", (after[one] > 1.0).astype(float), 0.5, SHARE_MARGIN, decides=False),
    ]


def _recover(cells: Cells) -> list[Outcome]:
    twenty = [cell for cell in cells.planned() if cell[2] is not None and cell[2] > 0.0]
    if not twenty:
        raise UndecidedError("the run has no trials with failures by chance")
    count, middle, _ = failing = twenty[0]
    whole = (count, middle, 0.0)
    differences = cells.difference("flocks_end", failing, whole)
    share = cells.difference("largest_flock_end", failing, whole)
    return [
        same("flocks at the end with failures less without", differences, FLOCKS_MARGIN),
        same("share of the largest flock, likewise", share, 2.0 * SHARE_MARGIN, decides=False),
    ]
