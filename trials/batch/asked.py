"""What a run of an experiment is asked to do, and the plan that comes of it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from flocking.errors import InputError
from flocking.lawentry import is_path
from trials import simulations
from trials.batch.deciding import NO_BUDGET, Budget
from trials.design import DEFAULT_SEED, Plan, load, plan
from trials.evidence.looks import planned_looks
from trials.invoked import spelled
from trials.keys import AVOIDS
from trials.types import Trial


@dataclass(frozen=True)
class Asked:
    """What a run is asked to do."""

    experiment: str
    repeats: int | None = None
    """None: the experiment's own number."""
    seed: int = DEFAULT_SEED
    settings: dict[str, Any] = field(default_factory=dict)
    sweep: dict[str, list[Any]] = field(default_factory=dict)
    law: str | None = None
    pipeline: str | None = None
    body: str | None = None
    only: tuple[int, ...] | None = None
    """Trials from 1, in order; None: all."""
    record: str | None = None
    """None: as the experiment says."""
    scans: str = "some"
    until_decided: bool = False
    """Whether repeats are added in blocks of `repeats` until each claim is decided."""
    budget: Budget = NO_BUDGET
    world: str | None = None

    def command(self) -> str:
        """The command that plans the same trials, whichever of them it then runs."""
        words = ["herd", "run", self.experiment]
        if self.repeats is not None:
            words += ["--repeats", str(self.repeats)]
        if self.seed != DEFAULT_SEED:
            words += ["--seed", str(self.seed)]
        for name in ("law", "pipeline", "body", "world"):
            if getattr(self, name) is not None:
                words += [f"--{name}", getattr(self, name)]
        for key, value in self.settings.items():
            words += ["--set", f"{key}={spelled(value)}"]
        for key, values in self.sweep.items():
            words += ["--sweep", f"{key}={','.join(map(spelled, values))}"]
        if self.until_decided:
            words += ["--until-decided", *(["--budget", str(self.budget)] if self.budget != NO_BUDGET else [])]
        return shlex.join(words)


def planned(asked: Asked) -> tuple[Plan, list[Trial]]:
    """The plan, and those of its trials that are asked for.

    Raises `InputError` for anything that does not exist or fit.
    """
    made = plan(
        asked.experiment,
        repeats=looks_of(asked)[-1] if asked.until_decided else asked.repeats,
        seed=asked.seed,
        settings=asked.settings,
        sweep=asked.sweep,
        law=asked.law,
        pipeline=asked.pipeline,
        body=asked.body,
        world=asked.world,
        most_by="--budget" if asked.until_decided else "--repeats",
    )
    if asked.scans == "all" and not any(simulations.of(trial).has_scans for trial in made.trials):
        raise InputError(f"--scans all: {made.experiment} has no lasers; expected an experiment on robots")
    for trial in made.trials:
        simulations.check(trial)
    if asked.only is None:
        return made, made.trials
    if not 1 <= asked.only[0] <= asked.only[-1] <= len(made.trials):
        raise InputError(f"--only {ranges(asked.only)!r}: expected trials from 1 to {len(made.trials)}")
    return made, [made.trials[index - 1] for index in asked.only]


def looks_of(asked: Asked) -> tuple[int, ...]:
    """Repeats at each look of a run until decided. Raises `InputError` where there is nothing to decide."""
    module = load(asked.experiment)
    if asked.only is not None:
        raise InputError("--until-decided with --only: claims need all trials of their cells; expected one of the two")
    if not hasattr(module, "claims"):
        raise InputError(
            f"--until-decided: experiment {asked.experiment!r} has no claims; expected --repeats N, or an experiment "
            "with claims"
        )
    return planned_looks(asked.repeats or module.REPEATS, asked.budget.repeats)


def record_of(experiment: str) -> str:
    """Which trials of an experiment are recorded where the user does not say."""
    return str(getattr(load(experiment), "RECORD", "all"))


def users_laws(asked: Asked) -> list[str]:
    """The paths of the users' law files that are asked for."""
    swept = {**{key: [value] for key, value in asked.settings.items()}, **asked.sweep}
    laws = [asked.law, *(value for key, values in swept.items() if key.endswith(".law") for value in values)]
    names = [law.removesuffix(AVOIDS) for law in laws if isinstance(law, str)]
    return list(dict.fromkeys(filter(is_path, names)))


def ranges(indices: Sequence[int], between: str = ",") -> str:
    """Whole numbers in short: 1-4,9."""
    parts: list[list[int]] = []
    for index in sorted(indices):
        if parts and index == parts[-1][1] + 1:
            parts[-1][1] = index
        else:
            parts.append([index, index])
    return between.join(str(a) if a == b else f"{a}-{b}" for a, b in parts)
