"""The bench runs and says what it measured. No test depends on how fast anything is."""

from __future__ import annotations

import dataclasses
import json
import math
import time
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.errors import InputError
from flocking.kinematic import plain
from trials.commands import bench, bench_eyes, bench_figures, bench_kinematic, bench_legs, bench_validation


def test_every_measure_gives_finite_figures_that_are_saved_and_compared(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for part in (bench, bench_figures):
        monkeypatch.setattr(part, "REPEATS", 1)
    monkeypatch.setattr(bench, "SECONDS", 0.5)
    monkeypatch.setattr(bench, "RECORDED_SECONDS", 1.0)
    monkeypatch.setattr(bench, "BATCH_SECONDS", 1.0)
    monkeypatch.setattr(bench, "BATCH_TRIALS", 6)
    monkeypatch.setattr(bench, "BATCHES", 1)
    monkeypatch.setattr(bench_eyes, "SECONDS", 0.3)
    monkeypatch.setattr(bench_eyes, "CALLS", 1)
    monkeypatch.setattr(bench_validation, "ENVIRONMENTS", 10)
    monkeypatch.setattr(bench, "GROUP_SIZES", (2, 4))
    monkeypatch.setattr(bench, "LARGE", 8)
    monkeypatch.setattr(bench_kinematic, "SIZES", (100, 200))
    monkeypatch.setattr(bench_kinematic, "STEPS", 1)
    monkeypatch.setattr(bench_legs, "HERD", 8)
    monkeypatch.setattr(bench_legs, "SIZES", (2, 4))
    whole = bench.guided_trial()
    assert [group.count for group in whole.groups] == [4, 6]
    short = dataclasses.replace(whole, setup={**whole.setup, "duration_s": 1.0})
    monkeypatch.setattr(bench, "guided_trial", lambda: short)
    left_out = (bench.start_up, bench.whole_experiment)
    monkeypatch.setattr(bench, "MEASURES", [m for m in bench.MEASURES if m not in left_out])
    saved = tmp_path / "bench.json"
    bench.bench(save=saved)
    figures = json.loads(saved.read_text())
    assert len(figures) > 15
    assert all(math.isfinite(run) for figure in figures for run in figure["runs"])
    assert {figure["met"] for figure in figures} <= {True, False, None}
    medians = {figure["name"]: figure["median"] for figure in figures}
    assert len(medians) == len(figures)  # a saved figure is found again by its name
    assert medians["rays"] * medians["rays of a scan"] == pytest.approx(682)
    assert medians["beams off by more than 1 cm"] <= 0.2
    assert medians["8 one-legged robots"] > 0.0
    assert medians["a trial of piloting, 4 robots and 6 pilots"] > 0.0
    assert medians["8 robots, built and measured too"] > 0.0  # of a run of its own: single runs are not compared
    monkeypatch.setattr(bench, "MEASURES", [bench.laser])  # a comparison sets saved figures beside whatever is measured
    bench.bench(compare=saved)
    assert "before" in capsys.readouterr().out


def test_what_one_process_does_is_timed_without_waiting_and_what_others_do_with_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert bench_figures.processor_s(lambda: time.sleep(0.2)) < 0.1
    assert bench_figures.wall_s(lambda: time.sleep(0.2)) >= 0.2
    monkeypatch.setattr(bench, "repeated", lambda *_: (1.0,))
    timed = [figure.name for figure in (*bench.start_up(), *bench.whole_experiment())]
    assert all("wall time" in name for name in timed)


def test_the_flock_rewritten_in_arrays_moves_as_the_law_says() -> None:
    band, state, dt = bench_kinematic.small_flock()
    ours = bench_kinematic.numpy_step(state, band.law.parameters({}), dt)
    theirs = plain.step([band], state, [np.zeros((bench_kinematic.SMALL, 0))], dt)
    assert (ours.positions != state.positions).all()
    # other sums in another order: some ten units of rounding of coordinates up to a hundred metres
    assert_allclose(ours.positions, theirs.positions, rtol=0.0, atol=1e-12)
    assert_allclose(ours.velocities, theirs.velocities, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("text", ["", "[1]", "{}x", '[{"name": 1}]'])
def test_a_file_that_is_no_bench_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bench.json"
    path.write_text(text)
    with pytest.raises(InputError, match="no saved bench"):
        bench.bench(compare=path)


def test_a_file_that_cannot_be_written_is_refused_before_anything_is_measured(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot save"):
        bench.bench(save=tmp_path / "missing" / "bench.json")
