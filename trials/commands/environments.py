"""`herd generate`, `herd validate` and `herd map`: environments of a schema, and what they do to a herd."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from typer import Argument, Option, Typer

from flocking.errors import InputError
from trials.commands.arguments import Jobs, Seed, Settings, jobs_of, whole


def generate(
    schema: Annotated[str, Argument(help="Its name, or the path of your own file: Python, or a grammar in TOML.")],
    out: Annotated[Path, Option(metavar="DIR", help="A new or an empty folder for the files.")],
    count: Annotated[int, Option(parser=whole(1, 1_000_000), metavar="N", help="Environments that pass.")] = 1,
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


def validate(
    environments: Annotated[
        list[Path], Argument(metavar="ENVIRONMENT...", help="Files of environments, or folders of them.")
    ],
    behaviour: Annotated[str, Option(help="Its name, or the path of your own file.")],
    law: Annotated[str, Option(help="Its name, or the path of your own file.")],
    members: Annotated[int, Option(parser=whole(1, 1000), metavar="N", help="Members of the group.")],
    body: Annotated[
        str | None, Option(help="Robots in MuJoCo of that body, as create; kinematic members by default.")
    ] = None,
    scale: Annotated[
        float | None, Option(metavar="M", help="Of robots: metres in a unit of the environment; 0.05 by default.")
    ] = None,
    repeats: Annotated[int, Option(parser=whole(1), metavar="R", help="Starts in each environment.")] = 1,
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
        jobs_of(jobs, None),
        out,
        options.settings(settings or []),
    )
    validation.validate(asked)


def plan(
    task: Annotated[str, Argument(metavar="TASK", help="Its name, as task-3, or the path of your own file.")],
    law: Annotated[str, Option(help="Its name, or the path of your own file.")] = "reynolds-boids",
    members: Annotated[int, Option(parser=whole(1, 100), metavar="N", help="Members of the herd.")] = 4,
    body: Annotated[
        str | None, Option(help="Ranks the walls of a turn anew by robots of that body in MuJoCo, as create.")
    ] = None,
    static: Annotated[
        bool, Option("--static", help="Walls that stand all the time; by default they vanish once the herd is past.")
    ] = False,
    exhaust: Annotated[
        bool, Option("--exhaust", help="Tries all sets of standing walls of the grid, whether any guides a herd.")
    ] = False,
    starts: Annotated[int, Option(parser=whole(1, 1000), metavar="R", help="Herds by which a wall is tried.")] = 6,
    share: Annotated[float, Option(metavar="P", help="Of their members, how many a wall must turn.")] = 0.95,
    budget: Annotated[int, Option(parser=whole(1), metavar="N", help="Most simulations of a stage.")] = 100_000,
    seed: Seed = 1,
    jobs: Jobs = None,
    settings: Settings = None,
    out: Annotated[
        Path | None, Option(metavar="FILE", help="Gets the plan, or as much of it as was found, to go on with.")
    ] = None,
) -> None:
    """Plans the walls that guide a herd through a task.

    One wall a turn, of a grid of angles and lengths, by simulations of kinematic members. Keys of --set: law.*,
    grid.angle_step_deg, grid.lengths_m, grid.robots, grid.reach_m.
    """
    from trials.commands import options, planning

    if not 0.0 < share <= 1.0:
        raise InputError(f"--share {share:g}: expected a share above 0 and at most 1")
    own = options.settings(settings or [])
    asked = planning.Asked(
        task, law, members, body, static, exhaust, starts, share, budget, seed, jobs_of(jobs, None), own, out
    )
    planning.plan(asked)


def pilot(
    experiment: Annotated[str, Argument(help="Whose herd is guided through a task.")] = "piloting",
    number: Annotated[int, Option("--trial", parser=whole(1), metavar="K", help="Number of a trial, from 1.")] = 2,
    times: Annotated[float, Option(metavar="X", help="Times real time, where the machine is fast enough.")] = 4.0,
    settings: Settings = None,
    out: Annotated[Path | None, Option(metavar="FILE.rrd", help="Gets the recording.")] = None,
) -> None:
    """Runs one guided trial in which you say when a wall has been cleared.

    Enter is the key that changes the formation, as in Fine 2015, section 8.2. Keys of --set are the experiment's.
    """
    from trials.commands import options, piloting

    if not times > 0.0:
        raise InputError(f"--times {times:g}: expected a number above 0")
    piloting.pilot(experiment, number, times, options.settings(settings or []), out)


def watch(
    experiment: Annotated[str, Argument(help="Whose herd has a creature that a user controls.")] = "herd-steady",
    number: Annotated[int, Option("--trial", parser=whole(1), metavar="K", help="Number of a trial, from 1.")] = 1,
    times: Annotated[float, Option(metavar="X", help="Times real time, where the machine is fast enough.")] = 1.0,
    settings: Settings = None,
    out: Annotated[Path | None, Option(metavar="FILE.rrd", help="Gets the recording.")] = None,
) -> None:
    """Runs one herd in MuJoCo's viewer, where you steer the creature that it follows.

    Arrows: faster, slower, left, right; space: stand; Escape or closing the window ends it. What you did is told as a
    script for --set. Keys of --set are the experiment's.
    """
    from trials.commands import options, watching

    if not times > 0.0:
        raise InputError(f"--times {times:g}: expected a number above 0")
    watching.watch(experiment, number, times, options.settings(settings or []), out)


def map_(
    schema: Annotated[str, Argument(metavar="SCHEMA", help="Its name, or the path of your own file.")],
    out: Annotated[Path, Option(metavar="DIR", help="A new folder: map.csv, map.json and figures.")],
    behaviour: Annotated[
        str | None, Option(help="Its name, or the path of your own file; the schema's own by default.")
    ] = None,
    law: Annotated[str, Option(help="Its name, or the path of your own file.")] = "reynolds-boids",
    members: Annotated[int, Option(parser=whole(1, 1000), metavar="N", help="Members of the group.")] = 7,
    refinements: Annotated[
        int, Option(parser=whole(0, 12), metavar="R", help="Beyond the first iteration, around successes.")
    ] = 3,
    refined: Annotated[
        str | None, Option(metavar="A,B", help="Parameters that vary; the schema's first two by default.")
    ] = None,
    grid: Annotated[
        str | None, Option(metavar="N|N,M", help="Cells of the first iteration along each of them; 8 by default.")
    ] = None,
    budget: Annotated[int, Option(parser=whole(0), metavar="N", help="Most configurations; 0: any number.")] = 0,
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


def add_to(app: Typer) -> None:
    """Adds these commands to the command `herd`."""
    app.command()(generate)
    app.command()(validate)
    app.command("map")(map_)
    app.command()(plan)
    app.command()(pilot)
    app.command()(watch)
