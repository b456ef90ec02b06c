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
    """That three robots are one flock; that all neighbours make fewer flocks than the nearest, by the same eyes and by
    the same perfect sensing; and, which nobody says, whether eyes or hiding one another change how many there are."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    found, planned = [], cells.planned()
    for herd in dict.fromkeys(cell[:2] for cell in planned):
        told = f"{herd[0]} {'Pioneers' if herd[1] else 'Creates'}"
        mine = [cell for cell in planned if cell[:2] == herd]
        for cell in mine:
            _, _, pipeline, nearest, hides = cell
            if herd[0] == THREE and pipeline == ONE:
                judge = all_must_hold(f"flocks after a minute within {HALF_A_FLOCK:g} of 1", _flocks(cells, cell))
                found.append(claim_of(__package__, "kirchner2006", SOURCE, 1, f"{told}: flocks after a minute", judge))
            every = (*cell[:3], False, hides)
            if nearest and pipeline != ONE and hides is not False and every in mine:
                judge = all_must_hold(f"fewer by more than {HALF_A_FLOCK:g} (paired)", _fewer(cells, cell, every))
                quantity = f"{told}, {pipeline}: flocks by the nearest neighbour less those by all"
                found.append(claim_of(__package__, "kirchner2006", SOURCE, 2, quantity, judge))
            for number, (other, words) in enumerate(
                (
                    ((*herd, PERFECT, nearest, True), "flocks by eyes less those by perfect sensing"),
                    (
                        (*herd, PERFECT, nearest, False),
                        "flocks where robots hide one another less those where none does",
                    ),
                ),
                1,
            ):
                if other in mine and (pipeline, hides) == ((SEVERAL, None) if other[4] else (PERFECT, True)):
                    which = "nearest" if nearest else "all"
                    judge = all_must_hold(f"within {HALF_A_FLOCK:g} of none (paired)", _same(cells, cell, other))
                    quantity = f"{told}, {which}: {words}"
                    found.append(claim_of(__package__, "kirchner2006", "flock_open", number, quantity, judge))
    return found


def _same(cells: Cells, one: tuple[object, ...], other: tuple[object, ...]) -> Callable[[], list[Outcome]]:
    return lambda: [near("difference", cells.difference("flocks", one, other), 0.0, HALF_A_FLOCK)]


def _flocks(cells: Cells, cell: tuple[object, ...]) -> Callable[[], list[Outcome]]:
    return lambda: [near("flocks", cells.array("flocks", *cell), 1.0, HALF_A_FLOCK)]


def _fewer(cells: Cells, one: tuple[object, ...], several: tuple[object, ...]) -> Callable[[], list[Outcome]]:
    return lambda: [more("nearest less all", cells.difference("flocks", one, several), HALF_A_FLOCK)]
