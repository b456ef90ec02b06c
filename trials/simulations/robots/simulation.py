"""The simulation `robots`: robots in MuJoCo that see through simulated sensors."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from flocking import found
from flocking.errors import InputError
from robots import body as bodies
from trials.simulations import judged
from trials.simulations.contract import Simulation, Watcher
from trials.simulations.robots import (
    checks,
    fields,
    guided,
    keys,
    link,
    measures_eyes,
    measures_falls,
    measures_guided,
    measures_odometry,
    measures_splitting,
    measures_velocities,
    worldfile,
)
from trials.simulations.robots.measures import ABOUT, HEADINGS, KEY_MEASURES
from trials.simulations.robots.resolved import Resolved
from trials.types import Trial, TrialResult, with_setup
from worlds import formations, known, start_poses

MOMENT_S = 1.0
"""Simulated time in which every robot senses and acts a few times."""
PAIR_LIMIT_S = 1.0
"""Processor time for a pair of images and its truth above which a trial counts as hung: some thirty times what it takes
on a busy machine."""
CONSTANTS = (
    "robots.physics",
    "sensing.laser.readings",
    "sensing.laser.intensity",
    "worlds.formations",
    "trials.simulations.robots.measures",
)


def run_trial(trial: Trial, scans: str, reraise: bool, folder: Path | None) -> TrialResult:
    """See `trials.simulations.run_trial`."""
    from trials.simulations.robots import loop

    return loop.run_trial(trial, scans, reraise, folder)


def watched(trial: Trial, scans: str, watcher: Watcher) -> TrialResult:
    """Runs a trial in which a herd is guided, and somebody says when it has cleared a wall. Raises `InputError`."""
    from trials.simulations.robots import loop

    if not guided.has_task(trial):
        raise InputError(f"experiment {trial.experiment!r} has no task; expected one whose herd is guided, as piloting")
    checks.check(trial)
    return loop.run_trial(trial, scans, watcher=watcher)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording. Rerun is imported only here, since importing it takes long."""
    from trials.simulations.robots.recordings import write

    write(result, path)


def write_images(trial: Trial, folder: Path, every_s: float) -> int:
    """See `labelled_images.write_images`. OpenCV is imported only here, since importing it takes long."""
    from trials.simulations.robots import labelled_images

    return labelled_images.write_images(trial, folder, every_s)


def limit_s(trial: Trial) -> float:
    """Processor time (s) after which a trial counts as hung."""
    robots = sum(group.count for group in trial.groups)
    duration_s = fields.of_trial(trial).duration_s
    return 60.0 + duration_s * (1.0 + robots / 10.0) + PAIR_LIMIT_S * duration_s * _pairs_a_second(trial)


def _pairs_a_second(trial: Trial) -> float:
    """Pairs of images that all robots take in a second."""
    seeing = [group for group in trial.groups if Resolved(group).reads_images]
    return sum(group.count * fields.of_group(group).rate_hz for group in seeing)


def moment(trial: Trial) -> Trial:
    """The trial's first second."""
    seconds = min(MOMENT_S, fields.of_trial(trial).duration_s)
    return with_setup(trial, {"duration_s": seconds})


def prepare() -> None:
    """Imports the loop, the measures and the recordings."""
    import trials.simulations.robots.loop
    import trials.simulations.robots.measures
    import trials.simulations.robots.recordings  # noqa: F401


def at_step(trial: Trial, step: int) -> str:
    """A step of the simulation by its time."""
    return f"at {step * fields.of_trial(trial).timestep_s:.2f} s"


def constants(trial: Trial) -> list[str]:
    """Modules with the constants of the bodies that take part, and of what all robots share."""
    of_bodies = [name for group in trial.groups for name in bodies.load(fields.of_group(group).body).constants]
    return [*dict.fromkeys(of_bodies), *CONSTANTS]


def listed(kind: str) -> Mapping[str, object]:
    """The bodies, worlds or formations of robots."""
    if kind == "bodies":
        return {name: bodies.package(name) for name in bodies.names()}
    if kind == "worlds":
        modules = {name: found.load(known.PACKAGE, name, "world") for name in fields.world_names()}
        return {**modules, "FILE": known.OfFile}
    places: dict[str, object] = {f"robots: {name}": each.place for name, each in formations.FORMATIONS.items()}
    return {**places, "FILE": start_poses.Parameters}


SIMULATION = Simulation(
    keys_of=keys.keys_of,
    check=checks.check,
    settled=keys.settled,
    run_trial=run_trial,
    record=record,
    measures={
        **ABOUT,
        **judged.ABOUT,
        **measures_guided.ABOUT,
        **measures_eyes.ABOUT,
        **measures_splitting.ABOUT,
        **measures_odometry.ABOUT,
        **measures_velocities.ABOUT,
        **measures_falls.ABOUT,
        **link.ABOUT,
    },
    key_measures=KEY_MEASURES,
    limit_s=limit_s,
    moment=moment,
    prepare=prepare,
    at_step=at_step,
    listed=listed,
    constants=constants,
    check_start=checks.check_start,
    has_scans=True,
    world_xml=worldfile.world_xml,
    headings=HEADINGS,
    watched=watched,
    reads_images=lambda trial: any(Resolved(group).reads_images for group in trial.groups),
    write_images=write_images,
)
