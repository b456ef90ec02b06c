"""The heat map of `information-abstraction`: which laws keep flocking as information is taken away."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.summary import shown_value
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.information import law_survey
from trials.studies.information.abstraction_claims import cell_of, control_of, kept, rules_of, told_of
from trials.studies.information.abstraction_design import ALL_TOLD, KEYS, law_of, words_left_out
from trials.studies.information.law_judges import Cell, mean_of
from trials.studies.information.verdict_maps import Square, verdict_map

CONTROL_COLUMN = "random motion"


def figures(run: Run, folder: Path) -> list[Figure]:
    """The map of each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), KEYS)
    rows = {shown_value(rule): _row(cells, rule) for rule in rules_of(cells)}
    columns = [*(told.words() for told in ALL_TOLD), CONTROL_COLUMN]
    key = "numbers: what the law is judged by (largest group's share; polarization, or MMD in spacings of the herd)"
    caption = (
        "Green: shown to flock as with perfect poses and better than random motion; red: shown not to; grey: neither; "
        "white: not asked of this law. First column: better than random motion alone. Last: its control. "
        f"{words_left_out()} {law_survey.without_goals(run.trials)}"
    )
    title = "Who keeps flocking as information is taken away"
    return [draw.save(verdict_map(rows, columns, key), place, "information", title, caption.rstrip())]


def _row(cells: Cells, rule: str) -> list[Square | None]:
    try:
        found = {one.told: one for one in kept(cells, rule)}
    except UndecidedError:
        found = {}
    there = set(told_of(cells, rule))
    squares: list[Square | None] = []
    for told in ALL_TOLD:
        if told not in there:
            squares.append(None)
            continue
        one = found.get(told)
        agrees = None if one is None else one.flocks if told == ALL_TOLD[0] else one.agrees
        squares.append(Square(agrees, numbers(cells, law_of(rule), cell_of(rule, told))))
    return [*squares, Square(None, numbers(cells, law_of(rule), control_of(rule)))]


def numbers(cells: Cells, law: str, cell: Cell) -> str:
    """The means of what a law is judged by, in a few letters."""
    spacing, words = law_survey.herd_of(law).spacing_m, []
    for measure in law_survey.judged_by(law):
        value = mean_of(cells, measure, cell)
        words.append(f"{value / spacing:.2g}" if measure == law_survey.SPREAD else f"{value:.2f}")
    return " ".join(words)
