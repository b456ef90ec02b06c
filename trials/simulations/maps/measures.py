"""What is measured of one map: how many configurations are successful, and what their region is like.

A configuration is successful if the behaviour shows in at least `reliable_share` of its simulations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from flocking.types import Bools, Floats
from generation.maps.judging import Control
from generation.maps.regions import region
from generation.maps.trees import ParameterMap
from trials.types import Measure

ABOUT: dict[str, Measure] = {
    "configurations": Measure("", "configurations that were judged"),
    "successful": Measure("", "those that are successful: + in the document's figures"),
    "successful_share": Measure("", "share of the configurations that are successful"),
    "first_successful": Measure("", "successful configurations of the first iteration"),
    "refused": Measure("", "configurations of which the schema makes nothing"),
    "region_area": Measure("", "share of the possible parameters that the successful cells cover"),
    "region_density": Measure(
        "", "share of success about a successful place, in a window of the first iteration's cell"
    ),
    "clustering": Measure("", "region_density over region_area: 1 where successes are strewn at random"),
    "components": Measure("", "parts of the region that faces connect"),
    "largest_share": Measure("", "volume share of the largest of them; 0 without any"),
    "success": Measure("", "mean share of successful simulations, over the possible parameters"),
    "success_inside": Measure("", "the same inside of the box"),
    "success_outside": Measure("", "the same outside of it"),
    "control_success": Measure("", "the same in the empty world, on the starts of the first 64 configurations"),
    "uplift": Measure("", "success less control_success"),
    "uplift_inside": Measure("", "success_inside less control_success"),
    "best_success": Measure("", "share of successful simulations of the best configuration"),
    "middle_1": Measure("", "the value of the first refined parameter in the middle of the successful configurations"),
    "middle_2": Measure("", "the value of the second one"),
    "trend_1": Measure("", "rank correlation of success with the first refined parameter, first iteration"),
    "trend_2": Measure("", "the same of the second one"),
    "trend_rest": Measure("", "the same of 1 less both, where both are probabilities: of the third one"),
    "x_deviation_low": Measure("m", "5 % of the configurations have a smaller deviation along x at the end"),
    "x_deviation": Measure("m", "half of them"),
    "x_deviation_high": Measure("m", "95 % of them"),
    "x_deviation_least": Measure("m", "the smallest"),
    "x_deviation_within": Measure("", "share of them from 1.5 to 4.0 m (Fine 2015, figure 7.14)"),
    "x_deviation_below": Measure("", "share of them below 0.5 m: near a single line"),
    "control_x_deviation": Measure(
        "m", "mean deviation in the empty world, on the starts of the first 64 configurations"
    ),
}
"""Every measure, in the order in which they are shown."""
KEY_MEASURES = ("configurations", "successful", "region_area", "region_density", "largest_share")
"""Those that a first look at a run needs."""
TYPICAL_M = (1.5, 4.0)
"""Fine 2015, section 7.4.2: the deviations of most configurations of DSDR."""
LINE_M = 0.5
"""A deviation that is near a single line. A choice: half of the separation of the herd's members."""


def measure(map_: ParameterMap, within: Mapping[str, tuple[float, float]] | None, control: Control) -> dict[str, float]:
    """The measures of a map, by the names of `ABOUT`; nan where there is nothing to measure."""
    possible, successful, found = map_.possible, map_.successful, region(map_, within)
    share = map_.judged.successes[possible] / map_.judged.trials[possible]
    deviations = map_.judged.x_deviation[possible]
    first = possible & (map_.levels <= 0)
    count = int(possible.sum())
    middle = np.median(map_.points[successful], axis=0) if successful.any() else np.full(len(map_.box.axes), math.nan)
    columns = [map_.points[first, column] for column in range(len(map_.box.axes))][:2]
    judged = map_.judged.successes[first] / map_.judged.trials[first]
    trends = [_trend(column, judged) for column in columns]
    low, half, high = np.quantile(deviations, [0.05, 0.5, 0.95]) if count else [math.nan] * 3
    values = {
        "configurations": count,
        "successful": successful.sum(),
        "successful_share": successful.sum() / count if count else math.nan,
        "first_successful": (successful & (map_.levels == 0)).sum(),
        "refused": (~possible).sum(),
        "region_area": found.area,
        "region_density": found.density,
        "clustering": found.density / found.area if found.area else math.nan,
        "components": found.components,
        "largest_share": 0.0 if found.components == 0.0 else found.largest_share,
        "success": found.mean,
        "success_inside": found.inside,
        "success_outside": found.outside,
        "control_success": control.success,
        "uplift": found.mean - control.success,
        "uplift_inside": found.inside - control.success,
        "best_success": share.max() if count else math.nan,
        "middle_1": middle[0],
        "middle_2": middle[1] if len(middle) > 1 else math.nan,
        "trend_1": trends[0],
        "trend_2": trends[1] if len(trends) > 1 else math.nan,
        "trend_rest": _trend(1.0 - columns[0] - columns[1], judged) if _simplex(map_) else math.nan,
        "x_deviation_low": low,
        "x_deviation": half,
        "x_deviation_high": high,
        "x_deviation_least": deviations.min() if count else math.nan,
        "x_deviation_within": _share((deviations >= TYPICAL_M[0]) & (deviations <= TYPICAL_M[1])),
        "x_deviation_below": _share(deviations < LINE_M),
        "control_x_deviation": control.x_deviation,
    }
    return {name: float(values[name]) for name in ABOUT}


def _simplex(map_: ParameterMap) -> bool:
    """Whether the refined parameters can be two of three probabilities."""
    return len(map_.box.axes) == 2 and all((axis.low, axis.high) == (0.0, 1.0) for axis in map_.box.axes)


def _share(mask: Bools) -> float:
    return float(mask.mean()) if len(mask) else math.nan


def _trend(values: Floats, success: Floats) -> float:
    """Spearman's rank correlation; 0 where the success does not differ, nan for fewer than three configurations."""
    from scipy.stats import spearmanr

    if len(values) < 3:
        return math.nan
    if np.ptp(success) == 0.0 or np.ptp(values) == 0.0:
        return 0.0
    return float(spearmanr(values, success).statistic)
