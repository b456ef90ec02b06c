"""Link tension, Akama and Naruse 2014: does the index of two members foretell which links of a flock break?

Both simulations of the publication, nine settings each, 100 seeds, with snapshots at t = 0, 1 and 2 s: a lattice of
regular triangles with random velocities below beta, and the lattice shifted by random values below gamma, at rest.
Beside them a third, in which positions and velocities vary: table 2 foretells 227 of 267 links to break, which
equation 8 cannot of members at rest, as there it is positive only where members are nearer than 2 d - r.

Not published, and so choices that a sweep can change: how 100 members are arranged (`formation.arrangement`), the
signs of gamma's shifts (`formation.shifts`), how velocities below beta are distributed (`formation.velocities`), k_p
and k_v (`herd.law.spring_per_s2`, `herd.law.damper_per_s`), the mass (`herd.law.mass`), the time step (`timestep_s`):
`link-tension-choices` puts each to other values. Repeat r has the same numbers drawn in all cells.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.simulations.kinematic.lattice_starts import NAMES
from trials.studies.link_tension.claims import claims
from trials.studies.link_tension.design import with_links
from trials.studies.link_tension.figures import figures
from trials.types import Trial

REPEATS = 100
RECORD = "none"
CONDITIONS = {
    "formation": NAMES,
    "herd.law.range_m": (1.3, 1.6, 1.9),
    "formation.strength": (1.0, 3.0, 5.0),
}
KEY_MEASURES = ("links", "links_foretold", "links_broken", "link_precision", "link_recall")
SOURCES = {
    "herd.count": Parameter("", "Akama and Naruse 2014, section 4.1", published=True),
    "formation.spacing_m": Parameter("m", "Akama and Naruse 2014, section 4.1: d", published=True),
    "steps": Parameter("", "up to the last moment at which links are counted", plausible=()),
}


def base(repeat: int) -> Trial:
    """A hundred members in unbounded space."""
    return trial(
        "link-tension",
        repeat,
        [group("akama-naruse", 100)],
        world="unbounded",
        formation="velocity-variation",
        keeps_way=False,
    )


def finish(trial: Trial) -> Trial:
    """Its links, and its length."""
    return with_links(trial)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
