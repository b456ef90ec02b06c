"""A Create that others take for a part of a wall: a cross of boards in place of the reflective paper."""

from __future__ import annotations

from robots.body import Body
from robots.create.driven import driven
from robots.create_pilot import model

BODY: Body = driven(
    model.DIMENSIONS,
    constants=("robots.create_pilot.model", "robots.create.model", "robots.create.controller"),
    marked=False,
)
