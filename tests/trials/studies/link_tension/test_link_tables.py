"""The published tables of links: their cells, the sums that the text tells, the numbers in the report."""

from __future__ import annotations

import pytest

from flocking.measures.links import Outcomes
from tests.trials.made_up_run import finished
from trials.design import plan
from trials.evidence.claims import published
from trials.simulations.kinematic.lattice_starts import BOTH, POSITION, VELOCITY
from trials.studies.link_tension.claims import ALPHA, PERIODS, STRENGTH, claims

STUDY = "trials.studies.link_tension"


@pytest.mark.parametrize("table", ["table_1", "table_2"])
def test_link_tables_have_the_cells_that_are_measured_and_the_sums_that_the_text_tells(table: str) -> None:
    first, second = published(STUDY, "akama2014", table).values()
    assert set(first) == set(second) == set(Outcomes._fields)
    told = published(STUDY, "akama2014", "simulations")["predicted_broken"][table]
    assert first["broken_broken"] + first["intact_predicted_broken"] == told


def test_the_settings_are_the_published_ones() -> None:
    told, made = published(STUDY, "akama2014", "simulations"), plan("link-tension", repeats=1)
    assert made.conditions["herd.law.range_m"] == told["alpha"]  # in units of d, which is 1 m
    assert made.conditions["formation.strength"] == told["beta"] == told["gamma"]
    values = {row.key: row.value for row in made.parameters}
    assert values["herd.count"] == told["agents"]
    assert values["formation.spacing_m"] == told["stable_distance"]
    assert {ALPHA, STRENGTH} <= {*told["alpha"], *told["beta"]}
    assert len(PERIODS) == len(told["snapshots"]) - 1


def test_every_number_of_the_tables_and_the_text_is_a_number_in_the_report() -> None:
    """Of a run in which no links were counted each table hangs on the first of its counts."""
    run = finished(plan("link-tension", repeats=1).trials, lambda trial: {"links": 261.0}, seed=1)
    found = {(entry.source, entry.quantity.partition(":")[0]): entry for entry in claims(run)}
    told = published(STUDY, "akama2014", "simulations")["predicted_broken"]
    for table, readings in (("table_1", (VELOCITY,)), ("table_2", (POSITION, BOTH))):
        number = table[-1]
        periods = published(STUDY, "akama2014", table)
        for reading in readings:
            note = ", read with velocities below 3 as well" if reading == BOTH else ""
            for part, counted in zip("ab", periods.values(), strict=True):
                entry = found[f"akama2014 table {number} ({part}){note}", f"table {number} ({part}), {reading}"]
                assert [outcome.published for outcome in entry.outcomes] == list(counted.values())
                assert entry.published in counted.values()
                assert isinstance(entry.published, float)
                assert all(str(value) in entry.claim for value in counted.values())
            links = found[f"akama2014 table {number} (a){note}", f"links at t = 0, {reading}"]
            assert links.published == sum(periods["t0_to_t1"].values())
            (broken,) = [e for (_, quantity), e in found.items() if quantity == f"foretold at t = 0, {reading}"]
            assert broken.published == told[table]
