"""What each law loses in a run of `environment-and-synchrony`, and whether contact alone makes a flock.

A law loses in a measure where its herd does less well than itself in free space and in step, by more than a margin
(the 95 % interval of the paired differences lies below it); it keeps what it is shown not to lose. The published words
say that nobody has looked (section 3.5.2), that asynchronism can do harm (there, after Samiloglu et al. 2006), and ask
whether contact alone can make a flock (section 3.6.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from trials.evidence import statistics
from trials.evidence.claims import Entry, Judged, Question, answers, published
from trials.evidence.outcomes import Outcome, above
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.summary import shown_value
from trials.studies.information import law_survey
from trials.studies.information.environment_design import (
    BUMPER,
    KEYS,
    SETTINGS,
    Setting,
    bumper_cell,
    bumper_control,
    cell,
)
from trials.studies.information.law_judges import (
    IN_WORDS,
    MARGINS,
    WORDS,
    Cell,
    gain,
    held_in_all,
    no_worse,
    tested_exactly,
    verdict,
)
from trials.studies.information.law_survey import CONTROL, LAW, ORDER, SHARE, SPREAD

MEASURES = (SHARE, ORDER, SPREAD)
FLOCKING = (SHARE, ORDER)
"""Of these either would do for contact to have made a flock."""
TEST = (
    "in each setting no measure worse by its margin than in free space and in step (t tests, paired); the number is "
    f"the share of settings for which that is shown; {IN_WORDS}"
)


def claims(run: Run) -> list[Entry]:
    """An entry for each law, and one for the law that feels its way, for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    told = published(__package__, "fine2015", "environment")
    (losing, touching), (sections, section) = told["claims"], told["sections"]
    found = [
        Question(f"fine2015, sections {sections}", shown_value(law), losing, judge=partial(_kept, cells, law))
        for law in laws_of(cells)
    ]
    if BUMPER in cells.levels(LAW):
        quantity = f"{BUMPER} less random motion"
        found.append(Question(f"fine2015, section {section}", quantity, touching, partial(_contact, cells)))
    return found


def laws_of(cells: Cells) -> list[str]:
    """The laws of a run that see one another."""
    return [law for law in cells.levels(LAW) if law not in (CONTROL, BUMPER)]


def settings_of(cells: Cells, law: str) -> list[Setting]:
    """The settings of a law that the run has."""
    return [setting for setting in SETTINGS if cell_of(law, setting) in cells.planned()]


def cell_of(law: str, setting: Setting) -> Cell:
    """The values of `KEYS` of a law's cell."""
    values = bumper_cell(setting) if law == BUMPER else cell(law, setting)
    return tuple(values.get(key) for key in KEYS)


def control_of(setting: Setting) -> Cell:
    """Likewise of the bumper's control."""
    values = bumper_control(setting)
    return tuple(values.get(key) for key in KEYS)


def losses(cells: Cells, law: str, setting: Setting) -> list[Outcome]:
    """That nothing is lost, measure by measure. Raises `UndecidedError`."""
    spacing_m = law_survey.herd_of(law).spacing_m
    return no_worse(cells, MEASURES, cell_of(law, setting), cell_of(law, SETTINGS[0]), spacing_m)


def _kept(cells: Cells, law: str) -> Judged:
    outcomes = [losses(cells, law, setting) for setting in settings_of(cells, law)[1:]]
    found = [verdict(each) for each in outcomes]
    n = len(cells.values(ORDER, *cell_of(law, SETTINGS[0])))
    if not found:
        raise UndecidedError("the run has no other setting")
    label = (
        f"shown to lose nothing in {found.count(True)} of {len(found)} settings, to lose something in "
        f"{found.count(False)}"
    )
    return held_in_all(outcomes, label, n, TEST)


def contact(cells: Cells, settings: Sequence[Setting]) -> list[Outcome]:
    """That the bumper's law flocks more than its control by a margin, setting by setting. Raises `UndecidedError`."""
    spacing_m, found = law_survey.herd_of(BUMPER).spacing_m, []
    for setting in settings:
        for name in MEASURES:
            compared = cell_of(BUMPER, setting), control_of(setting)
            values, exact = gain(cells, name, *compared, spacing_m), tested_exactly(cells, name, *compared)
            label = f"{setting.words()}: {WORDS[name]}, less random motion"
            margin, decides = MARGINS[name], name in FLOCKING
            found.append(above(label, values, margin, margin, decides=decides, exact=exact))
    return found


def _contact(cells: Cells) -> Judged:
    outcomes = contact(cells, settings_of(cells, BUMPER))
    deciding = [outcome for outcome in outcomes if outcome.decides]
    return Judged(
        agrees=statistics.some_hold([[outcome.decision] for outcome in deciding]),
        shown=min(deciding, key=lambda outcome: outcome.decision.p_holds),
        outcomes=outcomes,
        test="in some setting the largest group's share or the polarization is above that of random motion of the same "
        "body by a margin (t tests, paired; Holm)",
    )
