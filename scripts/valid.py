"""Finds the environments in which tables 7.3 and 7.4 are tried: `python -m scripts.valid`.

For each behaviour it goes through the first `MOST` environments that pass, and prints that in which kinematic members
of BOIDS show the behaviour in most of `STARTS` starts, with the shares of all three laws there. BOIDS decides, since
the other laws do in these environments what they do in the empty plane.
"""

from __future__ import annotations

import dataclasses
from functools import partial

from trials import simulations
from trials.studies.environments import tried
from trials.studies.environments.design import LAWS
from trials.types import with_setup

STARTS = 20
MOST = 60
"""Environments that are gone through."""
DECIDES = LAWS[0]


def main() -> None:
    """Prints for each behaviour the number and its shares."""
    for behaviour in tried.BEHAVIOURS:
        number = max(range(1, MOST + 1), key=partial(share, behaviour, DECIDES))
        print(f"{behaviour}: environment {number}, shares { ({law: share(behaviour, law, number) for law in LAWS}) }")


def share(behaviour: str, law: str, number: int) -> float:
    """Share of the starts in which the members of a law show the behaviour in the environment of that number."""
    made = tried.of_kinematic("maebe-members", 1)
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
