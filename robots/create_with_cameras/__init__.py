"""A Create that sees: two offset cameras and an orange cone in place of the laser and the reflective paper."""

from __future__ import annotations

from dataclasses import replace

from robots import eyes
from robots.body import Body, Mount
from robots.create.driven import driven
from robots.create_with_cameras import model

BODY: Body = replace(
    driven(
        model.DIMENSIONS,
        constants=(
            "robots.create_with_cameras.model",
            "robots.eyes",
            "robots.create.model",
            "robots.create.controller",
        ),
    ),
    mounts={"cameras": Mount(eyes.CAMERAS[0], eyes.LENS_HEIGHT)},
    spec=model.spec,
)
