"""What sonars heard in a recording: an arc for each echo, and the points that were taken for obstacles."""

from __future__ import annotations

import numpy as np
import rerun as rr

from flocking.types import Floats
from sensing.sonar import HALF_WIDTH_RAD
from trials.simulations.columns import packed, times_column
from trials.types import Heard, TrialResult

ECHO_COLOUR, OBSTACLE_COLOUR = 0x7FB5D5FF, 0xFF7A1AFF
CORNERS = 5
"""Of the line that an arc is drawn as."""
LEGEND = """
- **pale arc**: an echo, which may have come from anywhere on it; **orange dot**: one that was taken for an obstacle
"""


def send_echoes(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends, for each moment at which echoes were kept, the arcs and the obstacles in the world."""
    heard = result.heard
    if heard is None:
        return
    arcs_style = rr.LineStrips2D.from_fields(colors=packed([ECHO_COLOUR]), radii=[0.01], draw_order=9.0)
    points_style = rr.Points2D.from_fields(colors=packed([OBSTACLE_COLOUR]), radii=[0.04], draw_order=36.0)
    for k, name in enumerate(result.robot_names):
        mine = np.flatnonzero(heard.robots == k).tolist()
        if len(mine) == 0:
            continue
        times = [times_column(heard.times[mine])]
        arcs, obstacles = [arcs_w(heard, row) for row in mine], [obstacles_w(heard, row) for row in mine]
        recording.log(f"world/echoes/{name}", arcs_style, static=True)
        columns = rr.LineStrips2D.columns(strips=np.concatenate(arcs).astype(np.float32))
        recording.send_columns(f"world/echoes/{name}", times, columns.partition(np.array([len(a) for a in arcs])))
        recording.log(f"world/obstacles/{name}", points_style, static=True)
        points = rr.Points2D.columns(positions=np.concatenate(obstacles).astype(np.float32))
        recording.send_columns(
            f"world/obstacles/{name}", times, points.partition(np.array([len(a) for a in obstacles]))
        )


def arcs_w(heard: Heard, row: int) -> Floats:
    """(E, CORNERS, 2) m, world frame: where each echo of that row may have come from."""
    some = np.isfinite(heard.ranges[row])
    x, y, heading = heard.rings[row][some].T
    along = heading[:, None] + np.linspace(-HALF_WIDTH_RAD, HALF_WIDTH_RAD, CORNERS)
    way = heard.ranges[row][some][:, None]
    body = np.stack([x[:, None] + way * np.cos(along), y[:, None] + way * np.sin(along)], axis=-1)
    return _in_world(body, heard.poses_w[row])


def obstacles_w(heard: Heard, row: int) -> Floats:
    """(K, 2) m, world frame: the obstacles of that row."""
    return _in_world(heard.obstacles[row], heard.poses_w[row])


def _in_world(points: Floats, pose_w: Floats) -> Floats:
    """Points (…, 2) of the body frame in the world."""
    x, y, heading = pose_w
    c, s = np.cos(heading), np.sin(heading)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + (x, y))
