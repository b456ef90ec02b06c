"""Members that fail, and when. A member that failed stands for good; the others still see it.

Source: Kirchner 2006, section 4.5: a small chance of each robot at each time step, and one robot in the middle of nine.
"""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np

from flocking.kinematic import Failures
from flocking.types import Floats
from trials.simulations.kinematic import fields
from trials.streams import Purpose, stream
from trials.types import Trial


def failures_of(trial: Trial) -> Failures | None:
    """The failures of a trial's members; None where none can fail.

    By chance each fails at a step of its own, which no condition but the probability changes.
    """
    given = [fields.of_group(group) for group in trial.groups]
    if all(one.failure_probability == 0.0 and one.failure_time_s == fields.NEVER for one in given):
        return None
    own, steps, middles = fields.of_trial(trial), [], []
    firsts = accumulate((group.count for group in trial.groups), initial=0)
    for number, (group, one, first) in enumerate(zip(trial.groups, given, firsts, strict=False)):
        drawn = stream(trial.seed, trial.repeat, number + 1, 0, Purpose.FAILURE).random(group.count)
        steps += [_step_of(u, one.failure_probability, own.steps) for u in drawn.tolist()]
        if one.failure_time_s != fields.NEVER:
            middles.append((round(one.failure_time_s / own.timestep_s), np.arange(first, first + group.count)))
    return Failures(np.array(steps, dtype=np.int64), tuple(middles))


def times_of(failures: Failures, timestep_s: float, steps: int) -> Floats:
    """(N,) the time, s, at which each member failed; nan for those who did not within so many steps."""
    return np.where(failures.steps < steps, failures.steps * timestep_s, math.nan)


def _step_of(u: float, probability: float, most: int) -> int:
    """The step, from 0, at which a member fails, by its quantile `u` in [0, 1); `most` where it does not before."""
    if probability <= 0.0:
        return most
    if probability >= 1.0:
        return 0
    return int(min(math.log1p(-u) / math.log1p(-probability), most))
