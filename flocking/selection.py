"""Stage 3, neighbour selection: plain functions from the detected members to a mask (M,) of the selected ones.

Source: Fine 2015, table 3.1. In a trial a selection is text: a name, and numbers where it takes them, as in
`all`, `nearest`, `k-nearest(3)`, `distance-based(0, 2.5)`; several are applied in succession with `&`.
"""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.types import Bools, Ints, Members


def everyone(members: Members) -> Bools:
    """All(): every detected member."""
    return np.ones(len(members.ids), dtype=np.bool_)


def nearest(members: Members) -> Bools:
    """Nearest(): the nearest member only."""
    return k_nearest(members, 1)


def k_nearest(members: Members, k: float) -> Bools:
    """k-Nearest(): the k nearest members; of equally near ones the one with the smaller position first."""
    positions = members.positions
    distances = np.hypot(positions[:, 0], positions[:, 1])
    mask = np.zeros(len(distances), dtype=np.bool_)
    mask[np.lexsort((positions[:, 1], positions[:, 0], distances))[: int(k)]] = True
    return mask


def distance_based(members: Members, low_m: float, high_m: float) -> Bools:
    """DistanceBased(): members at a distance in [low, high)."""
    distances = np.hypot(members.positions[:, 0], members.positions[:, 1])
    return (low_m <= distances) & (distances < high_m)


_SELECTIONS: dict[str, tuple[Callable[..., Bools], int]] = {
    "all": (everyone, 0),
    "nearest": (nearest, 0),
    "k-nearest": (k_nearest, 1),
    "distance-based": (distance_based, 2),
}

_CALL = re.compile(r"^\s*([a-z_-]+)\s*(?:\(([^()]*)\))?\s*$")


def parse(text: str) -> list[tuple[Callable[..., Bools], tuple[float, ...]]]:
    """The functions that a selection's text names, with their numbers; `InputError` if it names none."""
    steps = []
    for part in text.split("&"):
        match = _CALL.match(part)
        if match is None:
            raise InputError(f"selection {text!r}: expected names such as all or k-nearest(3), joined by &")
        name = match.group(1).replace("_", "-")
        if name not in _SELECTIONS:
            raise unknown_name("selection", name, _SELECTIONS)
        function, count = _SELECTIONS[name]
        given = [piece for piece in (match.group(2) or "").split(",") if piece.strip()]
        try:
            numbers = tuple(float(piece) for piece in given)
        except ValueError:
            numbers = (np.nan,)
        if len(numbers) != count or not np.all(np.isfinite(numbers)):
            raise InputError(f"selection {part.strip()!r}: {name} takes {count} finite number{'s' * (count != 1)}")
        steps.append((function, numbers))
    return steps


def select(steps: list[tuple[Callable[..., Bools], tuple[float, ...]]], members: Members) -> Bools:
    """The mask (M,) of the members that every step keeps, each step seeing only what the last one kept."""
    mask = everyone(members)
    for function, numbers in steps:
        kept = np.flatnonzero(mask)
        chosen = function(_rows(members, kept), *numbers)
        mask = np.zeros_like(mask)
        mask[kept[chosen]] = True
    return mask


def _rows(members: Members, kept: Ints) -> Members:
    positions, bearings, headings, velocities, ids = members
    return Members(positions[kept], bearings[kept], headings[kept], velocities[kept], ids[kept])
