"""`herd laws`: every law is in both tables, what was filled in is marked and described, one law is shown in full."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from flocking import lawentry, lawsource
from flocking.parameters import declared
from trials.commands import cli, lawtables

LAWS = lawsource.names()


def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *words: str) -> str:
    monkeypatch.setattr(sys, "argv", ["herd", *words])
    assert cli.main() == 0
    return capsys.readouterr().out


def test_both_tables_hold_every_law_as_its_file_has_it() -> None:
    required, validated, _ = lawtables.tables()
    assert [row[0] for row in required.rows] == [row[0] for row in validated.rows] == LAWS
    for name, one, other in zip(LAWS, required.rows, validated.rows, strict=True):
        law = lawentry.module_of(name)
        assert one[1:5] == tuple(law.TAXONOMY[:4])
        assert [cell == "yes" for cell in one[5:9]] == list(law.TAXONOMY[4:])
        assert (other[1], other[2] == "yes", *other[3:7]) == tuple(law.VALIDATION)


def test_what_was_left_open_is_marked_by_stage_and_told() -> None:
    required, _, filled = lawtables.tables()
    for row in required.rows:
        told = [line for line in filled.rows if line[0] == row[0]]
        law = lawentry.module_of(row[0])
        assert len(told) == len(law.FILLED)
        for entry in law.FILLED:
            assert entry.stage in lawtables.STAGES
            assert ("!" if entry.misprint else lawtables.STAGES[entry.stage]) in row[-1]
            assert any(entry.reading == line[3] and entry.left_open in line[2] for line in told)
        assert bool(row[-1]) == bool(told)


def test_rows_of_ours_are_marked_and_what_the_files_remark_is_printed(capsys, monkeypatch) -> None:
    printed = run(capsys, monkeypatch, "laws")
    for name in LAWS:
        law = lawentry.module_of(name)
        ours = getattr(law, "NO_ROW", "")
        rows = [line for line in printed.splitlines() if line.split()[:1] == [name] and len(line.split()) > 5]
        marked = [line for line in rows if line.endswith(f" {lawtables.OURS}")]
        assert len(marked) == (2 if ours else 0), name
        for said in (ours, getattr(law, "REMARK", "")):
            if said:
                assert f"  {name}: {said}" in printed
                assert said in lawtables.one_law(name)
        assert ("not in table 3.2" in lawtables.one_law(name)) == bool(ours)


@pytest.mark.parametrize("name", LAWS)
def test_one_law_in_full(name: str) -> None:
    law = lawentry.module_of(name)
    text = lawtables.one_law(name)
    assert text.startswith(law.__doc__.strip())
    for part in (*declared(law.Parameters), *lawentry.sets_of(law), *law.RULES, *(f.reading for f in law.FILLED)):
        assert part in text
    assert "on Creates" in text


def test_the_command_prints_tables_or_one_law(capsys, monkeypatch) -> None:
    tables = run(capsys, monkeypatch, "laws")
    assert "Table 3.2" in tables
    assert "Table 3.4" in tables
    assert max(len(line.split()) for line in tables.splitlines()) > 8
    told = tables.partition("Completeness")[2].splitlines()
    assert max(map(len, told)) <= lawtables.PLAIN_WIDTH
    assert set(told) >= {name for name in LAWS if lawentry.module_of(name).FILLED}, "a heading for each law"
    one = run(capsys, monkeypatch, "laws", "extended_hamilton")
    assert "exclusion_m" in one
    assert "algorithm 2" in one


@pytest.mark.parametrize(("width", "word"), [(150, "homogeneous"), (80, "homo.")])
def test_a_terminal_is_drawn_a_table_a_line_a_law(width: int, word: str, monkeypatch) -> None:
    shown = lawtables.tables()[:2]
    plain = lawtables.printed(shown)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", str(width))
    drawn = lawtables.printed(shown)
    assert "─" in drawn
    assert "─" not in plain
    assert "homogeneous" in plain
    head = lawtables.remarks().splitlines()[0]
    lines = drawn.partition(head)[0].splitlines()
    assert len(lines) < len(drawn.splitlines())
    assert any(word in line for line in lines)
    for name in LAWS:
        assert sum(f" {name} " in f" {line} " for line in lines) == 2
    assert not any("…" in line for line in lines), "nothing is cut"
    assert len([line for line in lines if line.strip()]) < 2 * len(LAWS) + 12, "a line a law beside heads and legend"


def test_a_users_own_file(tmp_path: Path, capsys, monkeypatch) -> None:
    path = tmp_path / "mine.py"
    source = Path(lawentry.module_of("snn").__file__).read_text()
    path.write_text(source.replace("Simple nearest neighbour", "My neighbour"))
    assert "My neighbour" in run(capsys, monkeypatch, "laws", str(path))
    path.write_text("def law(:\n")
    monkeypatch.setattr(sys, "argv", ["herd", "laws", str(path)])
    assert cli.main() == 2
    said = capsys.readouterr().err
    assert "mine.py" in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("kind", ["selections", "formations"])
def test_the_list_has_selections_and_formations(kind: str, capsys, monkeypatch) -> None:
    text = run(capsys, monkeypatch, "list", kind)
    assert {"selections": "k-nearest", "formations": "split-group"}[kind] in text
    assert all(len(line.split("  ", 1)) == 2 for line in text.strip().splitlines()), "each with a line about it"
