"""The iRobot Create (first generation) with a laptop and a laser on it, wrapped in reflective paper."""

from __future__ import annotations

from robots.body import Body
from robots.create import model
from robots.create.driven import driven

BODY: Body = driven(
    model.DIMENSIONS,
    constants=("robots.create.model", "robots.create.controller", "robots.create.odometry"),
)
