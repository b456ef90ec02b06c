"""What Fine 2015, section 4.2, says of the four LCH variations on four robots, held against a run of `lch-robots`.

Sameness: all six pairs of variations are equivalent in all five measures of the motion, each within its margin (two
one-sided tests on the differences of trials of one repeat). The margins are choices: a body-length, and shares that
would show in a drawing of four robots. Keeping the direction is a share of updates that must be 1. Following the leader
is measured as the share of way-points for which one member alone was selected: it must be more than half in the
group-centric variations, and more than in the member-centric one that is told the same of the members.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations

import numpy as np

from trials.claims import Cells, Entry, Outcome, Question, Run, above, answered, arms, more, near, published, same

KEYS = ("herd.law",)
MARGINS = {
    "mmd": ("MMD, m", 0.33),
    "polarization": ("polarization", 0.2),
    "group_speed": ("group speed, m/s", 0.05),
    "net_displacement": ("net displacement, m", 1.5),
    "largest_share": ("largest group's share", 0.25),
}
"""Within which two variations count as the same: a body-length, a fifth, a fifth of the cruising speed, a tenth of the
way of a minute at that speed, one robot of four."""
ALL_OF_THEM = 0.01
"""How near to 1 a share must be to be all."""
MOST = 0.5
DIFFERENCE = 0.1
"""Of two shares that would count as one."""
INFORMATION = ("pose", "bearing")
SOURCE = "fine2015 lch_claims"


def claims(run: Run) -> list[Entry]:
    """Four entries for each arm of the run."""
    entries = []
    for arm, trials in arms(run, KEYS):
        cells = Cells(trials, run.rows(), KEYS)
        entries += [answered(question, cells, arm) for question in _questions(cells)]
    return entries


def _questions(cells: Cells) -> list[Question]:
    told = published("fine2015", "lch_claims")["claims"]
    return [
        Question(
            source=f"{SOURCE}, claim 2 (section 4.2)",
            quantity="differences of two variations",
            words=told[1],
            test="every pair within the margin of every measure (two one-sided tests, paired); all 30 must be",
            outcomes=partial(_same, cells),
        ),
        Question(
            source=f"{SOURCE}, claim 3, its second half (section 4.2, figure 4.3a)",
            quantity="updates that saw nobody and left the command as it was",
            words=told[2],
            test=f"share within {ALL_OF_THEM:g} of 1 (two one-sided tests) in every variation",
            outcomes=partial(_kept, cells),
        ),
        *(
            Question(
                source=f"{SOURCE}, claim 4 (section 4.2, figure 4.3b)",
                quantity=f"way-points made from one member, {information}",
                words=told[3],
                test="share above a half, and above that of the member-centric variation (paired); both must be",
                outcomes=partial(_following, cells, information),
            )
            for information in INFORMATION
        ),
    ]


def _same(cells: Cells) -> list[Outcome]:
    found = []
    for first, second in combinations(cells.levels(*KEYS), 2):
        for measure, (words, margin) in MARGINS.items():
            differences = cells.difference(measure, (first,), (second,))
            found.append(same(f"{words}: {first} less {second}", differences, margin))
    return found


def _kept(cells: Cells) -> list[Outcome]:
    found = []
    for law in cells.levels(*KEYS):
        kept = np.array(list(cells.values("kept_share", law).values()))
        blind = np.array(list(cells.values("none_share", law).values()))
        found.append(near(f"share of them, {law}", kept, 1.0, ALL_OF_THEM))
        found.append(more(f"share of updates that saw nobody, {law}", blind, ALL_OF_THEM, decides=False))
    return found


def _following(cells: Cells, information: str) -> list[Outcome]:
    group, member = f"lch-group-{information}", f"lch-member-{information}"
    shares = np.array(list(cells.values("follow_share", group).values()))
    more_often = cells.difference("follow_share", (group,), (member,))
    straighter = cells.difference("straightness", (group,), (member,))
    return [
        above(f"share of way-points, {group}", shares, MOST, DIFFERENCE),
        more(f"share of way-points, {group} less {member}", more_often, DIFFERENCE),
        more(f"straightness, {group} less {member}", straighter, DIFFERENCE, decides=False),
    ]
