"""Walls one cell thin, as those of grid maps: their boxes stay inside of what is occupied, and leave no face bare."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
import shapely

from generation.environment import Environment
from generation.plans import outlines
from generation.primitives import Polygon
from worlds.assemble import specification
from worlds.walls import walls_of

ROUNDING_M = 1e-3
"""Within which the walls take two places for one."""


@pytest.mark.parametrize("cell_m", [0.02, 0.05, 0.1, 0.3])
def test_boxes_of_thin_walls_stay_in_them_and_fill_their_faces(cell_m: float) -> None:
    rng = np.random.default_rng(5)
    for turn in rng.uniform(-math.pi, math.pi, 4):
        occupied = rng.random((9, 9)) < rng.uniform(0.1, 0.5)
        occupied[2, 2:7] = occupied[2:7, 2] = True  # a corner of two walls, one cell thin
        back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        environment = Environment(outlines.polygons(occupied, lambda cells, back=back: cell_m * cells @ back, "map"))
        model = specification(walls_of(environment), (), (), np.empty((0, 3)), 0.01).compile()
        boxes = shapely.union_all(_footprints(model))
        solid = _filled(environment)
        assert shapely.difference(boxes, solid.buffer(ROUNDING_M)).area < 1e-9
        for face in environment.faces():
            middle = shapely.LineString(face.reshape(2, 2)).interpolate(0.5, normalized=True)
            assert boxes.distance(middle) < ROUNDING_M


def _footprints(model: mujoco.MjModel) -> list[shapely.Polygon]:
    """What each box covers of the floor."""
    found = []
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_BOX):
        w, _, _, z = model.geom_quat[geom]
        heading, (x, y), (half_x, half_y) = 2.0 * math.atan2(z, w), model.geom_pos[geom, :2], model.geom_size[geom, :2]
        c, s = math.cos(heading), math.sin(heading)
        found.append(
            shapely.Polygon(
                [
                    (x + c * a * half_x - s * b * half_y, y + s * a * half_x + c * b * half_y)
                    for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
                ]
            )
        )
    return found


def _filled(environment: Environment) -> shapely.Geometry:
    polygons = [primitive for primitive in environment.workspace if isinstance(primitive, Polygon)]
    solids, holes = (
        shapely.union_all([shapely.Polygon(p.corners_m) for p in polygons if p.free == side])
        for side in ("outside", "inside")
    )
    return shapely.difference(solids, holes)
