"""A Create that pilots a herd (Fine 2015, section 8.2), as a MuJoCo model: the Create, with two boards about its laser.

The document marks piloting robots "in a way that the target group robots sense them the same as they sensed the
environment". Here they carry a cross of upright boards of what walls are made of, and no reflective paper: detection by
intensity takes them for parts of walls from half a metre on. Detection by shape takes what is as wide and as round as a
Create for one (`sensing.shapes.recognition`), which a cross is not: a square screen as wide as a Create was a member
to it in most scans. Grades of the constants as in `robots.create.model`.
"""

from __future__ import annotations

from math import hypot

from robots.create.model import DECK_HEIGHT, Dimensions, Part
from robots.create.model import DIMENSIONS as CREATE

BOARD_LENGTH = 0.32  # m; ?: the ends stay within the outline
BOARD_THICKNESS = 0.05  # m; ?: at 2 m still wider than the gap between two beams
BOARD_HEIGHT = 0.12  # m; ?: the laser's plane in its upper half, as of the Create's reflective cylinder
BOARD_MASS = 0.035  # kg; ?: a hollow board, about 0.09 m² of cardboard at 0.4 kg/m²
BOARD = (0.8, 0.0)  # white board, as walls are; ?
# How far tyres and caster sink in under their loads, with the boards' inertia in place of the cylinder's
TYRE_MARGIN = 3.01872e-3  # m; D
CASTER_MARGIN = 2.848e-5  # m; D
SILHOUETTE_RADIUS = hypot(BOARD_LENGTH, BOARD_THICKNESS) / 2  # D: of the circle about the cross


def _board(name: str, x: float, y: float) -> Part:
    centre = (0.0, 0.0, DECK_HEIGHT + BOARD_HEIGHT / 2)
    return Part(name, (x, y, BOARD_HEIGHT), centre, BOARD_MASS, BOARD, (0.85, 0.3, 0.25, 1.0))


DIMENSIONS: Dimensions = CREATE._replace(
    name="create-pilot",
    silhouette_radius=SILHOUETTE_RADIUS,
    tyre_margin=TYRE_MARGIN,
    caster_margin=CASTER_MARGIN,
    parts=(
        *(part for part in CREATE.parts if part.name != "sheeting"),
        _board("board_along", BOARD_LENGTH, BOARD_THICKNESS),
        _board("board_across", BOARD_THICKNESS, BOARD_LENGTH),
    ),
)
