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
CALL = """
import sys
import numpy as np
from flocking import lawentry
from flocking.kinematic import Band, simulate

start = np.array([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]])
band = Band(lawentry.load(sys.argv[1]), 2)
history = simulate(band, start, dt_s=1.0, steps=1, rng=np.random.default_rng(0))
print(float(history.positions_w[-1, 0, 0]))
"""


def moved(law: Path) -> float:
    """How far the first member comes in one step; compiled code is kept from call to call."""
    done = subprocess.run(
        [sys.executable, "-c", CALL, str(law)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(law.parent)])},
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
        assert moved(file) == expected


@pytest.mark.parametrize(
    "uses",
    [
        ("from helper_of_a_user import factor", "factor()"),
        ("import helper_of_a_user as helper", "helper.factor()"),
    ],
)
def test_a_users_law_after_edits_of_the_users_helper(tmp_path: Path, uses: tuple[str, str]) -> None:
    file, helper = tmp_path / "mine.py", tmp_path / "helper_of_a_user.py"
    file.write_text(text(imported=uses[0], factor=uses[1]))
    for value in (1.0, 7.0):
        helper.write_text(HELPER.format(value=value))
        assert moved(file) == 2.0 * value


def test_the_kernel_is_kept_where_every_edit_leads_elsewhere(tmp_path: Path) -> None:
    """The folder's name is a hash of all sources: of laws, of their helpers, and of the kernel's own parts."""
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
