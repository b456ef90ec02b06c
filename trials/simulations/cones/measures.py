"""What is measured where cameras look at a cone."""

from __future__ import annotations

from trials.types import Measure

ABOUT: dict[str, Measure] = {
    "detected": Measure("", "share of the looks in which the cone was detected, its distance right to within a half"),
    "false_inputs": Measure("", "inputs a look that are no cone's"),
    "distance": Measure("m", "of the cone, by the detection: mean over the looks that found it"),
    "distance_error": Measure("", "of that mean, relative to the true distance; above 0: too far"),
    "distance_deviation": Measure("m", "standard deviation of the distance from look to look"),
    "distance_deviates": Measure("", "amount of the error of a look, relative to the true distance: mean"),
    "bearing_error": Measure("rad", "amount of the error of the bearing: mean"),
    "pixels_found": Measure("", "share of the cone's pixels that are taken for a cone's: mean over the looks"),
    "pixels_false": Measure("", "share of the pixels that are taken for a cone's and show none: mean over the looks"),
    "run": Measure("px", "columns that made the nearest input: mean"),
}
KEY_MEASURES = ("detected", "false_inputs", "distance", "distance_error", "bearing_error")
