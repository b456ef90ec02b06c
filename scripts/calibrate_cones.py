"""Calibrates each segmentation on the rendered orange cone at nominal light, and says how well each finds it.

    python -m scripts.calibrate_cones [--scenes 20] [--seed 2006]

A scene is the focal robot and five others at random places within 3 m in front of it, in both its cameras. The masks
are those of the renderer. The ranges printed are those of `sensing.camera.palette.CALIBRATED`, and the table is that of
docs/cone_vision.md: the share of the cones' pixels that is found, and of those found, the share that is a cone's.
"""

from __future__ import annotations

import argparse
import math

import cv2
import numpy as np

from sensing.camera.calibration import calibrated
from sensing.camera.colours import KINDS, PUBLISHED, Segmentation
from sensing.camera.images import Picture
from sensing.camera.lens import Lens
from sensing.camera.rendering import Cameras
from sensing.camera.segmentation import Labels, agreement, segmented
from worlds.assemble import build, prefix

OTHERS = 5
APART_M = 0.4
LIGHTS = (0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.6)
"""Of the nominal light."""
AROUND = np.ones((3, 3), np.uint8)
"""Calibrated is on the pixels all of whose neighbours show the cone, too: at its edges colours may be mixed."""


def places(rng: np.random.Generator) -> list[tuple[float, float, float]]:
    """The focal robot at the origin and the others in its view, none on another."""
    taken = [(0.0, 0.0, 0.0)]
    while len(taken) <= OTHERS:
        distance, bearing = rng.uniform(0.5, 3.0), math.radians(rng.uniform(-100.0, 100.0))
        x, y = distance * math.cos(bearing), distance * math.sin(bearing)
        if all(math.hypot(x - a, y - b) > APART_M for a, b, _ in taken):
            taken.append((x, y, rng.uniform(-math.pi, math.pi)))
    return taken


def shot(scenes: int, seed: int, light: float) -> tuple[list[Picture], list[Labels]]:
    """Images, and masks of 0 and 1, of that many scenes."""
    rng = np.random.default_rng(seed)
    images, masks = [], []
    for _ in range(scenes):
        poses = np.array(places(rng))
        names = [f"robot-{k}" for k in range(len(poses))]
        world = build("open-floor", {}, ["create-with-cameras"] * len(poses), names, poses, 0.01)
        cameras = Cameras(world.seen(), [prefix(name) for name in names], [Lens()] * len(names), light)
        pair, shown = cameras.look(world.data, 0, 0.0), cameras.shown(world.data, 0)
        images += [pair.left, pair.right]
        masks += [(shown.left >= 0).view(np.uint8), (shown.right >= 0).view(np.uint8)]
    return images, masks


def main() -> None:
    """Prints the ranges, and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=20)
    parser.add_argument("--seed", type=int, default=2006)
    given = parser.parse_args()
    images, masks = shot(given.scenes, given.seed, 1.0)
    inside = [cv2.erode(mask, AROUND) for mask in masks]
    made = {kind: calibrated(PUBLISHED[kind], images, inside) for kind in KINDS}
    for kind in KINDS:
        (colour,) = made[kind].colours
        print(kind, [round(v, 3) for v in colour.low], [round(v, 3) for v in colour.high])
    rows: list[tuple[str, Segmentation]] = [(f"{kind}, calibrated", made[kind]) for kind in KINDS]
    rows += [(f"{kind}, published", PUBLISHED[kind]) for kind in KINDS]
    tests = [shot(given.scenes, given.seed + 1, light) for light in LIGHTS]
    print("\n| segmentation | " + " | ".join(f"{light:g}" for light in LIGHTS) + " |")
    print("|---|" + "---|" * len(LIGHTS))
    for name, segmentation in rows:
        cells = []
        for seen, truth in tests:
            found, right = agreement([segmented(image, segmentation) for image in seen], truth)
            cells.append(f"{found:.2f}" + ("" if math.isnan(right) or right > 0.995 else f" ({right:.2f})"))
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
