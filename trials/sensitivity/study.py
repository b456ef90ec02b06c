"""A sensitivity analysis from what was asked to what is told: the experiment's own point, the budget, the stages."""

from __future__ import annotations

import dataclasses
import math
import signal
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from trials.batch import folders
from trials.batch.crew import check_main_guard
from trials.batch.folders import write_whole
from trials.design import DEFAULT_SEED, Plan, experiment_names, load, plan
from trials.evidence.claims import Entry
from trials.sensitivity.choices import Choice, choices, reference
from trials.sensitivity.explore import explore, least_points
from trials.sensitivity.ledger import Ledger, opened
from trials.sensitivity.model import Model, Part, judged, read_cells, supplements
from trials.sensitivity.points import StoppedError, refused, run_points
from trials.sensitivity.quantity import lacking, output
from trials.sensitivity.told import SINGLE, Context, told

PROBE, REFERENCE = "probe", "reference"
PROBED_REPEATS = 3
"""Of all cells, run once to see which of them a claim reads: the fewest from which a claim is judged."""
AT_WORK = 0.9
"""Of a budget of time, the part in which trials run: the rest starts workers and plans points. A choice."""
TABLE = "table.txt"


@dataclass(frozen=True)
class Budget:
    """How much may be run: trials, or seconds of wall time."""

    text: str
    trials: int | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class Asked:
    """What a sensitivity analysis is asked for."""

    experiment: str
    budget: Budget
    claim: int | None = None
    """From 1; None: all."""
    keys: tuple[str, ...] | None = None
    """None: all choices that have a range."""
    repeats: int | None = None
    """None: the experiment's own number."""
    seed: int = DEFAULT_SEED


def start(asked: Asked, out: Path | None, jobs: int) -> tuple[str, Path]:
    """Begins an analysis, or goes on with the one in `out`; returns its table and its folder.

    Raises `InputError` for what does not exist or fit, and `StoppedError`, after which it can go on.
    """
    check_main_guard()
    made = plan(asked.experiment, repeats=asked.repeats, seed=asked.seed)
    count = _count(asked, made)
    varied, without = choices(made, asked.keys)
    if not varied:
        raise InputError(f"experiment {made.experiment!r} has no choices with a range: nothing can be varied")
    least = made.repeats * (1 + least_points(len(varied)))
    if asked.budget.trials is not None and asked.budget.trials < least:
        raise _too_small(asked.budget, least, "", len(varied))
    model = Model(asked.experiment, made.repeats, asked.seed, varied)
    kept_as = {
        "experiment": made.experiment,
        "claim": asked.claim,
        "repeats": made.repeats,
        "seed": asked.seed,
        "choices": [[c.key, c.value, c.low, c.high, list(c.names)] for c in varied],
    }
    folders.check_name(out)
    with folders.new_folder(out, f"{made.experiment}-sensitivity") as folder:
        ledger = opened(folder, kept_as)
        if made.repeats == 1:  # before the budget is spent
            print(f"note: {SINGLE}", file=sys.stderr, flush=True)
        try:
            return _run(asked, made, model, count, without, ledger, jobs), folder
        except KeyboardInterrupt:  # between two batches
            stop = StoppedError(signal.SIGINT)
            stop.folder = folder
            raise stop from None
        except StoppedError as stop:
            stop.folder = folder
            raise
        finally:
            ledger.close()


def _run(asked: Asked, made: Plan, model: Model, count: int, without: Sequence[str], ledger: Ledger, jobs: int) -> str:
    own, notes = reference(model.varied), list[str]()
    if asked.claim is not None:
        model = dataclasses.replace(model, claims=(asked.claim,), supplements=supplements(model, asked.claim))
    else:
        model = dataclasses.replace(model, claims=tuple(range(1, count + 1)))
    probe = dataclasses.replace(model, repeats=min(model.repeats, PROBED_REPEATS))
    parts, entries, probed = _ran(probe, ledger, PROBE, own, jobs)
    if asked.claim is None:
        needy = {claim for claim in model.claims if entries[claim - 1].words}
        notes += [f"claim {claim} needs trials of another experiment: --claim {claim} runs them" for claim in needy]
        model = dataclasses.replace(model, claims=tuple(claim for claim in model.claims if claim not in needy))
    rows = {row.index: row for row in ledger.rows(PROBE, 0, [t for part in parts for t in part.trials]).values()}
    model = dataclasses.replace(model, wanted=read_cells(dataclasses.replace(probe, claims=model.claims), parts, rows))
    least = probed + sum(len(part.trials) for part in model.parts(own)) * (1 + least_points(len(own)))
    if asked.budget.trials is not None and asked.budget.trials < least:
        raise _too_small(asked.budget, least, "", len(own))
    _, entries, each = _ran(model, ledger, REFERENCE, own, jobs)
    lacks = {claim: lacking(entries[claim - 1]) for claim in model.claims}
    kept = [claim for claim in model.claims if not lacks[claim]]
    if asked.claim is not None and not kept:
        raise InputError(f"claim {asked.claim} has no quantity that could be varied: {lacks[asked.claim]}")
    if not kept:
        raise InputError(f"experiment {made.experiment!r} has no claim with a quantity that could be varied")
    notes += [f"claim {claim} is left out: {why}" for claim, why in lacks.items() if why]
    model = dataclasses.replace(model, claims=tuple(kept))
    trials = _trials(asked.budget, ledger, probed + each * (1 + least_points(len(own))), jobs, len(own))
    explored = explore(
        lambda stage, points: run_points(model, ledger, stage, points, jobs),
        ledger,
        own,
        [output(entries[claim - 1]) for claim in kept],
        (trials - probed - each) // each,
        model.seed,
        lambda place: _snapped(model.varied, place),
    )
    context = Context(
        model, [entries[claim - 1] for claim in kept], asked.repeats, each, trials, without, refused(ledger), notes
    )
    text = told(context, explored)
    write_whole(ledger.folder / TABLE, f"{text}\n".encode())
    return text


def _ran(model: Model, ledger: Ledger, stage: str, own: Floats, jobs: int) -> tuple[list[Part], list[Entry], int]:
    """The experiment's own point run: its trials, its entries and how many trials it has."""
    parts = model.parts(own)
    run_points(model, ledger, stage, {0: own}, jobs)
    trials = [trial for part in parts for trial in part.trials]
    return parts, judged(parts, ledger.rows(stage, 0, trials)), len(trials)


def _count(asked: Asked, made: Plan) -> int:
    """How many claims the experiment has. Raises `InputError` where it has none, or not the one asked for."""
    if not hasattr(load(asked.experiment), "claims"):
        others = ", ".join(name for name in experiment_names() if hasattr(load(name), "claims"))
        raise InputError(f"experiment {made.experiment!r} has no claims; expected one of {others}")
    entries = judged([Part(asked.experiment, made.trials)], {})
    if asked.claim is not None and not 1 <= asked.claim <= len(entries):
        nearest = min(max(asked.claim, 1), len(entries))
        raise InputError(f"--claim {asked.claim}: {made.experiment} has claims 1 to {len(entries)}; nearest: {nearest}")
    return len(entries)


def _trials(budget: Budget, ledger: Ledger, least: int, jobs: int, factors: int) -> int:
    """The budget in trials, settled once: of a budget of time by how long those at the reference took."""
    before = ledger.settled("budget")
    if before is not None and before["text"] != budget.text:
        raise InputError(
            f"{ledger.folder} was begun with --budget {before['text']}, not {budget.text}; "
            "expected the same command, or another folder"
        )
    if before is not None:
        return int(before["trials"])
    trials, told_s = budget.trials, ""
    if budget.seconds is not None:
        each_s = float(np.mean(ledger.seconds(REFERENCE))) / jobs
        trials = int(AT_WORK * budget.seconds / each_s)
        told_s = f", about {math.ceil(least * each_s / AT_WORK / 60.0)}m"
    assert trials is not None
    if trials < least:
        raise _too_small(budget, least, told_s, factors)
    return int(ledger.settle("budget", {"text": budget.text, "trials": trials})["trials"])


def _too_small(budget: Budget, least: int, told_s: str, factors: int) -> InputError:
    choices = f"{factors} choice{'s' * (factors != 1)}"
    return InputError(
        f"--budget {budget.text}: one screening of {choices} takes at least {least} trials{told_s}; "
        f"expected --budget {least} or more, fewer --keys or fewer --repeats"
    )


def _snapped(varied: Sequence[Choice], place: Floats) -> Floats:
    """The point whose places are those of its values: one place for all that stand for the same name or number."""
    return np.array(
        [
            choice._replace(value=choice.at(float(x))).place() if choice.names or isinstance(choice.value, int) else x
            for choice, x in zip(varied, place, strict=True)
        ]
    )


__all__ = ["Asked", "Budget", "StoppedError", "start"]
