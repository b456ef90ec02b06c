"""Draws the starting formations of the detection case study: docs/formations.png.

    python -m scripts.formations

Figure 2.5 of Fine 2015 draws three formations without numbers. The picture shows the project's own versions of them
(worlds/formations.py), with which repeats 1 to 3 of seed 1 start.
"""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.patches import Circle

from robots import body
from trials.design import plan
from trials.simulations.robots.starts import starting_poses
from worlds import corridor

RADIUS = body.load("create").radius
OUT = Path(__file__).parents[1] / "docs" / "formations.png"


def main() -> None:
    """Writes the picture."""
    repeats = {trial.repeat: trial for trial in plan("detection-case-study", repeats=3).trials}
    half_width = corridor.Parameters().width_m / 2
    figure, axes = plt.subplots(len(repeats), 1, figsize=(8.0, 6.4), sharex=True, layout="constrained")
    for axis, trial in zip(axes, repeats.values(), strict=True):
        for x, y, heading in starting_poses(trial):
            axis.add_patch(Circle((x, y), RADIUS, facecolor="#4c8cb5", edgecolor="#1d3f55"))
            tip = 2.0 * RADIUS
            axis.plot([x, x + tip * math.cos(heading)], [y, y + tip * math.sin(heading)], color="#1d3f55")
        for side in (-half_width, half_width):
            axis.axhline(side, color="0.35", linewidth=3)
        axis.set(title=f"{trial.formation} (repeat {trial.repeat})", ylabel="y (m)", aspect="equal", xlim=(-4.5, 4.5))
    axes[-1].set_xlabel("x (m), along the corridor")
    figure.savefig(OUT, dpi=110)


if __name__ == "__main__":
    main()
