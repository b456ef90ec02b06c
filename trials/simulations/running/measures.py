"""What is measured of a running herd of N creatures kept at T times; of the test, from the trial's `settle_s` on.

Who has fallen counts as fallen and in nothing else. A group is single linkage at the trial's `cut_m`, of all but the
user's creature, which is told what to do. Speeds are over `OVER_S`; deviations of velocities over `UNREST_S`, since
over two hops most of what robots deviate is their gait.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from flocking.measures.groups import group_labels, group_sizes
from flocking.types import Bools, Floats, Ints
from trials.simulations.running import fields, script
from trials.types import Measure, TrialResult

OVER_S = 1.0
"""s. A choice: two hops."""
UNREST_S = 5.0
"""s. A choice: ten hops."""
PART = 1.0 / 3.0
"""First part of a leg, in which its change is answered. A choice."""
FEWEST = 3
"""Creatures that make a group that breaks away. A choice."""
LATE = 0.1
"""Last part of the test that end values are means over. A choice."""
LAGS_S = np.arange(101) / 10.0
"""s, those that are tried."""
MOST_MEASURED = 400
"""Most moments whose groups are counted; they are evenly picked."""

ABOUT: dict[str, Measure] = {
    "upright": Measure("", "share of the creatures that are upright at the end"),
    "falls": Measure("", "creatures that fell, before the test too"),
    "first_fall": Measure("s", "from the trial's begin to the first fall; nan = nobody fell"),
    "collisions": Measure("", "times that two creatures came nearer than `collision_m`, from 1.25 times it"),
    "collided_pairs": Measure("", "different pairs that did so"),
    "collisions_a_minute": Measure("1/min", "the same, a minute of the test"),
    "closest": Measure("m", "least distance between two creatures"),
    "radius_start": Measure("m", "distance of the farthest creature from the herd's centre, at the begin"),
    "radius_end": Measure("m", "the same, over the last tenth"),
    "aspect_start": Measure("", "narrowest over longest extent (root of the moments' ratio): 1 a circle; at the begin"),
    "aspect_end": Measure("", "the same, over the last tenth"),
    "aspect_least": Measure("", "the same, least"),
    "ahead_1": Measure("m", "how far the user's creature is ahead of the herd's centre, first third of leg 1"),
    "ahead_2": Measure("m", "the same of leg 2; nan without one"),
    "ahead_3": Measure("m", "the same of leg 3"),
    "user_away": Measure("m", "distance of the user's creature from the herd's centre, root of the mean square"),
    "user_lost": Measure("", "1 if the user's creature is farther than `cut_m` from all others at the end"),
    "lag_s": Measure("s", "by which the velocity of the herd's centre follows that told, where it changes; at most 10"),
    "off_course": Measure("m", "of the herd's centre from where it would be had it run as is told, root mean square"),
    "speed_end": Measure("m/s", "speed of the herd's centre over the last tenth"),
    "speed_ratio": Measure("", "the same over the speed that the user's creature is told"),
    "speed_most": Measure("m/s", "highest speed of the herd's centre"),
    "speed_least": Measure("m/s", "lowest"),
    "unrest": Measure(
        "m/s", "deviation of a creature's velocity over 5 s from the herd's, root of the mean square, last half"
    ),
    "groups_end": Measure("", "number of groups at the end"),
    "largest_share_end": Measure("", "share of the upright creatures in the largest group at the end"),
    "breakaways": Measure("", "groups of three and more beside the largest at the end"),
    "strays": Measure("", "creatures outside of all groups of three and more at the end"),
    "groups_most": Measure("", "most groups at one time"),
    "split_s": Measure("s", "how long the herd was more than one group"),
    "regroup_s": Measure(
        "s", "from its first split until it is one for good; 0 = never split, nan = not until the end"
    ),
    "obstacle_hits": Measure("", "creatures that touched the obstacle, half of `collision_m` being their radius"),
    "first_hits": Measure("", "1 if the creature that was nearest to the obstacle at the begin touched it"),
    "parted_m": Measure("m", "widest gap between those that pass the obstacle to its left and to its right"),
    "rejoin_s": Measure(
        "s", "from when that gap is wider than the obstacle's radius until it never is again; nan = not until the end"
    ),
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
        "collided_pairs": float(len({tuple(pair) for pair in _pairs(result).tolist()})),
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
    found |= _of_user(result, times, places, up, centres, given) | _speeds(times, places, up, centres, given, late)
    users = fields.of_group(fields.group_of(result.trial)).users
    found |= _of_groups(times, places[:, users:], up[:, users:], given.cut_m)
    if len(result.tables["obstacle"]):
        disc = result.tables["obstacle"][0]
        hits, first_one = _hits(places, up, np.array([*disc[:2], disc[2] + 0.5 * given.collision_m]))
        found |= {"obstacle_hits": float(hits.sum()), "first_hits": float(hits[first_one])}
        found |= _parted(times, places[:, users:], up[:, users:], disc)
    return {name: float(found[name]) for name in ABOUT}


def centres_of(result: TrialResult) -> Floats:
    """(T, 2) the centre of those who are upright at each moment, m; of all where nobody is."""
    places, fallen_s = result.poses_w[:, :, :2], result.tables["fallen_s"]
    up = ~(result.times[:, None] >= fallen_s)  # nan: it never fell
    up |= ~up.any(axis=1, keepdims=True)
    centres: Floats = (places * up[..., None]).sum(axis=1) / up.sum(axis=1)[:, None]
    return centres


def _pairs(result: TrialResult) -> Ints:
    """(C, 2) which pair each kept collision is of, the lower number first."""
    pairs: Ints = np.column_stack([result.contacts.robots, result.contacts.others])
    return pairs


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
    result: TrialResult, times: Floats, places: Floats, up: Bools, centres: Floats, given: fields.TrialFields
) -> dict[str, float]:
    """How far the user's creature is from the centre, and ahead of it in each leg, while it is upright."""
    if fields.of_group(fields.group_of(result.trial)).users == 0:
        return {}
    there, away = up[:, 0], places[:, 0] - centres
    found = {"user_away": math.sqrt(float((away[there] ** 2).sum(axis=1).mean())) if there.any() else math.nan}
    if there[-1] and up[-1, 1:].any():
        others = places[-1, 1:][up[-1, 1:]] - places[-1, 0]
        found["user_lost"] = float(np.hypot(*others.T).min() > given.cut_m)
    legs = script.parse(given.script)
    clock = times - given.settle_s
    way = np.cumsum(_told(legs, clock[:-1]) * np.diff(times)[:, None], axis=0)
    off = centres[1:] - centres[0] - way
    found["off_course"] = math.sqrt(float((off**2).sum(axis=1).mean())) if len(off) else math.nan
    ends = [*(leg.from_s for leg in legs[1:]), times[-1] - given.settle_s]
    for number, (leg, end) in enumerate(zip(legs[:3], ends, strict=False), start=1):
        part = there & (clock >= leg.from_s - 1e-9) & (clock <= leg.from_s + PART * (end - leg.from_s) + 1e-9)
        if part.any() and leg.speed > 0.0:
            found[f"ahead_{number}"] = float((away[part] @ np.array([leg.x_m_s, leg.y_m_s])).mean() / leg.speed)
    return found


def _told(legs: Sequence[script.Leg], clock: Floats) -> Floats:
    """(T, 2) the velocity that the user's creature is told at these times of the test, m/s."""
    begins = np.array([leg.from_s for leg in legs])
    which = np.clip(np.searchsorted(begins, clock + 1e-9, side="right") - 1, 0, None)
    told: Floats = np.array([[leg.x_m_s, leg.y_m_s] for leg in legs])[which]
    return told


def _lag_s(legs: Sequence[script.Leg], clock: Floats, velocities: Floats) -> float:
    """The delay, s, after which the told velocities are most like those (T, 2) at these times; nan if none changes."""
    if len(legs) < 2 or not (clock > legs[1].from_s).any():
        return math.nan
    errors = np.array([((_told(legs, clock - delay) - velocities) ** 2).sum() for delay in LAGS_S])
    return float(LAGS_S[errors <= errors.min() * (1.0 + 1e-9)].mean())  # moments are coarser than the delays


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
    legs = script.parse(given.script)
    told = script.at(legs, float(times[-1]) - given.settle_s).speed
    end = float(speeds[min(late.start, len(speeds) - 1) :].mean())
    middles = 0.5 * (times[lag:] + times[:-lag]) - given.settle_s
    return {
        "speed_end": end,
        "speed_ratio": end / told if told > 0.0 else math.nan,
        "speed_most": float(speeds.max()),
        "speed_least": float(speeds.min()),
        "unrest": _unrest(times, places[:, stays]),
        "lag_s": _lag_s(legs, middles, mean),
    }


def _unrest(times: Floats, places: Floats) -> float:
    """How far velocities over `UNREST_S` deviate from their mean in the last half, m/s; nan of a shorter test."""
    lag = int(np.searchsorted(times - times[0], UNREST_S - 1e-9))
    first = max(0, min(len(times) // 2, len(times) - lag - 1))
    if lag >= len(times):
        return math.nan
    velocities = (places[first + lag :] - places[first:-lag]) / (times[first + lag :] - times[first:-lag])[
        :, None, None
    ]
    deviations = velocities - velocities.mean(axis=1, keepdims=True)
    return math.sqrt(float((deviations**2).sum(axis=2).mean()))


def _of_groups(times: Floats, places: Floats, up: Bools, cut_m: float) -> dict[str, float]:
    """Into how many groups those who follow split, and for how long."""
    if not up.any(axis=1).all():
        return {}
    picked = np.unique(np.linspace(0, len(times) - 1, MOST_MEASURED).round().astype(np.int64))
    counts, sizes = np.zeros(len(picked)), np.zeros(0, np.int64)
    for row, t in enumerate(picked.tolist()):
        sizes = group_sizes(group_labels(places[t, up[t]], cut_m))
        counts[row] = float((sizes > 0).sum())
    at, large = times[picked], sizes >= FEWEST
    parted_s, regroup_s = _spans(at, counts > 1)
    return {
        "groups_end": counts[-1],
        "largest_share_end": float(sizes.max() / sizes.sum()),
        "breakaways": float(max(0, large.sum() - 1)),
        "strays": float(sizes[~large].sum()),
        "groups_most": counts.max(),
        "split_s": parted_s,
        "regroup_s": regroup_s,
    }


def _spans(at: Floats, parted: Bools) -> tuple[float, float]:
    """How long it is parted, s, and from when it first is until it never is again; 0 if never, nan if it still is."""
    if not parted.any():
        return 0.0, 0.0
    first, last = np.flatnonzero(parted)[[0, -1]].tolist()
    again = math.nan if last == len(at) - 1 else float(at[last + 1] - at[first])
    return float(parted.mean() * (at[-1] - at[0])), again


def _parted(times: Floats, places: Floats, up: Bools, disc: Floats) -> dict[str, float]:
    """The gap between those who pass the disc on either side of the herd's course, while they stay upright."""
    stays = up[-1]
    ways = places[:, stays] - disc[:2]
    if stays.sum() < 2:
        return {}
    course = ways[-1].mean(axis=0) - ways[0].mean(axis=0)
    left = np.array([-course[1], course[0]]) / max(float(np.hypot(*course)), 1e-9)
    nearest = np.hypot(*np.moveaxis(ways, 2, 0)).argmin(axis=0)
    side = ways[nearest, np.arange(ways.shape[1])] @ left > 0.0
    if side.all() or not side.any():
        return {"parted_m": 0.0, "rejoin_s": 0.0}
    gaps = np.array([cKDTree(now[side]).query(now[~side])[0].min() for now in ways])
    return {"parted_m": float(gaps.max()), "rejoin_s": _spans(times, gaps > disc[2])[1]}


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
