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
    BREAKAWAY,
    EASIER_M,
    GAP,
    HERD,
    PARTICLES,
    ROBOTS,
    SELECTION,
    TESTS,
    USUAL_M,
    VELOCITIES,
    VISIBLE,
)

SOURCE, TABLE = "hodgins1994", "tests"
ALL, HIDDEN, REAR = "all", "unoccluded(0.23)", "angle(120)"
"""Selections: everybody, those whose centre no nearer creature's disc hides, those less than so many degrees off."""
FEW_A_MINUTE = 0.1 * HERD["individuals"]
"""Collisions: one creature in ten, once a minute, is few."""
MOST = 0.5
"""Share of the trials that is most of them."""
ROUND = 0.85
"""Narrowest over longest extent of what is nearly a circle."""
CLOSER = 1.25
"""Ratio of distances that is much."""
AHEAD_M = 0.1
APPROXIMATELY = 0.7
"""Narrowest over longest extent of what is approximately a circle."""
QUICK_S, SLOWER_S, TEST_S = TESTS["obstacle"]["seconds"], 1.0, 40.0
"""s: of the publication's test, in which point masses rejoined; that counts; until which we watch."""
FEWER = 5.0
"""Creatures that touch the obstacle: so many more count."""
STABLER = 1.1
"""Ratio of velocities' deviations that counts."""
ALIKE = math.log(STABLER)
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
    test = (
        "one herd in most trials; in the first third of 3 m/s ahead of the centre by "
        f"{AHEAD_M:g} m more than in those of 2 and 1.5 m/s"
    )
    return answers(
        run,
        (BODY,),
        lambda cells: [_first(cells, "acceleration"), _claim(10, "robots", test, partial(_ahead, cells))],
    )


def _ahead(cells: Cells) -> list[Outcome]:
    one, two, three = (cells.array(f"ahead_{leg}", ROBOTS) for leg in (1, 2, 3))
    points = cells.array("ahead_2", PARTICLES) - cells.array("ahead_1", PARTICLES)
    one_herd = {body: (cells.array("breakaways", body) == 0).astype(float) for body in BODIES}
    return [
        *(
            above(f"share of the trials in which no group breaks away, {body}", each, MOST, 0.1, bounds=(0.0, 1.0))
            for body, each in one_herd.items()
        ),
        more("m further ahead at 3 than at 2 m/s", two - one, AHEAD_M),
        more("m further ahead at 3 than at 1.5 m/s", two - three, AHEAD_M),
        more("m further ahead at 3 than at 2 m/s, point masses", points, AHEAD_M, decides=False),
    ]


def zigzag_claims(run: Run) -> list[Entry]:
    """Upright, collisions, and how closely the herds track their user's creature."""
    collide = "most trials of the point masses without a collision, more than one on average with robots"
    circle = f"narrowest over longest extent over the last tenth above {APPROXIMATELY:g}, both herds"
    restless = f"paired ratios of the deviation of velocities above {STABLER:g}"
    track = f"paired ratios of the distance between the user's creature and the herd's centre above {CLOSER:g}"
    return answers(
        run,
        (BODY,),
        lambda cells: [
            _first(cells, "zigzag"),
            _claim(2, "collisions", collide, partial(_collide, cells)),
            _claim(3, "zigzag", track, partial(_track, cells)),
            _claim(12, "zigzag", circle, partial(_round, cells)),
            _claim(13, "zigzag", restless, partial(_restless, cells)),
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
    lags = [cells.array("lag_s", body) for body in (ROBOTS, PARTICLES)]
    both = min(map(len, lags))
    return [
        ratio("distance, robots over point masses", cells.log_ratio("user_away", (ROBOTS,), (PARTICLES,)), CLOSER),
        ratio("the same of the centre from the course that is told", course, CLOSER, decides=False),
        more("s by which the herd of robots follows later", lags[0][:both] - lags[1][:both], 0.5, decides=False),
    ]


def _round(cells: Cells) -> list[Outcome]:
    shape = {"bounds": (0.0, 1.0)}
    return [
        above(f"narrowest over longest, {body}", cells.array("aspect_end", body), APPROXIMATELY, 0.05, **shape)  # type: ignore[arg-type]
        for body in BODIES
    ]


def _restless(cells: Cells) -> list[Outcome]:
    logs = cells.log_ratio("unrest", (ROBOTS,), (PARTICLES,))
    return [ratio("deviation of velocities, robots over point masses", logs, STABLER)]


def obstacle_claims(run: Run) -> list[Entry]:
    """Upright, and who avoids the obstacle and rejoins."""
    return answers(run, (AHEAD, BODY), _of_obstacle)


def _of_obstacle(cells: Cells) -> list[Question]:
    test = (
        f"point masses one group again within {QUICK_S:g} s and their first misses it, the robots' first hits it, in "
        f"most trials; robots slower by more than {SLOWER_S:g} s"
    )
    alike = f"robots rejoin within {SLOWER_S:g} s of point masses, and {FEWER:g} creatures more touch it at most"
    levels = sorted({cell[0] for cell in cells.planned() if cell[0] is not None}, reverse=True)
    asked = []
    for ahead in levels or [USUAL_M]:
        words = f"obstacle {ahead:g} m ahead"
        asked.append(_first(cells, words, ahead))
        if ahead < EASIER_M:
            asked.append(_claim(5, words, test, partial(_rejoin, cells, ahead)))
        else:
            asked.append(_claim(11, words, alike, partial(_alike, cells, ahead)))
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
    """(n,) s until both sides are together for good; who never rejoins is watched until the test's end."""
    found = cells.array("rejoin_s", ahead, body)
    return np.where(np.isnan(found), TEST_S, found)


def _alike(cells: Cells, ahead: float) -> list[Outcome]:
    times = [_until_one(cells, ahead, body) for body in (ROBOTS, PARTICLES)]
    hits = [cells.array("obstacle_hits", ahead, body) for body in (ROBOTS, PARTICLES)]
    both = min(map(len, [*times, *hits]))
    return [
        same("s later that robots rejoin", times[0][:both] - times[1][:both], SLOWER_S),
        same("creatures that touch the obstacle, robots less point masses", hits[0][:both] - hits[1][:both], FEWER),
    ]


def breakaway_claims(run: Run) -> list[Entry]:
    """Who rejoins, by the size of the group and by its gap."""
    visible = HERD["visible_n"]
    test = (
        f"groups of {visible} and fewer within {HERD['visible_radius_m']:g} m rejoin in most trials; larger ones, and "
        "those beyond, in few"
    )
    return answers(
        run,
        (BREAKAWAY, GAP, BODY),
        lambda cells: [_claim(14, "groups behind", test, partial(_rejoins, cells, visible))],
    )


def _rejoins(cells: Cells, visible: int) -> list[Outcome]:
    found = []
    for size, gap, body in sorted(cells.planned()):
        rejoined = (cells.array("breakaways", size, gap, body) == 0).astype(float)
        words = f"share that rejoins: {size:g} creatures, {gap:g} m behind, {body}"
        if size <= visible and gap < HERD["visible_radius_m"]:
            found.append(above(words, rejoined, MOST, 0.1, bounds=(0.0, 1.0)))
        else:
            found.append(above(f"{words} (less 1)", 1.0 - rejoined, MOST, 0.1, bounds=(0.0, 1.0)))
    return found


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
                f"deviation of velocities grows by more than {STABLER:g} times, that of robots by less",
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
