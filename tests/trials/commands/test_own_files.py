"""Experiments, worlds and bodies of the user's own, found by their paths from outside of the project."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flocking.errors import InputError
from robots import body as bodies
from trials import design, experiments, simulations
from trials.batch.asked import Asked, planned
from trials.batch.running import users_bodies
from trials.commands import listing
from trials.reports import report
from trials.types import Trial

HOME = Path(design.__file__).parents[1]
EXPERIMENT = '''"""My own comparison."""

from helper import COUNT
from trials.simulations.kinematic.fields import group, trial

REPEATS = 2
CONDITIONS = {"herd.law": ("vicsek", "couzin")}


def base(repeat):
    return trial("mine", repeat, [group("vicsek", COUNT, law_parameters={"noise_rad": 0.3})], steps=20)
'''
WORLD = '''"""A yard."""

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import Polygon


class Parameters(NamedTuple):
    size_m: Annotated[float, Parameter("m", "a choice", low=2.0, high=100.0)] = 12.0


def environment(parameters):
    a = parameters.size_m / 2
    return Environment((Polygon(((-a, -a), (a, -a), (a, a), (-a, a)), "inside"),))
'''
BODY = '''"""A wider Create."""

from robots.create.driven import driven

from .model import DIMENSIONS

BODY = driven(DIMENSIONS, constants=(".model",))
'''
MODEL = '''"""Its numbers."""

from robots.create import bumpers, model

RADIUS = 0.2  # m; ?
RING = bumpers.ring(RADIUS, model.BUMPER_HEIGHT, model.BUMPER_OVERLAP)
PLACE = {"name": "wide", "radius": RADIUS, "ring": RING}
try:
    DIMENSIONS = model.DIMENSIONS._replace(**PLACE)
except AttributeError:
    import dataclasses

    DIMENSIONS = dataclasses.replace(model.DIMENSIONS, **PLACE)
'''


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of the user's own, which is the working folder, with one file of each kind."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(experiments, "_own", {})
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.delitem(sys.modules, "helper", raising=False)
    (tmp_path / "helper.py").write_text("COUNT = 7\n")
    (tmp_path / "my_test.py").write_text(EXPERIMENT)
    (tmp_path / "yard.py").write_text(WORLD)
    (tmp_path / "wide").mkdir()
    (tmp_path / "wide" / "__init__.py").write_text(BODY)
    (tmp_path / "wide" / "model.py").write_text(MODEL)
    return tmp_path


def test_an_experiment_is_its_file(own: Path) -> None:
    made = design.plan(str(own / "my_test.py"))
    assert (made.experiment, made.title, len(made.trials)) == ("my-test", "My own comparison.", 4)
    assert {trial.groups[0].count for trial in made.trials} == {7}
    assert {trial.experiment for trial in made.trials} == {"my-test"}
    assert design.load("my-test") is design.load("my_test.py")


def test_a_report_has_the_claims_of_the_file_that_is_named(own: Path) -> None:
    """What a run's folder says of its experiment's file is not enough to run it."""
    assert report._experiment("my-test", None) is None
    assert report._experiment("my-test", "my_test.py").REPEATS == 2
    with pytest.raises(InputError, match="the run is of 'another'; expected the file of that experiment"):
        report._experiment("another", "my_test.py")


def test_what_an_experiment_sets_is_not_called_published(own: Path) -> None:
    text = EXPERIMENT.replace('"herd.law": ("vicsek", "couzin")', '"herd.radius_m": (0.0,)')
    (own / "alone.py").write_text(text)
    rows = {row.key: row for row in design.plan("alone.py").parameters}
    assert not rows["herd.law.noise_rad"].published  # 0.1 is; the file sets 0.3
    assert "set by the experiment in place of 0.1" in rows["herd.law.noise_rad"].source
    assert rows["herd.law.speed_m_s"].published  # left as its law has it
    case_study = {row.key: row for row in design.plan("detection-case-study").parameters}
    assert case_study["herd.count"].published


def test_laws_that_bring_their_herds_are_told_to_do_so(own: Path) -> None:
    """Vicsek's herd has a spacing of 0.5 m and steps of 1 s, Couzin's 1.5 m and 0.2 s."""
    (note,) = design.plan("my_test.py").notes
    for told in ("herd.law", "timestep_s (0.2 to 1)", "formation.spacing_m (0.5 to 1.5)", "herd.speed_m_s"):
        assert told in note
    shared = {"timestep_s": 1.0, "formation.spacing_m": 1.0, "herd.speed_m_s": 0.1, "herd.cruise_m_s": 0.1, "cut_m": 1}
    shared["updating"] = "forward"
    assert design.plan("my_test.py", settings={**shared, "world": "unbounded"}).notes == []
    assert design.plan("detection-case-study", sweep={"herd.law": ["snn", "vicsek"]}).notes == [
        "herd.law.exclusion_m is left out: the law has no parameter exclusion_m"
    ]


def test_a_law_without_a_herd_is_not_said_to_have_one(own: Path) -> None:
    (own / "law.py").write_text(
        "from typing import NamedTuple\n\n\nclass Parameters(NamedTuple):\n    pass\n\n\ndef law(*_):\n    pass\n"
    )
    rows = {row.key: row.source for row in design.plan("my_test.py", settings={"herd.law": "law.py"}).parameters}
    assert "no HERD" in rows["timestep_s"]
    assert not any("own herd" in source for source in rows.values())
    rows = {row.key: row.source for row in design.plan("my_test.py", settings={"herd.law": "couzin"}).parameters}
    assert "own herd" in rows["timestep_s"]


def test_a_world_is_a_file_whose_text_travels_with_the_trial(own: Path) -> None:
    settings = {"world": "yard.py", "world.size_m": 14}
    trial = design.plan("detection-case-study", repeats=1, settings=settings).trials[0]
    trial = Trial.from_dict(json.loads(json.dumps(trial.as_dict())))
    (own / "yard.py").unlink()
    simulations.check(trial)
    shortened = simulations.of(trial).moment(trial)
    result = simulations.run_trial(shortened, reraise=True)
    assert abs(result.walls_w).max() == 7.0


def test_a_body_is_a_folder_that_stays_as_it_was(own: Path) -> None:
    made, _ = planned(Asked("detection-case-study", repeats=1, body="./wide"))
    trial = made.trials[0]
    assert bodies.load("./wide").radius == 0.2
    result = simulations.run_trial(simulations.of(trial).moment(trial), reraise=True)
    assert result.radii.tolist() == [0.2] * 6
    told = listing.planned(made, made.trials)
    assert ".model.RADIUS" in told
    assert users_bodies(made.trials) == [trial.groups[0].setup["body"]] != []  # resume says that it runs it
    (own / "wide" / "model.py").write_text(MODEL.replace("0.2 ", "0.21 "))
    simulations._check_kind.cache_clear()  # another process, as `herd resume` is
    with pytest.raises(InputError, match="have changed since the run began"):
        simulations.check(trial)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["no_such.py"], "'no_such.py' does not exist"),
        (["detection_case_study.py"], "is that of another experiment"),
        (["my test.py"], "is no name"),
        (["detection-case-study", "--set", "world=gone.py"], "'gone.py' does not exist"),
        (["detection-case-study", "--set", "world=helper.py"], "lacks Parameters"),
        (["detection-case-study", "--body", "./nothing"], "has no __init__.py"),
        (["detection-case-study", "--body", "./bare"], "has no BODY"),
    ],
)
def test_what_is_no_such_file_is_refused(own: Path, words: list[str], expected: str) -> None:
    for name in ("detection_case_study.py", "my test.py"):
        (own / name).write_text(EXPERIMENT)
    (own / "bare").mkdir()
    (own / "bare" / "__init__.py").touch()
    options = dict(zip(words[1::2], words[2::2], strict=True))
    key, _, value = options.get("--set", "=").partition("=")
    with pytest.raises(InputError, match=expected) as told:
        planned(Asked(words[0], settings={key: value} if key else {}, body=options.get("--body")))
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"""My own comparison."""', "", "no docstring"),
        ("REPEATS = 2", "REPEATS = 0", "REPEATS = 0; expected a whole number"),
        ("REPEATS = 2", "", "it has no REPEATS"),
        (
            'CONDITIONS = {"herd.law": ("vicsek", "couzin")}',
            "CONDITIONS = [1]",
            r"CONDITIONS = \[1\]; expected a mapping",
        ),
        ('("vicsek", "couzin")', '"vicsek"', "CONDITIONS = .*lists of values"),
        ('("vicsek", "couzin")', "()", "CONDITIONS = .*lists of values"),
        ("    return trial", "    trial", r"base\(1\) returned None; expected a Trial"),
        ("    return trial", "    return 1 / 0\n    return trial", r"line 11: ZeroDivisionError: division by zero"),
        (
            "from helper import COUNT",
            "from nowhere import COUNT",
            "line 3: ModuleNotFoundError: No module named 'nowhere'",
        ),
        ("REPEATS = 2", "import sys; sys.exit(3)", "line 6: SystemExit: 3"),
        ("REPEATS = 2", "REPEATS = = 2", "line 6: invalid syntax"),
        ("REPEATS = 2", "REPEATS = 2\ncells = 3", "cells = 3; expected a function"),
        ("REPEATS = 2", "REPEATS = 2\ndef cells(conditions):\n    return None", r"cells\(\) returned None"),
        (
            "REPEATS = 2",
            "REPEATS = 2\ndef finish(trial):\n    return None",
            r"finish\(\) returned None; expected a Trial",
        ),
        ("REPEATS = 2", "REPEATS = 2\nSOURCES = {'steps': 'mine'}", "SOURCES = .*Parameter"),
        ("REPEATS = 2", "REPEATS = 2\nRECORD = 'some'", "RECORD = 'some'; expected all or first or none"),
    ],
)
def test_a_fault_in_an_experiments_file_is_told_in_one_line(own: Path, old: str, new: str, expected: str) -> None:
    assert old in EXPERIMENT
    (own / "faulty.py").write_text(EXPERIMENT.replace(old, new))
    with pytest.raises(InputError, match=expected) as told:
        design.plan("faulty.py")
    assert "faulty.py" in str(told.value)
    assert "\n" not in str(told.value)


def test_packages_of_the_working_folder_do_not_stand_in_for_ours(own: Path) -> None:
    """As the command is installed: Python does not look in the working folder, but would for what it starts in turn."""
    for name in ("robots", "trials", "flocking", "worlds", "sensing"):
        (own / name).mkdir()
        (own / name / "__init__.py").write_text("raise RuntimeError('not ours')\n")
    start = "import sys; sys.path[0] = {home!r}; sys.argv = ['herd', *{words!r}]\n"
    start += "from trials.commands.cli import main; sys.exit(main())"
    words = ["show", "detection-case-study", "--law", str(HOME / "flocking" / "laws" / "snn.py")]
    done = subprocess.run(
        [sys.executable, "-c", start.format(home=str(HOME), words=words)],
        cwd=own,
        env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "snn.py" in done.stdout
