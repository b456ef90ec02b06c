"""`herd validate`: environments tried with a group, each beside its empty world on the same starts."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from flocking import lawentry, users_files
from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, filled
from generation import sources
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group
from generation.validation.robustness import Perturbed, Robustness, ranked
from generation.validation.starts import Starts
from generation.validation.uplift import Uplift
from generation.validation.validate import Plan, Validated, overall
from trials.commands import lawcheck
from trials.environments.blocks import USERS_S, robustnesses, validated
from trials.environments.limits import loaded

PREFIXES = ("law", "members", "starts", "behaviour", "robustness")
"""What keys of --set begin with."""
COLUMNS = (
    "environment", "simulations", "fitness", "success", "success_low", "success_high", "control_fitness",
    "control_success", "uplift", "uplift_low", "uplift_high", "p",
)  # fmt: skip
"""Of what is written, a row an environment."""


ROBUSTNESS_COLUMNS = (
    "environment", "perturbed", "simulations", "success", "success_low", "success_high", "control_success", "uplift",
    "uplift_low", "uplift_high", "p",
)  # fmt: skip
"""Of what is written of robustness, a row an environment and kind of perturbation."""
BESIDES = ("reynolds-boids", "viscido-snn")
"""Laws that `--robustness` tries besides; where the first is the group's own, the second."""


class Perturbations(NamedTuple):
    """What `--robustness` changes, besides starts and size."""

    epsilon_m: Annotated[
        float, Parameter("m", "our choice: half a step of Fine 2015's members; how far wall ends move", low=0.0)
    ] = 1.0
    other_law: Annotated[str, Parameter("", "our choice: the law that is tried besides; empty: none")] = BESIDES[0]


@dataclass(frozen=True)
class Asked:
    """What a command asks for."""

    paths: Sequence[Path]
    behaviour: str
    law: str
    members: int
    body: str | None = None
    """Of robots; None = kinematic members."""
    scale: float | None = None
    repeats: int = 1
    seed: int = 1
    mirror: bool = False
    robustness: bool = False
    jobs: int = 1
    out: Path | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)

    def of(self, prefix: str) -> dict[str, Any]:
        """The settings whose keys begin with it, without it."""
        return {key.partition(".")[2]: value for key, value in self.settings.items() if key.partition(".")[0] == prefix}


def validate(asked: Asked) -> None:
    """Tries all environments and prints the table; what is done is written as it comes. Raises `InputError`."""
    from rich.console import Console

    for key in asked.settings:
        if key.partition(".")[0] not in PREFIXES or not key.partition(".")[2]:
            raise unknown_name("key", key, [f"{prefix}." for prefix in PREFIXES])
    if lawentry.is_path(asked.law):
        lawcheck.check(asked.law)
    console = Console()
    with users_files.executed(True):
        behaviour = loaded(asked.behaviour, USERS_S)
        behaviour.filled(asked.of("behaviour"))
        group, starts = group_of(asked, asked.law, asked.members)
        perturbations: Perturbations = filled(Perturbations, asked.of("robustness"), "robustness.")
        paths = _files(asked.paths)
        environments = [_read(path) for path in paths]
        plan = Plan(starts, asked.repeats, asked.mirror, asked.seed)
        given, jobs = asked.of("behaviour"), asked.jobs if asked.body is None else 1
        found: list[Validated] = []
        console.print(f"[dim]{_told(asked, behaviour, len(paths))}[/dim]")
        beside = _beside(asked.out)
        if asked.robustness and beside is not None and beside.exists():
            raise InputError(f"--robustness: there is a file {str(beside)!r}; expected another name for --out")
        with _written(asked.out) as write:
            for one in validated(environments, asked.behaviour, group, plan, given, jobs):
                found.append(one)
                write(row_of(paths[one.number], one))
        _print(console, paths, found)
        if asked.robustness:
            chosen = [(one.number, environments[one.number]) for one in found if one.succeeded.any()]
            others = _others(asked, perturbations)
            robust: list[Robustness] = []
            with _written(beside, ROBUSTNESS_COLUMNS) as write:
                for each in robustnesses(
                    chosen, asked.behaviour, group, plan, perturbations.epsilon_m, others, given, jobs
                ):
                    robust.append(each)
                    for row in rows_of(paths[each.number], each):
                        write(row)
            _print_robustness(console, paths, robust, perturbations)


def group_of(asked: Asked, law: str, members: int) -> tuple[Group, Starts]:
    """The group that is asked for, with another law or size, and how it starts. Raises `InputError`."""
    from trials.commands.validated_groups import group

    return group(
        law, members, asked.of("law"), asked.of("members"), asked.of("starts"), asked.body, asked.scale, asked.jobs
    )


def _others(asked: Asked, perturbations: Perturbations) -> dict[str, Group]:
    """Groups of half and of twice the size, and of the other law."""
    sizes = sorted({max(1, asked.members // 2), 2 * asked.members} - {asked.members})
    found = {f"{size} members": group_of(asked, asked.law, size)[0] for size in sizes}
    other = perturbations.other_law
    if "other_law" not in asked.of("robustness"):
        other = next(law for law in BESIDES if law != asked.law.replace("_", "-"))
    if other:
        found[other] = group_of(_without_law(asked), other, asked.members)[0]
    return found


def _without_law(asked: Asked) -> Asked:
    from dataclasses import replace

    return replace(asked, settings={key: value for key, value in asked.settings.items() if key[:4] != "law."})


def _files(paths: Sequence[Path]) -> list[Path]:
    """The files named, and those of the folders named. Raises `InputError` where there is none."""
    found: list[Path] = []
    for path in paths:
        inside = sorted(path.glob("*.json")) if path.is_dir() else [path]
        if not inside:
            raise InputError(f"folder {str(path)!r} holds no environment; expected files that end in .json")
        found += inside
    return found


def _read(path: Path) -> Environment:
    """The environment of a file, or of a plan. What was mended is said."""
    environment, told = sources.environment(str(path))
    for line in told:
        print(f"herd: {line}", file=sys.stderr)
    return environment


def _told(asked: Asked, behaviour: Behaviour, count: int) -> str:
    several = "s" * (asked.members != 1)
    who = f"kinematic member{several}" if asked.body is None else f"robot{several} ({asked.body})"
    starts = f"{asked.repeats} start{'s' * (asked.repeats > 1)}" + (" and mirror images" if asked.mirror else "")
    return (
        f"{behaviour.name}: {asked.members} {who} of {asked.law}, {behaviour.iterations} iterations, {starts} in each "
        f"of {count} environment{'s' * (count > 1)} and in its empty world"
    )


def row_of(path: Path, one: Validated) -> dict[str, Any]:
    """What is written of an environment."""
    success, uplift = one.rate, one.uplift
    values = (
        str(path), len(one.fitness), float(one.fitness.mean()), success.rate, success.low, success.high,
        float(one.control.mean()), one.control_rate.rate, uplift.uplift, uplift.low, uplift.high, uplift.p,
    )  # fmt: skip
    return dict(zip(COLUMNS, values, strict=True))


def rows_of(path: Path, one: Robustness) -> list[dict[str, Any]]:
    """What is written of an environment's robustness."""
    found = []
    for kind, (success, control, uplift) in one.kinds.items():
        values = (
            str(path), kind, success.n, success.rate, success.low, success.high, control.rate, uplift.uplift,
            uplift.low, uplift.high, uplift.p,
        )  # fmt: skip
        found.append(dict(zip(ROBUSTNESS_COLUMNS, values, strict=True)))
    return found


def _beside(out: Path | None) -> Path | None:
    """Where robustness is written: beside what else is."""
    return None if out is None else out.with_name(f"{out.stem}-robustness{out.suffix}")


@contextmanager
def _written(out: Path | None, columns: Sequence[str] = COLUMNS) -> Iterator[Any]:
    """Writes rows as they come: CSV, or a JSON list where the name ends so. Raises `InputError`."""
    if out is None:
        yield lambda row: None
        return
    if out.suffix not in (".csv", ".json"):
        raise InputError(f"--out {str(out)!r}: expected a name that ends in .csv or .json")
    try:
        file = out.open("x", encoding="utf-8", newline="")
    except FileExistsError:
        raise InputError(f"--out {str(out)!r}: there is such a file; expected a new one") from None
    except OSError as error:
        raise InputError(f"--out {str(out)!r} cannot be written: {error.strerror}") from None
    with file:
        if out.suffix == ".csv":
            table = csv.DictWriter(file, columns)
            table.writeheader()

            def write(row: Mapping[str, Any]) -> None:
                table.writerow(row)
                file.flush()

            yield write
            return
        separator = "[\n"

        def write_json(row: Mapping[str, Any]) -> None:
            nonlocal separator
            file.write(separator + json.dumps(row))
            file.flush()
            separator = ",\n"

        try:
            yield write_json
        finally:
            file.write("[]\n" if separator == "[\n" else "\n]\n")


def named(paths: Sequence[Path]) -> list[str]:
    """What each file is called in a table: its name, with as many of its folders as tell it from the others."""
    absolute = [path.resolve().with_suffix("").parts for path in paths]
    found = []
    for parts in absolute:
        others = [each for each in absolute if each != parts]
        kept = next((n for n in range(1, len(parts)) if all(each[-n:] != parts[-n:] for each in others)), len(parts))
        found.append("/".join(parts[-kept:]))
    return found


def _print(console: Any, paths: Sequence[Path], found: Sequence[Validated]) -> None:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in ("environment", "fitness", "success", "empty world", "uplift", "95 %"):
        table.add_column(column, justify="left" if column == "environment" else "right")
    names = named(paths)
    for one in found:
        uplift = one.uplift
        table.add_row(
            names[one.number],
            f"{one.fitness.mean():.2f}",
            f"{one.succeeded.sum()} of {len(one.succeeded)}",
            f"{one.control_succeeded.sum()} of {len(one.control_succeeded)}",
            f"{uplift.uplift:+.2f}",
            _interval(uplift),
        )
    console.print(table)
    total = overall(found)
    mean = sum(one.rate.rate for one in found) / len(found)
    control = sum(one.control_rate.rate for one in found) / len(found)
    console.print(
        f"uplift {total.uplift:+.3f} ({_interval(total)}): success {mean:.3f} with the constructs, {control:.3f} in "
        "the empty world on the same starts"
    )


def _print_robustness(
    console: Any, paths: Sequence[Path], found: Sequence[Robustness], perturbations: Perturbations
) -> None:
    from rich import box
    from rich.table import Table

    if not found:
        console.print("robustness: no environment elicited the behaviour, so none is perturbed")
        return
    kinds = list(found[0].kinds)
    table = Table(
        title=(
            f"success when perturbed, less that in the empty world; walls by up to {perturbations.epsilon_m:g} m, new "
            "starts throughout; intervals: --out"
        ),
        box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False,
    )  # fmt: skip
    table.add_column("environment")
    for kind in (*kinds, "mean uplift"):
        table.add_column(kind, justify="right")
    names = named(paths)
    for one in ranked(found):
        table.add_row(
            names[one.number], *(_perturbed(one.kinds[kind]) for kind in kinds), f"{one.mean:+.2f}"
        )  # fmt: skip
    console.print(table)


def _perturbed(found: Perturbed) -> str:
    return f"{found.rate.rate:.2f} - {found.control.rate:.2f}"


def _interval(uplift: Uplift) -> str:
    return "-" if uplift.low != uplift.low else f"{uplift.low:+.2f} to {uplift.high:+.2f}"
