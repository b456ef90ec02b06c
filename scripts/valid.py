"""Finds the environments in which tables 7.3 and 7.4 are tried: `python -m scripts.valid`.

For each behaviour it goes through the environments that pass, in their order, and prints the first in which kinematic
members under all three laws show the behaviour in most of `STARTS` starts.
"""

from __future__ import annotations

import dataclasses

from trials import simulations
from trials.studies.environments import tried
from trials.studies.environments.design import LAWS
from trials.types import with_setup

STARTS = 10
MOST = 60
"""Environments that are gone through."""


def main() -> None:
    """Prints for each behaviour the number and its shares, or the best that there is."""
    for behaviour in tried.BEHAVIOURS:
        best: tuple[float, int, dict[str, float]] = (-1.0, 0, {})
        for number in range(1, MOST + 1):
            shares = {law: share(behaviour, law, number) for law in LAWS}
            best = max(best, (min(shares.values()), number, shares), key=lambda entry: entry[0])
            if best[0] > 0.5:
                break
        print(f"{behaviour}: environment {best[1]}, shares {best[2]}")


def share(behaviour: str, law: str, number: int) -> float:
    """Share of the starts in which the members of a law show the behaviour in the environment of that number."""
    made = tried.of_kinematic("valid", 1)
    (group,) = made.groups
    made = with_setup(
        dataclasses.replace(made, groups=(dataclasses.replace(group, law=law),)), {"behaviour": behaviour}
    )
    found = [
        simulations.run_trial(tried.members(dataclasses.replace(made, repeat=repeat), number), reraise=True)
        for repeat in range(1, STARTS + 1)
    ]
    return sum(result.measures["elicited"] for result in found) / STARTS


if __name__ == "__main__":
    main()
