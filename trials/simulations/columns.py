"""Columns of numbers and colours as the Rerun viewer takes them."""

from __future__ import annotations

from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from flocking.types import Floats, Ints

TIMELINE = "time"
TAG_COLOUR = 0xFFFFFFFF
MEMBER_COLOURS = np.array(
    [0xE69F00FF, 0x56B4E9FF, 0x2FBF8FFF, 0xF0E442FF, 0xF0703AFF, 0xD58BB8FF, 0x7D9BFFFF, 0xB8C4CEFF], np.uint32
)
"""After Okabe and Ito 2008, which colour-blind people can tell apart; the dark ones lightened."""


def in_world(positions: Any, poses_w: Floats) -> Floats:
    """(M, 2) world positions of `positions` (M, 2), each in the body frame of its own pose (M, 3)."""
    c, s = np.cos(poses_w[:, 2]), np.sin(poses_w[:, 2])
    x, y = positions[:, 0], positions[:, 1]
    return np.stack([poses_w[:, 0] + c * x - s * y, poses_w[:, 1] + s * x + c * y], axis=1)


def series(recording: rr.RecordingStream, entity: str, name: str, colour: int, times: Floats, values: Floats) -> None:
    """One line of a plot."""
    recording.log(entity, rr.SeriesLines(names=name, colors=packed([colour]), widths=[1.5]), static=True)
    recording.send_columns(entity, [times_column(times)], rr.Scalars.columns(scalars=values))


def name_tag(name: str) -> rr.Points2D:
    """A name at the origin of its entity: light, for the viewer writes on dark in the colour of the dot."""
    return rr.Points2D(
        [[0.0, 0.0]], radii=[0.0], colors=packed([TAG_COLOUR]), labels=[name], show_labels=True, draw_order=60.0
    )


def nanoseconds(times: Floats) -> Ints:
    return np.round(times * 1e9).astype(np.int64)


def times_column(times: Floats) -> rr.TimeColumn:
    """Rounded to the nearest nanosecond: the viewer's own conversion cuts off, and 0.3 s becomes 0.299999999."""
    return rr.TimeColumn(TIMELINE, duration=nanoseconds(times).astype("timedelta64[ns]"))


def packed(colours: Any) -> NDArray[np.uint32]:
    return np.array(colours, dtype=np.uint32)


def spans(starts: Ints, ends: Ints) -> Ints:
    """The numbers from each start to before its end, one span after the other."""
    counts = ends - starts
    return np.repeat(starts - np.r_[0, np.cumsum(counts)[:-1]], counts) + np.arange(counts.sum())


def member_colours(count: int) -> NDArray[np.uint32]:
    """(N,) packed colours; they repeat beyond eight members."""
    return MEMBER_COLOURS[np.arange(count) % len(MEMBER_COLOURS)]
