"""What is measured of a running herd of N creatures kept at T times; of the test, from the trial's `settle_s` on.

Who has fallen counts as fallen and in nothing else. A group is single linkage at the trial's `cut_m`. Velocities are
over `OVER_S`, so that a gait's own swing drops out.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.measures.groups import group_labels, group_sizes
from flocking.types import Bools, Floats, Ints
from trials.simulations.running import fields, script
from trials.types import Measure, TrialResult

OVER_S = 1.0
"""s. A choice: two hops."""
LATE = 0.1
"""Last part of the test that end values are means over. A choice."""
MOST_MEASURED = 400
"""Most moments whose groups are counted; they are evenly picked."""

ABOUT: dict[str, Measure] = {
    "upright": Measure("", "share of the creatures that are upright at the end"),
    "falls": Measure("", "creatures that fell, before the test too"),
    "first_fall": Measure("s", "from the trial's begin to the first fall; nan = nobody fell"),
    "collisions": Measure("", "times that two creatures came nearer than `collision_m`"),
    "collisions_a_minute": Measure("1/min", "the same, a minute of the test"),
    "closest": Measure("m", "least distance between two creatures"),
    "radius_start": Measure("m", "distance of the farthest creature from the herd's centre, at the begin"),
    "radius_end": Measure("m", "the same, over the last tenth"),
    "aspect_start": Measure("", "narrowest over longest extent (root of the moments' ratio): 1 a circle; at the begin"),
    "aspect_end": Measure("", "the same, over the last tenth"),
    "aspect_least": Measure("", "the same, least"),
    "ahead_1": Measure("m", "how far the user's creature is ahead of the herd's centre, second half of leg 1"),
    "ahead_2": Measure("m", "the same of leg 2; nan without one"),
    "ahead_3": Measure("m", "the same of leg 3"),
    "user_away": Measure("m", "distance of the user's creature from the herd's centre, root of the mean square"),
    "off_course": Measure("m", "of the herd's centre from where it would be had it run as is told, root mean square"),
    "speed_end": Measure("m/s", "speed of the herd's centre over the last tenth"),
    "speed_ratio": Measure("", "the same over the speed that the user's creature is told"),
    "speed_most": Measure("m/s", "highest speed of the herd's centre"),
    "speed_least": Measure("m/s", "lowest"),
    "unrest": Measure("m/s", "deviation of a creature's velocity from the herd's, root of the mean square, last half"),
    "groups_end": Measure("", "number of groups at the end"),
    "largest_share_end": Measure("", "share of the upright creatures in the largest group at the end"),
    "breakaways": Measure("", "groups beside the largest that have not rejoined at the end"),
    "groups_most": Measure("", "most groups at one time"),
    "split_s": Measure("s", "how long the herd was more than one group"),
    "regroup_s": Measure(
        "s", "from its first split until it is one for good; 0 = never split, nan = not until the end"
    ),
    "obstacle_hits": Measure("", "creatures whose centre came within the obstacle"),
    "first_hits": Measure("", "1 if the creature that was nearest to the obstacle at the begin came within it"),
}
KEY_MEASURES = ("upright", "collisions", "radius_end", "aspect_end", "user_away", "speed_ratio", "groups_end")


def measure(result: TrialResult, collisions: int, closest: float) -> dict[str, float]:
    """The measures of a trial, by the names of `ABOUT`; `collisions` and `closest` as they were counted."""
    given = fields.of_trial(result.trial)
    first = min(int(np.searchsorted(result.times, given.settle_s - 1e-9)), len(result.times) - 1)
    times, places = result.times[first:], result.poses_w[first:, :, :2]
    fallen_s = result.tables["fallen_s"]
    up = ~(times[:, None] >= fallen_s)  # nan: it never fell
    found: dict[str, float] = dict.fromkeys(ABOUT, math.nan)
    minutes = (times[-1] - times[0]) / 60.0
    found |= {
        "upright": float(np.isnan(fallen_s).mean()),
        "falls": float(np.isfinite(fallen_s).sum()),
        "first_fall": float(np.nanmin(fallen_s)) if np.isfinite(fallen_s).any() else math.nan,
        "collisions": float(collisions),
        "collisions_a_minute": collisions / minutes if minutes > 0.0 else math.nan,
        "closest": closest if math.isfinite(closest) else math.nan,
    }
    if not up.any(axis=1).all() or not np.isfinite(places).all():
        return found
    centres = np.array([places[t, up[t]].mean(axis=0) for t in range(len(times))])
    late = slice(min(len(times) - 1, math.floor((1.0 - LATE) * (len(times) - 1))), None)
    radii, aspects = _shape(places, up, centres)
    found |= {
        "radius_start": radii[0],
        "radius_end": radii[late].mean(),
        "aspect_start": aspects[0],
        "aspect_end": aspects[late].mean(),
        "aspect_least": aspects.min(),
    }
    found |= _of_user(result, times, places, centres, given) | _speeds(times, places, up, centres, given, late)
    found |= _of_groups(times, places, up, given.cut_m)
    if len(result.tables["obstacle"]):
        hits, first_one = _hits(places, up, result.tables["obstacle"][0])
        found |= {"obstacle_hits": float(hits.sum()), "first_hits": float(hits[first_one])}
    return {name: float(found[name]) for name in ABOUT}


def _shape(places: Floats, up: Bools, centres: Floats) -> tuple[Floats, Floats]:
    """(T,) distance of the farthest from the centre, m, and narrowest over longest extent."""
    radii, aspects = np.zeros(len(places)), np.full(len(places), math.nan)
    for t in range(len(places)):
        away = places[t, up[t]] - centres[t]
        radii[t] = np.hypot(away[:, 0], away[:, 1]).max()
        if len(away) > 2:
            low, high = np.linalg.eigvalsh(away.T @ away)
            aspects[t] = math.sqrt(max(low, 0.0) / high) if high > 0.0 else math.nan
    return radii, aspects


def _of_user(
    result: TrialResult, times: Floats, places: Floats, centres: Floats, given: fields.TrialFields
) -> dict[str, float]:
    """How far the user's creature is from the centre, and ahead of it in each leg."""
    if fields.of_group(fields.group_of(result.trial)).users == 0:
        return {}
    away = places[:, 0] - centres
    found = {"user_away": math.sqrt(float((away**2).sum(axis=1).mean()))}
    legs = script.parse(given.script)
    clock = times - given.settle_s
    told = np.array([[leg.x_m_s, leg.y_m_s] for leg in (script.at(legs, time) for time in clock[:-1])]).reshape(-1, 2)
    way = np.cumsum(told * np.diff(times)[:, None], axis=0)
    off = centres[1:] - centres[0] - way
    found["off_course"] = math.sqrt(float((off**2).sum(axis=1).mean())) if len(off) else math.nan
    ends = [*(leg.from_s for leg in legs[1:]), times[-1] - given.settle_s]
    for number, (leg, end) in enumerate(zip(legs[:3], ends, strict=False), start=1):
        half = (clock >= 0.5 * (leg.from_s + end) - 1e-9) & (clock <= end + 1e-9)
        if half.any() and leg.speed > 0.0:
            found[f"ahead_{number}"] = float((away[half] @ np.array([leg.x_m_s, leg.y_m_s])).mean() / leg.speed)
    return found


def _speeds(
    times: Floats, places: Floats, up: Bools, centres: Floats, given: fields.TrialFields, late: slice
) -> dict[str, float]:
    """How fast the centre of those that stay upright runs, and how far creatures deviate from it."""
    stays = up[-1]
    lag = next((k for k in range(1, len(times)) if times[k] - times[0] >= OVER_S - 1e-9), 0)
    if lag == 0:
        return {}
    spans = (times[lag:] - times[:-lag])[:, None, None]
    velocities = (places[lag:, stays] - places[:-lag, stays]) / spans
    mean = velocities.mean(axis=1)
    speeds = np.hypot(mean[:, 0], mean[:, 1])
    told = script.at(script.parse(given.script), float(times[-1]) - given.settle_s).speed
    end = float(speeds[min(late.start, len(speeds) - 1) :].mean())
    deviations = velocities[len(velocities) // 2 :] - mean[len(velocities) // 2 :, None]
    return {
        "speed_end": end,
        "speed_ratio": end / told if told > 0.0 else math.nan,
        "speed_most": float(speeds.max()),
        "speed_least": float(speeds.min()),
        "unrest": math.sqrt(float((deviations**2).sum(axis=2).mean())),
    }


def _of_groups(times: Floats, places: Floats, up: Bools, cut_m: float) -> dict[str, float]:
    """Into how many groups the herd splits, and for how long."""
    picked = np.unique(np.linspace(0, len(times) - 1, MOST_MEASURED).round().astype(np.int64))
    counts, share = np.zeros(len(picked)), math.nan
    for row, t in enumerate(picked.tolist()):
        sizes: Ints = group_sizes(group_labels(places[t, up[t]], cut_m))
        counts[row], share = float((sizes > 0).sum()), float(sizes.max() / up[t].sum())
    split, at = counts > 1, times[picked]
    regroup = 0.0
    if split.any():
        last = int(np.flatnonzero(split)[-1])
        first = int(np.flatnonzero(split)[0])
        regroup = math.nan if last == len(picked) - 1 else float(at[last + 1] - at[first])
    return {
        "groups_end": counts[-1],
        "largest_share_end": share,
        "breakaways": counts[-1] - 1.0,
        "groups_most": counts.max(),
        "split_s": float(split.mean() * (at[-1] - at[0])),
        "regroup_s": regroup,
    }


def _hits(places: Floats, up: Bools, disc: Floats) -> tuple[Bools, int]:
    """(N,) who came within the disc on the straight ways from moment to moment; and who was nearest to it at first."""
    x, y, radius = disc
    start, way = places[:-1] - [x, y], places[1:] - places[:-1]
    squared = np.maximum((way**2).sum(axis=2), 1e-12)
    part = np.clip(-(start * way).sum(axis=2) / squared, 0.0, 1.0)[..., None]
    near = np.hypot(*np.moveaxis(start + part * way, 2, 0)) < radius
    hits: Bools = (near & up[:-1]).any(axis=0)
    first = np.hypot(*(places[0] - [x, y]).T)
    return hits, int(np.where(up[0], first, math.inf).argmin())
