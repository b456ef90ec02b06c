"""From a budget of points to what the outputs hang on: a screening, then a variance-based analysis, then the flips.

Nothing here knows what a point is: `Evaluate` puts the outputs of points in the unit cube into the ledger. Every design
comes from the seed, and what follows from the outputs of one stage is the same whenever it is computed again; so an
analysis that was stopped goes on where it was.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats
from trials.sensitivity import analysis
from trials.sensitivity.analysis import Effects, Indices, Share
from trials.sensitivity.ledger import Ledger
from trials.sensitivity.quantity import Output

SCREENING, VARIANCE = "screening", "variance"
LEAST_TRAJECTORIES, USUAL_TRAJECTORIES = 4, 10
"""Morris 1991 has 4, Campolongo et al. 2007 recommend 10 and more."""
LEAST_BASE = 16
"""Points of a base sample below which no indices are estimated."""
MATTERS = 0.1
"""Of the largest mu*: a choice with less is fixed for the variance-based analysis."""
PARTS, ROUNDS = 4, 3
"""A line from the reference is cut into so many parts, so often: a flip is found to 1/64 of it. Two bisections at once
take one point more and half of the batches."""
Evaluate = Callable[[str, Mapping[int, Floats]], None]
"""(stage, points (k,) by number): puts the outputs of those that the ledger lacks into it."""
Snap = Callable[[Floats], Floats]
"""A point (k,) → the one that stands for the same values."""


class Flip(NamedTuple):
    """A point at which a claim's estimate has the other sign than at the reference."""

    place: Floats
    """(k,)."""
    distance: float
    """From the reference, in ranges scaled to [0, 1]."""
    output: Output


class Findings(NamedTuple):
    """What one claim hangs on."""

    reference: Output
    effects: Effects | None
    """Of all k choices."""
    indices: Indices | None
    """Of the active choices; None where there is no such analysis, or the claim does not vary."""
    holds: Share
    """Of the space, where the estimate holds: over what was varied last."""
    verdicts: tuple[Share, Share, Share]
    """Where the verdict is that it holds, that it does not, and undecided."""
    empty: int
    """Points at which the claim has no quantity."""
    flip: Flip | None


class Explored(NamedTuple):
    """What was run, and what each claim hangs on."""

    active: list[int]
    """Choices of the variance-based analysis; empty where there was none."""
    fixed_for_budget: list[int]
    """Choices that matter but for which the budget was too small."""
    trajectories: int
    base: int
    """Points of the base sample; 0: no variance-based analysis."""
    points: int
    """All that have ended, the reference apart."""
    findings: list[Findings]


def least_points(factors: int) -> int:
    """Points of the smallest screening."""
    return LEAST_TRAJECTORIES * (factors + 1)


def explore(
    evaluate: Evaluate,
    ledger: Ledger,
    reference: Floats,
    at_reference: Sequence[Output],
    points: int,
    seed: int,
    snap: Snap = lambda place: place,
) -> Explored:
    """Spends `points`, at least `least_points`, on the space around the reference (k,).

    `at_reference`: of each claim.
    """
    factors, claims = len(reference), len(at_reference)
    trajectories = min(USUAL_TRAJECTORIES, max(LEAST_TRAJECTORIES, points // 2 // (factors + 1)))
    design = analysis.screening(factors, trajectories, np.random.default_rng([seed, 1]))
    evaluate(SCREENING, dict(enumerate(design)))
    slack, agrees = _outputs(ledger, SCREENING, len(design), claims)
    effects = [analysis.screened(design, slack[:, c], np.random.default_rng([seed, 2])) for c in range(claims)]
    reserve = min(ROUNDS * (PARTS - 1) * claims, points // 10)
    matter = _that_matter(effects)
    active, base = _afforded(matter, points - len(design) - reserve)
    uniform = np.arange(len(design)) % (factors + 1) == 0
    indices: list[Indices | None] = [None] * claims
    if base:
        varied = analysis.saltelli_design(len(active), base, np.random.default_rng([seed, 3]))
        second = np.tile(reference, (len(varied), 1))
        second[:, active] = varied
        evaluate(VARIANCE, dict(enumerate(second)))
        more, more_agree = _outputs(ledger, VARIANCE, len(second), claims)
        indices = [analysis.indices(len(active), more[:, c], np.random.default_rng([seed, 4])) for c in range(claims)]
        uniform = np.concatenate([np.zeros(len(design), bool), analysis.base_points(len(active), len(second))])
        design, slack, agrees = np.vstack([design, second]), np.vstack([slack, more]), np.vstack([agrees, more_agree])
    lines = [
        line
        for c in range(claims)
        if (line := _nearest(c, at_reference[c], reference, design, slack[:, c], agrees[:, c], snap)) is not None
    ]
    holds, spent = [each.slack > 0.0 for each in at_reference], len(design)
    for turn in range(ROUNDS):
        if lines and spent + (PARTS - 1) * len(lines) <= points:
            lines = _narrowed(evaluate, ledger, f"flips {turn + 1}", lines, reference, holds)
            spent += (PARTS - 1) * len(lines)
    flips = {line.claim: _flip(line, reference, snap) for line in lines}
    return Explored(
        active=active,
        fixed_for_budget=[k for k in matter if k not in active],
        trajectories=trajectories,
        base=base,
        points=spent,
        findings=[
            Findings(
                at_reference[c], effects[c], indices[c], *_shares(slack[:, c], agrees[:, c], uniform), flip=flips.get(c)
            )
            for c in range(claims)
        ],
    )


def _outputs(ledger: Ledger, stage: str, count: int, claims: int) -> tuple[Floats, Floats]:
    """(P, C) slacks, and verdicts: 1 holds, 0 does not, nan undecided."""
    slack, agrees = np.full((count, claims), math.nan), np.full((count, claims), math.nan)
    for number, (_, outputs) in ledger.points(stage).items():
        if number < count:
            slack[number] = [each.slack for each in outputs]
            agrees[number] = [math.nan if each.agrees is None else float(each.agrees) for each in outputs]
    return slack, agrees


def _that_matter(effects: Sequence[Effects | None]) -> list[int]:
    """The choices that matter to any of the claims, the strongest first."""
    strength: dict[int, float] = {}
    for found in effects:
        most = float(found.mu_star.max()) if found is not None else 0.0
        if found is None or not most > 0.0:
            continue
        for k, size in enumerate(found.mu_star):
            if size >= MATTERS * most:
                strength[k] = max(strength.get(k, 0.0), float(size) / most)
    return sorted(strength, key=lambda k: (-strength[k], k))


def _afforded(matter: Sequence[int], points: int) -> tuple[list[int], int]:
    """As many of these choices as a variance-based analysis of so many points can have, in order, and its base
    sample: a power of 2, 0 if there is none."""
    for count in range(len(matter), 0, -1):
        most = points // (count + 2)
        if most >= LEAST_BASE:
            return sorted(matter[:count]), 1 << (most.bit_length() - 1)
    return [], 0


def _shares(slack: Floats, agrees: Floats, uniform: Bools) -> tuple[Share, tuple[Share, Share, Share], int]:
    """Where the estimate holds and what the verdicts are, of the points that are drawn uniformly; and how many of all
    points have none."""
    kept = uniform & np.isfinite(slack)
    found = agrees[kept]
    verdicts = (found == 1.0, found == 0.0, np.isnan(found))
    return (
        analysis.share(slack[kept] > 0.0),
        (analysis.share(verdicts[0]), analysis.share(verdicts[1]), analysis.share(verdicts[2])),
        int((~np.isfinite(slack)).sum()),
    )


class _Line(NamedTuple):
    """From the reference to a point at which a claim's estimate has the other sign: the part of it where that turns."""

    claim: int
    end: Floats
    low: float
    high: float
    output: Output
    """At `high`."""


def _nearest(
    claim: int, start: Output, reference: Floats, design: Floats, slack: Floats, agrees: Floats, snap: Snap
) -> _Line | None:
    """The line to the nearest point (k,) of the design (P, k) with the other sign; None where there is none."""
    flipped = np.flatnonzero(np.isfinite(slack) & ((slack > 0.0) != (start.slack > 0.0)))
    if not len(flipped):
        return None
    places = np.array([snap(design[k]) for k in flipped])
    nearest = int(np.argmin(np.linalg.norm(places - reference, axis=1)))
    verdict = agrees[flipped[nearest]]
    found = Output(float(slack[flipped[nearest]]), None if math.isnan(verdict) else bool(verdict))
    return _Line(claim, places[nearest], 0.0, 1.0, found)


def _narrowed(
    evaluate: Evaluate, ledger: Ledger, stage: str, lines: Sequence[_Line], reference: Floats, holds: Sequence[bool]
) -> list[_Line]:
    """The lines cut into `PARTS`, each narrowed to the first part at whose end the sign is the other one."""
    cuts = [np.linspace(line.low, line.high, PARTS + 1)[1:-1] for line in lines]
    points = {
        line.claim * PARTS + j: reference + cut * (line.end - reference)
        for line, inner in zip(lines, cuts, strict=True)
        for j, cut in enumerate(inner)
    }
    evaluate(stage, points)
    made, found = ledger.points(stage), []
    for line, inner in zip(lines, cuts, strict=True):
        low = line.low
        for j, cut in enumerate(inner):
            output = made[line.claim * PARTS + j][1][line.claim]
            if math.isfinite(output.slack) and (output.slack > 0.0) != holds[line.claim]:
                line = line._replace(high=float(cut), output=output)
                break
            low = float(cut)
        found.append(line._replace(low=low))
    return found


def _flip(line: _Line, reference: Floats, snap: Snap) -> Flip:
    place = reference + line.high * (line.end - reference)
    return Flip(place, float(np.linalg.norm(snap(place) - reference)), line.output)
