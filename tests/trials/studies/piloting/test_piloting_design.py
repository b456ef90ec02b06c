"""The trials of piloting: tasks of the user's own, whose texts travel, and numbers of pilots that were asked for."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path

import pytest
from numpy.testing import assert_array_equal

from flocking.errors import InputError
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from trials import simulations
from trials.batch import runfile
from trials.commands import cli
from trials.design import plan
from trials.simulations.robots import guided
from trials.types import Trial, Value

SHORT = {"duration_s": 1.5}


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """The first task as a file of the user's own, with its plan beside it."""
    path = tmp_path / "mine.json"
    path.write_text((tasks.FOLDER / "task-1.json").read_text())
    kept = dataclasses.replace(plans.shipped("task-1"), task="mine")
    path.with_suffix(".plan.json").write_text(plans.to_json(kept))
    return path


def planned(task: str, guides: str = "pilots", **setup: Value) -> Trial:
    return plan("piloting", repeats=1, settings={"task": task, "piloting.guides": guides, **setup}).trials[0]


@pytest.mark.parametrize("guides", ["walls", "pilots"])
def test_a_task_of_the_users_own_is_run_as_one_of_the_project_when_its_file_is_gone(mine: Path, guides: str) -> None:
    made = planned(str(mine), guides, **SHORT)
    usual = planned("task-1", guides, **SHORT)
    text = json.loads(runfile.text_of({"experiment": "piloting", "trials": [made.as_dict()]}))
    assert len(text["texts"]) == 2  # of the task, and of its workspace
    for path in mine.parent.iterdir():
        path.unlink()
    (kept,) = runfile._with_texts(text)["trials"]
    found = simulations.run_trial(Trial.from_dict(kept), reraise=True)
    assert_array_equal(found.poses_w, simulations.run_trial(usual, reraise=True).poses_w)
    assert "task_source" not in usual.as_dict()


def test_a_run_with_a_task_of_the_users_own_is_reported_and_recorded_when_its_file_is_gone(
    mine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    words = ["run", "piloting", "--sweep", f"task={mine}", "--repeats", "1", "--set", "duration_s=1.5", "--jobs", "1"]
    monkeypatch.setattr(sys, "argv", ["herd", *words, "--record", "none", "--out", str(out)])
    assert cli.main() == 0, capsys.readouterr().err
    assert (out / "code" / "mine.json").read_text() == mine.read_text()
    mine.unlink()
    monkeypatch.setattr(sys, "argv", ["herd", "report", str(out)])
    assert cli.main() == 0, capsys.readouterr().err
    assert any(path.name.startswith("series-mine") for path in (out / "figures").iterdir())
    trial = Trial.from_dict(runfile.read(out)["trials"][1])
    recorded = simulations.run_trial(trial, scans="some")
    simulations.of(trial).record(recorded, tmp_path / "played.rrd")
    assert (tmp_path / "played.rrd").stat().st_size > 1000


def test_a_task_without_a_plan_takes_walls_that_are_given_and_is_else_refused(mine: Path) -> None:
    mine.with_suffix(".plan.json").unlink()
    with pytest.raises(InputError, match=r"mine\.plan\.json; expected one, as herd plan .*mine\.json --out"):
        planned(str(mine))
    words = plans.words(plans.shipped("task-1").walls)
    simulations.check(planned(str(mine), **{"piloting.walls": words}))
    simulations.check(planned(str(mine), "nothing"))


def test_a_plan_of_another_task_and_a_damaged_task_are_refused(mine: Path) -> None:
    mine.with_suffix(".plan.json").write_text(plans.to_json(plans.shipped("task-1")))
    with pytest.raises(InputError, match="a plan of task-1 with 3 walls; expected one of mine with 3"):
        planned(str(mine))
    mine.write_text("{")
    with pytest.raises(InputError, match="task mine is no JSON"):
        planned(str(mine))
    with pytest.raises(InputError, match=r"task file .*none\.json' does not exist; expected a JSON file"):
        planned(str(mine.with_name("none.json")))


def test_six_pilots_that_were_asked_for_are_refused_where_walls_take_eight() -> None:
    usual = planned("task-1", **{"piloting.robots_a_wall": 2})
    assert [group.count for group in usual.groups] == [4, 4]  # as many as two walls take
    assert type(usual.groups[1].count) is int
    asked = planned("task-1", **{"piloting.robots_a_wall": 4, "pilots.count": 6})
    assert len(guided.members(asked, pilots=True)) == 6
    with pytest.raises(InputError, match="6 pilots for walls of 4 robots; expected a multiple, as 8"):
        simulations.check(asked)
    assert type(planned("task-1", "sheepdogs").groups[1].count) is int
