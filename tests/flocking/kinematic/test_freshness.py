"""Editing a law's file, or a helper that it uses, changes what a kinematic herd does next: in real processes.

That an edit below flocking, of a law or of a helper of its helper, makes all compiled code anew is tested without the
minutes that this would take: by where the kernel is kept.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from flocking import compilation, lawentry
from flocking.kinematic import kernel

ROOT = Path(lawentry.__file__).parents[1]

LAW = """
import math
from typing import Annotated, NamedTuple
from flocking.parameters import Parameter
from flocking.types import Kind, Motion
{imported}

RULES = ("go",)
SETS = {{"neighbours": "{selection}"}}


class Parameters(NamedTuple):
    speed_m_s: Annotated[float, Parameter("m/s", "a test")] = {speed}


def law(own, members, sets, obstacles, parameters, memory, u):
    return Motion(Kind.HEADING, 0.0, parameters.speed_m_s * {factor} + 100.0 * sets[0].sum(), 0)
"""
HELPER = """
from flocking.compilation import compiled


@compiled
def factor():
    return {value}
"""
OUTER = """
from flocking.compilation import compiled
from {helper} import factor


@compiled
def twice():
    return 2.0 * factor()
"""
DECIDE = """
import math
import numpy as np
from flocking import lawentry
from flocking.types import NO_OBSTACLES, Members, Own

law = lawentry.load("akama-naruse")
own = Own(np.zeros(2), 0.0, math.nan, np.zeros(2), np.zeros(2, dtype=bool), 0.1, 0, 0)
at, nothing = np.array([[7.0, 0.0]]), np.zeros(0)
members = Members(at, np.zeros(1), np.zeros(1), np.zeros((1, 2)), np.ones(1, dtype=np.int64))
print(law.decide(own, members, np.ones((1, 1), dtype=bool), NO_OBSTACLES, law.parameters({}), nothing, nothing).x)
"""
"""One neighbour, at rest: the acceleration goes by the unit vector towards it alone."""
CALL = """
import sys
import numpy as np
from flocking import lawentry
from flocking.kinematic import Band, Schedule, simulate

start = np.array([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]])
for law in sys.argv[1:]:
    band = Band(lawentry.load(law), 2)
    history = simulate(band, start, Schedule(1.0, 1), rng=np.random.default_rng(0))
    print(float(history.positions_w[-1, 0, 0]))
"""


def moved(*laws: Path) -> list[float]:
    """How far the first member of each law's herd comes in one step, in a new process; compiled code is kept."""
    done = subprocess.run(
        [sys.executable, "-c", CALL, *map(str, laws)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(laws[0].parent)])},
        capture_output=True,
        text=True,
        check=True,
    )
    return [float(line) for line in done.stdout.split()]


def decided(packages: Path, cache: Path) -> float:
    """What a law decides in a fresh process that runs the packages in that folder."""
    done = subprocess.run(
        [sys.executable, "-c", DECIDE],
        env={**os.environ, "PYTHONPATH": str(packages), compilation.CACHE_VARIABLE: str(cache)},
        cwd=packages,
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def text(speed: float = 2.0, factor: str = "1.0", imported: str = "", selection: str = "distance-based(0, 1)") -> str:
    return LAW.format(speed=speed, factor=factor, imported=imported, selection=selection)


def test_a_users_law_after_each_edit(tmp_path: Path) -> None:
    """Its number, its selection, its code, and back again: no compiled code of before is taken for it."""
    file = tmp_path / "mine.py"
    edits = [
        (text(), 2.0),
        (text(speed=3.0), 3.0),
        (text(selection="all"), 102.0),
        (text(factor="math.sqrt(4.0)"), 4.0),
        (text(), 2.0),
    ]
    for source, expected in edits:
        file.write_text(source)
        assert moved(file) == [expected]


USES = {
    "a helper": ("from helper_0 import factor", "factor()"),
    "a helper's module": ("import helper_1 as helper", "helper.factor()"),
    "a helper of a helper, in the law": (OUTER.format(helper="helper_2"), "twice()"),
    "a helper of a helper": ("from outer_3 import twice", "twice()"),
    "a number": ("from numbers_4 import FACTOR", "FACTOR"),
    "a module of numbers": ("import numbers_5", "numbers_5.FACTOR"),
    "numbers in a file": ("import numpy as np\nFACTOR = np.loadtxt({folder!r} + '/6.txt', ndmin=1)", "FACTOR[0]"),
    "text in a file": ("FACTOR = float(open({folder!r} + '/7.txt').read())", "FACTOR"),
}
"""What users' laws take a number from that other files hold: how it is imported, and used."""


@pytest.fixture(scope="module")
def after_edits(tmp_path_factory: pytest.TempPathFactory) -> dict[float, dict[str, float]]:
    """By the number in the other files, of which each law has its own, how far each law's member moves."""
    folder = tmp_path_factory.mktemp("laws")
    laws = [folder / f"law_{k}.py" for k in range(len(USES))]
    for law, (imported, factor) in zip(laws, USES.values(), strict=True):
        law.write_text(text(imported=imported.format(folder=str(folder)), factor=factor))
    (folder / "outer_3.py").write_text(OUTER.format(helper="helper_3"))
    found = {}
    for value in (1.0, 7.0):
        for k in range(len(USES)):
            (folder / f"helper_{k}.py").write_text(HELPER.format(value=value))
            (folder / f"numbers_{k}.py").write_text(f"FACTOR = {value}\n")
            (folder / f"{k}.txt").write_text(f"{value}\n")
        found[value] = dict(zip(USES, moved(*laws), strict=True))
    return found


@pytest.mark.parametrize("use", USES)
def test_a_users_law_after_edits_of_what_it_uses(after_edits: dict[float, dict[str, float]], use: str) -> None:
    times = 4.0 if "of a helper" in use else 2.0
    assert {value: moves[use] for value, moves in after_edits.items()} == {1.0: times, 7.0: 7.0 * times}


def test_a_law_of_the_project_after_an_edit_of_its_helper(tmp_path: Path) -> None:
    """In a copy of the packages; with one cache. A unit vector twice as long is a spring twice as strong."""
    for package in compilation.PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    terms = tmp_path / "flocking/terms.py"
    plain = terms.read_text()
    cache = tmp_path / "cache"
    before = decided(tmp_path, cache)
    assert before != 0.0
    terms.write_text(plain.replace("return over(x, y, length)", "return over(2.0 * x, 2.0 * y, length)"))
    assert terms.read_text() != plain
    assert decided(tmp_path, cache) == pytest.approx(2.0 * before, rel=1e-12)  # rounding
    assert len([folder for folder in cache.iterdir() if folder.is_dir()]) == 2


def test_the_kernel_is_kept_where_every_edit_leads_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder's name is a hash of all sources: of laws, of their helpers, and of the kernel's own parts."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", os.environ["NUMBA_CACHE_DIR"])  # which the copies below change
    kept = Path(kernel.synchronous.stats.cache_path)
    assert compilation.sources_digest() in kept.parts
    for package in compilation.PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))

    def digest() -> str:
        spec = importlib.util.spec_from_file_location("copied_compilation", tmp_path / "flocking/compilation.py")
        assert spec is not None
        assert spec.loader is not None
        copied = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(copied)
        found: str = copied.sources_digest()
        return found

    assert digest() == compilation.sources_digest()
    seen = {digest()}
    for name in ("laws/vicsek.py", "laws/new_one.py", "terms.py", "perception.py", "kinematic/walls.py"):
        path = tmp_path / "flocking" / name
        path.write_text((path.read_text() if path.exists() else "") + "\n")
        seen.add(digest())
    assert len(seen) == 6
