"""Users' laws that cannot be used: one line on stderr, exit code 2, nothing changed."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from flocking import users_files
from tests.trials.commands.own_laws import LAW_HEAD
from trials.commands import lawcheck

RUN = ["run", "detection-case-study"]


class Here:
    """In place of a check's own process: the same check, in this one, which has imported all that it needs."""

    def __init__(self, words: Sequence[str], **_: object) -> None:
        self.pid, self.stdout = os.getpid(), io.StringIO()
        with redirect_stdout(self.stdout), users_files.executed(True):
            self.code = lawcheck._main(words[-1])
        self.stdout.seek(0)

    def wait(self) -> int:
        return self.code

    def kill(self) -> None: ...


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
        (LAW_HEAD + "    return Motion(Kind.STOP, 0.0, 0.0, 0)\nMAY_LACK = {'headings'}\n", "MAY_LACK ['headings']"),
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
        (
            LAW_HEAD
            + "    x = members.positions[len(members.positions), 0]\n    return Motion(Kind.VELOCITY, x, 0.0, 0)\n",
            "",
        ),
    ],
)
def test_a_users_law_that_cannot_be_used(
    refused: Callable[..., str], tmp_path: Path, text: str, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lawcheck.subprocess, "Popen", Here)
    is_refused(refused, tmp_path, text, expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def law(:\n", "line 1"),
        (LAW_HEAD + "    return 1.0, 2.0\n", "Motion"),
        ("import os\nos._exit(0)\n", "ended its process with code 0 (importing)"),
        ("import sys\nsys.exit(0)\n", "ended its process with code 0 (importing)"),
        (
            LAW_HEAD.replace("import math\n", "import math\nimport os\n") + "    os._exit(0)\n",
            "ended its process with code 0 (member 1 with no neighbour)",
        ),
    ],
)
def test_a_users_law_that_cannot_be_used_or_ends_its_process(
    refused: Callable[..., str], tmp_path: Path, text: str, expected: str
) -> None:
    is_refused(refused, tmp_path, text, expected)


def is_refused(refused: Callable[..., str], folder: Path, text: str, expected: str) -> None:
    (folder / "mine.py").write_text(text)
    line = refused(*RUN, "--law", "mine.py", "--out", "out")
    assert "mine.py" in line
    assert expected in line
    assert not (folder / "out").exists()


def test_a_users_law_named_by_a_setting_is_tried_out_as_well(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("def law(:\n")
    assert "mine.py" in refused(*RUN, "--set", 'herd.law="mine.py"', "--out", "out")
    assert "mine.py" in refused(*RUN, "--sweep", "herd.law=snn,mine.py", "--out", "out")


def test_a_law_that_never_returns_is_stopped(
    refused: Callable[..., str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lawcheck, "CALL_LIMIT_S", 1.0)
    (tmp_path / "mine.py").write_text(LAW_HEAD + "    while True:\n        pass\n")
    line = refused(*RUN, "--law", "mine.py", "--out", "out")
    assert "did not return" in line
