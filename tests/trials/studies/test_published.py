"""Every study: its published.toml, and that its report holds a number as a number and a claim in its own words."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.trials.made_up_run import MadeUpRun, finished
from trials import design, simulations

ROOT = Path(__file__).parents[3]
STUDIES = sorted(path.parent.name for path in (ROOT / "trials" / "studies").glob("*/__init__.py"))
JUDGED = [name for name in design.experiment_names() if hasattr(design.load(name), "claims")]


def told_by(study: str) -> dict[str, Any]:
    """The content of a study's published.toml."""
    path = ROOT / "trials" / "studies" / study / "published.toml"
    return tomllib.loads(path.read_text(encoding="utf-8"))


def numbers_in(told: Any) -> Iterator[float]:
    """All numbers below a value of a TOML file, and the sums of its tables of numbers."""
    if isinstance(told, dict):
        if all(isinstance(value, int) for value in told.values()):
            yield float(sum(told.values()))
        for value in told.values():
            yield from numbers_in(value)
    elif isinstance(told, list):
        for value in told:
            yield from numbers_in(value)
    elif isinstance(told, int | float):
        yield float(told)


def claims_in(told: dict[str, Any]) -> list[str]:
    """The words of all claims."""
    return [
        claim for source in told.values() for table in source.values() if "claims" in table for claim in table["claims"]
    ]


@pytest.mark.parametrize("study", STUDIES)
def test_every_source_is_named_and_every_claim_has_its_section(study: str) -> None:
    for source in told_by(study).values():
        assert source["source"]
        for table in source.values():
            if "claims" in table:
                assert len(table["claims"]) == len(table["sections"]) > 0
                assert all([*table["claims"], *table["sections"]])


@pytest.mark.parametrize("study", STUDIES)
def test_every_study_has_a_page_that_names_its_experiments(study: str) -> None:
    text = (ROOT / "docs" / f"{study}.md").read_text(encoding="utf-8")
    for name, module in design.experiments().items():
        if module.split(".")[-2] == study:
            assert f"herd run {name}" in text


@pytest.fixture(autouse=True)
def _no_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Away from any runs that a study could find beside its own."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", JUDGED)
def test_a_number_is_a_number_and_a_claim_is_in_the_words_of_its_publication(name: str) -> None:
    """Words that are not the publication's claims tell a number: the entry must then hold it."""
    module = design.load(name)
    told = told_by(module.__name__.split(".")[-2])
    trials = design.plan(name, repeats=3).trials
    measures = dict.fromkeys(simulations.measures_of(trials), 0.5)
    entries = module.claims(finished(trials, lambda trial: measures, seed=1, spread=0.01))
    assert entries
    for entry in entries:
        assert entry.claim
        if isinstance(entry.published, str):
            assert entry.published == entry.claim
            assert entry.claim.removesuffix(": left open") in {c.removesuffix(": left open") for c in claims_in(told)}
        else:
            assert entry.published in set(numbers_in(told))
            assert f"{entry.published:g}" in entry.claim
        plain = entry.as_json()
        assert json.loads(json.dumps(plain, allow_nan=False)) == plain
        assert plain["published"] == entry.published
        assert plain["claim"] == entry.claim


@pytest.mark.parametrize("name", JUDGED)
@pytest.mark.parametrize("planned", [None, 2])
def test_a_run_that_has_not_begun_is_undecided(name: str, planned: int | None) -> None:
    """Whether all of its trials or a few are to come."""
    run = MadeUpRun(design.plan(name, repeats=1).trials[:planned], [])
    entries = design.load(name).claims(run)
    assert {entry.agrees for entry in entries} <= {None}
    assert all(math.isnan(entry.measured) for entry in entries)


def test_no_placeholder_is_left_in_the_docs() -> None:
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        assert "TRIALS-" + "OUTPUT" not in text, page
        assert "SPEED-" + "TABLE" not in text, page
    assert "| verdict |" in (ROOT / "docs/detection.md").read_text(encoding="utf-8")
