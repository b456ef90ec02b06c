"""What Fine 2015, section 4.2, says of the four LCH variations on four robots, held against a run of `lch-robots`.

Sameness: all six pairs of variations are equivalent in all five measures of the motion, each within its margin (two
one-sided tests on the differences of trials of one repeat). The margins are choices: a body-length, and shares that
would show in a drawing of four robots. Keeping the direction is measured on the robots' true headings: while one sees
nobody, and has not for half a second (the wheels must end a turn), it must turn by less than `STRAIGHT_RAD_S`; that its
law then steers straight ahead (`keeps_direction`) is the document's word, and what is tested is whether wheels, latency
and scans let it. Following the leader is measured as the share of way-points for which one member alone was selected:
it must be more than half in the group-centric variations, and more than in the member-centric one that is told the same
of the members.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations

import numpy as np

from trials.evidence.claims import Entry, Question, all_must_hold, answers, published
from trials.evidence.outcomes import Outcome, above, more, near, same
from trials.evidence.runs import Cells, Run
from trials.evidence.statistics import near_a_bound

LAW = "herd.law"
SIMULATED = published(__package__, "fine2015", "table_4_1")
THRESHOLDS = {
    "pose": ("herd.law.st_m", float(SIMULATED["st_distance"])),
    "bearing": ("herd.law.st_deg", float(SIMULATED["st_angular_deg"])),
}
"""Of the group-centric variations: figure 4.5's, for simulated members; the robots' own are twice as wide, since the
robots of the starting formation stand a metre apart: at half a metre each of them is a group by itself."""
KEYS = (LAW, *(key for key, _ in THRESHOLDS.values()))
MARGINS = {
    "mmd": ("MMD, m", 0.33),
    "polarization": ("polarization", 0.2),
    "group_speed": ("group speed, m/s", 0.05),
    "net_displacement": ("net displacement, m", 1.5),
    "largest_share": ("largest group's share", 0.25),
}
"""Within which two variations count as the same: a body-length, a fifth, a fifth of the cruising speed, a tenth of the
way of a minute at that speed, one robot of four."""
STRAIGHT_RAD_S = 0.1
"""At cruising speed a circle 5 m wide, which the corridor and the drawings of figure 4.3 would show as a bend."""
SOME = 0.01
"""A share of updates that would count as some."""
MOST = 0.5
DIFFERENCE = 0.1
"""Of two shares that would count as one."""
SOURCE = "fine2015 lch_claims"


def claims(run: Run) -> list[Entry]:
    """Six entries for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    told = published(__package__, "fine2015", "lch_claims")["claims"]
    return [
        Question(
            source=f"{SOURCE}, claim 2 (section 4.2)",
            quantity="differences of two variations",
            claim=told[1],
            judge=all_must_hold(
                "every pair within the margin of every measure (two one-sided tests, paired); all 30 must be",
                partial(_same, cells),
            ),
        ),
        Question(
            source=f"{SOURCE}, claim 3, its second half (section 4.2, figure 4.3a)",
            quantity="half a second after nobody is seen any more",
            claim=told[2],
            judge=all_must_hold(
                f"turn rate, mean of the variations, within ±{STRAIGHT_RAD_S:g} rad/s of 0 (two one-sided tests)",
                partial(_kept, cells),
            ),
        ),
        *(
            Question(
                source=f"{SOURCE}, claim 4 (section 4.2, figure 4.3b)",
                quantity=f"way-points made from one member, {information}{told_of}",
                claim=told[3],
                judge=all_must_hold(
                    "share above a half, and above that of the member-centric variation (paired); both must be",
                    partial(_following, cells, information, threshold),
                ),
            )
            for information, (key, value) in THRESHOLDS.items()
            for threshold, told_of in ((None, ""), (value, f" with figure 4.5's {key.rsplit('.', 1)[-1]} {value:g}"))
        ),
    ]


def _same(cells: Cells) -> list[Outcome]:
    found = []
    for first, second in combinations(laws_of(cells), 2):
        for measure, (words, margin) in MARGINS.items():
            differences = cells.difference(measure, cell(first), cell(second))
            found.append(same(f"{words}: {first} less {second}", differences, margin))
    return found


def _kept(cells: Cells) -> list[Outcome]:
    laws = laws_of(cells)
    turns = np.array([cells.array("blind_turn_rad_s", *cell(law)) for law in laws])
    some = turns[:, np.isfinite(turns).any(axis=0)]  # of the repeats in which somebody saw nobody for long enough
    found = [near("turn rate, rad/s", np.nanmean(some, axis=0), 0.0, STRAIGHT_RAD_S)]
    for law in laws:
        blind = cells.array("none_share", *cell(law))
        found.append(more(f"share of updates that saw nobody, {law}", blind, SOME, decides=False))
    return found


def laws_of(cells: Cells) -> list[str]:
    """The variations that a run has with the robots' own thresholds."""
    return [law for law in cells.levels(LAW) if cell(law) in cells.planned()]


def cell(law: str, threshold: float | None = None) -> tuple[str | float | None, ...]:
    """The values of `KEYS` of a variation, with the robots' own threshold or with another."""
    return law, *(threshold if law == f"lch-group-{information}" else None for information in THRESHOLDS)


def _following(cells: Cells, information: str, threshold: float | None) -> list[Outcome]:
    group, member = f"lch-group-{information}", f"lch-member-{information}"
    here, there = cell(group, threshold), cell(member)
    shares = cells.array("follow_share", *here)
    more_often = cells.difference("follow_share", here, there)
    exact = any(near_a_bound(values) for values in (shares, cells.array("follow_share", *there)))
    straighter = cells.difference("straightness", here, there)
    return [
        above(f"share of way-points, {group}", shares, MOST, DIFFERENCE, bounds=(0.0, 1.0)),
        more(f"share of way-points, {group} less {member}", more_often, DIFFERENCE, exact=exact),
        more(f"straightness, {group} less {member}", straighter, DIFFERENCE, decides=False),
    ]
