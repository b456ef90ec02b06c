"""What a law declares survives as data, and a process that was told of it need not execute it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from flocking import lawdata, lawentry, lawsource, users_files
from flocking.errors import InputError
from flocking.parameters import declared, filled

CONSTANTS = ("HERD", "TAXONOMY", "VALIDATION", "FILLED", "CHIRAL", "AXIS", "MEMORY", "DRAWS", "CREATE")
LAW = '''"""Marks that it was executed."""
from pathlib import Path
from typing import Annotated, NamedTuple
from flocking.parameters import Parameter
from flocking.types import Kind, Motion

Path({marker!r}).touch()
NEEDS = {{"positions", "headings"}}


class Parameters(NamedTuple):
    """Its own."""

    reach_m: Annotated[float, Parameter("m", "a choice", low=0.0)] = 2.0


def law(own, members, sets, obstacles, parameters, memory, u):
    return Motion(Kind.VELOCITY, 0.1, 0.0, 0)
'''


@pytest.mark.parametrize("name", lawsource.names())
def test_what_a_law_declares_comes_back(name: str) -> None:
    module = lawentry.module_of(name)
    again = lawdata.from_data(name, json.loads(json.dumps(lawdata.as_data(name, module))))
    assert declared(again.Parameters) == declared(module.Parameters)
    assert again.__doc__ == (module.__doc__ or "").strip()
    for constant in CONSTANTS:
        assert getattr(again, constant, None) == getattr(module, constant, None)
    assert lawentry.sets_of(again) == lawentry.sets_of(module)
    assert lawentry.needs_of(again) == lawentry.needs_of(module)
    assert lawentry.relations_of(again) == lawentry.relations_of(module)
    assert tuple(getattr(again, "RULES", ())) == tuple(getattr(module, "RULES", ()))


def test_a_law_that_was_told_of_is_not_executed(tmp_path: Path) -> None:
    marker, path = tmp_path / "executed", tmp_path / "mine.py"
    source = LAW.format(marker=str(marker))
    path.write_text(source)
    data = lawdata.as_data("mine.py", lawentry.module_of(str(path)))
    marker.unlink()
    source += "# another text\n"
    with users_files.executed(False):
        with pytest.raises(InputError, match=r"does not execute it"):
            lawentry.module_of(str(path), source)
        with pytest.raises(InputError, match=r"does not execute it"):
            lawentry.load(str(path), source)
        lawentry.learn(str(path), source, json.loads(json.dumps(data)))
        module = lawentry.module_of(str(path), source)
    assert filled(module.Parameters, {}).reach_m == 2.0
    assert lawentry.needs_of(module) == {"positions", "headings"}
    with pytest.raises(InputError, match=r"law\.reach_m = -1"):
        lawentry.parameters_of(str(path), module, {"reach_m": -1.0})
    assert not marker.exists()


@pytest.mark.parametrize(
    "data",
    [
        None,
        [],
        {},
        {"doc": "", "parameters": 3, "FILLED": []},
        {"doc": "", "parameters": [["a b", "float", 1.0, {"unit": "", "source": ""}]], "FILLED": []},
        {"doc": "", "parameters": [["a", "list", 1.0, {"unit": "", "source": ""}]], "FILLED": []},
        {"doc": "", "parameters": [], "FILLED": [], "HERD": 3},
        {"doc": "", "parameters": [], "FILLED": [], "RULES": 3},
    ],
)
def test_damaged_data_are_told_in_one_line(data: object) -> None:
    with pytest.raises(InputError, match=r"what is kept of law 'mine\.py' is damaged") as caught:
        lawdata.from_data("mine.py", data)
    assert "\n" not in str(caught.value)


def test_a_constant_of_another_type_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(LAW.format(marker=str(tmp_path / "executed")) + "HERD = 3\n")
    with pytest.raises(InputError, match=r"HERD = 3: expected Herd\(\.\.\.\)"):
        lawdata.as_data(str(path), lawentry.module_of(str(path)))
