"""A Create that pilots a herd (Fine 2015, section 8.2), as a MuJoCo model: the Create, with a screen about its laser.

The document marks piloting robots "in a way that the target group robots sense them the same as they sensed the
environment". Here they carry a square screen of what walls are made of, and no reflective paper: from half a metre on
detection by intensity takes them for walls. Detection by shape does not: it takes anything as wide as a Create for one
(`sensing.shapes.recognition`), and this screen in 0.73 to 0.99 of the scans from 0.5 to 3 m. So a herd that pilots
guide needs another detection. Grades of the constants as in `robots.create.model`.
"""

from __future__ import annotations

from robots.create.model import DECK_HEIGHT, Dimensions, Part
from robots.create.model import DIMENSIONS as CREATE

SCREEN_SIDE = 0.23  # m, of the square; ?: its corners stay within the outline
SCREEN_HEIGHT = 0.12  # m; ?: the laser's plane in its upper half, as of the Create's reflective cylinder
SCREEN_MASS = 0.05  # kg; ?: about 0.11 m² of cardboard at 0.4 kg/m²
SCREEN = (0.8, 0.0)  # white board, as walls are; ?
# How far tyres and caster sink in under their loads, with the screen's inertia in place of the cylinder's
TYRE_MARGIN = 3.01862e-3  # m; D
CASTER_MARGIN = 2.848e-5  # m; D
SILHOUETTE_RADIUS = SCREEN_SIDE / 2**0.5  # D: of the circle about the square

DIMENSIONS: Dimensions = CREATE._replace(
    name="create-pilot",
    silhouette_radius=SILHOUETTE_RADIUS,
    tyre_margin=TYRE_MARGIN,
    caster_margin=CASTER_MARGIN,
    parts=(
        *(part for part in CREATE.parts if part.name != "sheeting"),
        Part(
            "screen",
            (SCREEN_SIDE, SCREEN_SIDE, SCREEN_HEIGHT),
            (0.0, 0.0, DECK_HEIGHT + SCREEN_HEIGHT / 2),
            SCREEN_MASS,
            SCREEN,
            (0.85, 0.3, 0.25, 1.0),
        ),
    ),
)
