"""`herd laws`: what the laws' files say of their publications, in the tables of Fine 2015, and one law in full.

Completeness (section 3.1) is whether every stage of a law is defined; precision whether what is printed can be right.
Where a law's file fills in what was left open, its row has the letter of the stage; the text below the tables says how.
"""

from __future__ import annotations

import sys
import textwrap
from collections import Counter
from collections.abc import Sequence
from types import ModuleType
from typing import NamedTuple

from flocking import lawentry, lawsource, selection
from flocking.parameters import declared
from flocking.perception import Step
from flocking.taxonomy import Filled, Taxonomy, Validation
from sensing.pipelines import INFERRED, OF_ITSELF, all_pipelines, given_by

STAGES = {
    "sensing": "S",
    "member detection": "D",
    "neighbour selection": "N",
    "motion computation": "M",
    "physical motion": "P",
}
METHODS = {"M": "mathematical", "S": "simulation", "P": "physical"}
NONE = "-"
REMARKS = {"NO_ROW": "no row there", "REMARK": "remark"}
"""What a law's file may say of its rows, and what it is called here."""
OURS = "*"
"""In the last column: the row is ours."""
LEGEND = (
    "open: what the authors left undefined, by stage (S sensing, D member detection, N neighbour selection, "
    "M motion computation, P physical motion); !: misprints of the document. How each is filled: below."
)

PLAIN_WIDTH = 100
"""Characters of a line where there is no terminal."""
SHORT = {
    "homogeneous": "homo.",
    "heterogeneous": "hetero.",
    "idealized": "ideal",
    "constrained": "constr",
    "discrete": "discr",
    "continuous": "cont.",
    "environment": "envir.",
    "position": "pos.",
    "velocity": "vel.",
    "orientation": "orient.",
    "synchronous": "sync.",
    "mobility": "moves",
    "unbounded free": "unb. free",
    "unbounded obstacles": "unb. obst.",
    "bounded obstacles": "b. obst.",
    "bounded free": "b. free",
    "periodic free": "per. free",
}
"""Short words for terminals that are narrower than the tables."""


class Table(NamedTuple):
    """Rows of text below a row of headings."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]


def tables(names: Sequence[str] = ()) -> list[Table]:
    """Tables 3.2 and 3.4 of Fine 2015 for the laws that there are, and what their files filled in."""
    laws = {name: lawentry.module_of(name) for name in names or lawsource.names()}
    return [
        Table(
            "Table 3.2: what a law requires of its members",
            ("law", "group", "mobility", "time", "avoids", "id", "position", "velocity", "orientation", "open"),
            [(name, *_taxonomy(getattr(law, "TAXONOMY", None)), _open(law)) for name, law in laws.items()],
        ),
        Table(
            "Table 3.4: how a law was validated by its authors",
            ("law", "method", "synchronous", "position", "velocity", "orientation", "environment", "open"),
            [(name, *_validation(getattr(law, "VALIDATION", None)), _open(law)) for name, law in laws.items()],
        ),
        Table(
            "Completeness and precision: what was left open or misprinted, and how it is filled here",
            ("law", "stage", "left open", "filled by"),
            [
                (name, filled.stage, f"{'misprint: ' if filled.misprint else ''}{filled.left_open}", filled.reading)
                for name, law in laws.items()
                for filled in filled_in(law)
            ],
        ),
    ]


def filled_in(law: ModuleType) -> tuple[Filled, ...]:
    """What a law's file fills in of what its publication left open or misprinted."""
    return tuple(getattr(law, "FILLED", ()))


def remarks(names: Sequence[str] = ()) -> str:
    """Why the rows of some laws are ours, and what else their files say of their rows; a line each."""
    laws = {name: lawentry.module_of(name) for name in names or lawsource.names()}
    ours = [f"  {name}: {law.NO_ROW}" for name, law in laws.items() if hasattr(law, "NO_ROW")]
    others = [f"  {name}: {law.REMARK}" for name, law in laws.items() if hasattr(law, "REMARK")]
    parts = [f"{OURS}: the document's tables have no such row; it is ours", *ours] if ours else []
    return "\n".join([*parts, *(["remarks", *others] if others else [])])


def one_law(name: str) -> str:
    """A law in full. Raises `InputError`; a user's own file is checked first."""
    name = name.removesuffix("+")
    if lawentry.is_path(name):
        from trials.commands.lawcheck import check

        check(name)
    law = lawentry.module_of(name)
    parts = [(law.__doc__ or "").strip()]
    creates = getattr(law, "CREATE", {})
    rows = [
        (
            d.name,
            _number(d.default),
            _number(creates[d.name]) if d.name in creates else "",
            d.about.unit,
            "published" if d.about.published else "chosen",
            d.about.source,
        )
        for d in declared(law.Parameters).values()
    ]
    if rows:
        head = ("parameter", "value", "for Creates", "unit", "", "source")
        parts.append(plain(Table("", head, rows)))
    sets = lawentry.sets_of(law)
    width = max(map(len, sets))
    parts.append("\n".join(["sets of neighbours", *(f"  {one:{width}}  {text}" for one, text in sets.items())]))
    facts = [
        ("needs", ", ".join(sorted(lawentry.needs_of(law))) or NONE),
        ("and its selections", ", ".join(sorted(_of_selections(law))) or NONE),
        ("on Creates", _on_creates(law)),
        ("rules", ", ".join(getattr(law, "RULES", ("law",)))),
        ("remembers", f"{getattr(law, 'MEMORY', 0)} numbers"),
        ("draws", f"{getattr(law, 'DRAWS', 0)} random numbers a call"),
    ]
    if getattr(law, "CHIRAL", False):
        facts.append(("chiral", "a mirrored world does not mirror its motion"))
    if getattr(law, "AXIS", False):
        facts.append(("axis", "it moves along the world's x axis only"))
    herd = getattr(law, "HERD", None)
    if herd is not None:
        facts.append(
            (
                "kinematic herd",
                f"{herd.spacing_m:g} m a member, {herd.speed_m_s:g} m/s, {herd.dt_s:g} s a step, {herd.space}"
                + f", updated {herd.updating}"
                + (f", {herd.leaders} of role 1" if herd.leaders else ""),
            )
        )
    taxonomy, validation = getattr(law, "TAXONOMY", None), getattr(law, "VALIDATION", None)
    if taxonomy is not None:
        facts += zip(("group", "mobility", "time", "avoids"), _taxonomy(taxonomy)[:4], strict=True)
        required = [field for field in taxonomy._fields[4:] if getattr(taxonomy, field)]
        facts.append((f"requires ({_table(law, '3.2')})", ", ".join(required) or NONE))
    if validation is not None:
        methods = ", ".join(METHODS.get(letter, NONE) for letter in validation.method)
        facts.append((f"validated ({_table(law, '3.4')})", methods))
        facts.append(("synchronous", "yes" if validation.synchronous else "no"))
        facts += [(field, getattr(validation, field)) for field in validation._fields[2:]]
    facts += [(words, getattr(law, name)) for name, words in REMARKS.items() if hasattr(law, name)]
    parts.append(plain(Table("", ("", ""), facts)).strip("\n"))
    if filled_in(law):
        lines = [
            f"- {filled.stage}{' (misprint)' if filled.misprint else ''}: {filled.left_open}; here: {filled.reading}"
            for filled in filled_in(law)
        ]
        parts.append("\n".join(["left open or misprinted", *lines]))
    return "\n\n".join(parts)


def plain(table: Table) -> str:
    """A table for a file or a pipe: aligned columns, a line for each row."""
    lines = [table.head, *table.rows] if any(table.head) else table.rows
    widths = [max(len(line[column]) for line in lines) for column in range(len(table.head))]
    text = ["  ".join(f"{cell:{w}}" for cell, w in zip(line, widths, strict=True)).rstrip() for line in lines]
    return "\n".join([table.title, *text] if table.title else text)


def paragraphs(table: Table, width: int) -> str:
    """A table of long texts: its first column as headings, the rest of each row wrapped beneath them."""
    lines, before = [table.title], ""
    for name, stage, left_open, filled in table.rows:
        if name != before:
            lines += ["", name]
            before = name
        for text, indent in ((f"{stage}: {left_open}", "  "), (f"here: {filled}", "      ")):
            lines += textwrap.wrap(text, width, initial_indent=indent, subsequent_indent=indent + "  ")
    return "\n".join(lines)


def printed(shown: Sequence[Table], told: Table | None = None) -> str:
    """Tables for standard output, drawn on a terminal and plain elsewhere; `told` follows in paragraphs."""
    if sys.stdout is None or not sys.stdout.isatty():
        legends = [text for text in (LEGEND, remarks()) if text]
        return "\n\n".join([*map(plain, shown), *legends, *([paragraphs(told, PLAIN_WIDTH)] if told else [])])
    from rich import box
    from rich.console import Console
    from rich.table import Table as Drawn
    from rich.text import Text

    console = Console()
    with console.capture() as capture:
        for table in shown:
            narrow = max(map(len, plain(table).splitlines())) > console.width
            drawn = Drawn(title=Text(table.title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
            drawn.padding = (0, 0) if narrow else (0, 1)
            for column in table.head:
                drawn.add_column(SHORT.get(column, column) if narrow else column)
            for row in table.rows:
                cells = [*row[:-1], row[-1].replace(" ", "")] if narrow else row  # the marks stand side by side
                drawn.add_row(*(Text(SHORT.get(cell, cell) if narrow else cell) for cell in cells))
            console.print(drawn)
        console.print(Text(f"{LEGEND}\n\n{remarks()}"))
        if told:
            console.print(Text(f"\n{paragraphs(told, console.width)}"))
    return capture.get().rstrip("\n")


def _table(law: ModuleType, number: str) -> str:
    """Whose row it is."""
    return f"ours, not in table {number}" if hasattr(law, "NO_ROW") else f"table {number}"


def _taxonomy(row: Taxonomy | None) -> tuple[str, ...]:
    if row is None:
        return (NONE,) * len(Taxonomy._fields)
    return (*row[:4], *("yes" if value else NONE for value in row[4:]))


def _validation(row: Validation | None) -> tuple[str, ...]:
    if row is None:
        return (NONE,) * len(Validation._fields)
    return (row.method, "yes" if row.synchronous else "no", *row[2:])


def _open(law: ModuleType) -> str:
    """Marks of the stages that were left undefined, of misprints, and of rows that are ours."""
    found = filled_in(law)
    counts = Counter(STAGES[filled.stage] for filled in found if not filled.misprint)
    marks = [f"{mark}{counts[mark] if counts[mark] > 1 else ''}" for mark in STAGES.values() if counts[mark]]
    misprints = sum(filled.misprint for filled in found)
    of_row = [OURS] if hasattr(law, "NO_ROW") else []
    return " ".join([*marks, *([f"!{misprints if misprints > 1 else ''}"] if misprints else []), *of_row])


def _of_selections(law: ModuleType) -> frozenset[str]:
    sets = selection.parse_sets("all", lawentry.sets_of(law), declared(law.Parameters))
    return selection.needs(chosen for steps in sets for chosen in steps)


def _on_creates(law: ModuleType) -> str:
    """The pipelines that give what the law needs, alone or with association."""
    sets = selection.parse_sets("all", lawentry.sets_of(law), declared(law.Parameters))
    if any(chosen.step is Step.GRAPH for steps in sets for chosen in steps):
        return "with ids in place of its graph, as in fixed-set(0, 1, 2), and pipeline perfect"
    lacking = (lawentry.needs_of(law) | _of_selections(law)) - OF_ITSELF
    ways = []
    for name, pipeline in sorted(all_pipelines().items()):
        missing = lacking - given_by(pipeline)
        if not missing:
            ways.append(name)
        elif missing <= INFERRED:
            ways.append(f"{name} with association")
    return ", ".join(ways) or NONE


def _number(value: float) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"
