"""What drawings of all formats share: how they are opened, how curves become straight, how much may be in one."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from flocking.errors import InputError
from generation.checking import MOST_PIECES
from generation.primitives import BOTH, SAGITTA_M, Polygon, Polyline, Primitive, Segment

LARGEST_BYTES = 100_000_000
"""Of a plan's file. A choice: far above drawings that keep to the number of walls."""
MOST_ON_CURVE = 10_000
"""Most pieces of one curve. A choice."""
CURVES_TOLD = f"curves are straightened to within {1000.0 * SAGITTA_M:g} mm; circles and their arcs stay what they are"

Place = tuple[float, float]


def contents(path: Path, what: str) -> bytes:
    """All bytes of a plan's file. Raises `InputError` where it is missing, cannot be read, or is too large."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_BYTES + 1)
    except FileNotFoundError:
        raise InputError(f"{path} does not exist: expected {what}") from None
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{path} cannot be read: {reason}") from None
    if len(data) > LARGEST_BYTES:
        raise InputError(f"{path} is too large: expected at most {LARGEST_BYTES // 1_000_000} MB")
    return data


def pieces_of_bezier(controls: list[complex], sagitta: float) -> int:
    """Into how many pieces, equal in its parameter, a Bézier curve is cut so that none lies farther than `sagitta` off.

    A piece of parameter length h departs from its chord by at most h²/8 of the largest second derivative, which is at
    most d (d - 1) times the largest second difference of the control points, for degree d.
    """
    degree = len(controls) - 1
    differences = [abs(a - 2.0 * b + c) for a, b, c in zip(controls, controls[1:], controls[2:], strict=False)]
    bound = degree * (degree - 1) / 8.0 * max(differences, default=0.0)
    return _pieces(math.sqrt(bound / sagitta))


def pieces_of_arc(radius: float, turn_rad: float, sagitta: float) -> int:
    """The same for a part of a circle, or of an ellipse, whose larger radius this is and whose parameter turns so."""
    if radius <= sagitta:
        return _pieces(abs(turn_rad) * 4.0 / math.pi)
    return _pieces(abs(turn_rad) / (2.0 * math.acos(1.0 - sagitta / radius)))


def _pieces(wanted: float) -> int:
    if not math.isfinite(wanted):
        return 1  # its places are no numbers, which is refused where they are checked
    return min(max(math.ceil(wanted), 1), MOST_ON_CURVE)


def fence(places: list[Place], closed: bool, is_polyline: bool = False) -> Primitive | None:
    """A fence through places, free on both sides; None if they are all one place."""
    distinct = [place for n, place in enumerate(places) if n == 0 or place != places[n - 1]]
    if closed and len(distinct) > 1 and distinct[0] == distinct[-1]:
        distinct.pop()
    if len(distinct) < 2:
        return None
    if closed and len(distinct) > 2:
        return Polygon(tuple(distinct), BOTH)
    if len(distinct) == 2 and not is_polyline:
        return Segment(*distinct[0], *distinct[1])
    return Polyline(tuple(distinct))


class Count:
    """How much was met in a drawing: what is not told apart by the walls that came of it."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.pieces = 0
        self.left_out: Counter[str] = Counter()

    def add(self, pieces: int) -> None:
        """Counts pieces of wall. Raises `InputError` where they are too many."""
        self.pieces += pieces
        if self.pieces > MOST_PIECES:
            raise InputError(f"{self.where} has more than {MOST_PIECES} straight pieces of wall: expected fewer")

    def told(self) -> list[str]:
        """One line of what was left out; none if there is nothing."""
        parts = [f"{count} {what}" for what, count in sorted(self.left_out.items())]
        return [f"left out: {', '.join(parts)}"] if parts else []
