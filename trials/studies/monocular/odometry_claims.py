"""Appendices B and C of Kirchner 2006 held against a run of `odometry`.

What is compared is what the odometry reads less what is true: metres of a straight way, degrees of a turn. Margins are
choices: 2 cm and 2 degrees, about what the publication's tests of one kind differ by; for the mere sign 2 % of the way
and 1 degree.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import Entry, Judged, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, more, near
from trials.evidence.runs import Cells, Run

STOP_M, STOP_RAD, SPEED, RATE = (f"herd.law.{name}" for name in ("stop_m", "stop_rad", "leg_1_m_s", "leg_1_rad_s"))
KEYS = (STOP_M, STOP_RAD, SPEED, RATE)
MOVEMENT = published(__package__, "kirchner2006", "movement")
TURNING = published(__package__, "kirchner2006", "turning")
ANGLES = tuple(round(math.radians(angle), 4) for angle in TURNING["angles_deg"])
"""rad that the robot is told to turn."""
TURN_RAD_S = 0.2094395
"""Twelve degrees a second. A choice: slow enough to stop within a degree or two of the angle, as was done there."""
IN_PLACE, ONE_SIDE = 0.0, 0.0616
"""m/s of the robot's middle while it turns: on the right side's wheels alone it is the turn rate times half the track
that the firmware takes for its own, 588 mm."""
WAYS = {IN_PLACE: "in place", ONE_SIDE: "on one side's wheels"}
WAY_MARGIN_M, TURN_MARGIN_DEG, DISPLACED_MARGIN_M = 0.02, 2.0, 0.05
SIGN_SHARE, SIGN_DEG, SIGN_BEARS = 0.02, 1.0, 0.005
"""Of the way, degrees, and metres aside a metre: the least that counts as a sign."""
BEARS_FROM_M = 2.0
"""The publication's robot ends on its course after a metre, and 0.010 to 0.034 m a metre to its left after more."""


def claims(run: Run) -> list[Entry]:
    """Seven distances, four angles, two displacements and four claims in words, for each arm of the run."""
    return answers(run, KEYS, _questions)


def over_read_m(cells: Cells, distance: float, speed: float) -> Floats:
    """(n,) m that the odometry reads more than the robot drove."""
    counted, true = (cells.array(measure, distance, 0.0, speed, 0.0) for measure in ("counted_way", "true_way"))
    return believed(cells) * counted - true


def over_read_deg(cells: Cells, angle: float, speed: float) -> Floats:
    """(n,) degrees that the odometry reads more than the robot turned."""
    counted, true = (cells.array(measure, 0.0, angle, speed, TURN_RAD_S) for measure in ("counted_turn", "true_turn"))
    return np.degrees(believed(cells) * counted - true)


def believed(cells: Cells) -> float:
    """By which factor the robot reads more than its wheels have run."""
    return 1.0 + float(cells.trials[0].groups[0].law_parameters.get("radius_error", 0.0))


def _questions(cells: Cells) -> list[Question]:
    return [
        *(
            Question(
                source=f"kirchner2006 movement, {distance:g} m (appendix B)",
                quantity="straight ahead",
                claim=f"odometry less way at {distance:g} m and {speed:g} m/s: {told:g} m",
                judge=_near(
                    f"odometry less way, {distance:g} m at {speed:g} m/s, m",
                    partial(over_read_m, cells, float(distance), speed),
                    told,
                    WAY_MARGIN_M,
                ),
                published=told,
            )
            for distance, speed, told in _movement()
        ),
        *(
            Question(
                source=f"kirchner2006 turning, {degrees:g} degrees (appendix C)",
                quantity="turned in place",
                claim=f"odometry less turn at {degrees:g} degrees: {told:g} degrees",
                judge=_near(
                    f"odometry less turn, {degrees:g} degrees in place, degrees",
                    partial(over_read_deg, cells, angle, IN_PLACE),
                    told,
                    TURN_MARGIN_DEG,
                ),
                published=told,
            )
            for angle, degrees, told in zip(ANGLES, TURNING["angles_deg"], TURNING["over_read_deg"], strict=True)
        ),
        *(
            Question(
                source="kirchner2006 turning, displacement (appendix C)",
                quantity=f"turned {words}",
                claim=f"after a turn by 180 degrees the robot is displaced by {TURNING['displaced_m'][-1]:g} m",
                judge=_near(
                    f"displacement after 180 degrees {words}, m",
                    partial(cells.array, "true_way", 0.0, ANGLES[-1], speed, TURN_RAD_S),
                    TURNING["displaced_m"][-1],
                    DISPLACED_MARGIN_M,
                ),
                published=TURNING["displaced_m"][-1],
            )
            for speed, words in WAYS.items()
        ),
        *(
            claim_of(
                __package__, "kirchner2006", "movement", number, quantity, all_must_hold(test, partial(found, cells))
            )
            for number, quantity, test, found in (
                (1, "odometry less way, a metre", f"above {SIGN_SHARE:g} at all seven", _more_than_driven),
                (2, "aside to the left, a metre", f"above {SIGN_BEARS:g} from {BEARS_FROM_M:g} m on", _to_the_left),
            )
        ),
        *(
            claim_of(
                __package__,
                "kirchner2006",
                "turning",
                number,
                "degrees in place",
                all_must_hold(f"above {SIGN_DEG:g} degree at both", partial(_turns, cells, angles, sign)),
            )
            for number, angles, sign in ((1, ANGLES[:2], 1.0), (2, ANGLES[2:], -1.0))
        ),
    ]


def _movement() -> list[tuple[float, float, float]]:
    """Distance (m), speed (m/s) and what the odometry read too much (m) of each kind of test."""
    return list(zip(MOVEMENT["distances_m"], MOVEMENT["speeds_m_s"], MOVEMENT["over_read_m"], strict=True))


def _near(label: str, values: Callable[[], Floats], target: float, margin: float) -> Callable[[], Judged]:
    return all_must_hold(
        f"within ±{margin:g} of what was published (two one-sided tests)",
        lambda: [near(label, values(), target, margin)],
    )


def _more_than_driven(cells: Cells) -> list[Outcome]:
    return [
        more(
            f"odometry less way, a metre, {distance:g} m at {speed:g} m/s",
            over_read_m(cells, float(distance), speed) / distance,
            SIGN_SHARE,
        )
        for distance, speed, _ in _movement()
    ]


def _to_the_left(cells: Cells) -> list[Outcome]:
    return [
        more(
            f"aside, a metre, {distance:g} m at {speed:g} m/s",
            cells.array("moved_aside", float(distance), 0.0, speed, 0.0) / distance,
            SIGN_BEARS,
        )
        for distance, speed, _ in _movement()
        if distance >= BEARS_FROM_M
    ]


def _turns(cells: Cells, angles: tuple[float, ...], sign: float) -> list[Outcome]:
    words = "odometry less turn" if sign > 0.0 else "turn less odometry"
    return [
        more(
            f"{words}, {math.degrees(angle):.0f} degrees, degrees",
            sign * over_read_deg(cells, angle, IN_PLACE),
            SIGN_DEG,
        )
        for angle in angles
    ]
