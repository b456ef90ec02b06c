"""A smaller, slower Create, which was never built: for herds of two kinds."""

from __future__ import annotations

from robots.body import Body
from robots.create.driven import driven
from robots.create_small import model

BODY: Body = driven(model.DIMENSIONS, constants=("robots.create_small.model", "robots.create.controller"))
