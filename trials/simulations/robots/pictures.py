"""The images that a recording keeps, compressed as they come."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np

from sensing.types import Detection, Images
from trials.types import Pictures

QUALITY = 80
"""Of JPEG, out of 100: some 15 kB an image."""


@dataclass
class Kept:
    """Collects images while a trial runs."""

    _rows: list[tuple[float, int, bytes, bytes, Any, tuple[bytes, bytes]]] = field(default_factory=list)

    def keep(self, robot: int, images: Images, detection: Detection, taken_for: tuple[Any, Any] | None) -> None:
        """Keeps a pair, with what was made of it; `taken_for`: the number of each pixel's colour, (H, W) each."""
        left, right = (_encoded(".jpg", image[:, :, ::-1]) for image in (images.left, images.right))
        masks = taken_for or (np.zeros((1, 1), np.uint8),) * 2
        coded = _encoded(".png", masks[0]), _encoded(".png", masks[1])
        self._rows.append((images.time, robot, left, right, detection.beams.astype(np.int16), coded))

    def whole(self) -> Pictures | None:
        """All that was kept; None if nothing was."""
        if not self._rows:
            return None
        times, robots, left, right, found, masks = zip(*self._rows, strict=True)
        return Pictures(np.array(times), np.array(robots, np.int64), left, right, np.stack(found), masks)


def _encoded(kind: str, image: Any) -> bytes:
    options = [cv2.IMWRITE_JPEG_QUALITY, QUALITY] if kind == ".jpg" else []
    done, coded = cv2.imencode(kind, np.ascontiguousarray(image), options)
    assert done
    return coded.tobytes()
