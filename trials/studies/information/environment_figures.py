"""The heat maps of `environment-and-synchrony`: what each law loses, and what feeling one's way comes to."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.summary import shown_value
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.information import law_survey
from trials.studies.information.environment_claims import MEASURES, cell_of, control_of, laws_of, losses, settings_of
from trials.studies.information.environment_design import BUMPER, KEYS, SETTINGS, Setting
from trials.studies.information.law_judges import Cell, mean_of, verdict
from trials.studies.information.law_survey import CONTROL, LAW, SPREAD
from trials.studies.information.verdict_maps import Square, verdict_map

LETTERS = dict(zip(MEASURES, "SPM", strict=True))
"""Of what is lost."""


def figures(run: Run, folder: Path) -> list[Figure]:
    """The map of each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), KEYS)
    rows = {shown_value(law): [_square(cells, law, setting) for setting in SETTINGS] for law in laws_of(cells)}
    if BUMPER in cells.levels(LAW):
        felt = settings_of(cells, BUMPER)
        for name, cell in ((BUMPER, lambda setting: cell_of(BUMPER, setting)), (CONTROL, control_of)):
            rows[f"{name}, solid"] = [
                Square(None, _numbers(cells, BUMPER, cell(setting))) if setting in felt else None
                for setting in SETTINGS
            ]
    key = "largest group's share, polarization, MMD in spacings of the herd; letters: which of them (S, P, M) are lost"
    reasons = "; ".join(f"{law} ({why})" for law, why in law_survey.left_out().items() if law != BUMPER)
    caption = (
        "Green: shown to lose nothing against the same herd in free space and in step, the first column; red: shown to "
        "lose something; grey: neither. +: the shared avoidance is added. Last two rows: a law that knows nothing but "
        f"its bumper, and random motion of the same body. Left out: {reasons}. {law_survey.without_goals(run.trials)}"
    )
    title = "What laws lose within walls, among obstacles and out of step"
    columns = [setting.words() for setting in SETTINGS]
    return [draw.save(verdict_map(rows, columns, key), place, "environment", title, caption.rstrip())]


def _square(cells: Cells, law: str, setting: Setting) -> Square | None:
    if setting not in settings_of(cells, law):
        return None
    text = _numbers(cells, law, cell_of(law, setting))
    if setting == SETTINGS[0]:
        return Square(None, text)
    try:
        outcomes = losses(cells, law, setting)
    except UndecidedError:
        return Square(None, text)
    lost = [LETTERS[name] for name, outcome in zip(MEASURES, outcomes, strict=True) if outcome.decision.agrees is False]
    return Square(verdict(outcomes), " ".join([text, "".join(lost)]).strip())


def _numbers(cells: Cells, law: str, cell: Cell) -> str:
    spacing = law_survey.herd_of(law).spacing_m
    values = {name: mean_of(cells, name, cell) / (spacing if name == SPREAD else 1.0) for name in MEASURES}
    return " ".join(f"{value:.2g}" for value in values.values())
