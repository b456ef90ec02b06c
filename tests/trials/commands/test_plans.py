"""`herd import` and `herd export` in a process of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cv2
import mujoco
import numpy as np
import pytest
import trimesh

from generation import files, sources
from generation.environment import Environment
from generation.primitives import Point, Polygon, Segment

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="4000mm" height="2000mm" viewBox="0 0 4000 2000">
<rect width="4000" height="2000" data-free="inside"/>
<g id="construct"><line x1="1000" x2="1000" y2="1500"/></g></svg>"""


def herd(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "trials.commands.cli", *words], cwd=cwd, capture_output=True, text=True, timeout=300
    )


def test_a_plan_is_imported_and_exported_to_every_format(tmp_path: Path) -> None:
    (tmp_path / "plan.svg").write_text(SVG)
    done = herd("import", "plan.svg", "--out", "plan.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "1 polygon, 1 segment; 5 straight pieces" in done.stdout
    assert "13.50 m of walls, x 0.00 to 4.00 m, y -2.00 to 0.00 m" in done.stdout
    environment = files.read(tmp_path / "plan.json")
    assert environment.construct == (Segment(1.0, 0.0, 1.0, -1.5),)
    for name in ("out.svg", "out.stl", "out.3mf", "out.xml"):
        done = herd("export", "plan.json", "--out", name, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "its construct needs 1.500 m of fence" in done.stdout
    mesh = trimesh.load(tmp_path / "out.stl")
    assert mesh.is_watertight
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    assert model.ngeom == 1 + 5  # floor, four walls, one fence
    back = sources.environment_text(str(tmp_path / "out.svg"))
    found = files.from_json(back)
    assert (found.workspace, found.construct) == (environment.workspace, environment.construct)


def test_a_map_is_imported_with_the_error_of_its_walls(tmp_path: Path) -> None:
    pixels = np.full((40, 60), 254, dtype=np.uint8)
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    cv2.line(pixels, (10, 5), (50, 35), 0, 1)
    cv2.imwrite(str(tmp_path / "map.pgm"), pixels)
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.1\norigin: [-1, -2, 0.2]\noccupied_thresh: 0.65\nfree_thresh: 0.2\nnegate: 0\n"
    )
    done = herd("import", "map.yaml", "--out", "map.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "4000 beams against the map: 100.00 % at most one cell (0.1 m) off, the worst" in done.stdout
    assert (
        herd("export", "map.json", "--out", "map.xml", cwd=tmp_path).returncode == 0
    )  # thin walls have room for boxes


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("import", "none.svg", "--out", "a.json"), "does not exist"),
        (("import", "plan.svg", "--out", "a.txt"), "expected a name that ends in .json"),
        (("import", "plan.svg", "--out", "there.json"), "there is such a file"),
        (("import", "plan.svg", "--out", "a.json", "--unit", "mile"), "unknown unit 'mile'"),
        (("import", "plan.svg", "--out", "a.json", "--unit", "m", "--scale", "2"), "expected one of them"),
        (("import", "plan.svg", "--out", "a.json", "--scale", "nan"), "expected metres per unit"),
        (("import", "there.json", "--out", "a.json"), "is no plan"),
        (("export", "there.json", "--out", "a.obj"), "expected a name that ends in .svg or .stl or .3mf or .xml"),
        (("export", "there.json", "--out", "a.svg", "--height-m", "1"), "of fences to build"),
        (("export", "there.json", "--out", "a.stl", "--height-m", "-1"), "height_m"),
        (("export", "there.json", "--out", "a.stl"), "is empty"),
        (("export", "bad.json", "--out", "a.stl"), "is no JSON"),
    ],
)
def test_bad_input_is_told_in_one_line(tmp_path: Path, words: tuple[str, ...], expected: str) -> None:
    (tmp_path / "plan.svg").write_text(SVG)
    (tmp_path / "bad.json").write_text("{")
    files.write(Environment(markers={"start": Point()}), tmp_path / "there.json")
    done = herd(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "a.json").exists()


def test_a_plan_is_a_world_as_it_stands(tmp_path: Path) -> None:
    (tmp_path / "plan.svg").write_text(SVG)
    found = files.from_json(sources.environment_text(str(tmp_path / "plan.svg")))
    assert isinstance(found.workspace[0], Polygon)
    assert found.workspace[0].free == "inside"


def test_an_environment_is_rendered_in_three_dimensions_where_opengl_is(tmp_path: Path) -> None:
    room = Polygon(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), "inside")
    fence = Segment(1.0, 1.0, 3.0, 2.0)
    files.write(Environment((room,), (fence,), {"start": Point(0.5, 0.5)}), tmp_path / "room.json")
    done = herd("export", "room.json", "--out", "room.png", cwd=tmp_path)
    if done.returncode == 2 and "OpenGL" in done.stderr:
        pytest.skip(done.stderr.strip())
    assert done.returncode == 0, done.stderr
    assert "drawn as large as it is, fences 0.5 m high" in done.stdout
    pixels = cv2.imread(str(tmp_path / "room.png")).astype(int)
    assert pixels.shape == (960, 1280, 3)
    blue, green, red = np.moveaxis(pixels, 2, 0)
    orange = (red > 100) & (red > 1.8 * green) & (green > blue)  # the construct, and nothing else
    assert 500 < orange.sum() < pixels[..., 0].size / 4
    grey = (abs(red - green) < 12) & (red < 200)  # walls in the room's colour, and shadows
    assert grey.sum() > 5000
    assert ((green > 1.5 * red) & (green > blue)).sum() > 50  # the start
    rows, columns = np.nonzero(orange | grey)
    assert 0 < columns.min() < 320  # all of it is in the picture, and fills it
    assert 960 < columns.max() < 1279
    assert 640 < rows.max() < 959


def test_a_library_that_is_none_stops_nothing_but_rendering(tmp_path: Path) -> None:
    """MuJoCo cannot even be imported with it; an experiment's own file imports MuJoCo too."""
    mine = '"""Mine."""\nimport mujoco\nfrom trials.studies.monocular.follow_1 import *  # noqa: F403\n'
    (tmp_path / "mine.py").write_text(mine)
    told = {}
    for words in (("show", "mine.py", "--repeats", "1"), ("images", "mine.py", "--out", "images")):
        told[words[0]] = subprocess.run(
            [sys.executable, "-m", "trials.commands.cli", *words],
            cwd=tmp_path, capture_output=True, text=True, timeout=300, env={**os.environ, "MUJOCO_GL": "nonsense"},
        )  # fmt: skip
    assert told["show"].returncode == 0, told["show"].stderr
    assert told["images"].returncode == 2
    assert told["images"].stderr.count("\n") == 1
    assert "MUJOCO_GL = 'nonsense' renders nothing off-screen; expected osmesa or egl" in told["images"].stderr


def test_without_opengl_a_picture_is_refused_in_one_line(tmp_path: Path) -> None:
    files.write(Environment((Segment(0.0, 0.0, 1.0, 0.0),)), tmp_path / "wall.json")
    done = subprocess.run(
        [sys.executable, "-m", "trials.commands.cli", "export", "wall.json", "--out", "wall.png"],
        cwd=tmp_path, capture_output=True, text=True, timeout=300, env={**os.environ, "MUJOCO_GL": "off"},
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "needs OpenGL to render off-screen" in done.stderr
    assert "MUJOCO_GL=egl or osmesa" in done.stderr
    assert not (tmp_path / "wall.png").exists()
    files.write(Environment(markers={"start": Point(0.0, 0.0)}), tmp_path / "empty.json")
    done = herd("export", "empty.json", "--out", "empty.png", cwd=tmp_path)
    assert done.returncode == 2
    assert "without walls" in done.stderr
