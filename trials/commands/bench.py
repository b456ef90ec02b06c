"""`herd bench`: how fast everything is, as medians over repeated runs.

Where one process works alone its processor time is measured, which other work on the machine hardly changes; where
several work it is wall time, and the figure says so. Every figure stands beside its target. Figures can be saved, to be
compared with those of the same machine after a change.
"""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter, process_time

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from robots import body as bodies
from trials.commands import bench_eyes, bench_kinematic, bench_legs, bench_plan, bench_validation
from trials.commands.bench_figures import REPEATS, Figure, processor_s, repeated, timed, wall_s
from trials.design import plan
from trials.simulations.robots.fields import of_trial
from trials.simulations.robots.herd import Herd, assemble
from trials.simulations.robots.log import Log
from trials.simulations.robots.loop import run, run_trial
from trials.types import Trial

SECONDS = 20.0
"""Simulated seconds of each run of a herd."""
RECORDED_SECONDS = 60.0
"""Simulated seconds of the runs that are recorded: a trial's length, since a recording has a fixed cost too."""
GROUP_SIZES = (6, 12, 24, 48, 96)
LARGE = 96
"""Robots of the largest herd of which a whole trial is timed."""
BATCH_TRIALS = 16
BATCH_SECONDS = 60.0
"""Simulated seconds of each trial of the batches."""
BATCHES = 3
"""Times that a batch is run by two workers and by one."""


def bench(save: Path | None = None, compare: Path | None = None) -> None:
    """Measures everything and prints the table; saves it as JSON, compares it with a saved one."""
    from rich.console import Console
    from rich.table import Table

    earlier = _read(compare) if compare is not None else {}
    if save is not None:
        try:
            save.open("a").close()
        except OSError as error:
            raise InputError(f"cannot save to {str(save)!r}: {error.strerror}; expected a file to write") from None
    console = Console()
    figures: list[Figure] = []
    for measure in MEASURES:
        console.print(f"[dim]{(measure.__doc__ or '').splitlines()[0]}[/dim]")
        figures += measure()
    table = Table(title=f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, median of {REPEATS}")
    for column in ("figure", "median", "5/95 %", "target", "met", *(["before", "ratio"] if earlier else [])):
        table.add_column(column, justify="left" if column == "figure" else "right")
    for figure in figures:
        sign = "≥" if figure.at_least else "≤"
        target = "" if math.isnan(figure.target) else f"{sign} {figure.target:g}"
        row = [f"{figure.name} ({figure.unit})", f"{figure.median:.3g}", f"{figure.worst:.3g}", target]
        row.append({True: "yes", False: "NO", None: ""}[figure.met])
        if earlier:
            before = earlier.get(figure.name, math.nan)
            row += [f"{before:.3g}", f"{figure.median / before:.2f}" if before else "-"]
        table.add_row(*row)
    console.print(table)
    if save is not None:
        save.write_text(json.dumps([figure.as_dict() for figure in figures], indent=1) + "\n", encoding="utf-8")


def herd_speed() -> list[Figure]:
    """Herds with lasers, member-based detection and HA, asynchronous, not recorded: simulated by processor time."""
    figures = []
    for count, target in ((6, 100.0), (20, 25.0), (LARGE, math.nan)):
        rates = tuple(SECONDS / seconds for seconds in repeated(_loop_seconds, herd_of(count)))
        figures.append(Figure(f"{count} robots", "x real time", rates, target))
    rates = tuple(SECONDS / seconds for seconds in repeated(processor_s, lambda: run_trial(herd_of(LARGE))))
    return [*figures, Figure(f"{LARGE} robots, built and measured too", "x real time", rates, math.nan)]


def beyond_physics() -> list[Figure]:
    """What the project adds to physics: the whole trial against bare mj_step with the same controls."""
    trial = herd_of(6)
    herd, controls = _with_controls(trial)
    updates = 6 * 10 * SECONDS
    whole, bare = [], []
    for _ in range(REPEATS + 1):
        whole.append(_loop_seconds(trial))
        bare.append(_replayed(herd, controls))
    added = tuple((w - b) / updates * 1e6 for w, b in zip(whole[1:], bare[1:], strict=True))
    return [
        Figure("beyond physics", "µs a robot update", added, 80.0, at_least=False),
        Figure("bare mj_step, 6 robots", "x real time", tuple(SECONDS / b for b in bare[1:]), math.nan),
    ]


def parts() -> list[Figure]:
    """Stages of one robot update, on their own."""
    herd = assemble(herd_of(6), record=False)
    herd.world.advance(to=100)
    robot, data = herd.robots[0], herd.world.data
    senses, _ = robot.sense(data, data.time, None, record=False)
    detection = robot.detect(senses)
    sets = robot.select(detection.members)
    motion = robot.decide(detection, sets)
    clock = itertools.count()  # without a later time the laser makes no new scan, and the last one is sensed again
    calls: dict[str, Callable[[], object]] = {
        "1 sense (scan, noise, truth)": lambda: robot.sense(data, data.time + next(clock), None, record=False),
        "2 detect (member-based)": lambda: robot.detect(senses),
        "3 select": lambda: robot.select(detection.members),
        "4 decide (extended HA)": lambda: robot.decide(detection, sets),
        "5 drive": lambda: robot.drive(motion),
    }
    return [Figure(name, "µs", timed(call, 2000), math.nan, at_least=False) for name, call in calls.items()]


def laser() -> list[Figure]:
    """The rays of one scan, 682 beams among 25 robots and 40 walls, and their difference from MuJoCo's own rays."""
    from sensing.laser.hokuyo import BEAMS, SETTINGS, Lasers
    from sensing.laser.reference import Rays, compare
    from worlds.assemble import prefix, specification
    from worlds.walls import Walls

    rng = np.random.default_rng(5)
    names = [f"herd-{k + 1}" for k in range(25)]
    places = np.stack(np.meshgrid(np.arange(5), np.arange(5)), axis=-1).reshape(-1, 2) * 1.6 - 3.2
    poses_w = np.hstack([places + rng.uniform(-0.5, 0.5, size=(25, 2)), rng.uniform(-np.pi, np.pi, size=(25, 1))])
    angles = np.arange(40) * 2 * math.pi / 40
    corners = 5.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    segments = np.hstack([corners, np.roll(corners, -1, axis=0)])
    model = specification(Walls(segments, 0.8), [bodies.load("create")] * 25, names, poses_w, 0.01).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    sites = [f"{prefix(name)}laser" for name in names]
    roots = [model.body(f"{prefix(name)}base").id for name in names]
    lasers, rays = Lasers(model, sites, roots, [SETTINGS["ideal"]] * 25), Rays(model, sites, roots)
    turns = itertools.cycle(range(25))
    scans = timed(lambda: lasers.trace(data, next(turns)), 2000)
    apart = compare(lasers, rays, data)
    return [
        Figure("rays of a scan", "µs", scans, math.nan, at_least=False),
        Figure("rays", "million a second", tuple(BEAMS / scan for scan in scans), math.nan),
        Figure("beams off by more than 1 cm", "%", (100.0 * apart.distant / apart.beams,), 0.2, at_least=False),
    ]


def floor_plan() -> list[Figure]:
    """Four Creates that go about a floor plan of many rooms and keep away from its walls, on one core."""
    made = bench_plan.creates(SECONDS)
    runs = [bench_plan.loop_seconds(made) for _ in range(REPEATS + 1)][1:]
    name = f"{bench_plan.ROBOTS} robots in a plan of {len(bench_plan.floor_plan().workspace)} walls"
    return [
        Figure(f"{name}, physics and scans", "x real time", tuple(SECONDS / parts for _, parts in runs), 100.0),
        Figure(f"{name}, whole loop", "x real time", tuple(SECONDS / whole for whole, _ in runs), math.nan),
    ]


def piloting() -> list[Figure]:
    """One trial of `herd run piloting`: four Creates with lasers, guided by six others, on one core; all of it."""
    trial = guided_trial()
    seconds = of_trial(trial).duration_s
    rates = tuple(seconds / each for each in repeated(processor_s, lambda: run_trial(trial)))
    return [Figure("a trial of piloting, 4 robots and 6 pilots", "x real time", rates, 30.0)]


def eyes() -> list[Figure]:
    """A robot that follows another by two cameras, on one core, where OpenGL is to be had: pairs of images a second."""
    return bench_eyes.figures()


def legs() -> list[Figure]:
    """One-legged robots that run over open ground, on one core: the whole loop, and bare mj_step beside it."""
    found = bench_legs.measured(REPEATS, SECONDS / 5.0)
    herd, (small, large) = f"{bench_legs.HERD} one-legged robots", bench_legs.SIZES
    return [
        Figure("1 one-legged robot", "x real time", found["one"], 500.0),
        Figure(herd, "x real time", found["herd"], math.nan),
        Figure(f"{herd}, against bare mj_step", "x", found["bare"], math.nan, at_least=False),
        Figure(f"{herd} that herd", "x real time", found["herding"], 8.0),
        Figure(f"{herd} that herd, against bare mj_step", "x", found["of herding"], 1.4, at_least=False),
        Figure(f"cost per one-legged robot, {large} against {small}", "ratio", found["growth"], 2.0, at_least=False),
    ]


def growth() -> list[Figure]:
    """Cost per robot as the herd and its world grow together."""
    costs: dict[int, tuple[float, ...]] = {}
    for count in GROUP_SIZES:
        trial = herd_of(count, seconds=max(2.0, SECONDS * 6 / count))
        costs[count] = repeated(
            lambda trial=trial, count=count: _loop_seconds(trial) / of_trial(trial).duration_s / count * 1e3
        )
    figures = [
        Figure(f"cost at {count} robots", "ms a robot second", runs, math.nan, at_least=False)
        for count, runs in costs.items()
    ]
    ratios = tuple(b / a for a, b in zip(costs[GROUP_SIZES[0]], costs[GROUP_SIZES[-1]], strict=True))
    return [*figures, Figure("cost per robot, 96 against 6", "ratio", ratios, 2.0, at_least=False)]


def recording() -> list[Figure]:
    """What a recording with default settings adds to a trial's time, and the size of its file."""
    from trials.simulations.robots import recordings

    trial = herd_of(6, seconds=RECORDED_SECONDS)
    added, sizes = [], []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trial.rrd"
        for _ in range(REPEATS + 1):
            plain = processor_s(lambda: run_trial(trial))
            recorded = processor_s(lambda: recordings.write(run_trial(trial, scans="some"), path))
            added.append(100.0 * (recorded / plain - 1.0))
            sizes.append(path.stat().st_size / 1e6)
    return [
        Figure("recording adds", "% of a trial", tuple(added[1:]), 25.0, at_least=False),
        Figure("recording of a minute, scans at 2 Hz", "MB", tuple(sizes[1:]), 5.0, at_least=False),
    ]


def workers() -> list[Figure]:
    """Trials a second by two workers against one, without the time that starting them takes."""
    from trials.batch import store
    from trials.batch.batch import Work, run_batch

    class Clock:
        """Notes when each trial ended."""

        def __init__(self) -> None:
            self.times: list[float] = []

        def say(self, text: str) -> None:
            """Shows nothing."""

        def ended(self, row: store.Row) -> None:
            """Notes the time."""
            self.times.append(perf_counter())

        def goes_on(self, text: str, count: int) -> None:
            """Shows nothing."""

    def rate(jobs: int) -> float:
        trials = [dataclasses.replace(herd_of(6, seconds=BATCH_SECONDS), index=i + 1) for i in range(BATCH_TRIALS)]
        with tempfile.TemporaryDirectory() as folder:
            run = {"experiment": "bench", "trials": [trial.as_dict() for trial in trials]}
            kept = store.create(Path(folder) / "run", run, {})
            clock = Clock()
            run_batch(trials, kept, clock, jobs=jobs, work=Work())
        first = 2 * jobs
        return (len(clock.times) - first) / (clock.times[-1] - clock.times[first - 1])

    ratios = tuple(rate(2) / rate(1) for _ in range(BATCHES))
    return [Figure("two workers against one, wall time", "x", ratios, 1.8)]


def start_up() -> list[Figure]:
    """`herd --help` in a process of its own."""
    command = [sys.executable, "-m", "trials.commands.cli", "--help"]
    return [
        Figure(
            "herd --help, wall time",
            "s",
            repeated(wall_s, lambda: subprocess.run(command, stdout=subprocess.DEVNULL, check=True)),
            0.5,
            at_least=False,
        )
    ]


def kinematic_herd() -> list[Figure]:
    """Boids in unbounded space with a short range, on one core; and against the same law without a compiler.

    Without a compiler, members are computed one by one: by the law's own function as it is written, and by a version
    rewritten for NumPy's arrays.
    """
    found = bench_kinematic.measured(repeated)
    targets = {"10,000 boids": 100.0}
    figures = [
        Figure(name, "steps/s", runs, targets.get(name, math.nan)) for name, runs in found.items() if "boids" in name
    ]
    most, least = max(bench_kinematic.SIZES), min(bench_kinematic.SIZES)
    growth_name = f"cost of a step, {least:,} to {most:,} boids"
    figures.append(Figure(growth_name, "exponent", found["exponent"], 1.15, at_least=False))
    small = f"{bench_kinematic.SMALL} boids against"
    figures.append(Figure(f"{small} the same law, not compiled", "x faster", found["plain"], 200.0))
    figures.append(Figure(f"{small} one rewritten in NumPy's arrays", "x faster", found["numpy"], math.nan))
    return figures


def validation() -> list[Figure]:
    """Validation of splitting environments by 25 boids, 200 iterations, on one core; and not compiled."""
    rates, times = bench_validation.measured(repeated)
    return [
        Figure("validation, 25 boids", "environments/s", rates, 600.0),
        Figure("validation against the same law, not compiled", "x faster", times, 300.0),
    ]


def whole_experiment() -> list[Figure]:
    """`herd run lch-table-4-1`: 160 simulations with their report on all cores, the start of processes included."""
    return [
        Figure(
            "lch-table-4-1, wall time on all cores",
            "s",
            repeated(bench_kinematic.table_4_1_seconds),
            20.0,
            at_least=False,
        )
    ]


MEASURES: Sequence[Callable[[], list[Figure]]] = (
    herd_speed,
    beyond_physics,
    parts,
    laser,
    floor_plan,
    piloting,
    eyes,
    legs,
    growth,
    recording,
    workers,
    start_up,
    kinematic_herd,
    validation,
    whole_experiment,
)


def herd_of(count: int, seconds: float = SECONDS) -> Trial:
    """A trial of the detection case study with that many robots, in a corridor that is long enough for them."""
    trial = plan("detection-case-study", repeats=1).trials[1]
    length = 2.0 * math.ceil(count + 0.5 * seconds + 10.0)
    return dataclasses.replace(
        trial,
        setup={**trial.setup, "duration_s": seconds},
        groups=(dataclasses.replace(trial.groups[0], count=count),),
        world_parameters={"length_m": length},
    )


def guided_trial() -> Trial:
    """The first trial of the piloting study in which robots guide."""
    from trials.simulations.robots.guided import PILOTS

    return next(each for each in plan("piloting", repeats=1).trials if each.setup["piloting.guides"] == PILOTS)


def _last_tick(trial: Trial) -> int:
    given = of_trial(trial)
    return round(given.duration_s / given.timestep_s)


def _loop_seconds(trial: Trial) -> float:
    """Processor time of the loop, without building the world."""
    herd = assemble(trial, record=False)
    log = Log(trial, len(herd.robots), "none")
    return processor_s(lambda: run(herd, log, last=_last_tick(trial)))


def _with_controls(trial: Trial) -> tuple[Herd, Floats]:
    """The herd after its trial, and the controls (steps, nu) of every step."""
    herd = assemble(trial, record=False)
    controls: list[Floats] = []
    herd.world.observers.append(lambda data: controls.append(data.ctrl.copy()))
    run(herd, Log(trial, len(herd.robots), "none"), last=_last_tick(trial))
    return herd, np.array(controls)


def _replayed(herd: Herd, controls: Floats) -> float:
    """Processor time of bare mj_step through the same controls from the same start."""
    model, data, step = herd.world.model, mujoco.MjData(herd.world.model), mujoco.mj_step
    mujoco.mj_forward(model, data)
    ctrl = data.ctrl
    started = process_time()
    for row in controls:
        ctrl[:] = row
        step(model, data)
    return process_time() - started


def _read(path: Path) -> dict[str, float]:
    try:
        return {row["name"]: float(row["median"]) for row in json.loads(path.read_text(encoding="utf-8"))}
    except OSError as error:
        raise InputError(f"cannot read {str(path)!r}: {error.strerror}") from None
    except (ValueError, TypeError, KeyError):
        raise InputError(f"{str(path)!r} is no saved bench: expected what `herd bench --save FILE` wrote") from None
