"""Bad input: one line on stderr that says what was given and what was expected, exit code 2, nothing changed."""

from __future__ import annotations

import json
import sqlite3
import sys
from pathlib import Path
from typing import Any

import pytest

from flocking.errors import InputError
from trials.batch import folders, runfile, store
from trials.batch.running import ranges
from trials.commands import cli, options

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials

RUN = ["run", "detection-case-study"]
LAW_HEAD = """
import math
from typing import NamedTuple
from flocking.types import Kind, Motion
NEEDS = frozenset({"positions"})
RULES = ("law",)
class Parameters(NamedTuple):
    pass
def law(own, members, sets, obstacles, parameters, memory, u):
"""


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Runs the command in an empty folder and returns the one line that it prints."""
    monkeypatch.chdir(tmp_path)

    def command(*words: str) -> str:
        before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
        monkeypatch.setattr(sys, "argv", ["herd", *words])
        assert cli.main() == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.startswith("herd: ")
        assert said.err.count("\n") == 1
        assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before
        return said.err

    return command


def make_run(folder: Path) -> None:
    trials = [fake_trials.trial(k) for k in (1, 2)]
    run = {
        "format": runfile.FORMAT,
        "experiment": "detection-case-study",
        "record": "none",
        "scans": "some",
        "trials": [trial.as_dict() for trial in trials],
    }
    kept = store.create(folder, run, {})
    kept.add(store.Row(1, "done", "", 1, 1, {}, {}), {})
    kept.close()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["rnu"], ["rnu", "'run'"]),
        ([*RUN, "--set", f"herd.count={'[' * 3000}"], ["[[[", "…", "is not a TOML value"]),
        ([*RUN, "--set", f"herd.count={'9' * 5000}"], ["999", "…", "is not a TOML value"]),
        ([*RUN, "--only", "9" * 5000], ["--only", "expected numbers and ranges of trials"]),
        ([*RUN, "--law", "/dev/zero"], ["/dev/zero", "is no file"]),
        ([*RUN, "--out", "new\udcff"], ["new\\udcff", "expected a name in UTF-8"]),
        (["report", "new\udcff"], ["new\\udcff", "expected a name in UTF-8"]),
        (["fly"], ["fly", "list, laws, show, run"]),
        (["run"], ["experiment"]),
        (["run", "vicsek-transition", "--scans", "all"], ["--scans", "no lasers"]),
        (["run", "vicsek-transition", "--body", "create"], ["--body create", "no bodies"]),
        (["run", "vicsek-transition", "--set", "world.size_m=1e300"], ["world.size_m", "1e+09"]),
        (
            [*RUN, "--law", "snn+", "--set", "herd.obstacles=as-law"],
            ["snn+", "herd.obstacles=as-law", "one of the two"],
        ),
        ([*RUN, "--law", "snn", "--sweep", "herd.law=couzin,vicsek"], ["--law snn", "--sweep herd.law"]),
        ([*RUN, "--set", "herd.selection=all &"], ["'all &'", '"nearest & all"']),
        ([*RUN, "--sweep", "herd.count="], ["KEY=A,B,C", "herd.count=10,20"]),
        (["run", "vicsek-transition", "--set", "every=9999"], ["steps = 2000", "at least every = 9999"]),
        (
            ["run", "link-tension", "--set", "steps=20"],
            ["steps = 20: expected at least every = 25", "--set every=20"],
        ),
        (["run", "vicsek-transition", "--set", "herd.obstacle_selection=nearst"], ["nearst", "did you mean nearest"]),
        (["run", "vicsek-transition", "--set", "herd.spread.rnge_m=0.1"], ["rnge_m", "herd.spread.range_m"]),
        (
            ["run", "vicsek-transition", "--law", "gregoire-1", "--set", "herd.selection=field-of-view(240)"],
            ["gregoire-1", "voronoi must come first"],
        ),
        (
            [
                "run",
                "lch-field-of-view",
                "--law",
                "gregoire-1",
                "--sweep",
                "herd.selection=all",
                "--set",
                "herd.count=5001",
            ],
            ["5001 members", "Voronoi cells and graphs", "at most 5000"],
        ),
        (
            ["run", "vicsek-transition", "--law", "tanner-fixed", "--set", "herd.count=5001"],
            ["5001 members", "Voronoi cells and graphs", "at most 5000"],
        ),
        (
            ["run", "vicsek-transition", "--law", "conradt", "--set", "herd.law.alpha_m=9"],
            ["herd.law.alpha_m = 9", "alpha_m at most beta_m"],
        ),
        (["run", "vicsek-transition", "--set", "herd.radius_m=2e9"], ["herd.radius_m", "2000000000", "to 1e+09"]),
        (["run", "vicsek-transition", "--set", "herd.leaders=41"], ["herd.leaders = 41", "at most", "40 members"]),
        (["run", "detection-case-studdy"], ["detection-case-studdy", "did you mean detection-case-study"]),
        (["show", "xyzzy"], ["xyzzy", "detection-case-study"]),
        (["list", "lows"], ["'lows'", "'laws'"]),
        (["laws", "viscek"], ["'viscek'", "did you mean vicsek"]),
        (["laws", "nowhere/mine.py"], ["nowhere/mine.py", "does not exist"]),
        ([*RUN, "--repeatz", "3"], ["--repeatz", "--repeats"]),
        ([*RUN, "--repeats"], ["--repeats", "argument"]),
        ([*RUN, "--repeats", "0"], ["--repeats", "'0'", "at least 1"]),
        ([*RUN, "--repeats", "-3"], ["--repeats", "'-3'", "at least 1"]),
        ([*RUN, "--repeats", "2.5"], ["--repeats", "'2.5'", "whole number"]),
        ([*RUN, "--repeats", "1000000"], ["trials", "at most", "--repeats 1"]),
        ([*RUN, "--until-decided", "--budget", "1000000"], ["trials", "at most", "--budget 1"]),
        ([*RUN, "--jobs", "0"], ["--jobs", "'0'", "at least 1"]),
        ([*RUN, "--seed", "abc"], ["--seed", "'abc'", "whole number"]),
        ([*RUN, "--seed", "-1"], ["--seed", "'-1'", "at least 0"]),
        ([*RUN, "--seed", "99999999999999999999"], ["--seed", "at most"]),
        ([*RUN, "--only", "64"], ["--only", "'64'", "1 to 63"]),
        ([*RUN, "--only", "0"], ["--only", "1 to 63"]),
        ([*RUN, "--only", "4-1"], ["--only", "4-1"]),
        ([*RUN, "--only", "one"], ["--only", "'one'", "1-4,9"]),
        ([*RUN, "--only", ""], ["--only", "1-4,9"]),
        ([*RUN, "--record", "some"], ["--record", "'some'", "'first'"]),
        ([*RUN, "--scans", "none"], ["--scans", "'none'", "'all'"]),
        ([*RUN, "--debug"], ["--debug", "--only"]),
        ([*RUN, "--only", "1-2", "--debug"], ["--debug", "--only"]),
        ([*RUN, "--law", "extended-hamiltn"], ["extended-hamiltn", "did you mean extended-hamilton"]),
        ([*RUN, "--law", "nowhere/mine.py"], ["nowhere/mine.py", "does not exist"]),
        ([*RUN, "--law", "nowhere/mine.py+"], ["nowhere/mine.py", "does not exist"]),
        ([*RUN, "--law", "snnn+"], ["'snnn'", "did you mean snn"]),
        ([*RUN, "--law", "kelly-keating"], ["kelly-keating", "needs ids,", "member-based", "pipeline perfect"]),
        (
            [*RUN, "--law", "vicsek", "--set", "herd.association=none"],
            ["vicsek", "needs headings", "herd.association=two-scans", "pipeline perfect"],
        ),
        (
            [*RUN, "--law", "turgut", "--pipeline", "perfect-members"],
            ["turgut", "needs obstacles", "perfect-members", "pipeline member-based"],
        ),
        (
            [*RUN, "--law", "snn+", "--pipeline", "perfect-readings"],
            ["snn", "needs obstacles", "perfect-readings", "pipeline perfect"],
        ),
        ([*RUN, "--law", "tanner-fixed"], ["tanner-fixed", "'neighbours'", "no graph", "fixed-set(0, 1, 2, 3, 4, 5)"]),
        ([*RUN, "--set", "herd.selection=fixed-set(1)"], ["needs ids", "member-based", "pipeline perfect"]),
        ([*RUN, "--set", "herd.selection=fixed-set"], ["fixed-set without ids", "no graph"]),
        ([*RUN, "--set", "herd.selection=nearst"], ["nearst", "did you mean nearest"]),
        ([*RUN, "--set", "herd.selection=k-nearest(0)"], ["k-nearest(0)", "at least 1"]),
        ([*RUN, "--set", 'herd.selection="repulsion: nearest"'], ["'repulsion'", "neighbours"]),
        (
            [*RUN, "--law", "couzin", "--set", 'herd.selection="repulson: nearest; interaction: all"'],
            ["'repulson'", "did you mean repulsion"],
        ),
        (
            [*RUN, "--law", "conradt", "--set", 'herd.selection="attraction: distance-based(9, beta_m)"'],
            ["distance-based(9, ", "low <= high"],
        ),
        (
            ["run", "vicsek-transition", "--set", 'herd.selection="neighbours: distance-based(9, range_m)"'],
            ["distance-based(9, ", "low <= high"],
        ),
        (
            [*RUN, "--law", "gazi-passino-2003", "--set", "herd.law.attraction_per_s=20"],
            ["'gazi-passino-2003'", "herd.law.attraction_per_s = 20", "attraction_per_s below repulsion_per_s"],
        ),
        (
            ["run", "link-tension", "--set", "herd.law.length_m=5"],
            ["'akama-naruse'", "herd.law.length_m = 5.0 and herd.law.range_m = 1.3", "length_m at most range_m"],
        ),
        (
            [*RUN, "--law", "olfati-saber", "--set", "herd.spread.spacing_m=0.9"],
            ["spacing_m at most range_m", "herd.spread.spacing_m = 0.9", "member "],
        ),
        (
            ["run", "link-tension", "--set", "herd.spread.length_m=0.9"],
            ["length_m at most range_m", "herd.spread.length_m = 0.9", "member "],
        ),
        ([*RUN, "--law", "vicsek", "--set", "herd.law.range_m=-1"], ["herd.law.range_m", "-1", "at least 0"]),
        ([*RUN, "--set", "herd.obstacles=avoids"], ["herd.obstacles", "'avoids'", "did you mean avoid"]),
        ([*RUN, "--set", 'herd.obstacle_selection="within(-1)"'], ["within", "from 0"]),
        ([*RUN, "--set", "herd.own_motion=compass"], ["herd.own_motion", "commands or odometry or true"]),
        ([*RUN, "--set", "herd.association.gate_m=-1"], ["herd.association.gate_m", "-1", "at least 0"]),
        ([*RUN, "--set", "herd.avoidance.margin=1"], ["herd.avoidance.margin"]),
        ([*RUN, "--pipeline", "member-base"], ["member-base", "member-based"]),
        ([*RUN, "--body", "creature"], ["creature", "create"]),
        ([*RUN, "--set", "herd.law.repulsion"], ["herd.law.repulsion", "KEY=VALUE"]),
        ([*RUN, "--set", "=3"], ["=3", "KEY=VALUE"]),
        ([*RUN, "--set", "herd.law.repulsoin_m=1"], ["herd.law.repulsoin_m", "did you mean herd.law.repulsion_m"]),
        ([*RUN, "--set", "heard.law.repulsion_m=1"], ["heard.law.repulsion_m", "herd.law.repulsion_m"]),
        ([*RUN, "--set", "herd.law.exclusion_m=nan"], ["herd.law.exclusion_m", "nan", "finite"]),
        ([*RUN, "--set", "herd.law.exclusion_m=inf"], ["herd.law.exclusion_m", "inf", "finite"]),
        ([*RUN, "--set", "herd.law.exclusion_m=-0.5"], ["herd.law.exclusion_m", "-0.5", "at least 0"]),
        ([*RUN, "--set", "herd.law.exclusion_m=far"], ["herd.law.exclusion_m", "'far'", "a number"]),
        ([*RUN, "--set", "herd.law.exclusion_m=[1, 2]"], ["herd.law.exclusion_m", "[1, 2]", "a number"]),
        ([*RUN, "--set", "herd.law.exclusion_m=1\nseed = 3"], ["not a TOML value"]),
        ([*RUN, "--set", "duration_s=0"], ["duration_s", "from 0.1"]),
        ([*RUN, "--set", "duration_s=1e"], ["duration_s", "'1e'", "TOML"]),
        ([*RUN, "--set", "duration_s=1", "--set", "duration_s=2"], ["duration_s", "twice"]),
        ([*RUN, "--set", "herd.count=1.5"], ["herd.count", "1.5", "whole number"]),
        ([*RUN, "--sweep", "herd.law.exclusion_m"], ["herd.law.exclusion_m", "KEY=A,B,C"]),
        ([*RUN, "--sweep", "herd.speed_m_s=0.1,0.1"], ["0.1", "twice"]),
        ([*RUN, "--sweep", "herd.speed_m_s=0.1,,0.2"], ["herd.speed_m_s", "TOML"]),
        ([*RUN, "--sweep", "herd.speed_m_s=0.1,fast"], ["herd.speed_m_s", "'fast'", "a number"]),
        ([*RUN, "--sweep", "duration_s=1,2", "--set", "duration_s=3"], ["duration_s", "set and swept"]),
        (["report"], ["no run below runs/"]),
        (["play"], ["no run below runs/"]),
        (["resume"], ["no run below runs/"]),
        (["report", "nowhere"], ["nowhere", "run.json"]),
        (["play", "nowhere"], ["nowhere", "folder of a run"]),
        (["resume", "nowhere"], ["nowhere", "run.json"]),
        (["play", "nowhere", "--trial", "0"], ["--trial", "'0'"]),
        (["world", "detection-case-study", "--out", "no/such/folder/world.xml"], ["no/such/folder", "No such file"]),
        (["world", "detection-case-study"], ["--out"]),
        (["bench", "--compare", "nowhere.json"], ["nowhere.json"]),
    ],
)
def test_bad_words(refused, words: list[str], expected: list[str]) -> None:
    line = refused(*words)
    for part in expected:
        assert part in line


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def law(:\n", "line 1"),
        ("x = 1\n", "law"),
        (LAW_HEAD + "    return 1.0, 2.0\n", "Motion"),
        (LAW_HEAD + "    return Motion(Kind.VELOCITY, math.nan, 0.0, 0)\n", "nan, y 0 for member 1 with"),
        (LAW_HEAD + "    return Motion(Kind.VELOCITY, 0.0, math.inf, 0)\n", "inf for member 1 with"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 3)\n", "rule 3 for member 1 with"),
        (LAW_HEAD + "    return Motion(Kind.VELOCITY, own.velocity, 0.0, 0)\n", "expected four numbers"),
        (LAW_HEAD + "    return Motion(Kind.HEADING, own.compass, 0.2, 0)\n", "nan"),
        (
            LAW_HEAD
            + "    x = members.headings[0] if len(members.ids) else 0.0\n    return Motion(Kind.HEADING, x, 0.2, 0)\n",
            "nan, y 0.2 for member 1 with one neighbour",
        ),
        (LAW_HEAD.replace("(own, members, ", "(own, ") + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\n", "member 1"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nSETS = {'near': 'nearst'}\n", "SETS"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nMEMORY = -1\n", "MEMORY = -1: expected a whole number"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nDRAWS = 'x'\n", "DRAWS = 'x': expected a whole number"),
        (
            LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nSETS = {'near': 'distance-based(0, rnge_m)'}\n",
            "rnge_m",
        ),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nSETS = {'near': 'k-nearest(-1)'}\n", "at least 1"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nNEEDS = {'smells'}\n", "smells"),
        (
            LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nRELATIONS = ('a < b',)\n",
            "relation 'a < b': expected NAME",
        ),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nRELATIONS = 'a < b'\n", "expected a tuple of words"),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nCREATE = {'range_m': 1.0}\n", "range_m"),
        (
            (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\n")
            .replace(
                "    pass\n",
                "    range_m: Annotated[float, Parameter('m', 'mine', low=0.0)] = -1.0\n",
            )
            .replace(
                "import math\n",
                "import math\nfrom typing import Annotated\nfrom flocking.parameters import Parameter\n",
            ),
            "law.range_m = -1.0: expected a finite number of at least 0",
        ),
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nHERD = 3\n", "HERD = 3: expected Herd(...)"),
        ("import os\nos._exit(0)\n", "ended its process with code 0 (importing)"),
        ("import sys\nsys.exit(0)\n", "ended its process with code 0 (importing)"),
        (
            LAW_HEAD.replace("import math\n", "import math\nimport os\n") + "    os._exit(0)\n",
            "ended its process with code 0 (member 1 with no neighbour)",
        ),
        (
            LAW_HEAD
            + "    x = members.positions[len(members.positions), 0]\n    return Motion(Kind.VELOCITY, x, 0.0, 0)\n",
            "",
        ),
    ],
)
def test_a_users_law_that_cannot_be_used(refused, tmp_path: Path, text: str, expected: str) -> None:
    (tmp_path / "mine.py").write_text(text)
    line = refused(*RUN, "--law", "mine.py", "--out", "out")
    assert "mine.py" in line
    assert expected in line
    assert not (tmp_path / "out").exists()


def test_a_users_law_named_by_a_setting_is_tried_out_as_well(refused, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("def law(:\n")
    assert "mine.py" in refused(*RUN, "--set", 'herd.law="mine.py"', "--out", "out")
    assert "mine.py" in refused(*RUN, "--sweep", "herd.law=snn,mine.py", "--out", "out")


def test_a_law_that_never_returns_is_stopped(
    refused,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from trials.commands import lawcheck

    monkeypatch.setattr(lawcheck, "CALL_LIMIT_S", 1.0)
    (tmp_path / "mine.py").write_text(LAW_HEAD + "    while True:\n        pass\n")
    line = refused(*RUN, "--law", "mine.py", "--out", "out")
    assert "did not return" in line


def test_a_folder_that_holds_another_run_stays_as_it_is(refused, tmp_path: Path) -> None:
    make_run(tmp_path / "out")
    line = refused(*RUN, "--repeats", "1", "--out", "out")
    assert "out holds a run" in line
    assert "herd resume out" in line


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["lch-table-4-1", "--until-decided", "--only", "3"], "expected one of the two"),
        (["detection-ideal", "--until-decided"], "has no claims"),
        (["lch-table-4-1", "--until-decided", "--budget", "0"], "above 0"),
        (["lch-table-4-1", "--until-decided", "--budget", "0m"], "above 0"),
        (["lch-table-4-1", "--until-decided", "--budget", "soon"], "10m, 90s or 40"),
        (["lch-table-4-1", "--budget", "40"], "--until-decided"),
        (
            ["detection-case-study", "--until-decided", "--set", "herd.pipeline=perfect"],
            "no number of repeats decides a claim",
        ),
    ],
)
def test_what_cannot_be_decided_is_refused(refused, words: list[str], expected: str, tmp_path: Path) -> None:
    assert expected in refused("run", *words)
    assert not list(tmp_path.glob("runs/*/*"))


def test_a_world_is_not_written_over_a_file(refused, tmp_path: Path) -> None:
    (tmp_path / "world.xml").write_text("mine")
    assert "there is such a file" in refused("world", "detection-case-study", "--out", "world.xml")
    assert (tmp_path / "world.xml").read_text() == "mine"


def test_a_locked_results_file_is_not_called_damaged(refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_run(tmp_path / "run")
    connect = sqlite3.connect
    monkeypatch.setattr(sqlite3, "connect", lambda *given, **how: connect(*given, **{**how, "timeout": 0.0}))
    lock = connect(tmp_path / "run" / "results.sqlite", isolation_level=None)
    lock.execute("BEGIN EXCLUSIVE")
    line = refused("report", "run")
    lock.close()
    assert "another process has locked it" in line
    assert "damaged" not in line


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"seed": "1"}, "seed = '1'"),
        ({"groups": 3}, "not iterable"),
        ({"conditions": [1]}, "conditions = "),
        ({"setup": {"duration_s": [1.0]}}, "duration_s = "),
        ({"world": "\x1b[31mred"}, "control characters"),
    ],
)
def test_a_run_file_with_other_types_is_damaged(refused, tmp_path: Path, change: dict[str, Any], words: str) -> None:
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    run = json.loads(path.read_text())
    run["trials"][0] |= change
    path.write_text(json.dumps(run))
    for command in ("report", "resume"):
        line = refused(command, "run")
        assert "run.json is damaged" in line
        assert words in line
        assert "\x1b" not in line


@pytest.mark.parametrize("change", [{"notes": 1}, {"notes": [1]}, {"conditions": [1]}, {"only": 5}, {"body": {}}])
def test_a_head_of_a_run_file_with_other_types_is_damaged(refused, tmp_path: Path, change: dict[str, Any]) -> None:
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    for command in ("report", "resume"):
        assert "run.json is damaged" in refused(command, "run")


def test_a_users_file_that_is_not_what_the_trials_hold_is_not_run(refused, tmp_path: Path) -> None:
    """What resume says that it runs is what it runs."""
    make_run(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    run = json.loads(path.read_text())
    run["trials"][0] |= {"world": "my_world.py", "world_source": "evil = 1"}
    path.write_text(json.dumps(run))
    (tmp_path / "run" / "code").mkdir()
    (tmp_path / "run" / "code" / "my_world.py").write_text("harmless = 1")
    assert "my_world.py is not the file" in refused("resume", "run")


def test_a_folder_that_cannot_be_made(refused, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    assert "is a file" in refused(*RUN, "--out", "file")
    assert "file/out: Not a directory" in refused(*RUN, "--out", "file/out")
    (tmp_path / "runs").write_text("mine")
    assert "cannot write runs" in refused(*RUN)


def test_damaged_and_newer_results(refused, tmp_path: Path) -> None:
    for name in ("damaged", "newer", "empty", "json"):
        make_run(tmp_path / name)
    (tmp_path / "damaged" / "results.sqlite").write_bytes(b"nonsense" * 1000)
    (tmp_path / "empty" / "results.sqlite").write_bytes(b"")
    (tmp_path / "json" / "run.json").write_text("{")
    with sqlite3.connect(tmp_path / "newer" / "results.sqlite") as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    for command in ("resume", "report"):
        assert "run.json is damaged" in refused(command, "json")
        assert "damaged" in refused(command, "damaged")
        assert "not the results of a run" in refused(command, "empty")
        assert "format 99" in refused(command, "newer")


def test_a_trial_that_was_not_recorded_cannot_be_played(refused, tmp_path: Path) -> None:
    make_run(tmp_path / "run")
    assert "no trial of run was recorded" in refused("play", "run")
    assert "no trial of run was recorded" in refused("play", "run", "--trial", "1")
    (tmp_path / "run" / "recordings" / "0002.rrd").write_bytes(b"")
    (tmp_path / "run" / "recordings" / "².rrd").write_bytes(b"")  # a digit to Python, and no trial's
    assert "trial 9" in refused("play", "run", "--trial", "9")


def test_a_run_that_another_process_is_at_is_left_alone(refused, tmp_path: Path) -> None:
    make_run(tmp_path / "run")
    with folders.alone(tmp_path / "run"):
        assert "another process" in refused("resume", "run")


@pytest.mark.parametrize(
    ("text", "indices"), [("1", [1]), ("1-4,9", [1, 2, 3, 4, 9]), ("9, 1-2", [1, 2, 9]), ("2,2,1-3", [1, 2, 3])]
)
def test_only_takes_numbers_and_ranges(text: str, indices: list[int]) -> None:
    assert options.only(text) == tuple(indices)


@pytest.mark.parametrize("text", ["1", "1-4,9", "2-3,7-9", "1,3,5"])
def test_ranges_is_the_inverse_of_only(text: str) -> None:
    assert ranges(options.only(text)) == text


def test_values_are_toml_and_bare_words_are_text() -> None:
    given = ["a=1", "b=1.0", "c=true", 'd="x y"', "e=member-based", "f=laws/mine.py", "g=-1e-3", "h = 'q'"]
    given += ["i=snn+", "j=laws/mine.py+", "k=sector(-90, 90) & nearest"]
    assert options.settings(given) == {
        "a": 1,
        "b": 1.0,
        "c": True,
        "d": "x y",
        "e": "member-based",
        "f": "laws/mine.py",
        "g": -1e-3,
        "h": "q",
        "i": "snn+",
        "j": "laws/mine.py+",
        "k": "sector(-90, 90) & nearest",
    }
    assert options.sweeps(["a=1,2.5", "b=ideal,harsh", 'c="x,y","z"', "d=true,false"]) == {
        "a": [1, 2.5],
        "b": ["ideal", "harsh"],
        "c": ["x,y", "z"],
        "d": [True, False],
    }
    with pytest.raises(InputError, match="twice"):
        options.sweeps(["a=1", "a=2"])
