"""Cones as blobs, several at once, followed over time: what one would take today (`sensing.camera.blobs`).

Every cone in either image is a member, also where cones hide one another or are partly hidden; one in both images is
one. Members are followed from image to image, so their places are smoothed and their velocities are known from the
second image on. Two cones of one colour have no names: ids are −1, the tracks' own numbers stay in the state. With
several colours a member's id is the number of its colour.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import mujoco
import numpy as np

from flocking.parameters import Parameter
from flocking.types import ANONYMOUS, Floats, Ints, Members, Own
from sensing.camera import looking
from sensing.camera.blobs import sighted_blobs
from sensing.camera.colours import HSV
from sensing.camera.cones import RADIUS_M
from sensing.camera.runs import LARGEST_HOLE_PX
from sensing.camera.segmentation import Labels
from sensing.camera.tracking import NO_TRACKS, Settings, Tracks, followed, moved
from sensing.types import Detection, Senses

READS = frozenset({"images", "echoes"})
GIVES = frozenset({"positions", "bearings", "velocities"})


class Parameters(NamedTuple):
    """Which pixels are a cone's, how they become cones, and how cones are followed."""

    segmentation: looking.SegmentationKind = HSV
    ranges: looking.Ranges = "calibrated"
    """`calibrated` on the rendered cone, or as `published`."""
    colours: looking.Colours = 1
    """1: all cones are orange. More: one a robot, and ids are the colours' numbers."""
    largest_hole_px: looking.LargestHole = LARGEST_HOLE_PX
    """Holes of up to so many columns are closed."""
    minimum_run_px: looking.MinimumRun = 4
    """Narrower blobs are no cone's."""
    cone_radius_m: looking.ConeRadius = RADIUS_M
    """At the base."""
    pixels_per_degree: looking.Assumption = looking.LENS
    """`equal-angle`: the same for all columns, whatever the lens (5.12); `lens`: each column's own bearing."""
    offset: looking.Offset = looking.CAMERA
    """Where places are told from (`looking.OFFSETS`)."""
    top_speed_m_s: Annotated[float, Parameter("m/s", "choice: the Create's 0.5, the Pioneer's 0.8", low=0.0)] = 0.8
    """No member is faster, and none is looked for farther away than this would take it."""
    bearing_noise_deg: Annotated[float, Parameter("deg", "choice: one pixel of an own turn unseen", low=1e-3)] = 1.0
    """Of a bearing between two images."""
    distance_noise: Annotated[float, Parameter("", "choice: one pixel of 16, twice", low=1e-3, high=10.0)] = 0.12
    """Of a distance between two images, as a share of it."""
    place_gain: Annotated[float, Parameter("", "choice", low=0.0, high=1.0)] = 0.5
    """Least share of what a place is off by that a track takes over at once; 1 = places are not smoothed."""
    velocity_gain: Annotated[float, Parameter("", "choice: critically damped with 0.5", low=0.0, high=2.0)] = 0.17
    """Least share of it, over the time between two images, by which a velocity is put right."""
    memory_s: Annotated[float, Parameter("s", "choice: ten images", low=0.0)] = 1.0
    """How long a member out of sight is remembered, so that it is the same when it is back."""


class State(NamedTuple):
    """What is kept between updates."""

    gaze: looking.Gaze
    settings: Settings
    tracks: Tracks
    rows: Ints
    """(M,) which track each member of the last detection is; its number is `tracks.ids[rows]`."""
    columns: Ints
    """(2W,) which member each column of the last images made."""
    time: float
    """s, of the last images."""

    @property
    def labels(self) -> tuple[Labels, Labels]:
        """(H, W) each, what every pixel of the last images was taken for."""
        return self.gaze.labels


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> State:
    """The cameras' places are taken from the model; `angles` (2, W) are the columns' true bearings in each camera."""
    given = parameters._asdict()
    its = {name: given.pop(name) for name in list(given) if name not in looking.SHARED}
    its["bearing_noise_rad"] = np.radians(its.pop("bearing_noise_deg"))
    gaze = looking.gaze(**given, member_model=member_model, angles=angles)
    none = looking.nothing_seen(gaze)[1]
    return State(gaze, Settings(**its), NO_TRACKS, np.empty(0, np.int64), none, np.nan)


def detect(senses: Senses, own: Own, state: State) -> tuple[Detection, State]:
    """One row a cone, the widest first. Of images that were there before, the cones are moved on, not seen again."""
    state, images = state._replace(tracks=moved(state.tracks, own)), senses.images
    if images is not None and images.time != state.time:
        gaze = looking.labelled(images, state.gaze)
        seen = sighted_blobs(gaze.labels, gaze.colours, gaze.largest_hole_px, gaze.minimum_run_px, gaze.eyes)
        cones = looking.cones(seen, gaze, len(seen.found))
        tracks, rows = followed(state.tracks, cones.positions, cones.colours, state.settings)
        state = State(gaze, state.settings, tracks, rows, cones.columns, images.time)
    tracks, rows = state.tracks, state.rows
    places = tracks.places[rows]
    velocities = np.where(tracks.hits[rows, None] > 1, tracks.velocities[rows], np.nan)
    ids = tracks.colours[rows] if state.gaze.colours > 1 else np.full(len(rows), ANONYMOUS)
    bearings = np.arctan2(places[:, 1], places[:, 0])
    members = Members(places, bearings, np.full(len(rows), np.nan), velocities, ids)
    return Detection(members, looking.obstacles(senses, places, state.gaze), state.columns.copy()), state
