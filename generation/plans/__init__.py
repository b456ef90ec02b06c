"""Plans as workspaces: SVG and DXF drawings, and the grid maps of ROS.

A file a format. What a plan shows is the workspace of an environment, or, in an SVG that was exported here, what it
was: the herd's workspace, construct and markers. Metres, world frame, y up.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from flocking.errors import InputError
from generation.checking import checked
from generation.environment import Environment
from generation.plans import dxf, ros_map, svg
from generation.plans.units import Unit

Reader = Callable[[Path, Unit | None], tuple[Environment, list[str]]]
FORMATS: dict[str, Reader] = {".svg": svg.read, ".dxf": dxf.read, ".yaml": ros_map.read, ".yml": ros_map.read}
"""By the end of a file's name: a drawing or map, and the unit that it is given in place of its own."""


def read(path: str | os.PathLike[str], unit: Unit | None = None) -> tuple[Environment, list[str]]:
    """The environment that a plan shows, and lines that tell how it was read, what was left out and what was mended.

    `unit`: what one unit of a drawing is, in place of the drawing's own. Raises `InputError`: for a file of another
    format, one that cannot be read, a drawing without units, and one with nothing in it.
    """
    path = Path(path)
    reader = FORMATS.get(path.suffix.lower())
    if reader is None:
        own = " (of a ROS map, the YAML beside the image)" if path.suffix.lower() in (".png", ".pgm") else ""
        raise InputError(f"{path} is no plan: expected a name that ends in {', '.join(FORMATS)}{own}")
    environment, told = reader(path, unit)
    environment, mended = checked(environment, str(path))
    return environment, told + mended
