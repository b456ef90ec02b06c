"""The command called where it must refuse what it is given."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from trials.commands import cli


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
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
