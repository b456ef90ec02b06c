"""The wheel, installed in a clean environment, runs a trial from a folder that has nothing to do with this one."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CODE_PACKAGES = {"flocking", "generation", "robots", "scripts", "sensing", "trials", "worlds"}


def ran(command: Sequence[str | Path], folder: Path, **environment: str) -> str:
    plain = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "NUMBA", "CREATE_HERD"))}
    done = subprocess.run(
        [str(part) for part in command], cwd=folder, env={**plain, **environment}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    ran([sys.executable, "-m", "build", "--wheel", "--outdir", folder, ROOT], folder)
    (built,) = folder.glob("*.whl")
    return built


def test_the_wheel_holds_exactly_our_packages_and_their_data(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    top = {name.split("/")[0] for name in names if not name.split("/")[0].endswith(".dist-info")}
    assert top == CODE_PACKAGES
    for package in CODE_PACKAGES:
        for path in (ROOT / package).rglob("*"):
            if path.suffix in {".py", ".xml", ".toml", ".html"}:
                assert path.relative_to(ROOT).as_posix() in names


def test_every_dependency_is_pinned_without_an_address() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = (ROOT / "constraints.txt").read_text().split()
    pinned = {line.partition("==")[0].lower().replace("_", "-") for line in lines}
    wanted = project["dependencies"] + project["optional-dependencies"]["dev"]
    for dependency in wanted:
        name = dependency.partition(">=")[0].lower().replace("_", "-")
        assert name in pinned, name
    assert not any("/" in line or "@" in line for line in lines)


def test_every_library_that_is_imported_is_a_dependency() -> None:
    """Of the code as it is installed, without its extras: `dev` is for the tests, and Dask is asked for by name."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    declared = {re.split("[<>=]", line)[0].lower() for line in project["dependencies"]}
    providers = metadata.packages_distributions()
    for path in [path for package in CODE_PACKAGES - {"scripts"} for path in (ROOT / package).rglob("*.py")]:
        for name in imported(ast.parse(path.read_text())) - sys.stdlib_module_names - CODE_PACKAGES:
            offered = {distribution.lower() for distribution in providers[name]}
            assert offered & declared or offered & {"distributed", "dask"}, f"{path.relative_to(ROOT)} imports {name}"


def imported(code: ast.Module) -> set[str]:
    """The top names of all absolute imports."""
    found = set()
    for node in ast.walk(code):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
            found.add(node.module.split(".")[0])
    return found


def test_installed_alone_it_runs_a_short_trial_from_an_unrelated_folder(wheel: Path, tmp_path: Path) -> None:
    """The libraries are those of this environment, which has them already; the project is the wheel's alone."""
    home, elsewhere = tmp_path / "venv", tmp_path / "elsewhere"
    elsewhere.mkdir()
    venv.create(home)
    python, herd = home / "bin/python", home / "bin/herd"
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--disable-pip-version-check"]
    ran([*pip, "--no-deps", wheel], elsewhere)
    (site,) = home.glob("lib/python*/site-packages")
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib"))  # a path alone: what is editable there stays out
    command = [herd, "run", "detection-case-study", "--only", "1,5", "--set", "duration_s=2", "--jobs", "1"]
    printed = ran([*command, "--out", "kept"], elsewhere, CREATE_HERD_CACHE=str(tmp_path / "cache"))
    assert "kept" in printed
    assert (elsewhere / "kept/results.sqlite").is_file()
    assert (elsewhere / "kept/report.html").is_file()
    assert sorted(path.name for path in (elsewhere / "kept/series").iterdir()) == ["0001.npz", "0005.npz"]
    where = ran([python, "-c", "import flocking; print(flocking.__file__)"], elsewhere)
    assert str(home) in where
