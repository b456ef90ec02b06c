"""`herd import` and `herd export`: plans as environments, environments as drawings, solids and MJCF."""

from __future__ import annotations

import math
import os
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from flocking.errors import InputError
from sensing.camera import opengl

if TYPE_CHECKING:
    from generation.environment import Environment

MOST_TOLD = 12
"""Most lines of what was mended that are printed. A choice."""
EXPORTS = (".svg", ".stl", ".3mf", ".xml", ".png")

Plan = Annotated[Path, Argument(metavar="PLAN", help="An SVG or DXF drawing, or the YAML of a ROS map.")]
EnvironmentFile = Annotated[Path, Argument(metavar="ENVIRONMENT", help="An environment's JSON file, or a plan.")]


def import_(
    plan: Plan,
    out: Annotated[Path, Option(metavar="FILE", help="Where to write the environment: FILE.json.")],
    unit: Annotated[str | None, Option(metavar="U", help="Of a drawing without one: m, cm, mm, in, ft …")] = None,
    scale: Annotated[float | None, Option(metavar="M", help="The same in metres per unit of the drawing.")] = None,
) -> None:
    """Reads a floor plan as an environment.

    Tells what was read and left out and, for a map, how far beams end from where they end in the map.
    """
    from generation import files, plans
    from generation.plans import units

    if unit is not None and scale is not None:
        raise InputError(f"--unit {unit} and --scale {scale:g}: expected one of them")
    _check_new(out, (".json",))
    given = units.named(unit) if unit is not None else units.scaled(scale) if scale is not None else None
    environment, told = plans.read(plan, given)
    _write(out, files.to_json(environment).encode())
    print(f"{plan}: {_counted(environment)}")
    _print_some(told)
    print(_walled(environment))
    print(out)


def export(
    environment: EnvironmentFile,
    out: Annotated[Path, Option(metavar="FILE", help="FILE.svg, .stl, .3mf, .xml for MuJoCo, .png in 3D.")],
    height_m: Annotated[float | None, Option("--height-m", metavar="H", help="Of fences to build (STL, 3MF).")] = None,
    thickness_m: Annotated[float | None, Option("--thickness-m", metavar="T", help="Likewise.")] = None,
) -> None:
    """Writes an environment for drawing programs, for a workshop, for MuJoCo, or as a picture in three dimensions.

    Tells the length of fence that its construct needs.
    """
    from generation import sources

    _check_new(out, EXPORTS)
    given = {"height_m": height_m, "thickness_m": thickness_m}
    options = {name: value for name, value in given.items() if value is not None}
    kind = out.suffix.lower()
    if options and kind not in (".stl", ".3mf"):
        raise InputError(
            f"--{next(iter(options)).replace('_', '-')} is of fences to build: expected --out FILE.stl or .3mf"
        )
    read, told = sources.environment(str(environment))
    _print_some(told)
    if kind == ".svg":
        from generation.exports.svg import to_svg

        _write(out, to_svg(read).encode())
    elif kind == ".xml":
        _write(out, _mjcf(read).encode())
    elif kind == ".png":
        print(_pictured(read, out))
    else:
        print(_built(read, options, out))
    print(_fenced(read))
    print(out)


def _built(environment: Environment, options: dict[str, float], out: Path) -> str:
    """Writes the fences of an environment as a solid, and tells of it."""
    from flocking.parameters import filled
    from generation.exports import fences

    parameters = filled(fences.Parameters, options)
    mesh = fences.solid(fences.to_build(environment), parameters)
    _write(out, fences.to_stl(mesh) if out.suffix.lower() == ".stl" else fences.to_3mf(mesh))
    return (
        f"fences {parameters.height_m:g} m high and {parameters.thickness_m:g} m thick, a closed solid of "
        f"{mesh.volume:.4g} m³ in {len(mesh.faces)} triangles, mm at full size"
    )


def _pictured(environment: Environment, out: Path) -> str:
    """Writes a picture in three dimensions, and tells of its scale."""
    from worlds.picture import picture, scale_of
    from worlds.walls import HEIGHT

    _write(out, picture(environment, opengl.asked_for()))
    scale = scale_of(environment)
    return f"drawn {'as large as it is' if scale == 1.0 else f'at {scale:.3g} of its size'}, fences {HEIGHT:g} m high"


def _mjcf(environment: Environment) -> str:
    """Floor and walls as an MJCF document."""
    import numpy as np

    from worlds.assemble import specification
    from worlds.walls import walls_of

    spec = specification(walls_of(environment), (), (), np.empty((0, 3)), timestep_s=0.01)
    spec.compile()
    return str(spec.to_xml())


def _counted(environment: Environment) -> str:
    """How many primitives of which kinds there are, and of how many pieces."""
    from generation.primitives import kind_of

    kinds = Counter(map(kind_of, environment.primitives))
    parts = [f"{count} {kind}{'s' if count > 1 else ''}" for kind, count in sorted(kinds.items())]
    if environment.markers:
        parts.append(f"markers {', '.join(environment.markers)}")
    return f"{', '.join(parts)}; {len(environment.walls())} straight pieces"


def _walled(environment: Environment) -> str:
    """How long all walls are, and where."""
    walls = environment.walls()
    if len(walls) == 0:
        return "no walls"
    length = math.fsum(math.hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1 in walls.tolist())
    xs, ys = walls[:, 0::2], walls[:, 1::2]
    return f"{length:.2f} m of walls, x {xs.min():.2f} to {xs.max():.2f} m, y {ys.min():.2f} to {ys.max():.2f} m"


def _fenced(environment: Environment) -> str:
    if environment.construct:
        return f"its construct needs {environment.fence_length():.3f} m of fence"
    import dataclasses

    alone = dataclasses.replace(environment, construct=environment.workspace)
    return f"it has no construct: the walls of its workspace are {alone.fence_length():.3f} m of fence"


def _print_some(lines: list[str]) -> None:
    for line in lines[:MOST_TOLD]:
        print(line)
    if len(lines) > MOST_TOLD:
        print(f"and {len(lines) - MOST_TOLD} more lines like these")


def _check_new(out: Path, suffixes: tuple[str, ...]) -> None:
    if out.suffix.lower() not in suffixes:
        raise InputError(f"--out {out}: expected a name that ends in {' or '.join(suffixes)}")
    if os.path.lexists(out):
        raise InputError(f"--out {out}: there is such a file; expected a new one")


def _write(out: Path, data: bytes) -> None:
    from trials.batch.folders import write_whole

    write_whole(out, data)
