"""ROS maps: where cells are in the world, and beams among the walls against beams in the grid, cast independently."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from generation import plans
from generation.environment import Environment
from generation.plans import beams, outlines
from generation.primitives import Polygon

CELL_M = 0.05


def saved(
    folder: Path,
    pixels: object,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    image: str = "map.pgm",
    **changes: object,
) -> Path:
    """A map's YAML beside its image, whose first row of pixels is on top."""
    assert cv2.imwrite(str(folder / image), np.array(pixels, dtype=np.uint8))
    values = {
        "image": image, "resolution": CELL_M, "origin": list(origin),
        "occupied_thresh": 0.65, "free_thresh": 0.196, "negate": 0, **changes,
    }  # fmt: skip
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in values.items() if value is not None))
    return path


def areas(environment: Environment) -> shapely.Geometry:
    """What the polygons fill: those free outside, without those free inside."""
    solids = [
        shapely.Polygon(p.corners_m) for p in environment.workspace if isinstance(p, Polygon) and p.free == "outside"
    ]
    holes = [
        shapely.Polygon(p.corners_m) for p in environment.workspace if isinstance(p, Polygon) and p.free == "inside"
    ]
    return shapely.difference(shapely.union_all(solids), shapely.union_all(holes))


def test_the_first_row_of_an_image_is_the_top_of_the_map(tmp_path: Path) -> None:
    pixels = np.full((4, 3), 254)
    pixels[0, 2] = 0  # top right
    (polygon,) = plans.read(saved(tmp_path, pixels))[0].workspace
    assert isinstance(polygon, Polygon)
    assert polygon.free == "outside"
    expected = shapely.box(2 * CELL_M, 3 * CELL_M, 3 * CELL_M, 4 * CELL_M)
    assert shapely.Polygon(polygon.corners_m).symmetric_difference(expected).area < 1e-12


@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2, -2.0])
def test_the_origin_is_the_pose_of_the_lower_left_corner(tmp_path: Path, yaw: float) -> None:
    pixels = np.full((4, 3), 254)
    pixels[1, 2] = 0  # third column, third row from below: its middle is 2.5 cells along and 2.5 up
    environment, _ = plans.read(saved(tmp_path, pixels, (-3.0, 2.0, yaw)))
    c, s, at = math.cos(yaw), math.sin(yaw), 2.5 * CELL_M
    centre = areas(environment).centroid
    np.testing.assert_allclose((centre.x, centre.y), (-3.0 + c * at - s * at, 2.0 + s * at + c * at), atol=1e-9)


@pytest.mark.parametrize("image", ["map.pgm", "map.png"])
def test_thresholds_negate_and_channels_are_those_of_map_server(tmp_path: Path, image: str) -> None:
    pixels = np.array([[0, 89, 90, 205, 206, 255]])  # p = 1, 0.651, 0.647, 0.196.., 0.192, 0
    environment, told = plans.read(saved(tmp_path, pixels, image=image))
    assert areas(environment).bounds == pytest.approx((0.0, 0.0, 2 * CELL_M, CELL_M))
    assert any("2 occupied, 2 unknown" in line for line in told)
    environment, _ = plans.read(saved(tmp_path, pixels, image=image, negate=1))
    assert areas(environment).bounds == pytest.approx((3 * CELL_M, 0.0, 6 * CELL_M, CELL_M))


def test_the_mean_of_channels_counts_and_in_mode_scale_not_transparency(tmp_path: Path) -> None:
    pixels = np.zeros((1, 3, 4))
    pixels[0] = [[255, 0, 0, 0], [0, 0, 0, 255], [0, 0, 0, 0]]
    # with transparency as a channel the first two have p = 0.75, the last has 1; without, the last is not seen at all
    assert areas(plans.read(saved(tmp_path, pixels, image="m.png"))[0]).area == pytest.approx(3 * CELL_M**2)
    environment, _ = plans.read(saved(tmp_path, pixels, image="m.png", mode="scale"))
    assert areas(environment).bounds == pytest.approx((CELL_M, 0.0, 2 * CELL_M, CELL_M))


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 12), st.floats(0.02, 0.98))
def test_outlines_hold_the_occupied_cells_and_no_more_than_the_joints(
    seed: int, rows: int, columns: int, share: float
) -> None:
    occupied = np.random.default_rng(seed).random((rows, columns)) < share
    if not occupied.any():
        return
    filled = areas(Environment(outlines.polygons(occupied, lambda cells: cells, "map")))
    cells = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for y, x in np.argwhere(occupied)])
    assert filled.is_valid
    assert shapely.difference(cells, filled).area < 1e-9
    # a joint reaches into each of two cells by a square
    corners = sum(
        occupied[y, x] == occupied[y + 1, x + 1] != occupied[y, x + 1] == occupied[y + 1, x]
        for y in range(rows - 1)
        for x in range(columns - 1)
    )
    more = shapely.difference(filled, cells).area
    assert more == pytest.approx(2 * corners * outlines.JOINT_CELLS**2, abs=1e-9)


def slow_beam(occupied: np.ndarray, start: np.ndarray, direction: np.ndarray) -> float:
    """How far a beam gets in a grid, by walking in steps of a hundredth of a cell."""
    for k in range(1_000_000):
        x, y = np.floor(start + direction * k * 0.01).astype(int)
        if not (0 <= y < occupied.shape[0] and 0 <= x < occupied.shape[1]) or occupied[y, x]:
            return k * 0.01
    raise AssertionError


def test_beams_in_the_grid_end_where_a_walk_in_small_steps_does() -> None:
    rng = np.random.default_rng(3)
    occupied = rng.random((25, 40)) < 0.1
    rows, columns = np.nonzero(~occupied)
    starts = np.column_stack([columns, rows])[:300] + rng.uniform(0, 1, (300, 2))
    angles = rng.uniform(-math.pi, math.pi, 300)
    angles[:4] = 0.0, math.pi / 2, math.pi, -math.pi / 2  # along the cells
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    found, ends = beams.cast_in_grid(occupied, starts, directions)
    slow = [slow_beam(occupied, start, direction) for start, direction in zip(starts, directions, strict=True)]
    # a walk ends up to a step late, and may step over the corner of a cell: one in some hundred
    assert np.mean(np.abs(found - slow) < 0.011) > 0.98
    assert np.all(found <= np.array(slow) + 1e-9)
    assert np.all(found <= ends)


def room(turned: float = 0.0) -> np.ndarray:
    """A room with a slanting wall of one cell, some clutter, and unknown space around it."""
    pixels = np.full((300, 400), 205, dtype=np.uint8)
    box = cv2.boxPoints(((200.0, 150.0), (250.0, 180.0), turned)).astype(np.int32)
    cv2.fillPoly(pixels, [box], 254)
    cv2.polylines(pixels, [box], True, 0, 1)
    cv2.line(pixels, (150, 100), (230, 160), 0, 1)
    pixels[np.random.default_rng(1).random(pixels.shape) < 0.001] = 0
    return pixels


@pytest.mark.parametrize(("turned", "yaw"), [(0.0, 0.0), (17.0, 0.0), (45.0, -1.0), (3.0, 2.5)])
def test_beams_among_walls_are_within_a_cell_of_the_map_in_99_percent(
    tmp_path: Path, turned: float, yaw: float
) -> None:
    environment, told = plans.read(saved(tmp_path, room(turned), (-5.0, 3.0, yaw)))
    assert environment.origin["beams_within_a_cell"] >= 0.99
    assert any("4000 beams against the map" in line for line in told)


@pytest.mark.parametrize("wrong", ["mirrored", "turned", "shifted"])
def test_beams_show_walls_that_are_elsewhere(tmp_path: Path, wrong: str) -> None:
    pixels = room(17.0)
    occupied = (pixels == 0)[::-1]
    shown = {"mirrored": occupied[::-1], "turned": occupied[::-1, ::-1], "shifted": np.roll(occupied, 3, axis=1)}[wrong]
    walls = Environment(outlines.polygons(shown, lambda cells: CELL_M * cells, "map")).walls()
    error = beams.error(occupied, (pixels == 254)[::-1], CELL_M, (0.0, 0.0, 0.0), walls)
    assert error is not None
    assert error.share < 0.9


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"image": "none.png"}, "does not exist"),
        ({"resolution": 0}, "resolution"),
        ({"resolution": ".nan"}, "resolution"),
        ({"origin": "[0, 0]"}, "origin"),
        ({"origin": "[0, .inf, 0]"}, "origin"),
        ({"free_thresh": 0.9}, "above occupied_thresh"),
        ({"negate": 3}, "negate"),
        ({"mode": "raw"}, "mode"),
        ({"image": "map.yaml"}, "neither PNG nor PGM"),
        ({"resolution": None}, "lacks resolution"),
        ({"image": "[3]"}, "expected the name"),
        ({"negate": "[1"}, "broken YAML"),
    ],
)
def test_a_yaml_that_is_no_maps_is_refused(tmp_path: Path, changes: dict[str, object], expected: str) -> None:
    path = saved(tmp_path, [[0, 255]])
    given = {"image": "map.pgm", "resolution": 0.05, "origin": "[0, 0, 0]", "occupied_thresh": 0.65,
             "free_thresh": 0.196, "negate": 0, **changes}  # fmt: skip
    path.write_text("".join(f"{key}: {value}\n" for key, value in given.items() if value is not None))
    with pytest.raises(InputError, match=expected) as refusal:
        plans.read(path)
    assert "\n" not in str(refusal.value)


def test_images_are_refused_by_their_size_before_they_are_unpacked(tmp_path: Path) -> None:
    path = saved(tmp_path, [[0, 255]], image="map.png")
    image = tmp_path / "map.png"
    whole = image.read_bytes()
    image.write_bytes(whole[:16] + (60_000).to_bytes(4, "big") * 2 + whole[24:])
    with pytest.raises(InputError, match="60000 x 60000"):
        plans.read(path)
    image.write_bytes(whole[:50])
    with pytest.raises(InputError, match="broken"):
        plans.read(path)
    image.write_bytes(b"P5\n# by hand\n2 1\n100\n\0d")
    with pytest.raises(InputError, match="brightest value is 100"):
        plans.read(path)


def test_a_map_without_walls_or_of_noise_alone_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no cell"):
        plans.read(saved(tmp_path, np.full((9, 9), 254)))
    noise = np.where(np.random.default_rng(1).random((1000, 1000)) < 0.3, 0, 254)
    with pytest.raises(InputError, match="less noise"):
        plans.read(saved(tmp_path, noise))
