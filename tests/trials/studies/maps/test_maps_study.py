"""The maps of DSDR and SIRT have every group size; their claims are on the published one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.trials.made_up_run import MadeUpRun, finished
from tests.trials.studies.judged import judged
from trials import design, simulations
from trials.evidence.claims import published
from trials.studies.maps.design import COUNT

STUDY = "trials.studies.maps"
TINY = {"pairs": 1, "iterations": 3, "refinements": 0}
"""Of a map whose numbers mean nothing."""


@pytest.mark.parametrize(("name", "table"), [("dsdr-map", "dsdr_map"), ("sirt-map", "sirt_map")])
def test_the_published_group_size_comes_first_and_one_three_and_seven_are_there(name: str, table: str) -> None:
    trials = design.plan(name, repeats=1).trials
    counts = [trial.conditions[COUNT] for trial in trials]
    assert counts[0] == published(STUDY, "fine2015", table)["members"]
    assert set(counts) - {10} == {1, 3, 7}
    assert [trial.groups[0].count for trial in trials] == counts


def test_other_group_sizes_have_no_say_in_the_claims() -> None:
    def of_dsdr(conditions: Mapping[str, Any]) -> dict[str, float]:
        true = conditions[COUNT] == 10
        return {"x_deviation_within": 0.8 if true else 0.1, "x_deviation_below": 0.01 if true else 0.9}

    def of_sirt(conditions: Mapping[str, Any]) -> dict[str, float]:
        return {"trend_rest": 0.6 if conditions[COUNT] == 7 else -0.6}

    assert [entry.agrees for entry in judged("dsdr-map", of_dsdr)] == [True, True]
    assert [entry.agrees for entry in judged("sirt-map", of_sirt)] == [True]


def _run(name: str, folder: Path, **settings: Any) -> MadeUpRun:
    trials = design.plan(name, repeats=1, settings={**TINY, **settings}).trials
    run = finished(trials, lambda trial: {}, seed=1)
    run.folder, run.results = folder, {trial.index: simulations.run_trial(trial, reraise=True) for trial in trials}
    return run


def _drawn(monkeypatch: pytest.MonkeyPatch, name: str, run: MadeUpRun) -> dict[str, list[str]]:
    """The titles of the axes of each figure."""
    from trials.reports import figures

    found: dict[str, list[str]] = {}
    save = figures.save

    def kept(canvas: Any, place: Any, figure: str, *rest: Any, **more: Any) -> Any:
        found[figure] = [axis.get_title(loc="left") for axis in canvas.axes]
        return save(canvas, place, figure, *rest, **more)

    monkeypatch.setattr(figures, "save", kept)
    assert len(design.load(name).figures(run, run.folder)) == len(found)
    return found


def test_each_group_size_has_its_part_of_each_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = _drawn(monkeypatch, "sirt-map", _run("sirt-map", tmp_path, grid="2"))
    assert drawn["rules"] == [f"SIRT, anchor 4, {size}" for size in ("7 members", "1 member", "3 members")]
    assert sum("3 members: probability" in title for title in drawn["surfaces"]) == 1
    drawn = _drawn(monkeypatch, "dsdr-map", _run("dsdr-map", tmp_path, grid="1"))
    titles = [title for title in drawn["deviations"] if title]
    assert titles == ["10 members", "1 member", "3 members", "7 members"]
