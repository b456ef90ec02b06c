"""Picks the elites that are tried with Creates: `python -m scripts.elites RUN > trials/studies/searches/elites.toml`.

RUN is a folder of `herd run optimise`. Of the elites of its archives' trials that are robust on new starts `MOST` are
drawn.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from trials.batch.store import Store, opened
from trials.simulations.searches import fields
from trials.types import Trial

MOST = 24
ARCHIVES = ("cma-me", "map-elites")


def main() -> None:
    """Prints them as TOML."""
    store = opened(Path(sys.argv[1]))
    try:
        archives = [trial for trial in store.trials if fields.of_trial(trial).method in ARCHIVES]
        found = [elite for trial in archives for elite in of_trial(store, trial)]
    finally:
        store.close()
    print("# Walls that searches found robust, by `python -m scripts.elites` from a run of `herd run optimise`: the")
    print("# parameters of dirt, and the robustness on new starts of kinematic members.")
    for number in np.random.default_rng(1).permutation(len(found))[:MOST]:
        angle, length, anchor, robustness = found[number]
        print("\n[[elites]]")
        print(f"angle_deg = {angle:.2f}\nlength_m = {length:.3f}\nanchor = {anchor:.0f}\nrobustness = {robustness:.3f}")


def of_trial(store: Store, trial: Trial) -> list[tuple[float, ...]]:
    """The robust elites of one trial: values of the parameters, and robustness."""
    tables, given = store.series(trial.index).tables, fields.of_search(trial)
    points, anew = tables["parameters"][tables["elites"]], tables["elites_anew"]
    return [(*points[k].tolist(), float(anew[k])) for k in range(len(anew)) if anew[k] >= given.robust_share - 1e-9]


if __name__ == "__main__":
    main()
