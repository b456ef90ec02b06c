"""The figure of `tightness`: each schema's share of constructs that elicit its behaviour, beside the empty world."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.environments.tightness_claims import KEYS, counted

SERIES = (("tightness", "tightness: of all that were generated", "#1a1a1a"),
          ("valid", "of those that passed", "#0072b2"),
          ("control", "the same in the empty world", "#999999"))  # fmt: skip


def figures(run: Run, folder: Path) -> list[Figure]:
    """One figure for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    schemas = list(dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials))
    canvas, (axis,) = draw.grid(1, 1, width=6.4, height=0.4 * len(schemas) + 1.2)
    done = [row for row in run.rows() if row.status == "done"]
    named = set[str]()
    for k, schema in enumerate(schemas):
        counts = counted([row for row in done if row.conditions[KEYS[0]] == schema])
        if counts.passed == 0:
            continue
        for shift, (name, label, colour) in zip((-0.2, 0.0, 0.2), SERIES, strict=True):
            found = getattr(counts, name)()
            reach = [[found.rate - found.low], [found.high - found.rate]]
            shown = label if name not in named else None
            axis.errorbar([found.rate], [k + shift], xerr=reach, fmt="o", color=colour, ms=3.5, label=shown)
            named.add(name)
    axis.set_yticks(range(len(schemas)), schemas)
    axis.invert_yaxis()
    axis.set_xlim(-0.02, 1.02)
    axis.set_xlabel("share of the environments")
    canvas.legend(loc="outside upper center", ncols=1, frameon=False)
    caption = "Share of each schema's environments that elicit its behaviour, with Wilson's 95 % intervals."
    return [draw.save(canvas, place, "tightness", "Tightness of the schemas", caption)]
