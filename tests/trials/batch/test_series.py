"""A trial's series: nothing is lost, equal results are equal bytes, damage is reported."""

from __future__ import annotations

import dataclasses
import io
import json
import math
import sys
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking.errors import InputError
from trials.batch import series
from trials.types import TrialResult

sys.path.insert(0, str(Path(__file__).parents[1]))
from synthetic import synthetic_result


@pytest.fixture(scope="module")
def result() -> TrialResult:
    return synthetic_result(seconds=3.0, robots=3)


def assert_equal(a: Any, b: Any) -> None:
    """Equal with types, shapes and bits."""
    if dataclasses.is_dataclass(a):
        for field in dataclasses.fields(a):
            assert_equal(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, np.ndarray):
        assert (a.dtype, a.shape) == (b.dtype, b.shape)
        assert a.tobytes() == b.tobytes()
    elif isinstance(a, float):
        assert a == b or (math.isnan(a) and math.isnan(b))
    else:
        assert a == b


def test_a_result_comes_back_as_it_was_but_for_scans_and_timing(result: TrialResult) -> None:
    back = series.unpack(series.pack(result))
    assert back.scans is None
    assert back.timing == {}
    assert_equal(
        dataclasses.replace(result, scans=None, timing={}, measures={}), dataclasses.replace(back, measures={})
    )
    assert list(back.measures) == list(result.measures)
    np.testing.assert_array_equal(list(back.measures.values()), list(result.measures.values()))


def test_equal_results_are_equal_bytes_whenever_they_are_packed(result: TrialResult) -> None:
    first = series.pack(result)
    time.sleep(2.1)  # times in a zip file have steps of two seconds
    other = dataclasses.replace(result, scans=None, timing={"loop_s": 123.0})
    assert series.pack(other) == first


def test_a_change_of_one_bit_changes_the_bytes(result: TrialResult) -> None:
    poses_w = result.poses_w.copy()
    poses_w[-1, 0, 0] = np.nextafter(poses_w[-1, 0, 0], math.inf)
    assert series.pack(dataclasses.replace(result, poses_w=poses_w)) != series.pack(result)


def test_measures_keep_what_json_has_no_word_for(result: TrialResult) -> None:
    measures = {"a": math.nan, "b": math.inf, "c": -math.inf, "d": 0.1 + 0.2}
    back = series.unpack(series.pack(dataclasses.replace(result, measures=measures))).measures
    assert math.isnan(back["a"])
    assert [back[name] for name in "bcd"] == [math.inf, -math.inf, 0.1 + 0.2]


@pytest.mark.parametrize("period_m", [3.5, math.nan])
def test_the_side_of_a_periodic_world_comes_back(result: TrialResult, period_m: float) -> None:
    packed = series.pack(dataclasses.replace(result, period_m=period_m))
    np.testing.assert_equal(series.unpack(packed).period_m, period_m)


def test_tables_come_back_by_their_names(result: TrialResult) -> None:
    tables = {"fitness": np.array([0.5, np.nan]), "passed": np.array([True, False]), "none": np.empty((0, 4))}
    back = series.unpack(series.pack(dataclasses.replace(result, tables=tables)))
    assert list(back.tables) == list(tables)
    for name, table in tables.items():
        assert_equal(back.tables[name], table)
    assert series.unpack(series.pack(result)).tables == {}


def test_a_file_from_before_there_were_periods_has_none(result: TrialResult) -> None:
    data = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(series.pack(result))) as whole, zipfile.ZipFile(data, "w") as older:
        for name in whole.namelist():
            entry = whole.read(name)
            if name == series.HEAD:
                head = json.loads(entry)
                del head["period_m"]
                entry = json.dumps(head).encode()
            older.writestr(name, entry)
    assert math.isnan(series.unpack(data.getvalue()).period_m)


def test_numpy_reads_it_as_well(result: TrialResult) -> None:
    with np.load(io.BytesIO(series.pack(result))) as archive:
        np.testing.assert_array_equal(archive["poses_w"], result.poses_w)
        np.testing.assert_array_equal(archive["updates.motions"], result.updates.motions)


@pytest.mark.parametrize("keep", [0, 10, 1000, -1])
def test_a_file_cut_short_is_refused_in_one_line(result: TrialResult, keep: int) -> None:
    with pytest.raises(InputError, match="damaged") as caught:
        series.unpack(series.pack(result)[:keep])
    assert "\n" not in str(caught.value)


def test_a_flipped_byte_is_noticed(result: TrialResult) -> None:
    data = bytearray(series.pack(result))
    data[len(data) // 2] ^= 0xFF
    with pytest.raises(InputError, match="damaged"):
        series.unpack(bytes(data))


def test_a_newer_format_says_so(result: TrialResult, monkeypatch: pytest.MonkeyPatch) -> None:
    now = series.FORMAT
    monkeypatch.setattr(series, "FORMAT", now + 1)
    newer = series.pack(result)
    monkeypatch.setattr(series, "FORMAT", now)
    with pytest.raises(InputError, match=f"format {now + 1}: this version reads format {now}"):
        series.unpack(newer)
