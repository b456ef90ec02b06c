"""The first moments of a few trials are those of the version before; and the comparison of versions finds what differs.

`same_results.json` is made by `python -m scripts.same_results sample`, and made anew with a change that is meant to
change results. Its kinematic herds are those of version 0.1.0, its robots those since contact does not depend on the
time step.
"""

from __future__ import annotations

import io
import json
import sqlite3
import zipfile
from pathlib import Path

import numpy as np
import pytest

from scripts import same_results

KEPT = json.loads(Path(__file__).with_name("same_results.json").read_text(encoding="utf-8"))
OTHER_CPU = 1e-6
"""Relative: other processors and versions differ in last bits (1e-16), which two seconds of motion enlarge by far less
than a turn into another rule would: that changes shares of some hundred updates by 1e-3."""


def test_the_first_moments_are_those_of_the_version_before() -> None:
    now = same_results.sample()
    assert now["trials"].keys() == KEPT["trials"].keys()
    for name, before in KEPT["trials"].items():
        after = now["trials"][name]
        assert after["measures"] == pytest.approx(before["measures"], rel=OTHER_CPU, abs=OTHER_CPU), name
        if now["made with"] == KEPT["made with"]:
            assert after == before, name


def kept_run(folder: Path, measure: float = 1.0, reading: float = 2.0, **head: object) -> None:
    """A version's results: one experiment with one trial."""
    run = folder / "made-up" / "seed-1"
    (run / "series").mkdir(parents=True)
    (folder / "made-up" / "show.txt").write_text(
        "made-up: a title\n\nparameter  value  unit  source\nherd.count  6  robots  published  its words\n"
    )
    with sqlite3.connect(run / "results.sqlite") as tables:
        tables.execute("CREATE TABLE trials (idx, status, reason, seed, repeat, conditions, measures)")
        tables.execute("INSERT INTO trials VALUES (1, 'done', '', 1, 1, '{}', ?)", (json.dumps({"mmd": measure}),))
    tables.close()
    array = io.BytesIO()
    np.lib.format.write_array(array, np.array([reading]))
    with zipfile.ZipFile(run / "series" / "0001.npz", "w") as archive:
        archive.writestr("result.json", json.dumps({"format": 1, "outcome": "done", **head}))
        archive.writestr("times.npy", array.getvalue())


def test_equal_results_are_the_same(tmp_path: Path) -> None:
    kept_run(tmp_path / "before")
    kept_run(tmp_path / "after")
    assert same_results.compare(tmp_path / "before", tmp_path / "after") == []


def test_what_only_the_new_version_has_is_told_as_added(tmp_path: Path) -> None:
    kept_run(tmp_path / "before")
    kept_run(tmp_path / "after", period_m=1.0)
    (line,) = same_results.compare(tmp_path / "before", tmp_path / "after")
    assert line.startswith(same_results.ADDED)
    assert "period_m" in line


def test_a_last_bit_is_a_difference_in_a_row_and_in_a_series(tmp_path: Path) -> None:
    kept_run(tmp_path / "before")
    kept_run(tmp_path / "row", measure=float(np.nextafter(1.0, 2.0)))
    kept_run(tmp_path / "series", reading=float(np.nextafter(2.0, 3.0)))
    kept_run(tmp_path / "head", outcome="failed")
    for name, told in (("row", "row 1"), ("series", "times.npy"), ("head", "outcome")):
        (line,) = same_results.compare(tmp_path / "before", tmp_path / name)
        assert told in line
        assert not line.startswith(same_results.ADDED)
