"""The claims' verdicts on made-up runs in which the truth is laid down."""

from __future__ import annotations

import dataclasses
import json
import math
import sys
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))
from made_up_run import MadeUpRun, made_up_run

from trials.evidence.claims import Entry, published
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.detection.claims import claims
from trials.studies.detection.conditions import KEYS

SWEEP = (0.0, 0.2, 0.3, 0.5, 1.0, 2.0, 5.6)
IDEAL = (0.0, 0.35, 0.5, 1.0)


def as_published(pipeline: str, exclusion: float) -> dict[str, float]:
    """A world in which the case study's claims are true (but for what no world can have, see below)."""
    sensor = pipeline == "sensor-based"
    snn = 0.6
    if sensor:
        snn = 0.99 if exclusion == 0.0 else 0.3 if exclusion < 1.0 else 0.45
    if pipeline == "member-extrapolated":
        snn = 0.6
    if exclusion > 1.0:
        snn = 0.99
    return {
        "effective_snn_share": snn,
        "effective_ha_share": 1.0 - snn,
        "effective_snn_share_late": snn,
        "effective_snn_share_tight": snn,
        "effective_snn_share_wide": snn,
        "acts_as_snn_share": snn,
        "acts_as_snn_share_late": snn,
        "reverted_share": 0.2 if sensor else 0.6,
        "perpendicular_share": 0.3,
        "ha_share": 1.0 - snn,
        "straightness": 0.8,
        "smoothness": {"member-based": 0.02, "member-extrapolated": 0.04, "sensor-based": 0.2}.get(pipeline, 0.02),
        "smoothness_approach": 0.01,
        "way_point_variance": 1.0,
        "way_point_bearing_variance": 0.3,
        "fn_share": 0.05 if sensor else 0.2,
        "fn_beam_share": 0.1,
        "fp_update_share": 0.3 if sensor else 0.05,
        "fp_beam_share": 0.1,
        "seen_distance_q25": 0.8,
        "seen_distance_q50": 1.1,
        "seen_distance_q75": 1.6,
        "inputs_per_update": 40.0 if sensor else 2.0,
        "one_member_share": 0.5,
    }


def all_alike(pipeline: str, exclusion: float) -> dict[str, float]:
    return as_published("member-based", min(exclusion, 1.0)) | {"acts_as_snn_share": 0.6}


def opposite(pipeline: str, exclusion: float) -> dict[str, float]:
    """Each claim's clear contrary."""
    sensor = pipeline == "sensor-based"
    snn = {"member-based": 0.1, "perfect-members": 0.1, "member-extrapolated": 0.6}.get(pipeline, 0.9)
    snn += 0.05 * exclusion if not sensor else -0.2 * exclusion
    if pipeline == "member-based":
        snn += 0.4 * exclusion
    if sensor:
        snn = 0.9 if exclusion else 0.8
    published_values = as_published(pipeline, min(exclusion, 1.0))
    return published_values | {
        "effective_snn_share": snn,
        "effective_ha_share": 1.0 - snn,
        "effective_snn_share_late": snn,
        "acts_as_snn_share": snn,
        "acts_as_snn_share_late": snn,
        "reverted_share": 0.9 if sensor else 0.1,
        "smoothness": {"member-based": 0.2, "member-extrapolated": 0.1, "sensor-based": 0.02}.get(pipeline, 0.2),
        "fn_share": 0.3 if sensor else 0.1,
        "fp_update_share": 0.02 if sensor else 0.2,
        "seen_distance_q50": 2.0 if sensor else 1.1,
    }


def judged(law: Any, ideal: Any = None, sweep: Any = None, **changes: Any) -> list[Entry]:
    supplements = {
        "detection-ideal": ideal
        and made_up_run(
            ideal,
            21,
            ("perfect-members", "perfect-readings", "perfect", "member-based", "member-extrapolated", "sensor-based"),
            IDEAL,
        ),
        "detection-exclusion-sweep": sweep and made_up_run(sweep, 12, exclusions=SWEEP),
    }

    def find(run: Run, experiment: str, arm: Mapping[str, Any], besides: Collection[str]) -> Cells:
        found = supplements[experiment]
        if found is None:
            raise UndecidedError(f"needs trials of {experiment}")
        return Cells(found.trials, found.rows(), KEYS)

    return claims(made_up_run(law, **changes), find)


def verdicts(entries: list[Entry]) -> list[bool | None]:
    return [entry.agrees for entry in entries]


def test_each_claim_holds_where_it_is_true() -> None:
    """Claim 12 apart: extrapolated cannot follow sensor-based's change and also be member-based's equal,
    unless there is no change; claim 9 needs a distance at which all three are alike."""

    def alike_at_a_diameter(pipeline: str, exclusion: float) -> dict[str, float]:
        return as_published("member-based" if exclusion in (0.2, 0.3) else pipeline, exclusion)

    found = verdicts(judged(as_published, ideal=all_alike, sweep=alike_at_a_diameter))
    assert found[:11] == [True] * 11
    assert found[11] is None
    assert found[12] is True
    assert verdicts(judged(as_published, repeats=42))[11] is False


def test_seven_repeats_are_too_few_to_refute_many_outcomes_on_shares_near_a_bound() -> None:
    """Of seven repeats the sign test's smallest p-value is 2 / 2^7 = 0.016, and claim 12 has seven outcomes."""
    seven, many = (judged(as_published, repeats=repeats)[11] for repeats in (7, 42))
    assert "exact sign tests" in seven.test
    assert (seven.agrees, many.agrees) == (None, False)


def test_a_difference_that_may_be_too_small_to_count_does_not_hold_yet() -> None:
    """Claim 7 wants the extrapolated way-points less smooth by a tenth at least."""

    def hardly(pipeline: str, exclusion: float) -> dict[str, float]:
        rough = {"member-based": 0.100, "member-extrapolated": 0.105}
        return as_published(pipeline, exclusion) | {"smoothness": rough.get(pipeline, 0.2)}

    assert judged(hardly)[6].agrees is False  # a ratio of 1.05, and above 1
    assert judged(hardly, spread=0.2)[6].agrees is None


def test_the_power_at_seven_repeats_is_told() -> None:
    entries = judged(as_published, repeats=42, spread=0.15)
    for number in (2, 12):  # many outcomes, each to lie within a narrow margin
        entry = entries[number - 1]
        assert 0.0 <= entry.power < 0.2
        assert f"7 repeats show it in {100 * entry.power:.0f} % of runs" in entry.test
        assert entry.as_json()["power"] == entry.power
    assert judged(as_published)[5].power > 0.99  # claim 6: all alike but for a hundredth


def test_claim_12_holds_where_nothing_changes() -> None:
    assert verdicts(judged(all_alike))[11] is True


def test_each_claim_fails_where_its_contrary_is_true() -> None:
    found = verdicts(judged(opposite, ideal=opposite, sweep=opposite, repeats=42))
    assert found == [False] * 13


def test_noise_that_hides_everything_decides_nothing() -> None:
    found = verdicts(judged(all_alike, ideal=all_alike, sweep=all_alike, spread=0.0, repeats=2))
    assert [found[k] for k in (1, 2, 3, 5, 6, 7, 9, 10, 11, 12)] == [None] * 10


def test_what_the_63_cannot_decide_is_undecided_without_supplements() -> None:
    entries = judged(as_published)
    for number in (1, 5, 9):
        assert entries[number - 1].agrees is None
        assert "needs trials of detection-" in entries[number - 1].test
        assert math.isnan(entries[number - 1].measured)


def test_entries_carry_the_claims_words_and_json_keys() -> None:
    entries = judged(as_published)
    table = published("trials.studies.detection", "fine2015", "detection_case_study")
    assert [entry.published for entry in entries] == table["claims"]
    for entry in entries:
        told = entry.as_json()
        assert list(told)[:10] == [
            "source",
            "quantity",
            "published",
            "measured",
            "low",
            "high",
            "n",
            "agrees",
            "test",
            "margin",
        ]
        assert "NaN" not in json.dumps(told, allow_nan=False)
        if entry.agrees is not None:
            assert entry.low <= entry.measured <= entry.high
            assert entry.n == 7


def test_ratios_are_shown_as_ratios() -> None:
    entry = judged(as_published)[6]
    assert entry.measured == pytest.approx(2.0, rel=0.05)  # 0.04 over 0.02, spread of 1 %
    assert entry.margin == pytest.approx(1.1)


def _change(run: MadeUpRun, which: Any, **changes: Any) -> None:
    run.finished = [dataclasses.replace(row, **changes) if which(row) else row for row in run.finished]


def test_a_failed_trial_is_left_out_and_counted() -> None:
    run = made_up_run(as_published)
    _change(run, lambda row: row.index == 1, status="failed", measures={})
    entries = claims(run, _nothing)
    assert entries[1].n == 6  # trial 1 is the first pair of the member-based cells
    assert "1 failed trial left out" in entries[1].test
    assert entries[2].n == 7
    assert "failed" not in entries[2].test


def _nothing(run: Run, experiment: str, arm: Mapping[str, Any], besides: Collection[str]) -> Cells:
    raise UndecidedError(f"needs trials of {experiment}")


def test_an_unfinished_run_decides_only_what_has_run() -> None:
    run = made_up_run(as_published)
    run.finished = [row for row in run.finished if row.conditions["herd.pipeline"] != "sensor-based" or row.index < 30]
    entries = claims(run, _nothing)
    assert entries[1].agrees is True  # member-based alone
    assert entries[2].agrees is None
    assert "have not run" in entries[2].test


def test_a_run_without_a_condition_says_so() -> None:
    entries = claims(made_up_run(as_published, exclusions=(0.5,)), _nothing)
    assert verdicts(entries) == [None] * 3 + [True] + [None] * 3 + [True] + [None] * 5
    assert "herd.law.exclusion_m = 0" in entries[1].test


def test_each_arm_is_judged_apart() -> None:
    arms = [{"herd.sensors": "ideal"}, {"herd.sensors": "harsh"}]
    run = made_up_run(as_published, arms=arms)
    harsh = {trial.index for trial in run.trials if trial.conditions["herd.sensors"] == "harsh"}
    _change(run, lambda row: row.index in harsh, status="failed", measures={})
    entries = claims(run, _nothing)
    assert [entry.arm for entry in entries] == [arms[0]] * 13 + [arms[1]] * 13
    assert entries[1].agrees is True
    assert entries[13 + 1].agrees is None
    assert entries[1].as_json()["arm"] == arms[0]
