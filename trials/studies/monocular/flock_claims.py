"""What Kirchner 2006 says of flocks and of all neighbours, held against a run of `monocular-flock`."""

from __future__ import annotations

from collections.abc import Callable

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more, near
from trials.evidence.runs import Cells, Run
from trials.studies.monocular.design import BODY

COUNT, PIPELINE, NEAREST = "herd.count", "herd.pipeline", "herd.law.nearest_only"
OCCLUSION = "herd.pipeline.occlusion"
KEYS = (COUNT, BODY, PIPELINE, NEAREST, OCCLUSION)
ONE, SEVERAL, PERFECT = "cone-member-based", "cone-blobs", "perfect"
HALF_A_FLOCK = 0.5
"""Numbers of flocks that differ by less are the same: in every other trial one more. A choice."""
SOURCE = "flock_claims"
THREE = 3


def claims(run: Run) -> list[Entry]:
    """That three robots are one flock; that all neighbours make fewer flocks than the nearest; and eyes beside perfect
    sensing."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    found = []
    planned = cells.planned()
    for cell in planned:
        count, body, pipeline = cell[:3]
        told = f"{count} {'Pioneers' if body else 'Creates'}"
        if count == THREE and pipeline == ONE:
            judge = all_must_hold(f"flocks after a minute within {HALF_A_FLOCK:g} of 1", _flocks(cells, cell))
            found.append(claim_of(__package__, "kirchner2006", SOURCE, 1, f"{told}: flocks after a minute", judge))
        if pipeline == ONE:
            for other in planned:
                if other[:2] != cell[:2]:
                    continue
                if other[2] == SEVERAL:
                    judge = all_must_hold(f"fewer by more than {HALF_A_FLOCK:g} (paired)", _fewer(cells, cell, other))
                    quantity = f"{told}: flocks by the nearest neighbour less those by all"
                    found.append(claim_of(__package__, "kirchner2006", SOURCE, 2, quantity, judge))
    return found


def _flocks(cells: Cells, cell: tuple[object, ...]) -> Callable[[], list[Outcome]]:
    return lambda: [near("flocks", cells.array("flocks", *cell), 1.0, HALF_A_FLOCK)]


def _fewer(cells: Cells, one: tuple[object, ...], several: tuple[object, ...]) -> Callable[[], list[Outcome]]:
    return lambda: [more("nearest less all", cells.difference("flocks", one, several), HALF_A_FLOCK)]
