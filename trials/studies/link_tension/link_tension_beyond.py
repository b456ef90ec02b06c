"""The link tension index beyond its publication: other laws with attraction, smaller and larger groups, longer times.

Five laws, each at its own scale, from a lattice of regular triangles at the law's own spacing with random velocities
below its own speed, or three times as fast: Akama and Naruse's springs for comparison, Olfati-Saber's and Tanner's
accelerations, which have a stiffness at rest, and Couzin's headings and OpenSteer's steering, which have none and keep
to a speed of their own or a highest one. 25, 100 and 400 members, 20 seeds.

A unit of time is that in which a member at the herd's own speed passes three spacings: 1 s in the publication. The
index is taken at t = 0 and 1 and held against the links up to four units later, as printed (mass over stiffness is
1 s²) and, where the law has a stiffness, with it. Nothing was published: the report shows precision, recall and
calibration.
"""

from __future__ import annotations

import dataclasses

from trials.studies.link_tension import link_tension
from trials.studies.link_tension.beyond_figures import figures
from trials.studies.link_tension.design import LINKED
from trials.types import Trial

REPEATS = 20
RECORD = "none"
CONDITIONS = {"herd.law": tuple(LINKED), "herd.count": (25, 100, 400), "formation.factor": (1.0, 3.0)}
KEY_MEASURES = link_tension.KEY_MEASURES


def base(repeat: int) -> Trial:
    """A lattice in unbounded space."""
    return dataclasses.replace(link_tension.base(repeat), experiment="link-tension-beyond")


finish = link_tension.finish

__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "figures", "finish"]
