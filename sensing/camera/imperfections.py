"""What a real camera forces on an image, all of it off by default: light, exposure, glare, blur, noise, frames.

In the order of the light's way: the light of the room changes, the lens makes glare, the exposure scales what falls in,
optics blur, the sensor adds noise; frames come at the camera's own rate, and some are lost. The thesis leaves the light
open: "this necessitates nearly constant monitoring of the camera apertures" (Kirchner 2006, section 3.6.4.2).

The images are of 8 bits: what is saturated stays so, and a rendering darker than 1 stays black. Every update draws as
many numbers, whatever was seen and whatever is on.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from flocking.compilation import borrowing
from flocking.parameters import Parameter
from flocking.types import Floats
from sensing.camera.images import Images, Picture

SHIFTS = 65536
"""An image's noise is a piece of a pool that begins at one of so many places: one draw an image, not one a value."""
DRAWS = 8
"""Uniform numbers of an update: lost or not, where the noise of both images begins and where their glare is; one is
left over."""
MOST_GAIN = 4.0
"""Choice: the exposure makes an image at most so many times brighter or darker."""
SAMPLED = 8
"""The exposure looks at every so many-th row and column."""
_TIMES = 1e-9


class Parameters(NamedTuple):
    """The cameras of one robot. The defaults are those of no camera at all: nothing is imperfect."""

    noise_levels: Annotated[float, Parameter("levels", "choice: none", low=0.0, high=100.0, plausible=(0.0, 4.0))] = 0.0
    """Standard deviation of the noise of each value, of 256 levels."""
    blur_px: Annotated[float, Parameter("px", "choice: none", low=0.0, high=20.0, plausible=(0.0, 1.5))] = 0.0
    """Standard deviation of the blur."""
    light: Annotated[float, Parameter("", "choice: nominal", low=0.0, high=10.0, plausible=(0.6, 1.4))] = 1.0
    """How bright the room is, relative to the rendering."""
    light_change: Annotated[float, Parameter("", "choice: none", low=0.0, high=1.0, plausible=(0.0, 0.3))] = 0.0
    """How far the light swings up and down, as a share of it."""
    light_period_s: Annotated[float, Parameter("s", "choice: a cloud, a passer-by", low=1e-3, high=1e6)] = 20.0
    """How long a swing of the light takes."""
    auto_exposure: Annotated[bool, Parameter("", "choice: none", plausible=(False, True))] = False
    """Whether the camera scales its images so that their mean is `exposure_level`."""
    exposure_level: Annotated[float, Parameter("levels", "choice: middle grey", low=1.0, high=255.0)] = 118.0
    """The mean that the exposure aims at."""
    exposure_lag_s: Annotated[float, Parameter("s", "choice: consumer cameras take some tenths", low=0.0)] = 0.5
    """Time constant with which it gets there; 0 = from one image to the next."""
    glare_levels: Annotated[
        float, Parameter("levels", "choice: none", low=0.0, high=1000.0, plausible=(0.0, 400.0))
    ] = 0.0
    """What a spot of glare adds in its middle; each image has one, anywhere."""
    glare_px: Annotated[float, Parameter("px", "choice", low=0.5, high=1000.0)] = 20.0
    """Standard deviation of the spot."""
    capture_offset_s: Annotated[float, Parameter("s", "choice: none", low=0.0, high=1.0, plausible=(0.0, 0.03))] = 0.0
    """How much later the right image is taken than the left one: the thesis's two calls (section 3.6.3)."""
    frame_rate_hz: Annotated[
        float, Parameter("Hz", "choice: an image an update; the thesis's camera has up to 60", low=0.0, high=1000.0)
    ] = 0.0
    """How many pairs a second the cameras take; between them the last pair is seen again. 0 = one each update."""
    dropped: Annotated[float, Parameter("", "choice: none", low=0.0, high=1.0, plausible=(0.0, 0.05))] = 0.0
    """Share of pairs that are lost: the one before is seen again."""


SETTINGS: dict[str, Parameters] = {
    "none": Parameters(),
    # choices: a fair camera in steady light, one in a room with windows, and all at once
    "mild": Parameters(noise_levels=2.0, blur_px=0.6, capture_offset_s=0.005),
    "changing-light": Parameters(noise_levels=2.0, blur_px=0.6, light_change=0.4, auto_exposure=True),
    "harsh": Parameters(
        noise_levels=6.0, blur_px=1.2, light=0.7, light_change=0.5, light_period_s=10.0, auto_exposure=True,
        exposure_lag_s=1.0, glare_levels=300.0, capture_offset_s=0.03, frame_rate_hz=10.0, dropped=0.05,
    ),
}  # fmt: skip
"""Named settings of the cameras."""


class Memory(NamedTuple):
    """What the cameras of one robot keep."""

    images: Images | None
    """The last pair that was not lost."""
    taken_s: float
    """When the last pair was taken, lost or not; nan = none yet."""
    gain: float
    """Of the exposure, for the next pair; nan = it settles on the first."""
    pool: NDArray[np.int16]
    """(H W 3 + SHIFTS,) noise, or (0,) where there is none."""


def begun(parameters: Parameters, generator: np.random.Generator, height_px: int, width_px: int) -> Memory:
    """Before the first pair; draws the pool of noise where there is noise."""
    size = height_px * width_px * 3 + SHIFTS if parameters.noise_levels > 0.0 else 0
    drawn = generator.standard_normal(size, dtype=np.float32) * np.float32(parameters.noise_levels)
    return Memory(None, math.nan, math.nan, np.round(drawn).astype(np.int16))


def due(parameters: Parameters, memory: Memory, time: float) -> bool:
    """Whether the cameras take a pair at this time (s): if not, none needs to be rendered."""
    rate = parameters.frame_rate_hz
    if rate == 0.0 or math.isnan(memory.taken_s):
        return True
    return math.floor(time * rate + _TIMES) > math.floor(memory.taken_s * rate + _TIMES)


def seen(
    images: Images | None, parameters: Parameters, memory: Memory, generator: np.random.Generator
) -> tuple[Images | None, Memory]:
    """What the robot gets of a perfect pair, or, where none was taken (None), of the one before.

    None until the first pair arrives. The times of the images tell which pair it is.
    """
    draws = generator.random(DRAWS)
    if images is None:
        return memory.images, memory
    if not _any(parameters):
        return images, memory._replace(images=images, taken_s=images.time)
    light = light_at(parameters, images.time)
    gain, later = 1.0, math.nan
    if parameters.auto_exposure:
        brightness = light * (_brightness(images.left) + _brightness(images.right)) / 2.0
        wanted = min(max(parameters.exposure_level / max(brightness, 1e-9), 1.0 / MOST_GAIN), MOST_GAIN)
        gain = wanted if math.isnan(memory.gain) else memory.gain
        later = adapted(gain, wanted, images.time - memory.taken_s, parameters.exposure_lag_s)
    memory = memory._replace(taken_s=images.time, gain=later)
    if draws[0] < parameters.dropped:
        return memory.images, memory
    left, right = (
        _picture(picture, parameters, light * gain, gain, memory.pool, draws[1 + 3 * side : 4 + 3 * side])
        for side, picture in enumerate((images.left, images.right))
    )
    given = Images(images.time, left, right)
    return given, memory._replace(images=given)


def _any(parameters: Parameters) -> bool:
    """Whether anything touches an image or a frame."""
    idle = Parameters()._replace(
        capture_offset_s=parameters.capture_offset_s,
        frame_rate_hz=parameters.frame_rate_hz,
        light_period_s=parameters.light_period_s,
        exposure_level=parameters.exposure_level,
        exposure_lag_s=parameters.exposure_lag_s,
        glare_px=parameters.glare_px,
    )
    return parameters != idle


def _brightness(picture: Picture) -> float:
    return float(picture[::SAMPLED, ::SAMPLED].mean())


def _picture(
    picture: Picture, parameters: Parameters, factor: float, gain: float, pool: NDArray[np.int16], draws: Floats
) -> Picture:
    picture = lit(picture, factor)
    if parameters.glare_levels > 0.0:
        row, column = draws[1] * picture.shape[0], draws[2] * picture.shape[1]
        picture = with_glare(picture, row, column, gain * parameters.glare_levels, parameters.glare_px)
    return noisy(blurred(picture, parameters.blur_px), pool, int(draws[0] * SHIFTS))


def light_at(parameters: Parameters, time: float) -> float:
    """How bright the room is at a time (s), relative to the rendering."""
    swing = math.sin(2.0 * math.pi * time / parameters.light_period_s)
    return parameters.light * (1.0 + parameters.light_change * swing)


def adapted(gain: float, wanted: float, dt: float, lag_s: float) -> float:
    """The gain after `dt` s (nan = the first image: none) on its way to the wanted one, with this time constant."""
    if not dt > 0.0:
        return gain
    return wanted + (gain - wanted) * (math.exp(-dt / lag_s) if lag_s > 0.0 else 0.0)


def lit(picture: Picture, factor: float) -> Picture:
    """The image (H, W, 3) in so many times the light."""
    if factor == 1.0:
        return picture
    table = np.clip(np.round(np.arange(256) * factor), 0, 255).astype(np.uint8)
    made = np.empty_like(picture)
    _look_up(np.ascontiguousarray(picture).ravel(), table, made.ravel())
    return made


@borrowing
def _look_up(values: NDArray[np.uint8], table: NDArray[np.uint8], made: NDArray[np.uint8]) -> None:
    for k in range(len(values)):
        made[k] = table[values[k]]


def with_glare(picture: Picture, row: float, column: float, levels: float, size_px: float) -> Picture:
    """The image with a white spot about a place (px), a Gaussian of this height and standard deviation."""
    reach = 4.0 * size_px
    top, bottom = (int(min(max(v, 0), picture.shape[0])) for v in (row - reach, row + reach + 1))
    left, right = (int(min(max(v, 0), picture.shape[1])) for v in (column - reach, column + reach + 1))
    rows, columns = np.arange(top, bottom) + 0.5 - row, np.arange(left, right) + 0.5 - column
    made = picture.copy()
    down, across = levels * np.exp(-((rows / size_px) ** 2) / 2.0), np.exp(-((columns / size_px) ** 2) / 2.0)
    _brighten(made[top:bottom, left:right], down, across)
    return made


def blurred(picture: Picture, size_px: float) -> Picture:
    """The image blurred by a Gaussian of this standard deviation; its borders are carried on."""
    if size_px == 0.0:
        return picture
    made: Picture = cv2.GaussianBlur(picture, (0, 0), size_px, borderType=cv2.BORDER_REPLICATE)
    return made


def noisy(picture: Picture, pool: NDArray[np.int16], shift: int) -> Picture:
    """The image with a piece of the pool of noise added, which begins at `shift`."""
    if not len(pool):
        return picture
    made = np.empty_like(picture)
    _add(np.ascontiguousarray(picture).ravel(), pool[shift : shift + picture.size], made.ravel())
    return made


@borrowing
def _add(values: NDArray[np.uint8], noise: NDArray[np.int16], made: NDArray[np.uint8]) -> None:
    for k in range(len(values)):
        made[k] = np.uint8(min(max(np.int16(values[k]) + noise[k], 0), 255))


@borrowing
def _brighten(part: Picture, down: Floats, across: Floats) -> None:
    """Adds the product of `down` (H,) and `across` (W,) to all channels of a part (H, W, 3) of an image."""
    for i in range(part.shape[0]):
        for j in range(part.shape[1]):
            more = down[i] * across[j]
            for k in range(3):
                part[i, j, k] = np.uint8(min(math.floor(part[i, j, k] + more + 0.5), 255.0))
