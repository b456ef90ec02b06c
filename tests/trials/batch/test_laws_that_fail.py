"""Users' laws that go wrong in the middle of a real batch: the row names the law, the member and the step."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from flocking.types import Kind
from trials.batch import runfile, store, worker
from trials.batch.batch import Work, run_batch
from trials.batch.store import Row
from trials.commands import lawcheck
from trials.design import plan
from trials.simulations.kinematic.fields import group
from trials.simulations.kinematic.fields import trial as kinematic
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parents[1]))
import slow_trials  # by a name that worker processes can import too

LIMIT_S = 2.0
"""Processor time within which a law must return: ten times the longest piece of work of a kinematic trial."""
LAW = """
import math
from typing import NamedTuple
from flocking.types import Kind, Motion

MEMORY = 1


class Parameters(NamedTuple):
    pass


def law(own, members, sets, obstacles, parameters, memory, u):
    memory[0] += 1.0
    speed = 0.1
    if own.id == {who} and memory[0] >= 3.0:
        {does}
    return Motion(Kind.VELOCITY, speed, 0.0, 0)
"""
HANGS, IS_LOST, STAYS_WELL = "while memory[0] >= 3.0:\n            memory[0] += 1.0", "speed = math.nan", "pass"


@pytest.fixture(scope="module")
def laws(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, str]]:
    """Path and text of laws with which the sixth member goes wrong at its third decision; `herd` accepts them."""
    folder, found = tmp_path_factory.mktemp("laws"), {}
    for name, does in (("hangs", HANGS), ("lost", IS_LOST)):
        path = folder / f"{name}.py"
        path.write_text(LAW.format(who=5, does=does))
        lawcheck.check(str(path))
        found[name] = str(path), path.read_text()
    return found


class Silent:
    """Progress that is not shown."""

    def say(self, text: str) -> None: ...

    def ended(self, row: Row) -> None: ...


def batch(
    folder: Path, trials: Sequence[Trial], run: worker.Job = worker.run_and_write, warm: bool = True
) -> list[Row]:
    """The rows of a batch on one worker."""
    made = {"format": runfile.FORMAT, "experiment": "test", "trials": [trial.as_dict() for trial in trials]}
    kept = store.create(folder, made, {})
    warm_up, imports = trials[-1:] if warm else [], worker.imports_of(trials)
    work = Work(run=run, imports=imports, warm_up=warm_up, law_limit_s=LIMIT_S)
    run_batch(trials, kept, Silent(), jobs=1, work=work)
    rows = sorted(kept.rows(), key=lambda row: row.index)
    kept.close()
    return rows


def numbered(trials: Sequence[Trial]) -> list[Trial]:
    return [dataclasses.replace(trial, index=k) for k, trial in enumerate(trials, start=1)]


@pytest.mark.parametrize("synchronous", [True, False])
def test_of_a_kinematic_batch(tmp_path: Path, laws: dict[str, tuple[str, str]], synchronous: bool) -> None:
    """The failing law in the only group, then in the second of two groups, then a trial without it."""
    hangs, lost = laws["hangs"], laws["lost"]
    cases = [[hangs], [("vicsek", ""), hangs], [("vicsek", ""), lost], [lost], [("vicsek", "")]]
    trials = [
        kinematic(
            "test",
            1,
            [
                dataclasses.replace(group(law, 9 if len(named) == 1 else 4, name=f"g{k}"), law_source=source)
                for k, (law, source) in enumerate(named)
            ],
            steps=20,
            world="unbounded",
            synchronous=synchronous,
        )
        for named in cases
    ]
    rows = batch(tmp_path / "run", numbered(trials))
    hung = f"law {hangs[0]!r} did not return within 2 s of processor time for"
    gave = (
        f"law {lost[0]!r} returned kind {int(Kind.VELOCITY)}, x nan, y 0 for member 6 at step 3; "
        "expected a kind of 0 to 5 and finite numbers"
    )
    # of two groups with four members each, the sixth member of the herd is the second of the second group
    assert [row.reason for row in rows] == [f"{hung} g0-6 at step 3", f"{hung} g1-2 at step 3", gave, gave, ""]
    assert [row.status for row in rows] == [*["failed"] * 4, "done"]


def robots(law: tuple[str, str] | None = None) -> Trial:
    """Six Creates that update at 0, 0.1, 0.2 … s."""
    base = plan("detection-case-study", repeats=1).trials[1]
    changed = dataclasses.replace(base.groups[0], setup={"phase": "together", "rate_hz": 10.0}, pipeline="perfect")
    if law is not None:
        changed = dataclasses.replace(changed, law=law[0], law_source=law[1], law_parameters={})
    return dataclasses.replace(base, setup={"duration_s": 0.5}, groups=(changed,))


def test_of_a_batch_of_robots(tmp_path: Path, laws: dict[str, tuple[str, str]]) -> None:
    hangs, lost = laws["hangs"], laws["lost"]
    trials = [robots(hangs), robots(lost), robots()]
    names = [f"{trial.groups[0].name}-6" for trial in trials]
    rows = batch(tmp_path / "run", numbered(trials))
    assert rows[0].reason == f"law {hangs[0]!r} did not return within 2 s of processor time for {names[0]} at 0.20 s"
    assert rows[1].reason.startswith(f"law {lost[0]!r} returned kind {int(Kind.VELOCITY)}, x nan")
    assert rows[1].reason.endswith(f"for {names[1]} at 0.20 s")
    assert [row.status for row in rows] == ["failed", "failed", "done"]


@pytest.mark.parametrize("kind", ["kinematic", "robots"])
def test_what_is_compiled_in_a_trial_does_not_count(tmp_path: Path, kind: str) -> None:
    """The import of the kernel and a robot's first detection take longer than a law may, and do not end the trial."""
    assert slow_trials.SLOW_S > LIMIT_S
    trials = {"kinematic": kinematic("test", 1, [group("vicsek", 9)], steps=20), "robots": robots()}
    (row,) = batch(tmp_path / "run", [trials[kind]], run=slow_trials.run, warm=False)
    assert (row.status, row.reason) == ("done", "")
