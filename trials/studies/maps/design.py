"""The maps of this study: their conditions, and the herd that Fine 2015 names BOIDS in its T-junction.

The publication gives the law and the group sizes of its maps and nothing else; our choices stand in
`trials.simulations.maps.fields.herd`. With them the region of DIRT at anchor four emerged without any tuning.
"""

from __future__ import annotations

from collections.abc import Mapping

from trials.simulations.maps.fields import herd, trial
from trials.types import Trial, Value, with_setup

COUNT, ANCHOR, REFINEMENTS, METHOD, WORLD = "herd.count", "world.anchor", "refinements", "method", "world"
SOLITARY, FEW, MEMBERS = 1, 3, 7
IN_A_LINE = 10
"""Members of figure 7.14, which are to draw themselves into a line."""
SIZES = SOLITARY, FEW, MEMBERS
"""Group sizes at which every map is drawn, beside the one that was published."""
STEPS = 150
"""Of a herd in the T-junction: 15 m, where 8 m lead to the goal line, and 26 m by the end of the other arm."""
GRID = "8, 4"
"""Of DIRT: 45 degrees by 1 m, which six refinements bring down to 0.7 degrees by 1.6 cm."""
PUBLISHED_BOX = {"box.first_low": 200.0, "box.first_high": 250.0, "box.second_low": 2.0, "box.second_high": 3.0}
"""Fine 2015, section 7.4.2: degrees and metres."""


def base(
    experiment: str,
    repeat: int,
    schema: str,
    count: int = MEMBERS,
    formation_parameters: Mapping[str, Value] | None = None,
    **setup: Value,
) -> Trial:
    """A map of a schema for that herd."""
    found = trial(experiment, repeat, [herd(count)], schema, formation_parameters=formation_parameters)
    return with_setup(found, setup)
