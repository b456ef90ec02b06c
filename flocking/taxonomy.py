"""What a law's file says about its publication: the rows of the two taxonomies, and what had to be filled in.

Source: Fine 2015, tables 3.2 and 3.4; completeness and precision as in sections 3.1 and 3.4.1.

A file whose law has no row in those tables says why in `NO_ROW`: its `TAXONOMY` and `VALIDATION` are then ours. What
else is to be said of the rows stands in `REMARK`.
"""

from __future__ import annotations

from typing import NamedTuple


class Taxonomy(NamedTuple):
    """The row of table 3.2: what a model requires of its members."""

    composition: str
    """`homogeneous` or `heterogeneous`."""
    mobility: str
    """`idealized` or `constrained`."""
    time: str
    """`discrete` or `continuous`."""
    collision_avoidance: str
    """`-`, `member`, `environment` or `all`."""
    identification: bool
    position: bool
    velocity: bool
    orientation: bool


class Validation(NamedTuple):
    """The row of table 3.4: how a model was validated by its authors."""

    method: str
    """Letters of M (mathematical), S (simulation), P (physical), as in `SP`; `-`: nobody has."""
    synchronous: bool
    position: str
    """`global`, `local`, `inferred`, `constant` or `-`."""
    velocity: str
    orientation: str
    environment: str
    """`unbounded free`, `bounded free`, `periodic free`, `bounded obstacles`, `unbounded obstacles` or `-`."""


class Filled(NamedTuple):
    """One thing that the authors (or the document) left undefined or misprinted, and how it is filled here."""

    stage: str
    """`sensing`, `member detection`, `neighbour selection`, `motion computation` or `physical motion`."""
    left_open: str
    reading: str
    misprint: bool = False
    """True where the document prints something that cannot be right and the original's form is used."""


class Herd(NamedTuple):
    """A kinematic herd in which the publication's own numbers make sense."""

    spacing_m: float
    """Members start uniformly at random in a square of this side times the root of their number."""
    speed_m_s: float
    """At the start, along headings drawn uniformly; and the cruising speed towards a way-point."""
    dt_s: float
    """Time between updates."""
    space: str = "unbounded"
    """`unbounded`, `bounded` or `periodic`; the latter two have the starting square's side."""
    leaders: int = 0
    """Members with role 1, for a law that tells leaders or strong members from the others."""
    updating: str = "backward"
    """`backward`: members take up their new velocity and then move by it; `forward`: they move by the old one first."""


USUAL_HERD = Herd(spacing_m=1.0, speed_m_s=1.0, dt_s=0.1)
"""Of a law whose file declares none. A choice."""
