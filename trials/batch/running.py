"""Runs of an experiment: started in a new folder, resumed, or one trial of it run for its traceback."""

from __future__ import annotations

import re
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from time import monotonic
from types import ModuleType
from typing import TYPE_CHECKING, Any

from flocking import lawdata, lawentry, users_files
from flocking.errors import InputError
from flocking.lawentry import is_path
from trials import simulations
from trials.batch import deciding, folders, machine, progress, runfile, store, worker
from trials.batch.asked import Asked, looks_of, planned, ranges, record_of
from trials.batch.batch import Work, run_batch
from trials.batch.crew import check_main_guard
from trials.batch.kinds import kinds
from trials.batch.store import Row, Store
from trials.design import load
from trials.invoked import command, herd, spelled
from trials.types import Trial

if TYPE_CHECKING:
    from trials.batch.cluster import Cluster

SHOWN_FAILURES = 10
"""Failed trials that the summary at the end lists."""
Report = Callable[[Path], str]
"""Makes the report of a run's folder and returns its table."""
RECORD, SCANS = ("all", "first", "none"), ("some", "all")


def start(asked: Asked, out: Path | None, jobs: int, report: Report, cluster: str | None = None) -> tuple[int, Path]:
    """Runs what is asked for into a new folder and reports; returns the exit code and the folder.

    `cluster`: address of a Dask scheduler, whose workers run the trials in place of `jobs` processes.
    """
    check_main_guard()
    made, chosen = planned(asked)
    for note in made.notes:
        print(f"note: {note}", file=sys.stderr)
    if out is not None and str(out) in ("", "."):
        raise InputError(f"--out {str(out)!r}: expected a new or empty folder for the run")
    folders.check_name(out)
    run = {
        "format": runfile.FORMAT,
        "experiment": made.experiment,
        "command": asked.command(),
        "repeats": made.repeats,
        "seed": asked.seed,
        "settings": asked.settings,
        "conditions": made.conditions,
        "sweep": asked.sweep,
        "law": asked.law,
        "pipeline": asked.pipeline,
        "body": asked.body,
        "world": asked.world,
        "only": ranges(asked.only) if asked.only is not None else None,
        "record": asked.record or record_of(asked.experiment),
        "scans": asked.scans,
        "notes": made.notes,
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        **machine.made_with(),
        "laws": declared_laws(chosen),
        "trials": [trial.as_dict() for trial in chosen],
    }
    experiment = load(asked.experiment)
    if asked.until_decided:
        planned_for = out or Path("runs") / made.experiment / "new"
        looks = looks_of(asked)
        run["until_decided"] = deciding.laid_down(planned_for, chosen, experiment, looks, asked.budget)
    if cluster is None:
        _check_rendering(chosen)
    with engine(cluster, chosen) as hands, folders.new_folder(out, made.experiment) as folder:
        kept = store.create(folder, run, code_of(chosen))
        try:
            return _run_rest(kept, jobs, report, experiment, hands), folder
        except InputError:  # nothing could be run: no unfinished run is left behind
            if not kept.rows():
                store.removed(kept)
            raise
        finally:
            kept.close()


def resume(folder: Path, jobs: int, report: Report, experiment: str | None = None, cluster: str | None = None) -> int:
    """Runs the trials of a run that have not ended yet; returns the exit code.

    `experiment`: the path of a user's own, whose claims say what is left of a run until decided.

    A trial that failed has ended, so the table is the same as if the run had not been interrupted. A trial whose worker
    died has not. `cluster` as in `start`.
    """
    kept = store.opened(folder)
    try:
        if cluster is None:
            _check_rendering(kept.trials)
        with folders.alone(folder), engine(cluster, kept.trials) as hands:
            code = code_of(kept.trials)
            store.check_code(kept, code)
            changed = machine.differences(kept.run, machine.made_with())
            if changed:
                print(
                    f"note: changed since this run began: {'; '.join(changed)}; results may differ in their last bits",
                    file=sys.stderr,
                )
            run_here = [str(folder / folders.CODE / name) for name in code if name.endswith(".py")]
            users = [*run_here, *users_bodies(kept.trials)]
            if users:
                print(f"note: runs the user's {', '.join(users)}", file=sys.stderr)
            _tell_misfits(kept)
            module = deciding.experiment_of(kept, experiment) if "until_decided" in kept.run else None
            return _run_rest(kept, jobs, report, module, hands)
    finally:
        kept.close()


@contextmanager
def engine(address: str | None, trials: Sequence[Trial]) -> Iterator[Cluster | None]:
    """The cluster at that address, for these trials; None for none.

    Raises `InputError` if no scheduler answers there, or the trials or the cluster's versions do not fit.
    """
    if address is None:
        yield None
        return
    from trials.batch import cluster

    cluster.check_travels(trials)
    with cluster.connected(address) as connected:
        yield connected


def debug(asked: Asked) -> int:
    """Runs one trial in this process, keeps nothing, and shows the traceback of what fails; returns the exit code.

    Ctrl-C ends it and shows where it is, also in a law that never returns.
    """
    import faulthandler

    from trials.batch.worker import run_and_write

    if asked.only is None or len(asked.only) != 1:
        raise InputError("--debug runs one trial in this process: say which, as in --only 5 --debug")
    _, (trial,) = planned(asked)
    faulthandler.enable()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a handler in Python would wait for compiled code to return
    faulthandler.register(signal.SIGINT, chain=True)
    print(f"trial {trial.index}: seed {trial.seed}, repeat {trial.repeat}, {conditions(trial)}", flush=True)
    try:
        with users_files.executed(True), tempfile.TemporaryDirectory(prefix="herd-") as kept:
            recorded = (asked.record or record_of(asked.experiment)) != "none"
            files = folders.Files(None, Path(kept) / "trial.rrd" if recorded else None)
            output = run_and_write(trial.as_dict(), asked.scans, files)
        if output.status != "done":  # run once more with its error raised, to see where
            with users_files.executed(True):
                simulations.run_trial(trial, reraise=True)
    except Exception:
        traceback.print_exc()
        return 1
    print(f"{output.status}{': ' if output.reason else ''}{output.reason}")
    for name, value in output.measures.items():
        print(f"{name:32} {value:.6g}")
    return 0 if output.status == "done" else 1


def _check_rendering(trials: Sequence[Trial]) -> None:
    """Raises `InputError` where trials need images and nothing here renders them: before any is run."""
    if any(simulations.of(trial).reads_images(trial) for trial in kinds(trials)):
        from sensing.camera import opengl

        opengl.library()


def conditions(trial: Trial) -> str:
    """The conditions of a trial in one line."""
    return ", ".join(f"{key}={spelled(value)}" for key, value in trial.conditions.items()) or "no conditions"


def code_of(trials: Sequence[Trial]) -> dict[str, str]:
    """The texts of the users' files that take part, under names of their own; of a plan, the environment's JSON."""
    found: dict[str, str] = {}
    texts = {(group.law, group.law_source): None for trial in trials for group in trial.groups if group.law_source}
    texts |= {(trial.world, trial.world_source): None for trial in trials if trial.world_source}
    texts |= {(trial.formation, trial.formation_source): None for trial in trials if trial.formation_source}
    texts |= {(str(trial.setup.get("task")), trial.task_source): None for trial in trials if trial.task_source}
    for law, text in texts:
        path = _kept_as(Path(law))
        name, number = path.name, 2
        while found.get(name, text) != text:
            name, number = f"{path.stem}-{number}{path.suffix}", number + 1
        found[name] = text
    return found


def _kept_as(path: Path) -> Path:
    """The name under which the text of a user's file is kept: that of a plan is an environment's, as JSON."""
    return path if path.suffix.lower() in (".py", ".json", ".csv", ".toml") else path.with_name(f"{path.name}.json")


def users_bodies(trials: Sequence[Trial]) -> list[str]:
    """The folders of the users' own bodies that take part: they are run from where they are."""
    named = dict.fromkeys(str(group.setup.get("body", "")) for trial in trials for group in trial.groups)
    return [name for name in named if is_path(name)]


def declared_laws(trials: Sequence[Trial]) -> dict[str, Any]:
    """What the users' laws that take part declare, by the digest of their text: reports need it, and run no law."""
    laws = {group.law_source: group.law for trial in trials for group in trial.groups if group.law_source}
    modules = {source: (law, lawentry.module_of(law, source)) for source, law in laws.items()}
    return {runfile.text_digest(source): lawdata.as_data(*module) for source, module in modules.items()}


def _run_rest(
    kept: Store, jobs: int, report: Report, experiment: ModuleType | None, cluster: Cluster | None = None
) -> int:
    """Runs the trials that have no row yet or whose worker died, and reports; returns the exit code.

    Of a run until decided it runs those that the next look needs, look by look; `experiment` then has its claims.
    """
    record, scans = kept.run.get("record"), kept.run.get("scans")
    if record not in RECORD or scans not in SCANS:
        raise InputError(f"{kept.folder / folders.RUN} is damaged: record {record!r}, scans {scans!r}")
    recorded = {"all": kept.trials, "first": kept.trials[:1], "none": []}[record]
    blocks = deciding.Blocks(kept, experiment) if "until_decided" in kept.run and experiment is not None else None
    rows = kept.rows()
    ended = {row.index for row in rows if not row.reason.startswith(store.DIED)}
    wanted = kept.trials
    if blocks is not None:
        begun = {row.index for row in rows}
        first = {trial.index for trial in blocks.first()}
        wanted = [trial for trial in wanted if trial.index in begun | first]
    left = [trial for trial in wanted if trial.index not in ended]
    for trial in left:
        try:
            simulations.check(trial)
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            raise InputError(f"{kept.folder / folders.RUN}: trial {trial.index}: {error}") from error
    started, stopped, new, expected = monotonic(), 0, 0, len(wanted)
    if left:
        with progress.shown(expected, len(ended)) as shown:
            summary = run_batch(
                left,
                kept,
                shown,
                jobs=jobs,
                work=Work(
                    scans=scans,
                    recorded=frozenset(trial.index for trial in recorded),
                    imports=worker.imports_of(left),
                    warm_up=kinds(left),
                    more=partial(blocks.next, shown) if blocks is not None else None,
                ),
                cluster=cluster,
            )
        stopped, new = summary.stopped, len(summary.rows)
    rows = kept.rows()
    if stopped:
        expected = max(expected, len(rows)) if blocks is None else blocks.expected
        where = ["--cluster", cluster.address] if cluster is not None else []
        print(
            f"herd: stopped; {len(rows)} of {expected} trials are kept in {kept.folder}; "
            f"finish it with: {command('resume', str(kept.folder), *_own_file(kept), *where)}",
            file=sys.stderr,
        )
        return 128 + stopped
    _close(kept, rows, new, monotonic() - started, report)
    return 1 if any(row.status != "done" for row in rows) else 0


def again_of(run: Mapping[str, Any]) -> str:
    """The command that plans the trials of a run, of one until decided all that it might run."""
    words = str(run.get("command")).replace("herd", herd(), 1)
    if "until_decided" not in run:
        return words
    words = re.sub(r" --until-decided( --budget \S+)?| --repeats \S+", "", words)
    return f"{words} --repeats {deciding.looks_of(run)[-1]}"


def _own_file(kept: Store) -> list[str]:
    """What resuming a run until decided of a user's own experiment takes: the words that name its file."""
    own = runfile.own_experiment(kept.run)
    return ["--experiment", own] if own is not None and "until_decided" in kept.run else []


def _tell_misfits(kept: Store) -> None:
    """Names the trials that are run again since what is kept of them is not theirs."""
    planned = {trial.index for trial in kept.trials}
    told = [f"note: trial {index} is run again: {why}" for index, why in kept.misfits.items() if index in planned]
    for line in told[:SHOWN_FAILURES]:
        print(line, file=sys.stderr)
    if len(told) > SHOWN_FAILURES:
        print(f"note: so are {len(told) - SHOWN_FAILURES} more", file=sys.stderr)


def _close(kept: Store, rows: Sequence[Row], new: int, seconds: float, report: Report) -> None:
    """Prints the report's table and the summary; the summary also where the report cannot be made."""
    try:
        print(report(kept.folder))
    finally:
        print("\n".join(["", *_summary(kept, rows, new, seconds)]))


def _summary(kept: Store, rows: Sequence[Row], new: int, seconds: float) -> list[str]:
    """Lines on what was run, what failed, and where everything is."""
    folder = kept.folder
    failed = [row for row in rows if row.status != "done"]
    done = f"{len(rows) - len(failed)} done, {len(failed)} failed"
    took = f", {new} of them now, in" if new < len(rows) else " in"
    lines = [f"{len(rows)} trial{'s' * (len(rows) != 1)}: {done}{took} {progress.duration(seconds)}"]
    for row in failed[:SHOWN_FAILURES]:
        lines.append(progress.failure(row))
        lines.append(f"  once more, with its traceback: {again_of(kept.run)} --only {row.index} --debug")
    if len(failed) > SHOWN_FAILURES:
        lines.append(f"… and {len(failed) - SHOWN_FAILURES} more failed; all are in {folder / folders.RESULTS}")
    died = sum(row.reason.startswith(store.DIED) for row in failed)
    if died:
        again = command("resume", str(folder), *_own_file(kept))
        lines.append(f"{died} of them lost their workers; run these again with: {again}")
    lines.append(f"results     {folder}")
    if (folder / "report.html").exists():
        lines.append(f"report      {folder / 'report.html'}")
    recorded = [row.index for row in rows if kept.recording(row.index)]
    if recorded:
        lines.append(f"recordings  {folder / folders.RECORDINGS}, {len(recorded)} of {len(rows)} trials")
        lines.append(f"play one    {command('play', str(folder), '--trial', str(recorded[0]))}")
    return lines
