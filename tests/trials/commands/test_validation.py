"""`herd validate`: its table, what it writes, and what it refuses in one line."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from generation import files
from generation.environment import Environment
from generation.exports import svg
from generation.primitives import Point, Segment
from trials.commands import cli, validation
from trials.environments import blocks

WEDGE = Environment(
    construct=(Segment(0.0, 30.0, -60.0, 90.0), Segment(0.0, 30.0, 60.0, 90.0)),
    markers={"start": Point(0.0, 0.0, 1.5707963)},
)
GROUP = ["--law", "reynolds-boids", "--members", "5", "--jobs", "1"]
BAD = '''
"""Returns too much."""
from typing import NamedTuple
ITERATIONS = 3
SUCCESS = 1.0


class Parameters(NamedTuple):
    """None."""


def fitness(positions, environment, parameters):
    return {}
'''
KEPT_BACK = '''
"""Nobody gets 12 units along x: in twelve iterations of two units a robot would get twice as far."""
from typing import NamedTuple
ITERATIONS = 12
SUCCESS = 1.0


class Parameters(NamedTuple):
    """None."""


def fitness(positions, environment, parameters):
    return float(positions[-1, :, 0].max() < 12.0)
'''


def herd(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["herd", "validate", *words])
    code = cli.main()
    out, err = capsys.readouterr()
    return code, out, err


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "made").mkdir()
    for k in range(2):
        files.write(WEDGE, tmp_path / "made" / f"{k}.json")
    return tmp_path


def test_the_table_and_what_is_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(folder / "made"), "--behaviour", "simple-split", *GROUP, "--repeats", "3", "--set", "starts.side_m=20"]
    code, out, err = herd(monkeypatch, capsys, *words, "--out", str(folder / "o.csv"), "--robustness")
    assert (code, err) == (0, "")
    assert "uplift" in out
    assert "empty world on the same starts" in " ".join(out.split())
    kinds = list(csv.DictReader((folder / "o-robustness.csv").open(encoding="utf-8")))
    if "no environment elicited" not in out:
        assert "success when perturbed" in " ".join(out.split())
        assert [row["perturbed"] for row in kinds[:5]] == ["starts", "walls", "2 members", "10 members", "viscido-snn"]
    for row in kinds:
        assert float(row["uplift"]) == pytest.approx(float(row["success"]) - float(row["control_success"]))
    code, _, _ = herd(monkeypatch, capsys, *words, "--out", str(folder / "o.json"))
    rows = list(csv.DictReader((folder / "o.csv").open(encoding="utf-8")))
    again = json.loads((folder / "o.json").read_text(encoding="utf-8"))
    assert [row["environment"] for row in rows] == [str(folder / "made" / f"{k}.json") for k in range(2)]
    for row, other in zip(rows, again, strict=True):
        assert {name: str(value) for name, value in other.items()} == row  # a run of the same seed is the same
        assert int(row["simulations"]) == 3
        assert float(row["uplift"]) == pytest.approx(float(row["success"]) - float(row["control_success"]))


def test_robots_are_tried_beside_their_empty_world(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One Create that goes straight on: a wall across its way keeps it back, and the empty world does not."""
    wall = Environment(construct=(Segment(12.0, -60.0, 12.0, 60.0),), markers={"start": Point()})
    files.write(wall, tmp_path / "wall.json")
    own = tmp_path / "kept.py"
    own.write_text(KEPT_BACK, encoding="utf-8")
    words = [str(tmp_path / "wall.json"), "--behaviour", str(own), "--law", "random-motion", "--members", "1"]
    words += ["--body", "create", "--repeats", "2", "--out", str(tmp_path / "o.csv")]
    for setting in ("law.turn_rad=0", "law.speed_m_s=0.25", "starts.side_m=0", "starts.spread_rad=0"):
        words += ["--set", setting]
    words += ["--set", "members.pipeline=perfect", "--set", "members.selection=nearest"]
    code, out, err = herd(monkeypatch, capsys, *words, "--set", "members.obstacles=as-law")
    assert (code, err) == (0, "")
    told = " ".join(out.split())
    assert "1 robot (create) of random-motion" in told
    assert "wall 1.00 2 of 2 0 of 2 +1.00" in told
    assert "success 1.000 with the constructs, 0.000 in the empty world on the same starts" in told
    (row,) = csv.DictReader((tmp_path / "o.csv").open(encoding="utf-8"))
    assert [float(row[name]) for name in ("simulations", "success", "control_success", "uplift")] == [2, 1, 0, 1]
    assert float(row["uplift_low"]) < 1.0 == float(row["uplift_high"])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--set", "law.rang_m=3"], "range_m"),
        (["--set", "herd.count=3"], "herd.count"),
        (["--set", "members.sped_m_s=3"], "members.speed_m_s"),
        (["--set", "starts.side_m=-1"], "starts.side_m"),
        (["--set", "members.speed_m_s=fast"], "members.speed_m_s = 'fast'"),
        (["--set", "members.speed_m_s=0"], "members.speed_m_s = 0"),
        (["--set", f"members.radius_m=1{'0' * 400}"], "members.radius_m"),
        (["--set", "members.obstacles=avoids"], "did you mean avoid?"),
        (["--set", "robustness.other_law=vicsec", "--robustness"], "vicsek"),
        (["--body", "create", "--set", "members.speed_m_s=0"], "members.speed_m_s = 0"),
        (["--body", "create", "--set", "members.speed_m_s=fast"], "members.speed_m_s = 'fast'"),
        (["--body", "create", "--set", "members.formation=disc"], "members.formation"),
        (["--body", "create", "--set", "members.pipeline=perfct"], "perfect"),
        (["--body", "create", "--set", "members.step_units=0"], "members.step_units"),
        (["--scale", "0.1"], "--body"),
        (["--body", "creat"], "create"),
        (["--out", "x.txt"], ".csv or .json"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(
    words: list[str], told: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [str(folder / "made"), "--behaviour", "simple-split", *GROUP, *words]
    code, _, err = herd(monkeypatch, capsys, *given)
    assert code == 2
    assert told in err
    assert err.count("\n") == 1


def test_a_missing_file_and_behaviour(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, _, err = herd(monkeypatch, capsys, str(folder / "no.json"), "--behaviour", "simple-split", *GROUP)
    assert (code, err.count("\n")) == (2, 1)
    assert "does not exist" in err
    code, _, err = herd(monkeypatch, capsys, str(folder / "made"), "--behaviour", "simple-splat", *GROUP)
    assert (code, err.count("\n")) == (2, 1)
    assert "simple-split" in err


@pytest.mark.parametrize("value", ["1.7", "float('nan')"])
def test_a_behaviour_that_returns_no_fitness(
    value: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own = folder / "own.py"
    own.write_text(BAD.format(f"0.5 if environment.markers['start'].x_m == 0 else {value}"), encoding="utf-8")
    files.write(WEDGE.moved(x_m=5.0), folder / "made" / "1.json")
    words = [str(folder / "made"), "--behaviour", str(own), *GROUP, "--out", str(folder / "o.json")]
    code, _, err = herd(monkeypatch, capsys, *words)
    assert (code, err.count("\n")) == (2, 1)
    assert "expected a number from 0 to 1" in err
    kept = json.loads((folder / "o.json").read_text(encoding="utf-8"))
    assert [row["fitness"] for row in kept] == [0.5]  # what came before is kept


def test_a_behaviour_that_does_not_return_is_ended(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own = folder / "own.py"
    own.write_text(BAD.format("[None for _ in iter(int, 1)]"), encoding="utf-8")
    monkeypatch.setattr(blocks, "USERS_S", 2.0)
    monkeypatch.setattr(blocks, "USERS_EACH_S", 0.0)
    code, _, err = herd(monkeypatch, capsys, str(folder / "made"), "--behaviour", str(own), *GROUP)
    assert (code, err.count("\n")) == (2, 1)
    assert "takes more than 2 s" in err


def test_what_a_block_may_take_does_not_count_what_is_compiled_before_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Workers import the kernel, which compiles it, before their first block: where nothing is cached that takes a
    minute and more, and a block of a user's behaviour may take 14 s."""
    own, seen = folder / "own.py", []
    own.write_text(BAD.format(0.5), encoding="utf-8")
    in_order = blocks.in_order

    def kept(*given: Any, **more: Any) -> Any:
        seen.append(given[3])
        return in_order(*given, **more)

    monkeypatch.setattr(blocks, "in_order", kept)
    words = [str(folder / "made"), "--behaviour", str(own), *GROUP]
    assert herd(monkeypatch, capsys, *words)[0] == 0
    assert seen == [blocks.prepared]
    blocks.prepared()
    assert "flocking.kinematic.kernel" in sys.modules


@pytest.mark.parametrize("where", ["fitness", "file"])
def test_a_behaviour_that_does_not_return_is_ended_with_robots_too(
    where: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    endless = "sum(0 for _ in iter(int, 1))"
    own = folder / "own.py"
    own.write_text(BAD.format(endless) if where == "fitness" else f"{BAD.format(0.5)}\n{endless}\n", encoding="utf-8")
    for module in (blocks, validation):
        monkeypatch.setattr(module, "USERS_S", 1.0)
    words = [str(folder / "made"), "--behaviour", str(own), *GROUP, "--body", "create"]
    code, _, err = herd(monkeypatch, capsys, *words)
    assert (code, err.count("\n")) == (2, 1)
    assert "own.py' did not return within 1 s of processor time" in err


def test_plans_of_other_formats_are_environments_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plan.svg").write_text(svg.to_svg(WEDGE), encoding="utf-8")
    given = [str(tmp_path / "plan.svg"), "--behaviour", "simple-split", *GROUP, "--set", "starts.side_m=20"]
    assert herd(monkeypatch, capsys, *given)[0] == 0


def test_files_of_one_name_in_two_folders_are_told_apart() -> None:
    paths = [Path("a/1.json"), Path("b/1.json"), Path("b/2.json")]
    assert validation.named(paths) == ["a/1", "b/1", "2"]
