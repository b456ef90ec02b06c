"""`herd run ANY-EXPERIMENT --world FILE`, on robots and on the kinematic herd, with starting poses of one's own."""

from __future__ import annotations

import json
import os
import sqlite3
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from generation.environment import Environment
from generation.files import to_json
from generation.primitives import Circle, Point, Polygon, Segment
from trials import design, simulations
from trials.batch import runfile, store
from trials.batch.asked import Asked, planned
from trials.batch.cluster import check_travels
from trials.batch.running import code_of
from trials.commands import cli

ROBOTS, KINEMATIC = "detection-case-study", "lch-table-4-1"
ROOM = Environment(
    (Polygon(((0, 0), (12, 0), (12, 8), (0, 8)), "inside"), Circle(9, 4, 0.5)),
    (Segment(6, 0, 6, 2),),
    {"start": Point(3, 4, 0.2)},
)


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with an environment, one that is to be mended, and poses."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.json").write_text(to_json(ROOM))
    twice = json.loads(to_json(ROOM))
    twice["construct"] *= 2
    (tmp_path / "twice.json").write_text(json.dumps(twice))
    (tmp_path / "poses.csv").write_text("x_m,y_m,heading_deg\n" + "".join(f"{k},1,0\n" for k in range(1, 7)))
    return tmp_path


@pytest.fixture
def herd(own: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs the command; gives what it printed."""

    def command(*words: str, code: int = 0) -> str:
        monkeypatch.setattr(sys, "argv", ["herd", *words])
        assert cli.main() == code
        said = capsys.readouterr()
        return said.out + said.err

    return command


@pytest.mark.parametrize("experiment", [ROBOTS, KINEMATIC])
def test_a_trial_holds_its_world_and_needs_no_file(own: Path, experiment: str) -> None:
    asked = Asked(experiment, repeats=1, world="room.json", settings={"world.scale": 4})
    trials = planned(asked)[0].trials
    (own / "room.json").unlink()
    assert asked.command() == f"herd run {experiment} --repeats 1 --world room.json --set world.scale=4"
    check_travels(trials)  # a cluster takes it
    assert code_of(trials) == {"room.json": to_json(ROOM)}
    short = simulations.of(trials[0]).moment(trials[0])
    result = simulations.run_trial(short, reraise=True)
    assert np.max(result.walls_w) == 48.0
    start = result.poses_w[0, :, :2].mean(axis=0)
    # the mean of six or more starts within a few metres of the marker
    np.testing.assert_allclose(start, [12.0, 16.0], atol=1.0)


@pytest.mark.parametrize("experiment", [ROBOTS, KINEMATIC])
def test_show_tells_the_world_and_what_was_mended(herd: Callable[..., str], experiment: str) -> None:
    told = herd("show", experiment, "--world", "twice.json", "--set", "world.scale=4", "--repeats", "1")
    assert "note: twice.json: construct 2 (segment) is the same wall as construct 1, and was left out" in told
    (scale,) = [line for line in told.splitlines() if line.startswith("world.scale")]
    assert scale.split()[1] == "4"
    assert "set here in place of 1.0" in scale
    (shine,) = [line for line in told.splitlines() if line.startswith("world.reflectance")]
    assert shine.split()[1] == "0.8"


def test_a_run_keeps_its_world_and_is_resumed_without_the_file(herd: Callable[..., str], own: Path) -> None:
    words = [KINEMATIC, "--world", "room.json", "--set", "formation=poses.csv", "--set", "herd.count=6"]
    herd("run", *words, "--set", "steps=4", "--repeats", "1", "--only", "1-2", "--jobs", "1", "--out", "run")
    assert {path.name for path in (own / "run" / "code").iterdir()} == {"room.json", "poses.csv"}
    before = store.opened(own / "run")
    rows = repr(before.rows())
    before.close()
    with sqlite3.connect(own / "run" / "results.sqlite") as tables:
        tables.execute("DELETE FROM trials WHERE idx = 2")
    tables.close()
    for name in ("room.json", "poses.csv", "twice.json"):
        (own / name).unlink()
    told = herd("resume", "run", "--jobs", "1")
    assert "runs the user's" not in told  # an environment is no code
    again = store.opened(own / "run")
    assert repr(again.rows()) == rows
    assert again.trials[0].formation_source.startswith("x_m")
    assert runfile.read(own / "run")["world"] == "room.json"
    again.close()
    (own / "run" / "code" / "room.json").write_text("{}")
    assert "room.json is not the file" in herd("resume", "run", code=2)


def test_the_world_of_robots_is_written_with_it(herd: Callable[..., str], own: Path) -> None:
    herd("world", ROBOTS, "--world", "room.json", "--out", "world.xml")
    model = mujoco.MjModel.from_xml_path(str(own / "world.xml"))
    names = [model.geom(k).name for k in range(model.ngeom)]
    assert sum(name.startswith("fence-") for name in names) == 1
    assert sum(name.startswith("wall-") for name in names) > 4


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["run", ROBOTS, "--world", "gone.json"], "environment file 'gone.json' does not exist"),
        (["run", ROBOTS, "--world", "plan.doc"], "unknown world 'plan.doc'"),
        (["run", ROBOTS, "--world", "./plan.doc"], "expected a name that ends in"),
        (["run", ROBOTS, "--world", "coridor"], "unknown world 'coridor'; did you mean corridor"),
        (["run", KINEMATIC, "--world", "unbound"], "did you mean unbounded"),
        (["run", ROBOTS, "--world", "room.json", "--set", "world=corridor"], "expected one of the two"),
        (["run", ROBOTS, "--world", "room.json", "--sweep", "world=corridor,open-floor"], "expected one of the two"),
        (["run", ROBOTS, "--world", "room.json", "--set", "world.width_m=3"], "unknown parameter 'world.width_m'"),
        (
            ["run", ROBOTS, "--world", "room.json", "--set", "world.scale=0.1"],
            "m, .* expected a start within the world",
        ),
        (["run", KINEMATIC, "--world", "room.json"], "behind a wall; expected a start within the world"),
        (["run", ROBOTS, "--world", "poses.csv"], "expected a name that ends in"),
        (["run", ROBOTS, "--set", "formation=gone.csv"], "formation file 'gone.csv' does not exist"),
        (["run", ROBOTS, "--set", "formation=poses.csv", "--set", "herd.count=5"], "has 6 poses for 5 members"),
        (["run", ROBOTS, "--set", "formation=poses.csv"], "herd-1 starts at .* reaches"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(herd: Callable[..., str], words: list[str], expected: str) -> None:
    told = herd(*words, code=2)
    assert told.count("\n") == 1
    assert told.startswith("herd: ")
    with pytest.raises(InputError, match=expected):
        raise InputError(told.strip())


def test_an_experiment_that_varies_the_corridors_width_leaves_it_out_of_another_world(own: Path) -> None:
    (own / "widths.py").write_text(
        '"""Widths."""\nfrom trials.simulations.robots.fields import group, trial\nREPEATS = 1\n'
        'CONDITIONS = {"world.width_m": (2.0, 3.0)}\n'
        'def base(repeat):\n    return trial("w", repeat, [group(count=2)], world_parameters={"length_m": 90.0})\n'
    )
    assert len(design.plan("widths.py").trials) == 2
    made = design.plan("widths.py", world="room.json")
    assert [trial.world_parameters for trial in made.trials] == [{}]
    assert made.notes == ["world.width_m is left out: the world has no parameter width_m"]


def test_listed_worlds_tell_of_files(herd: Callable[..., str]) -> None:
    told = herd("list", "worlds")
    assert "FILE" in told
    assert "corridor" in told
    assert "FILE" in herd("list", "formations")


def test_nothing_of_a_users_environment_is_executed(own: Path) -> None:
    """A report reads it as data, where a world in Python is refused."""
    from flocking import users_files

    trial = planned(Asked(ROBOTS, repeats=1, world="room.json"))[0].trials[0]
    with users_files.executed(False, others=False):
        assert simulations.of(trial).keys_of(trial)
    assert os.listdir(own)
