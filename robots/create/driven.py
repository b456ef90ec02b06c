"""A Create of given dimensions as a body."""

from __future__ import annotations

from functools import partial

from robots.body import Body, Mount
from robots.create import controller, drive
from robots.create.fleet import Fleet
from robots.create.model import Dimensions, spec


def driven(dimensions: Dimensions, constants: tuple[str, ...], marked: bool = True) -> Body:
    """The body that the Create's code makes of those dimensions; `constants`: the modules that state them.

    `marked`: whether others can tell it as a member.
    """
    return Body(
        name=dimensions.name,
        radius=dimensions.radius,
        silhouette_radius=dimensions.silhouette_radius,
        top_speed=dimensions.gear.top_speed,
        mounts={"laser": Mount("laser", dimensions.laser[2])},
        follows=controller.FOLLOWS,
        spec=partial(spec, dimensions),
        fleet=partial(Fleet, dimensions=dimensions),
        follow=partial(controller.follow, drive.recorded(dimensions.gear)),
        constants=constants,
        marked=marked,
    )
