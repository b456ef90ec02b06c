"""The Pioneer P2-AT8 with the eyes of Kirchner 2006: four driven wheels, bumpers, sonar."""

from __future__ import annotations

from functools import partial

from robots import eyes
from robots.body import Body, Mount
from robots.create import controller, drive
from robots.pioneer import model
from robots.pioneer.fleet import Fleet

BODY: Body = Body(
    name="pioneer",
    radius=model.RADIUS,
    silhouette_radius=eyes.CONE_RADIUS,  # what eyes see of it
    top_speed=model.GEAR.top_speed,
    mounts={
        "cameras": Mount(eyes.CAMERAS[0], eyes.LENS_HEIGHT),
        "sonar": Mount("sonar", model.SONAR_HEIGHT),
    },
    follows=controller.FOLLOWS,
    spec=model.spec,
    fleet=Fleet,
    follow=partial(controller.follow, drive.recorded(model.GEAR)),
    constants=("robots.pioneer.model", "robots.eyes", "robots.create.controller"),
)
