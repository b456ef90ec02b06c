"""The claims of Hodgins and Brogan 1994 held against runs of this study's experiments.

Their words leave open how many are few, and how close is closely: the margins are choices, and stand above the tests.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more, ratio, same
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.robot_herds.design import (
    AHEAD,
    BODIES,
    BODY,
    PARTICLES,
    ROBOTS,
    SELECTION,
    VELOCITIES,
    VISIBLE,
)

SOURCE, TABLE = "hodgins1994", "tests"
ALL, HIDDEN, REAR = "all", "unoccluded(0.23)", "angle(120)"
"""Selections: everybody, those whose centre no nearer creature's disc hides, those less than so many degrees off."""
CREATURES = 105
FEW_A_MINUTE = 0.1 * CREATURES
"""Collisions: one creature in ten, once a minute, is few."""
MOST = 0.5
"""Share of the trials that is most of them."""
ROUND = 0.85
"""Narrowest over longest extent of what is nearly a circle."""
CLOSER = 1.1
"""Ratio of distances that counts."""
AHEAD_M = 0.1
QUICK_S, SLOWER_S, TEST_S = 15.0, 1.0, 40.0
"""s: of the publication's test, in which point masses rejoined; that counts; until which we watch."""
STABLER = 1.1
"""Ratio of velocities' deviations that counts."""
ALIKE = math.log(2.0)
ASTRAY = 0.2
"""Of the speed that is told."""


def _claim(number: int, quantity: str, test: str, outcomes: Callable[[], Sequence[Outcome]]) -> Question:
    return claim_of(__package__, SOURCE, TABLE, number, quantity, all_must_hold(test, outcomes))


def _first(cells: Cells, words: str, *cell: float) -> Question:
    test = f"no robot fell in most trials, collisions below {FEW_A_MINUTE:g} a minute"
    return _claim(1, words, test, partial(_upright, cells, *cell))


def _upright(cells: Cells, *cell: float) -> list[Outcome]:
    key = (*cell, ROBOTS)
    fewer = FEW_A_MINUTE - cells.array("collisions_a_minute", *key)
    upright = (cells.array("falls", *key) == 0).astype(float)
    return [
        above("share of the trials in which no robot fell", upright, MOST, 0.1, bounds=(0.0, 1.0)),
        above("collisions a minute fewer than few", fewer, 0.0, FEW_A_MINUTE),
    ]


def steady_claims(run: Run) -> list[Entry]:
    """Upright, and nearly circular."""
    test = f"aspect above {ROUND:g} and grown, radius less, of both herds"
    return answers(
        run,
        (BODY,),
        lambda cells: [_first(cells, "steady state"), _claim(4, "at the end", test, partial(_circle, cells))],
    )


def _circle(cells: Cells) -> list[Outcome]:
    found = []
    for body in BODIES:
        start, end = cells.array("aspect_start", body), cells.array("aspect_end", body)
        less = cells.array("radius_start", body) - cells.array("radius_end", body)
        found += [
            above(f"narrowest over longest, {body}", end, ROUND, 0.05, bounds=(0.0, 1.0)),
            more(f"the same, end less start, {body}", end - start, 0.05),
            more(f"m by which the outer radius shrank, {body}", less, 0.1),
        ]
    return found


def acceleration_claims(run: Run) -> list[Entry]:
    """Upright, and ahead of the herd while that accelerates."""
    test = f"ahead of the centre at 3 m/s by more than {AHEAD_M:g} m beyond what it is at 2 and at 1.5 m/s"
    return answers(
        run,
        (BODY,),
        lambda cells: [_first(cells, "acceleration"), _claim(10, "robots", test, partial(_ahead, cells))],
    )


def _ahead(cells: Cells) -> list[Outcome]:
    one, two, three = (cells.array(f"ahead_{leg}", ROBOTS) for leg in (1, 2, 3))
    points = cells.array("ahead_2", PARTICLES) - cells.array("ahead_1", PARTICLES)
    return [
        more("m further ahead at 3 than at 2 m/s", two - one, AHEAD_M),
        more("m further ahead at 3 than at 1.5 m/s", two - three, AHEAD_M),
        more("m further ahead at 3 than at 2 m/s, point masses", points, AHEAD_M, decides=False),
    ]


def zigzag_claims(run: Run) -> list[Entry]:
    """Upright, collisions, and how closely the herds track their user's creature."""
    collide = "most trials of the point masses without a collision, more than one on average with robots"
    track = f"paired ratios of the distance between the user's creature and the herd's centre above {CLOSER:g}"
    return answers(
        run,
        (BODY,),
        lambda cells: [
            _first(cells, "zigzag"),
            _claim(2, "collisions", collide, partial(_collide, cells)),
            _claim(3, "zigzag", track, partial(_track, cells)),
        ],
    )


def _collide(cells: Cells) -> list[Outcome]:
    none = (cells.array("collisions", PARTICLES) == 0).astype(float)
    return [
        above("share of the point masses' trials without any", none, MOST, 0.1, bounds=(0.0, 1.0)),
        more("collisions of robots", cells.array("collisions", ROBOTS), 0.5, threshold=1.0),
    ]


def _track(cells: Cells) -> list[Outcome]:
    course = cells.log_ratio("off_course", (ROBOTS,), (PARTICLES,))
    return [
        ratio("distance, robots over point masses", cells.log_ratio("user_away", (ROBOTS,), (PARTICLES,)), CLOSER),
        ratio("the same of the centre from the course that is told", course, CLOSER, decides=False),
    ]


def obstacle_claims(run: Run) -> list[Entry]:
    """Upright, and who avoids the obstacle and rejoins."""
    return answers(run, (AHEAD, BODY), _of_obstacle)


def _of_obstacle(cells: Cells) -> list[Question]:
    test = (
        f"point masses one group again within {QUICK_S:g} s and their first misses it, the robots' first hits it, in "
        f"most trials; robots slower by more than {SLOWER_S:g} s"
    )
    levels = sorted({cell[0] for cell in cells.planned() if cell[0] is not None}, reverse=True)
    asked = []
    for ahead in levels or [math.nan]:
        words = f"obstacle {ahead:g} m ahead"
        asked.append(_first(cells, words, ahead))
        asked.append(_claim(5, words, test, partial(_rejoin, cells, ahead)))
    return asked


def _rejoin(cells: Cells, ahead: float) -> list[Outcome]:
    times = {body: _until_one(cells, ahead, body) for body in BODIES}
    quick = (times[PARTICLES] <= QUICK_S).astype(float)
    misses, hits = 1.0 - cells.array("first_hits", ahead, PARTICLES), cells.array("first_hits", ahead, ROBOTS)
    both = min(map(len, times.values()))
    share = {"bounds": (0.0, 1.0)}
    return [
        above("share of the trials in which point masses rejoin quickly", quick, MOST, 0.1, **share),  # type: ignore[arg-type]
        above("share in which their first misses the obstacle", misses, MOST, 0.1, **share),  # type: ignore[arg-type]
        above("share in which the robots' first hits it", hits, MOST, 0.1, **share),  # type: ignore[arg-type]
        more("s longer until robots are one group", times[ROBOTS][:both] - times[PARTICLES][:both], SLOWER_S),
    ]


def _until_one(cells: Cells, ahead: float, body: str) -> Floats:
    """(n,) s until the herd is one group for good; who never rejoins is watched until the test's end."""
    found, apart = cells.array("regroup_s", ahead, body), cells.array("breakaways", ahead, body)
    return np.where(apart > 0.0, TEST_S, found)


def visible_claims(run: Run) -> list[Entry]:
    """Stability by the number of visible creatures."""
    test = f"ratio of the deviations of velocities, mean over the numbers below 30 (of logarithms), above {STABLER:g}"
    return answers(run, (VISIBLE, BODY), lambda cells: [_claim(6, "below 30 visible", test, partial(_stabler, cells))])


def _stabler(cells: Cells) -> list[Outcome]:
    few = [n for n in cells.levels(VISIBLE) if n < 30]
    if not few:
        raise UndecidedError("the run has no trials with fewer than 30 visible")
    logs = [cells.log_ratio("unrest", (n, PARTICLES), (n, ROBOTS)) for n in few]
    shared = min(map(len, logs))
    mean = np.mean([each[:shared] for each in logs], axis=0)
    each_one = [ratio(f"the same, {n} visible", one, STABLER, decides=False) for n, one in zip(few, logs, strict=True)]
    return [ratio("deviation of velocities, point masses over robots", mean, STABLER), *each_one]


def perception_claims(run: Run) -> list[Entry]:
    """Actual velocities, occlusion, and less sight to the rear."""
    return answers(
        run,
        (SELECTION, VELOCITIES, BODY),
        lambda cells: [
            _claim(
                7,
                "after a minute",
                f"speed more than {ASTRAY:.0%} off with actual velocities, and less with desired ones",
                partial(_astray, cells),
            ),
            _claim(
                8,
                "creatures as discs of 0.23 m",
                f"deviation of velocities grows by more than {STABLER:g} times, that of robots at most twofold",
                partial(_hidden, cells),
            ),
            _claim(9, "120 degrees to either side", "speed above that told, of both herds", partial(_rear, cells)),
        ],
    )


def _astray(cells: Cells) -> list[Outcome]:
    off = {told: np.abs(cells.array("speed_ratio", ALL, told, ROBOTS) - 1.0) for told in ("actual", "desired")}
    return [
        above("actual: amount that the speed is off, of that told", off["actual"], ASTRAY, 0.1),
        above("desired: how far below that it stays", ASTRAY - off["desired"], 0.0, 0.1),
    ]


def _hidden(cells: Cells) -> list[Outcome]:
    logs = {body: cells.log_ratio("unrest", (HIDDEN, "desired", body), (ALL, "desired", body)) for body in BODIES}
    return [
        ratio("deviation of velocities, with over without occlusion, point masses", logs[PARTICLES], STABLER),
        same("logarithm of the same, robots", logs[ROBOTS], ALIKE),
    ]


def _rear(cells: Cells) -> list[Outcome]:
    return [
        more(f"speed over that told, {body}", cells.array("speed_ratio", REAR, "desired", body), 0.1, threshold=1.0)
        for body in BODIES
    ]
