"""The `herd` command. Large modules are imported where they are needed, so that `herd --help` answers at once."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer import Argument, Option

from flocking import users_files
from flocking.errors import InputError, printable
from trials.commands import plans

LONG = 60
"""Characters of a text that an error repeats."""

app = typer.Typer(
    name="herd",
    help="Simulated herds of iRobot Create robots, and the experiments that made such herds known.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _whole(low: int, high: int | None = None) -> Callable[[str], int]:
    """A parser of whole numbers from `low` to `high`, whose error repeats the text that it was given."""

    def read(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = low - 1
        if number < low or (high is not None and number > high):
            most = f" and at most {high}" if high is not None else ""
            told = text if len(text) <= LONG else f"{text[:LONG]}…"
            raise ValueError(f"{told!r}: expected a whole number of at least {low}{most}")
        return number

    return read


Experiment = Annotated[
    str, Argument(help="Name of an experiment, see `herd list experiments`, or the path of your own file.")
]
Run = Annotated[Path | None, Argument(metavar="[DIR]", help="A run's folder; the newest one below runs/ by default.")]
Repeats = Annotated[
    int | None, Option(parser=_whole(1), metavar="N", help="Repeats of each cell; the experiment's own by default.")
]
Seed = Annotated[int, Option(parser=_whole(0, 2**63 - 1), metavar="S", help="Of all random numbers.")]
Jobs = Annotated[int | None, Option(parser=_whole(1), metavar="J", help="Worker processes; all cores by default.")]
Cluster = Annotated[
    str | None,
    Option(metavar="ADDRESS", help="Of a Dask scheduler, whose workers run the trials: tcp://HOST:8786."),
]
Law = Annotated[str | None, Option(help="Another law: its name or the path of your own file.")]
Pipeline = Annotated[str | None, Option(help="Another member detection.")]
Body = Annotated[str | None, Option(help="Another robot: its name or the path of your own folder.")]
World = Annotated[
    str | None,
    Option(metavar="WORLD", help="Another world: its name, or the path of an environment, a plan or your own file."),
]
Settings = Annotated[
    list[str] | None, Option("--set", metavar="KEY=VALUE", help="Sets a parameter; VALUE is TOML. May be repeated.")
]
Sweeps = Annotated[
    list[str] | None, Option("--sweep", metavar="KEY=A,B,C", help="Runs all of it for each value. May be repeated.")
]
OwnExperiment = Annotated[
    Path | None, Option(metavar="FILE", help="Your own experiment's file, for its claims and figures.")
]


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
    from trials.batch.running import Asked, planned
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
    from trials.commands import lawcheck, listing, options

    if budget is not None and not until_decided:
        raise InputError(f"--budget {budget}: it is of --until-decided; expected both, or --repeats N")
    asked = running.Asked(
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
        print(listing.planned(*running.planned(asked)))
        return 0
    if debug:
        return running.debug(asked)
    return running.start(asked, out, _jobs(jobs, cluster), _report, cluster)[0]


@app.command()
def sensitivity(
    experiment: Experiment,
    claim: Annotated[
        int | None, Option(parser=_whole(1), metavar="N", help="One claim, by its place in the report; all by default.")
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

    return sensitivity(experiment, claim, budget, keys, repeats, seed, _jobs(jobs, None), out)


@app.command()
def resume(folder: Run = None, jobs: Jobs = None, experiment: OwnExperiment = None, cluster: Cluster = None) -> int:
    """Finishes an interrupted run."""
    from trials.batch import running

    own = str(experiment) if experiment is not None else None
    told = partial(_report, experiment=own)
    return running.resume(_run_folder(folder), _jobs(jobs, cluster), told, own, cluster)


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
        int | None, Option(parser=_whole(1), metavar="K", help="Which trial; the first recorded one by default.")
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
    repeat: Annotated[int, Option(parser=_whole(1), metavar="R", help="Whose starting formation.")] = 1,
    world_: Annotated[str | None, Option("--world", metavar="WORLD", help="Another world, as of `herd run`.")] = None,
    settings: Settings = None,
) -> None:
    """Writes an experiment's world for MuJoCo's viewer.

    The compiled world with its robots at their start; it loads in any MuJoCo viewer.
    """
    import shlex

    from trials import simulations
    from trials.batch.folders import write_whole
    from trials.batch.running import Asked, planned
    from trials.commands import lawcheck, options
    from trials.invoked import command

    asked = Asked(experiment, repeats=repeat, settings=options.settings(settings or []), world=world_)
    lawcheck.check_all(asked)
    made, _ = planned(asked)
    chosen = next(trial for trial in made.trials if trial.repeat == repeat)
    world_xml = simulations.of(chosen).world_xml
    if world_xml is None:
        raise InputError(
            f"experiment {experiment!r} is {chosen.simulation}: it has no world for MuJoCo; run it and see it with "
            f"{command('play')}"
        )
    if os.path.lexists(out):
        raise InputError(f"--out {out}: there is such a file; expected a new one")
    write_whole(out, world_xml(chosen).encode())
    print(f"{out}: open it with {shlex.join([sys.executable, '-m', 'mujoco.viewer', f'--mjcf={out}'])}")


app.command("import")(plans.import_)
app.command()(plans.export)


@app.command("map")
def map_(
    schema: Annotated[str, Argument(metavar="SCHEMA", help="Its name, or the path of your own file.")],
    out: Annotated[Path, Option(metavar="DIR", help="A new folder: map.csv, map.json and figures.")],
    behaviour: Annotated[
        str | None, Option(help="Its name, or the path of your own file; the schema's own by default.")
    ] = None,
    law: Annotated[str, Option(help="Its name, or the path of your own file.")] = "reynolds-boids",
    members: Annotated[int, Option(parser=_whole(1, 1000), metavar="N", help="Members of the group.")] = 7,
    refinements: Annotated[
        int, Option(parser=_whole(0, 12), metavar="R", help="Beyond the first iteration, around successes.")
    ] = 3,
    refined: Annotated[
        str | None, Option(metavar="A,B", help="Parameters that vary; the schema's first two by default.")
    ] = None,
    grid: Annotated[
        str | None, Option(metavar="N|N,M", help="Cells of the first iteration along each of them; 8 by default.")
    ] = None,
    budget: Annotated[int, Option(parser=_whole(0), metavar="N", help="Most configurations; 0: any number.")] = 0,
    method: Annotated[Literal["quad-tree", "random"], Option(help="How configurations are chosen.")] = "quad-tree",
    seed: Seed = 1,
    settings: Settings = None,
) -> None:
    """Maps a schema's parameters.

    Which of them make environments that elicit a behaviour, by simulations from mirrored starts. Keys of --set:
    pairs, splits, reliable_share, world.*, behaviour.*, formation.*, box.*, herd.*.
    """
    from trials.commands import mapping, options

    mapping.map_(
        mapping.Asked(
            schema,
            behaviour,
            law,
            members,
            refinements,
            refined,
            grid,
            budget,
            method,
            seed,
            options.settings(settings or []),
            out,
        )
    )


@app.command()
def generate(
    schema: Annotated[str, Argument(help="Its name, or the path of your own file: Python, or a grammar in TOML.")],
    out: Annotated[Path, Option(metavar="DIR", help="A new or an empty folder for the files.")],
    count: Annotated[int, Option(parser=_whole(1, 1_000_000), metavar="N", help="Environments that pass.")] = 1,
    seed: Seed = 1,
    settings: Settings = None,
    vary: Annotated[
        str | None, Option(metavar="A,B,C", help="Parameters to be drawn between their bounds, each time anew.")
    ] = None,
    filter_: Annotated[
        str | None,
        Option("--filter", metavar="F|none", help="Its name, or the path of your own file; the schema's by default."),
    ] = None,
    workspace: Annotated[
        Path | None, Option(metavar="FILE", help="An environment to build in; the schema's own by default.")
    ] = None,
) -> None:
    """Generates environments that pass a filter.

    One JSON file an environment and a contact sheet of the first hundred. Keys of --set are the schema's, or the
    filter's, as in filter.least=4. Environment k of a seed is the same however many there are.
    """
    from trials.commands import options
    from trials.commands.generating import Asked, generate

    names = [name.strip() for name in vary.split(",")] if vary is not None else []
    print(generate(Asked(schema, count, seed, out, options.settings(settings or []), names, filter_, workspace)))


@app.command()
def validate(
    environments: Annotated[
        list[Path], Argument(metavar="ENVIRONMENT...", help="Files of environments, or folders of them.")
    ],
    behaviour: Annotated[str, Option(help="Its name, or the path of your own file.")],
    law: Annotated[str, Option(help="Its name, or the path of your own file.")],
    members: Annotated[int, Option(parser=_whole(1, 1000), metavar="N", help="Members of the group.")],
    body: Annotated[
        str | None, Option(help="Robots in MuJoCo of that body, as create; kinematic members by default.")
    ] = None,
    scale: Annotated[
        float | None, Option(metavar="M", help="Of robots: metres in a unit of the environment; 0.05 by default.")
    ] = None,
    repeats: Annotated[int, Option(parser=_whole(1), metavar="R", help="Starts in each environment.")] = 1,
    mirror: Annotated[bool, Option("--mirror", help="Tries each start's mirror image too.")] = False,
    robustness: Annotated[
        bool, Option("--robustness", help="Perturbs the environments that elicit the behaviour, and ranks them.")
    ] = False,
    seed: Seed = 1,
    jobs: Jobs = None,
    out: Annotated[Path | None, Option(metavar="FILE", help="Writes a row an environment: .csv or .json.")] = None,
    settings: Settings = None,
) -> None:
    """Tries environments with a group.

    Each environment's fitness for a behaviour beside that of its empty world on the same starts, and the uplift. Keys
    of --set: law.*, members.*, starts.*, behaviour.*, robustness.*.
    """
    from trials.commands import options, validation

    asked = validation.Asked(
        environments,
        behaviour,
        law,
        members,
        body,
        scale,
        repeats,
        seed,
        mirror,
        robustness,
        _jobs(jobs, None),
        out,
        options.settings(settings or []),
    )
    validation.validate(asked)


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
    except _StoppedError as stop:
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


class _StoppedError(Exception):
    """Ctrl-C ended a command; the message says what is missing. Typer would take a KeyboardInterrupt for itself."""


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
        raise _StoppedError(f"the report of {folder} is not complete; make it with: {again}") from None


def _jobs(jobs: int | None, cluster: str | None) -> int:
    """Worker processes of this machine: all cores by default."""
    if jobs is not None and cluster is not None:
        raise InputError(f"--jobs {jobs}: counts processes of this machine; expected --jobs or --cluster, not both")
    return jobs or len(os.sched_getaffinity(0))


def _run_folder(folder: Path | None) -> Path:
    from trials.batch.folders import check_name, newest

    if folder is not None:
        check_name(folder)
        return folder

    return newest()


if __name__ == "__main__":
    sys.exit(main())
