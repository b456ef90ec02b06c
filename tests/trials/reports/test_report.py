"""The report of a made-up run: the table, the JSON, the page that loads nothing, the figures."""

from __future__ import annotations

import dataclasses
import json
import re
import sys
import threading
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
import fake_trials
from made_up_run import MadeUpRun, finished, made_up_run
from synthetic import synthetic_result

from flocking.errors import InputError
from trials import design
from trials.batch import runfile, series, store
from trials.batch.store import Row, Store
from trials.evidence.claims import published
from trials.evidence.runs import UndecidedError
from trials.evidence.summary import cells, mean, named, naming
from trials.invoked import command
from trials.reports import figures as draw
from trials.reports import report
from trials.reports.wording import shown_interval, shown_number
from trials.simulations.robots.measures import ABOUT
from trials.studies.detection import claims, figures
from trials.studies.detection.claims import supplement


def _law(pipeline: str, exclusion: float) -> dict[str, float]:
    return dict.fromkeys(ABOUT, 0.5) | {
        "smoothness": 0.1 if pipeline == "member-based" else 0.3,
        "mmd": 1.0 + exclusion,
    }


def _kept(run: MadeUpRun, folder: Path, experiment: str, with_series: int = 0, missing: int = 0) -> Store:
    """A run's folder on disk; the first trials with series, the last ones not run."""
    trials = [trial.as_dict() for trial in run.trials]
    kept = store.create(folder, {"format": runfile.FORMAT, "experiment": experiment, "trials": trials}, {})
    ended = run.finished[: len(run.finished) - missing]
    for trial, row in zip(run.trials, ended, strict=False):
        data = None
        if trial.index <= with_series:
            pipeline = str(trial.conditions["herd.pipeline"])
            result = synthetic_result(seed=trial.index, seconds=6.0, scans="none", pipeline=pipeline)
            data = series.pack(dataclasses.replace(result, trial=trial))
        told = Row(row.index, row.status, row.reason, 1, row.repeat, dict(row.conditions), dict(row.measures))
        fake_trials.keep(kept, told, data, timing={"seconds": 1.0})
    return kept


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """63 made-up trials, one failed for a reason with markup in it; series of the first repeat only."""
    run = made_up_run(_law)
    reason = "law returned <nan> & stopped"
    run.finished[-1] = dataclasses.replace(run.finished[-1], status="failed", reason=reason, measures={})
    path = tmp_path_factory.mktemp("runs") / "detection-case-study" / "001"
    path.parent.mkdir()
    _kept(run, path, "detection-case-study", with_series=9).close()
    return path


@pytest.fixture(autouse=True)
def _experiment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The reports' wiring apart from the experiments' files, and away from any real runs."""
    monkeypatch.chdir(tmp_path)
    module = SimpleNamespace(claims=claims.claims, figures=figures.figures)
    known: dict[str, Any] = {"detection-case-study": module}
    monkeypatch.setattr(report, "_experiment", lambda name, path: known.get(name))


class _Page(HTMLParser):
    """Collects the addresses that a page would load, its figures and its text."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href", "data")]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_holds_everything_and_loads_nothing(folder: Path) -> None:
    report.report(folder)
    html = (folder / "report.html").read_text(encoding="utf-8")
    page = _Page()
    page.feed(html)
    assert all(address.startswith(("#", "data:image/png;base64,")) for address in page.addresses)
    assert not re.search(r"url\((?!#)|@import", html)
    assert {"script", "link", "iframe", "object"}.isdisjoint(page.tags)
    assert page.tags.count("figure") == 5  # claims, inputs, trajectories, formations, measures
    assert page.tags.count("svg") == 4
    assert "law returned <nan> & stopped" in page.text  # as text, not as markup
    assert "with perfect sensing the behaviours" in page.text
    assert {path.stem for path in (folder / "figures").iterdir()} == {
        "claims",
        "inputs",
        "trajectories",
        "formations",
        "measures",
    }


@pytest.mark.parametrize("columns", [80, 120])
def test_the_table_fits_the_terminal_and_the_page_is_ever_the_same(
    folder: Path, columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    page = folder / "report.html"
    before = page.read_bytes() if page.exists() else None
    told = report.report(folder)
    assert before in (None, page.read_bytes())
    assert max(len(line) for line in told.splitlines() if not line.startswith("  ")) <= columns  # commands are whole
    words = " ".join(told.split())
    assert "62 of 63 trials done, 1 failed" in words
    assert "trial 63 failed: law returned <nan> & stopped" in words
    for verdict in ("holds", "does not hold", "undecided"):
        assert verdict in words


def test_json_is_a_list_of_the_claims(folder: Path) -> None:
    told = json.loads(report.report(folder, as_json=True))
    assert len(told) == 13
    assert {entry["agrees"] for entry in told} <= {True, False, None}
    smooth = told[6]
    assert smooth["agrees"] is True
    assert smooth["measured"] == pytest.approx(3.0, rel=0.05)  # 0.3 over 0.1, spread of 1 %
    assert smooth["low"] < smooth["measured"] < smooth["high"]


def test_an_experiment_without_claims_reports_its_measures(tmp_path: Path) -> None:
    _kept(made_up_run(_law, repeats=3), tmp_path / "run", "of-another-version").close()
    told = report.report(tmp_path / "run")
    assert "member-based" in told
    assert "27 of 27 trials done" in told
    entries = json.loads(report.report(tmp_path / "run", as_json=True))
    assert len(entries) == 9 * len(ABOUT)
    assert (tmp_path / "run" / "report.html").is_file()


def test_an_unfinished_run_is_reported_as_such(tmp_path: Path) -> None:
    _kept(made_up_run(_law), tmp_path / "run", "detection-case-study", missing=63).close()
    told = report.report(tmp_path / "run")
    assert "0 of 63 trials done, 63 have not run" in told
    assert "0 hold, 0 do not hold, 13 undecided" in told


def test_the_commands_told_are_of_the_run_that_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    place = tmp_path / "my runs" / "001"
    place.parent.mkdir()
    _kept(made_up_run(_law), place, "detection-case-study", missing=1).close()
    told = report.report(place)
    again = command("report", str(place))
    lines = told.splitlines()
    assert f"  {command('run', 'detection-ideal')}" in lines  # each command whole, on a line of its own
    assert lines[lines.index("and then:") + 1] == f"  {again}"
    assert lines[lines.index("finish it with:") + 1] == f"  {command('resume', str(place))}"
    assert "'" in again  # the space in its path is quoted


def test_a_run_of_a_users_own_experiment_says_how_to_have_its_claims(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    _kept(made_up_run(_law, repeats=3), tmp_path / "run", "my-own").close()
    assert command("report", str(tmp_path / "run"), "--experiment", "FILE.py") in report.report(tmp_path / "run")


def test_an_arm_has_figures_of_its_own_named_by_what_was_varied(tmp_path: Path) -> None:
    run = made_up_run(_law, repeats=2, arms=[{"herd.law": "/far/away/mine.py"}, {"herd.law": "snn"}])
    run.finished = []
    made = figures.figures(run, tmp_path)
    assert len(made) == 6
    assert {figure.title for figure in made if "Trajectories" in figure.title} == {
        "Trajectories: mine.py",
        "Trajectories: snn",
    }
    assert len({figure.path for figure in made}) == 6
    assert all(figure.path.is_file() for figure in made)


def test_two_reports_at_once_see_whole_figures_alone(tmp_path: Path) -> None:
    """While one process writes a figure, another reads the one before, or the new one, but no part of it."""

    def drawn() -> Path:
        canvas = draw.measures_by_cell(found, ["mmd"], ABOUT)
        return draw.save(canvas, tmp_path, "measures", "", "").path

    found, seen = cells(made_up_run(_law, repeats=3), ABOUT), set[bytes]()
    first = drawn()
    whole, stop = first.read_bytes(), threading.Event()

    def read() -> None:
        while not stop.is_set():
            seen.add(first.read_bytes())

    reader = threading.Thread(target=read)
    reader.start()
    for _ in range(5):
        drawn()
    stop.set()
    reader.join()
    assert seen == {whole}


def test_measures_are_drawn_over_what_was_varied() -> None:
    """A condition that some cells lack is the axis of the others; those are levels, and nothing is put at its rank."""
    run = made_up_run(_law, repeats=3, pipelines=("member-based",))
    other = made_up_run(_law, repeats=3, pipelines=("sensor-based",), exclusions=(0.5,))
    other.trials = [dataclasses.replace(t, conditions={"herd.law": "/far/mine.py"}) for t in other.trials]
    other.finished = [dataclasses.replace(row, conditions={"herd.law": "/far/mine.py"}) for row in other.finished]
    found = [*cells(run, ABOUT), *cells(other, ABOUT)]
    (axis,) = draw.measures_by_cell(found, ["mmd"], ABOUT).axes
    assert axis.get_xlabel() == "exclusion_m"
    line, level = axis.get_lines()
    assert line.get_xdata().tolist() == pytest.approx([0.0, 0.5, 1.0])
    assert level.get_ydata() == pytest.approx([mean(found[-1], "mmd").measured] * 2)
    assert axis.get_legend_handles_labels()[1] == ["member-based", "mine.py"]
    (axis,) = draw.measures_by_cell([found[0], found[-1]], ["mmd"], ABOUT).axes  # nothing numeric has two values
    assert [label.get_text() for label in axis.get_yticklabels()] == ["member-based, exclusion_m 0", "mine.py"]


def test_conditions_are_named_by_as_much_as_tells_them_apart() -> None:
    both = {"herd.speed_m_s": 0.2, "pursuer.speed_m_s": 0.3, "herd.law": "snn", "pursuer.law": "vicsek"}
    assert named(both) == "herd.speed_m_s 0.2, pursuer.speed_m_s 0.3, herd.law snn, pursuer.law vicsek"
    words = naming([both, {"synchronous": True}])
    assert words({"pursuer.speed_m_s": 0.3}) == "pursuer.speed_m_s 0.3"  # among all conditions of the run
    assert words({"synchronous": True}) == "synchronous true"
    laws = [{"herd.law": path} for path in ("/a/mine.py", "/b/mine.py", "/b/yours.py+", "snn")]
    assert [naming(laws)(each) for each in laws] == ["a/mine.py", "b/mine.py", "yours.py+", "snn"]
    assert named({"herd.law": "/a/mine.py"}) == "mine.py"


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError):
        report.report(tmp_path)


def test_supplements_must_have_the_settings_of_the_run(tmp_path: Path) -> None:
    main = made_up_run(_law)
    main.folder = tmp_path / "detection-case-study" / "001"
    with pytest.raises(UndecidedError, match="needs trials of detection-ideal") as told:
        supplement(main, "detection-ideal", {}, ("herd.sensors",))
    assert told.value.words == ("run", "detection-ideal")
    main.trials = [
        dataclasses.replace(t, groups=tuple(dataclasses.replace(g, count=4) for g in t.groups)) for t in main.trials
    ]
    with pytest.raises(UndecidedError) as told:  # with the settings of the run, by which its claims are judged
        supplement(main, "detection-ideal", {}, ("herd.sensors",))
    assert told.value.words == ("run", "detection-ideal", "--set", "herd.count=4")
    main = dataclasses.replace(made_up_run(_law), folder=main.folder)
    ideal = made_up_run(_law, pipelines=("perfect", "member-based"), repeats=3, experiment="detection-ideal")
    ideal.trials = [
        dataclasses.replace(t, groups=tuple(dataclasses.replace(g, setup={"sensors": "ideal"}) for g in t.groups))
        for t in ideal.trials
    ]
    (tmp_path / "detection-ideal").mkdir()
    _kept(ideal, tmp_path / "detection-ideal" / "001", "detection-ideal").close()
    found = supplement(main, "detection-ideal", {}, ("herd.sensors",))
    assert len(found.trials) == 18
    with pytest.raises(UndecidedError, match=r"herd\.sensors.* = "):
        supplement(main, "detection-ideal", {}, ())
    given = main.trials
    narrow = {"sensors.view_deg": 150.0}
    main.trials = [dataclasses.replace(t, groups=(dataclasses.replace(t.groups[0], setup=narrow),)) for t in given]
    with pytest.raises(UndecidedError, match=r"herd\.sensors\.view_deg = 150.*have 240"):
        supplement(main, "detection-ideal", {}, ("herd.sensors",))
    main.trials = [dataclasses.replace(t, formation="split-group") if t.repeat == 2 else t for t in given]
    with pytest.raises(UndecidedError, match=r"formation of repeat 2 = split-group.*have single-group"):
        supplement(main, "detection-ideal", {}, ("herd.sensors",))


def test_a_cell_is_its_repeats() -> None:
    run = made_up_run(_law, repeats=5)
    run.finished[0] = dataclasses.replace(run.finished[0], status="failed", measures={})
    found = cells(run, ABOUT)
    assert [(cell.planned, cell.failed, cell.done) for cell in found] == [(5, 1, 4)] + [(5, 0, 5)] * 8
    assert mean(found[2], "mmd").measured == pytest.approx(2.0, rel=0.03)  # standard error 0.5 %
    assert named(found[1].conditions) == "member-based, exclusion_m 0.5"


def test_numbers_are_shown_in_three_digits() -> None:
    nan = float("nan")
    numbers = {1.0: "1.00", 0.12345: "0.123", 123.4: "123", -0.05: "-0.0500", 0.0: "0.00", 2e-5: "2.00e-05"}
    assert {value: shown_number(value) for value in numbers} == numbers
    assert shown_number(nan) == "-"
    assert shown_interval(nan, 1.0) == ""
    assert shown_interval(0.0, 1.0) == "[0.00, 1.00]"


def test_a_published_number_is_a_number_in_json_and_stands_in_words_before_the_reader(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "_experiment", lambda name, path: design.load(name))
    monkeypatch.setenv("COLUMNS", "160")
    run = finished(design.plan("lch-table-4-1", repeats=3).trials, lambda trial: {"mmd_end": 0.05}, seed=1, spread=0.01)
    _kept(run, tmp_path / "run", "lch-table-4-1").close()
    first, *_, last = json.loads(report.report(tmp_path / "run", as_json=True))
    table = published("trials.studies.crowded_horizon", "fine2015", "table_4_1")
    assert first["published"] == table["single_group"]["group_pose"]
    assert first["claim"].endswith(f"range 3: {first['published']:g}")
    assert last["published"] == last["claim"]
    told = report.report(tmp_path / "run")
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    for entry in (first, last):
        assert entry["claim"] in told
        assert entry["claim"] in page
