"""The `herd` command. Large modules are imported where they are needed, so that `herd --help` answers at once."""

from __future__ import annotations

import io
import os
import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer import Argument, Option

from flocking import users_files
from flocking.errors import InputError, printable
from sensing.camera import opengl
from trials.commands import environments, images, plans
from trials.commands.arguments import (
    Body,
    Cluster,
    Experiment,
    Jobs,
    Law,
    OwnExperiment,
    Pipeline,
    Repeats,
    Run,
    Seed,
    Settings,
    Sweeps,
    World,
    jobs_of,
    whole,
)
from trials.commands.stopping import StoppedError

app = typer.Typer(
    name="herd",
    help="Simulated herds of iRobot Create robots, and the experiments that made such herds known.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if not asked:
        return
    from importlib import metadata

    print(f"herd {metadata.version('create-herd')} (Python {sys.version.split()[0]})")
    raise typer.Exit


@app.callback()
def _first(
    version: Annotated[
        bool, Option("--version", callback=_version, is_eager=True, help="Prints the version and ends.")
    ] = False,
) -> None:
    """Simulated herds of iRobot Create robots, and the experiments that made such herds known."""


@app.command("list")
def list_(
    what: Annotated[
        Literal[
            "experiments",
            "laws",
            "pipelines",
            "selections",
            "formations",
            "bodies",
            "worlds",
            "schemas",
            "filters",
            "behaviours",
        ]
        | None,
        Argument(help="One kind; all kinds by default."),
    ] = None,
) -> None:
    """Lists what there is: experiments, laws, pipelines, and all else that a command can name."""
    from trials.commands.listing import listing

    print(listing(what))


@app.command()
def laws(
    name: Annotated[str | None, Argument(help="One law in full: its name or the path of your own file.")] = None,
) -> None:
    """Tables all laws by what they require and how they were validated.

    Tables 3.2 and 3.4 of Fine 2015 for the laws that there are; where the authors of a law left a stage undefined, and
    how it is filled.
    """
    from trials.commands import lawtables

    if name is not None:
        print(lawtables.one_law(name))
        return
    *drawn, told = lawtables.tables()
    print(lawtables.printed(drawn, told))


@app.command()
def show(
    experiment: Experiment,
    repeats: Repeats = None,
    seed: Seed = 1,
    law: Law = None,
    pipeline: Pipeline = None,
    body: Body = None,
    world: World = None,
    settings: Settings = None,
    sweep: Sweeps = None,
) -> None:
    """Shows an experiment's parameters and trials.

    Every parameter with its unit and source, published or chosen, and the trials that it will run.
    """
    from trials.batch.asked import Asked, planned
    from trials.commands import lawcheck, listing, options

    asked = Asked(
        experiment,
        repeats,
        seed,
        options.settings(settings or []),
        options.sweeps(sweep or []),
        law,
        pipeline,
        body,
        world=world,
    )
    lawcheck.check_all(asked)
    print(listing.planned(*planned(asked)))


@app.command()
def run(
    experiment: Experiment,
    repeats: Repeats = None,
    only: Annotated[
        str | None, Option(metavar="1-4,9", help="Only these trials, counted from 1; see --dry-run.")
    ] = None,
    seed: Seed = 1,
    jobs: Jobs = None,
    cluster: Cluster = None,
    out: Annotated[
        Path | None, Option(metavar="DIR", help="Folder of the run; runs/EXPERIMENT/NNN by default.")
    ] = None,
    record: Annotated[
        Literal["all", "first", "none"] | None,
        Option(help="Which trials to record for `herd play`; the experiment's own choice by default."),
    ] = None,
    scans: Annotated[Literal["some", "all"], Option(help="Scans in recordings: 2 a second, or all.")] = "some",
    law: Law = None,
    pipeline: Pipeline = None,
    body: Body = None,
    world: World = None,
    settings: Settings = None,
    sweep: Sweeps = None,
    dry_run: Annotated[bool, Option("--dry-run", help="Only shows what would run.")] = False,
    debug: Annotated[bool, Option("--debug", help="With --only K: runs it here and shows its traceback.")] = False,
    until_decided: Annotated[
        bool, Option("--until-decided", help="Adds repeats, block by block, until each claim is decided.")
    ] = False,
    budget: Annotated[
        str | None,
        Option(metavar="10m|N", help="With --until-decided: a time, or the most repeats; 8 blocks by default."),
    ] = None,
) -> int:
    """Runs an experiment on all cores and reports.

    The exit code is 1 if a trial failed.
    """
    from trials.batch import deciding, running
    from trials.batch.asked import Asked, planned
    from trials.commands import lawcheck, listing, options

    if budget is not None and not until_decided:
        raise InputError(f"--budget {budget}: it is of --until-decided; expected both, or --repeats N")
    asked = Asked(
        experiment,
        repeats,
        seed,
        options.settings(settings or []),
        options.sweeps(sweep or []),
        law,
        pipeline,
        body,
        options.only(only) if only is not None else None,
        record,
        scans,
        until_decided,
        deciding.budget(budget) if budget is not None else deciding.NO_BUDGET,
        world,
    )
    lawcheck.check_all(asked)
    if dry_run:
        print(listing.planned(*planned(asked)))
        return 0
    if debug:
        return running.debug(asked)
    return running.start(asked, out, jobs_of(jobs, cluster), _report, cluster)[0]


@app.command()
def sensitivity(
    experiment: Experiment,
    claim: Annotated[
        int | None, Option(parser=whole(1), metavar="N", help="One claim, by its place in the report; all by default.")
    ] = None,
    budget: Annotated[str, Option(metavar="10m|N", help="Wall time, or a number of trials.")] = "10m",
    keys: Annotated[str | None, Option(metavar="A,B,C", help="Only these choices; all by default.")] = None,
    repeats: Repeats = None,
    seed: Seed = 1,
    jobs: Jobs = None,
    out: Annotated[
        Path | None, Option(metavar="DIR", help="A new folder, or that of an analysis to go on with.")
    ] = None,
) -> int:
    """Shows which unpublished choices a claim's verdict hangs on.

    Varies the choices of an experiment within plausible ranges, a screening first, then a variance-based analysis.
    """
    from trials.commands.sensitivity import sensitivity

    return sensitivity(experiment, claim, budget, keys, repeats, seed, jobs_of(jobs, None), out)


@app.command()
def resume(folder: Run = None, jobs: Jobs = None, experiment: OwnExperiment = None, cluster: Cluster = None) -> int:
    """Finishes an interrupted run."""
    from trials.batch import running

    own = str(experiment) if experiment is not None else None
    told = partial(_report, experiment=own)
    return running.resume(_run_folder(folder), jobs_of(jobs, cluster), told, own, cluster)


@app.command()
def report(
    folder: Run = None,
    json: Annotated[bool, Option("--json", help="Prints the list of claims as JSON.")] = False,
    experiment: OwnExperiment = None,
) -> None:
    """Sets the published beside the measured.

    A table here, figures and one HTML page in the run's folder.
    """
    print(_report(_run_folder(folder), json, str(experiment) if experiment is not None else None))


@app.command()
def play(
    folder: Run = None,
    trial: Annotated[
        int | None, Option(parser=whole(1), metavar="K", help="Which trial; the first recorded one by default.")
    ] = None,
    web: Annotated[bool, Option("--web", help="In the browser instead of the viewer.")] = False,
) -> None:
    """Plays a trial's recording in Rerun."""
    from trials.commands.playback import play

    play(folder, trial, web=web)


@app.command()
def world(
    experiment: Experiment,
    out: Annotated[Path, Option(metavar="FILE", help="Where to write the MJCF.")],
    repeat: Annotated[int, Option(parser=whole(1), metavar="R", help="Whose starting formation.")] = 1,
    world_: Annotated[str | None, Option("--world", metavar="WORLD", help="Another world, as of `herd run`.")] = None,
    settings: Settings = None,
) -> None:
    """Writes an experiment's world for MuJoCo's viewer.

    The compiled world with its robots at their start; it loads in any MuJoCo viewer.
    """
    from trials.commands import options, worldfile

    worldfile.write(experiment, out, repeat, world_, options.settings(settings or []))


app.command("import")(plans.import_)
app.command()(plans.export)
app.command()(images.images)
environments.add_to(app)


@app.command()
def bench(
    save: Annotated[Path | None, Option(metavar="FILE", help="Keeps the figures.")] = None,
    compare: Annotated[Path | None, Option(metavar="FILE", help="Sets kept figures beside these.")] = None,
) -> None:
    """Measures speed."""
    from trials.commands.bench import bench

    bench(save, compare)


def main() -> int:
    """The command: 0 done, 1 a trial failed, 2 bad input (one line on stderr), 130 stopped by Ctrl-C."""
    _find_ours_alone()
    opengl.set_aside()
    try:
        for stream in (sys.stdout, sys.stderr):  # what its encoding cannot show is replaced, and nothing fails
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="replace")
        if len(sys.argv) == 1:
            sys.argv.append("--help")
        with users_files.executed(False):
            code = app(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except InputError as error:
        return _refuse(str(error))
    except (KeyboardInterrupt, typer.Abort):
        return _stopped("")
    except StoppedError as stop:
        return _stopped(f"; {stop}")
    except typer.TyperException as error:
        return _refuse(_told(error.format_message()))
    except BrokenPipeError:  # the reader of the output has closed it, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        if not error.strerror:
            raise
        return _refuse(f"{error.filename}: {error.strerror}" if error.filename else error.strerror)


def _find_ours_alone() -> None:
    """Keeps packages in the working folder, such as another `robots/` or `trials/`, from standing in for ours.

    Python looks there first for what is started as a module: this process, and those that it starts.
    """
    home = str(Path(__file__).resolve().parents[2])
    if sys.path and Path(sys.path[0]).resolve() == Path.cwd() and str(Path.cwd()) != home:
        del sys.path[0]
    os.environ["PYTHONSAFEPATH"] = "1"
    known = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    if home not in known and Path(home).name not in ("site-packages", "dist-packages"):
        os.environ["PYTHONPATH"] = os.pathsep.join([home, *filter(None, known)])


def _told(message: str) -> str:
    """A usage error of Typer in the words of this command."""
    if message.startswith("No such command") and "Did you mean" not in message:
        message += f" Valid: {', '.join(command.name or '' for command in _commands())}."
    return message.replace("Value error, ", "")


def _commands() -> list[Any]:
    return list(typer.main.get_group(app).commands.values())


def _stopped(told: str) -> int:
    print(f"herd: stopped{told}", file=sys.stderr)
    return 130


def _refuse(message: str) -> int:
    print(f"herd: {printable(' '.join(message.split()))}", file=sys.stderr)
    return 2


def _report(folder: Path, as_json: bool = False, experiment: str | None = None) -> str:
    from trials.invoked import command
    from trials.reports.report import report

    try:
        return report(folder, as_json, experiment)
    except KeyboardInterrupt:
        file = ["--experiment", experiment] if experiment is not None else []
        again = command("report", str(folder), *file, *(["--json"] if as_json else []))
        raise StoppedError(f"the report of {folder} is not complete; make it with: {again}") from None


def _run_folder(folder: Path | None) -> Path:
    from trials.batch.folders import check_name, newest

    if folder is not None:
        check_name(folder)
        return folder

    return newest()


if __name__ == "__main__":
    sys.exit(main())
