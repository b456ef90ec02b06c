"""Fences as solids: closed, and of the volume that length, thickness and height make."""

from __future__ import annotations

import io
import math
import zipfile

import numpy as np
import pytest
import trimesh
from lxml import etree

from flocking.errors import InputError
from generation.environment import Environment
from generation.exports import fences
from generation.exports.fences import Parameters
from generation.primitives import Arc, Circle, Polygon, Polyline, Primitive, Segment

HIGH, THICK = 0.4, 0.03
BUILT = Parameters(HIGH, THICK)


@pytest.mark.parametrize(
    "primitives",
    [
        (Segment(0.0, 0.0, 3.0, 4.0),),
        (Segment(0.0, 0.0, 3.0, 0.0), Segment(3.0, 0.0, 3.0, 2.0)),
        (Polyline(((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (5.0, 2.0))),),
        (Polygon(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0)), "both"),),
        (Polygon(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), "inside"), Segment(1.0, 1.0, 2.0, 1.0)),
        (Circle(0.0, 0.0, 1.0),),
        (Arc(0.0, 0.0, 1.0, 0.5, 3.0),),
    ],
)
def test_the_volume_is_length_times_thickness_times_height(primitives: tuple[Primitive, ...]) -> None:
    """What a mitred corner gains outside it loses inside, so that no corner counts."""
    mesh = fences.solid(primitives, BUILT)
    length = Environment(construct=primitives).fence_length()
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    # corners are rounded to a micrometre: 1e-6 of 0.03 m
    assert mesh.volume == pytest.approx(length * THICK * HIGH, rel=2e-4)
    np.testing.assert_allclose(mesh.bounds[:, 2], (0.0, HIGH), atol=1e-9)


def test_crossing_fences_share_the_crossing() -> None:
    mesh = fences.solid((Segment(-1.0, 0.0, 1.0, 0.0), Segment(0.0, -1.0, 0.0, 1.0)), BUILT)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx((4.0 * THICK - THICK**2) * HIGH, rel=2e-4)


def test_fences_that_touch_at_a_corner_are_a_closed_solid_all_the_same() -> None:
    half = THICK / 2
    mesh = fences.solid((Segment(0.0, 0.0, 1.0, 0.0), Segment(1.0, 2 * half, 2.0, 2 * half)), BUILT)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(2.0 * THICK * HIGH, rel=0.01)  # at most 0.1 mm of 30 mm thicker


def test_many_random_fences_are_closed_solids() -> None:
    rng = np.random.default_rng(7)
    for _ in range(40):
        walls = np.round(rng.uniform(-3.0, 3.0, (rng.integers(1, 10), 4)), int(rng.integers(1, 4)))
        mesh = fences.solid([Segment(*wall) for wall in walls.tolist()], BUILT)
        assert mesh.is_watertight
        lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
        assert 0.0 < mesh.volume <= lengths.sum() * THICK * HIGH * 1.02


def test_files_have_millimetres_at_full_size_and_the_same_solid() -> None:
    mesh = fences.solid((Polyline(((0.0, 0.0), (2.0, 0.0), (2.0, 1.0))),), BUILT)
    stl = trimesh.load(io.BytesIO(fences.to_stl(mesh)), file_type="stl")
    assert stl.is_watertight
    assert stl.volume == pytest.approx(mesh.volume * 1e9, rel=1e-5)  # STL has 32 bit numbers
    with zipfile.ZipFile(io.BytesIO(fences.to_3mf(mesh))) as package:
        assert package.testzip() is None
        model = etree.fromstring(package.read("3D/3dmodel.model"))
        relation = etree.fromstring(package.read("_rels/.rels"))[0]
        types = etree.fromstring(package.read("[Content_Types].xml"))
    assert relation.get("Target") == "/3D/3dmodel.model"
    assert {entry.get("Extension") for entry in types} == {"rels", "model"}
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    assert model.get("unit") == "millimeter"
    vertices = [[float(vertex.get(axis)) for axis in "xyz"] for vertex in model.iter(f"{core}vertex")]
    faces = [[int(face.get(corner)) for corner in ("v1", "v2", "v3")] for face in model.iter(f"{core}triangle")]
    read = trimesh.Trimesh(vertices, faces, process=False)
    assert read.is_watertight
    assert read.volume == pytest.approx(mesh.volume * 1e9, rel=1e-6)
    assert fences.to_3mf(mesh) == fences.to_3mf(mesh)


def test_the_construct_is_built_and_without_one_the_workspace() -> None:
    wall, fence = Segment(0.0, 0.0, 1.0, 0.0), Segment(0.0, 1.0, 1.0, 1.0)
    assert fences.to_build(Environment((wall,), (fence,))) == (fence,)
    assert fences.to_build(Environment((wall,))) == (wall,)
    with pytest.raises(InputError, match="empty"):
        fences.to_build(Environment())


def test_the_length_of_fence_is_that_of_all_pieces() -> None:
    assert Environment(construct=(Segment(0.0, 0.0, 3.0, 4.0),)).fence_length() == 5.0
    circle = Environment(construct=(Circle(0.0, 0.0, 1.0),)).fence_length()
    assert 2.0 * math.pi * 0.999 < circle < 2.0 * math.pi
