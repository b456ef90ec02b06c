"""Bad input: one line on stderr that says what was given and what was expected, exit code 2, nothing changed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from flocking.errors import InputError
from sensing.camera import opengl
from trials.batch.asked import ranges
from trials.commands import options

RUN = ["run", "detection-case-study"]


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
def test_bad_words(refused: Callable[..., str], words: list[str], expected: list[str]) -> None:
    line = refused(*words)
    for part in expected:
        assert part in line


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
def test_what_cannot_be_decided_is_refused(
    refused: Callable[..., str], words: list[str], expected: str, tmp_path: Path
) -> None:
    assert expected in refused("run", *words)
    assert not list(tmp_path.glob("runs/*/*"))


def test_a_world_is_not_written_over_a_file(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "world.xml").write_text("mine")
    assert "there is such a file" in refused("world", "detection-case-study", "--out", "world.xml")
    assert (tmp_path / "world.xml").read_text() == "mine"


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


def test_a_run_that_needs_images_begins_only_where_they_can_be_rendered(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(opengl.ASIDE, "")  # which the command sets
    monkeypatch.setenv(opengl.VARIABLE, "nonsense")
    assert "MUJOCO_GL = 'nonsense' renders nothing" in refused("run", "cone-distance", "--out", str(tmp_path / "run"))
    assert not (tmp_path / "run").exists()
