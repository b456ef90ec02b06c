"""Fences to build: the construct of an environment as a solid, for STL and 3MF files.

Each wall is the middle of a fence of a thickness and height, standing on the floor. Ends are cut flat, corners mitred,
fences that meet are one. A solid that is closed is what workshops' programs ask for. Millimetres at full size in files:
3MF says so, STL has no unit, and those programs take millimetres for granted.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from typing import Annotated, Any, NamedTuple

import shapely
import trimesh
from lxml import etree

from flocking.errors import InputError
from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import Primitive, places

_MM = 1000.0
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_TYPES = "http://schemas.openxmlformats.org/package/2006/content-types"
_RELATIONS = "http://schemas.openxmlformats.org/package/2006/relationships"
_MODEL = "3D/3dmodel.model"
_STEP_M = 1e-6
"""To which corners are rounded, m, so that no sliver opens the solid. A choice."""
_THICKER_M = (0.0, 1e-5, 3e-5, 1e-4)
"""By how much fences are thicker, m, the first that will do: those that touch in a line are no solid. A choice."""
_MITRE = 5.0
"""How far the point of a sharp corner may stand out, in half thicknesses; sharper ones are cut off. A choice."""


class Parameters(NamedTuple):
    """How fences are built."""

    height_m: Annotated[
        float, Parameter("m", "a choice: the height of walls in the simulation", low=0.001, high=100.0)
    ] = 0.5
    thickness_m: Annotated[
        float, Parameter("m", "a choice: a board that stands", low=0.001, high=10.0)
    ] = 0.02  # fmt: skip


def to_build(environment: Environment) -> tuple[Primitive, ...]:
    """What is built: the construct; the workspace, where there is no construct. Raises `InputError` if neither is."""
    found = environment.construct or environment.workspace
    if not found:
        raise InputError("the environment is empty: expected walls to build")
    return found


def solid(primitives: Iterable[Primitive], parameters: Parameters) -> Any:
    """The closed `trimesh.Trimesh` of fences along primitives, m, standing on z = 0.

    Raises `InputError` where no closed solid comes of them.
    """
    lines = shapely.union_all([shapely.LineString(places(primitive)) for primitive in primitives])
    chains = shapely.line_merge(lines)
    ground = shapely.union_all(
        [
            chain.buffer(parameters.thickness_m / 2.0, cap_style="flat", join_style="mitre", mitre_limit=_MITRE)
            for chain in shapely.get_parts(chains)
        ]
    )
    for more in _THICKER_M:
        wider = ground.buffer(more, join_style="mitre", mitre_limit=_MITRE) if more else ground
        mesh = _extruded(shapely.set_precision(wider, _STEP_M), parameters.height_m)
        if mesh.is_watertight:
            return mesh
    raise InputError("the fences make no closed solid: expected walls farther apart, or another thickness")


def _extruded(ground: Any, height_m: float) -> Any:
    polygons = [polygon for polygon in shapely.get_parts(ground) if polygon.area > 0.0]
    return trimesh.util.concatenate(
        [trimesh.creation.extrude_polygon(polygon, height_m, engine="earcut") for polygon in polygons]
    )


def to_stl(mesh: Any) -> bytes:
    """A binary STL file of a solid, mm."""
    return bytes(_in_mm(mesh).export(file_type="stl"))


def to_3mf(mesh: Any) -> bytes:
    """A 3MF file of a solid, mm.

    Source: 3D Manufacturing Format, core specification 1.3, chapters 2 to 4: a package of one model of one mesh.
    """
    scaled = _in_mm(mesh)
    model = etree.Element(f"{{{_CORE}}}model", nsmap={None: _CORE}, unit="millimeter")
    resources = etree.SubElement(model, f"{{{_CORE}}}resources")
    shape = etree.SubElement(resources, f"{{{_CORE}}}object", id="1", type="model")
    inside = etree.SubElement(shape, f"{{{_CORE}}}mesh")
    vertices = etree.SubElement(inside, f"{{{_CORE}}}vertices")
    for x, y, z in scaled.vertices:
        etree.SubElement(vertices, f"{{{_CORE}}}vertex", x=f"{x:.6f}", y=f"{y:.6f}", z=f"{z:.6f}")
    triangles = etree.SubElement(inside, f"{{{_CORE}}}triangles")
    for a, b, c in scaled.faces:
        etree.SubElement(triangles, f"{{{_CORE}}}triangle", v1=str(a), v2=str(b), v3=str(c))
    build = etree.SubElement(model, f"{{{_CORE}}}build")
    etree.SubElement(build, f"{{{_CORE}}}item", objectid="1")
    types = etree.Element(f"{{{_TYPES}}}Types", nsmap={None: _TYPES})
    for extension, content in (
        ("rels", "application/vnd.openxmlformats-package.relationships+xml"),
        ("model", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
    ):
        etree.SubElement(types, f"{{{_TYPES}}}Default", Extension=extension, ContentType=content)
    relations = etree.Element(f"{{{_RELATIONS}}}Relationships", nsmap={None: _RELATIONS})
    etree.SubElement(
        relations, f"{{{_RELATIONS}}}Relationship", Id="model", Target=f"/{_MODEL}",
        Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel",
    )  # fmt: skip
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as package:
        for name, tree in (("[Content_Types].xml", types), ("_rels/.rels", relations), (_MODEL, model)):
            entry = zipfile.ZipInfo(name)  # its date is fixed, so that the same fences make the same file
            entry.compress_type = zipfile.ZIP_DEFLATED
            package.writestr(entry, etree.tostring(tree, xml_declaration=True, encoding="UTF-8"))
    return packed.getvalue()


def _in_mm(mesh: Any) -> Any:
    scaled = mesh.copy()
    scaled.apply_scale(_MM)
    return scaled
