"""Each law's rows of the taxonomies are those that the document prints (`published_tables.toml`)."""

from __future__ import annotations

import tomllib
from collections import Counter
from pathlib import Path

import pytest

from flocking import lawentry, lawsource
from flocking.taxonomy import Taxonomy, Validation

PRINTED = tomllib.loads((Path(__file__).parent / "published_tables.toml").read_text(encoding="utf-8"))
SIGNS, LAWS, WITHOUT_ROW = PRINTED["signs"], PRINTED["laws"], PRINTED["without_row"]["laws"]
REQUIREMENTS, VALIDATION = PRINTED["requirements"]["rows"], PRINTED["validation"]["rows"]
YES = {"✓": True, "-": False}


def rows(printed: list[list[str]]) -> list[tuple[str, list[str]]]:
    """Each law with the cells that are printed for it."""
    return [(law, row[1:]) for row in printed for law in LAWS[row[0]]]


@pytest.mark.parametrize(("law", "cells"), rows(REQUIREMENTS))
def test_table_3_2(law: str, cells: list[str]) -> None:
    printed = Taxonomy(*(SIGNS[sign] for sign in cells[:3]), cells[3].lower(), *(YES[cell] for cell in cells[4:]))
    assert printed == lawentry.module_of(law).TAXONOMY


@pytest.mark.parametrize(("law", "cells"), rows(VALIDATION))
def test_table_3_4(law: str, cells: list[str]) -> None:
    method, synchrony, position, velocity, orientation, environment = (cell.lower() for cell in cells)
    space = environment.removesuffix(" space")
    printed = Validation(method.upper(), YES[synchrony], position, velocity, orientation, space)
    assert printed == lawentry.module_of(law).VALIDATION


def test_each_law_has_a_row_in_both_tables_or_a_reason_why_not() -> None:
    for printed in (REQUIREMENTS, VALIDATION):
        found = [law for law, _ in rows(printed)]
        assert sorted({*found, *WITHOUT_ROW}) == lawsource.names()
        assert not set(found) & set(WITHOUT_ROW)
        twice = {law for law, count in Counter(found).items() if count > 1}
        assert twice == {"szabo"}  # one rule of two publications, whose rows are alike
    assert {row[0] for row in [*REQUIREMENTS, *VALIDATION]} == set(LAWS)
    said = {law: getattr(lawentry.module_of(law), "NO_ROW", "") for law in lawsource.names()}
    assert {law for law, reason in said.items() if reason} == set(WITHOUT_ROW)


def test_the_rows_are_what_the_text_says_of_them() -> None:
    """Sections 3.3.3 and 3.5.2 count in words: heterogeneous, constrained, asynchronous."""
    assert sum(row[1] == "⊞" for row in REQUIREMENTS) == 6
    assert sum(row[2] == "△" for row in REQUIREMENTS) == 8
    assert sum(row[2] == "-" for row in VALIDATION) == 10
