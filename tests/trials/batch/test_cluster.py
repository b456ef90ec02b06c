"""Batches on a Dask cluster: the same trials, the same results, whatever happens to workers and scheduler."""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from flocking.errors import InputError
from trials import batch as batches
from trials.batch import cluster, machine, running
from trials.batch.batch import Summary, Work, run_batch
from trials.batch.store import Row
from trials.reports.report import report
from trials.types import Trial

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1]))
import dask_cluster
import fake_trials
from test_batch import batch, new_store, table

pytest.importorskip("distributed", reason="needs dask.distributed: pip install 'create-herd[cluster]'")


class Told:
    """Progress that calls what a test has laid down for the moment at which so many trials are kept."""

    def __init__(self, then: dict[int, Callable[[], None]] | None = None) -> None:
        self.then, self.kept = then or {}, 0

    def say(self, text: str) -> None: ...

    def ended(self, row: Row) -> None:
        self.kept += 1
        self.then.get(self.kept, lambda: None)()


def on_cluster(
    address: str, folder: Path, trials: Sequence[Trial], then: dict[int, Callable[[], None]] | None = None, **how: Any
) -> Summary:
    kept = new_store(folder, trials)
    try:
        with cluster.connected(address) as connected:
            return run_batch(trials, kept, Told(then), jobs=1, work=Work(run=fake_trials.run, **how), cluster=connected)
    finally:
        kept.close()


def files(folder: Path) -> dict[str, bytes]:
    found = sorted([*(folder / "series").iterdir(), *(folder / "recordings").iterdir()])
    return {path.name: path.read_bytes() for path in found}


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dask_cluster.Cluster]:
    """A scheduler and two workers, which their nannies start again when they die."""
    with dask_cluster.cluster(tmp_path_factory.mktemp("dask"), 2, nanny=True) as made:
        yield made


def test_all_is_as_with_two_local_jobs(
    two: dask_cluster.Cluster, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rows with their reasons, series and recordings, bit for bit; also of trials that fail, hang or die."""
    acts = ["raise", "exit", "kill", "hang", "nan", "sys.exit", "work", "half an answer", "spin watched"]
    trials = [fake_trials.trial(k, act) for k, act in enumerate([*acts, *["succeed"] * 41], start=1)]
    how: dict[str, Any] = {
        # one limit for each act: of two, a busy machine may see either first
        "limit_s": lambda trial: 1.0 if trial.conditions["act"] == "work" else 600.0,
        "still_s": 1.0,
        "law_limit_s": 0.5,
        "recorded": frozenset({11, 30}),
        "warm_up": trials[9:10],
    }
    batch(tmp_path / "local", trials, **how)
    summary = on_cluster(two.address, tmp_path / "cluster", trials, **how)
    assert len(summary.rows) == 50
    assert table(tmp_path / "cluster") == table(tmp_path / "local")
    assert files(tmp_path / "cluster") == files(tmp_path / "local")
    assert f"cluster {two.address}: 2 workers with 2 threads" in capsys.readouterr().err


def test_ctrl_c_cancels_what_is_under_way_and_frees_the_workers(two: dask_cluster.Cluster, tmp_path: Path) -> None:
    trials = [fake_trials.trial(k, act) for k, act in enumerate(["succeed", "succeed", "hang", "hang", "hang"], 1)]
    summary = on_cluster(two.address, tmp_path / "run", trials, {2: lambda: os.kill(os.getpid(), signal.SIGINT)})
    assert summary.stopped == signal.SIGINT
    assert [row[0] for row in table(tmp_path / "run")] == [1, 2]
    assert len(on_cluster(two.address, tmp_path / "next", [fake_trials.trial(k) for k in (1, 2)]).rows) == 2


def test_a_trial_that_kills_worker_after_worker_fails_alone(two: dask_cluster.Cluster, tmp_path: Path) -> None:
    trials = [fake_trials.trial(k, act) for k, act in enumerate(["succeed", "kill the parent", "succeed"], 1)]
    rows = {row.index: row for row in on_cluster(two.address, tmp_path / "run", trials).rows}
    assert rows[1].status == rows[3].status == "done"
    assert rows[2].reason.startswith("its worker process died (2 workers of the cluster were lost with it, the last")
    two.wait_for_workers(2)


def test_one_worker_killed_and_one_paused(tmp_path: Path) -> None:
    """The paused one goes on after the third has done some trials; every trial has the row of a local one."""
    trials = [fake_trials.trial(k, seconds=0.3) for k in range(1, 25)]
    batch(tmp_path / "local", trials)
    with dask_cluster.cluster(tmp_path, 3) as made:
        killed, paused, _ = made.workers

        def harm() -> None:
            killed.kill()
            paused.send_signal(signal.SIGSTOP)

        then = {3: harm, 10: lambda: paused.send_signal(signal.SIGCONT)}
        summary = on_cluster(made.address, tmp_path / "cluster", trials, then)
    assert sorted(row.index for row in summary.rows) == list(range(1, 25))
    assert table(tmp_path / "cluster") == table(tmp_path / "local")
    assert files(tmp_path / "cluster") == files(tmp_path / "local")


def test_the_scheduler_is_restarted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The batch waits for one at the same address, and has its workers run what had not come back."""
    trials = [fake_trials.trial(k, seconds=0.1) for k in range(1, 21)]
    batch(tmp_path / "local", trials)
    with dask_cluster.cluster(tmp_path, 1) as made:

        def restart() -> None:
            port = made.port
            assert made.scheduler is not None
            made.scheduler.kill()
            made.scheduler.wait()
            made.start_scheduler(port)
            made.start_worker()

        summary = on_cluster(made.address, tmp_path / "cluster", trials, {3: restart})
    assert len(summary.rows) == 20
    assert table(tmp_path / "cluster") == table(tmp_path / "local")
    assert [record for record in caplog.records if record.name.startswith("distributed")] == []  # one line is enough


def test_an_experiment_has_the_series_and_rows_of_a_local_run_also_when_it_is_resumed(
    two: dask_cluster.Cluster, tmp_path: Path
) -> None:
    how: dict[str, Any] = {"repeats": 1, "settings": {"steps": 2}, "record": "first"}
    batches.run("lch-table-4-1", tmp_path / "local", jobs=2, **how)
    batches.run("lch-table-4-1", tmp_path / "cluster", cluster=two.address, **how)
    assert table(tmp_path / "cluster") == table(tmp_path / "local")
    local, remote = files(tmp_path / "local"), files(tmp_path / "cluster")
    assert list(local) == list(remote)
    series = [name for name in local if name.endswith(".npz")]  # a recording holds times of day
    assert len(series) == len(local) - 1
    assert [remote[name] for name in series] == [local[name] for name in series]
    with closing(sqlite3.connect(tmp_path / "cluster" / "results.sqlite")) as kept, kept:
        kept.execute("DELETE FROM trials WHERE idx > 3")
    assert len(table(tmp_path / "cluster")) == 3
    assert running.resume(tmp_path / "cluster", 1, lambda folder: "", cluster=two.address) == 0
    assert table(tmp_path / "cluster") == table(tmp_path / "local")
    assert [files(tmp_path / "cluster")[name] for name in series] == [local[name] for name in series]


def test_a_run_until_decided_has_the_plan_rows_and_verdicts_of_a_local_run(
    two: dask_cluster.Cluster, tmp_path: Path
) -> None:
    """By the command: which trials come next is decided here, and who runs them makes no difference."""
    words = ["lch-table-4-1", "--until-decided", "--repeats", "3", "--budget", "6", "--set", "steps=2"]
    for name, where in (("local", ["--jobs", "2"]), ("cluster", ["--cluster", two.address])):
        done = subprocess.run(
            [sys.executable, "-m", "trials.commands.cli", "run", *words, "--record", "none", *where, "--out", name],
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        assert ("dashboard http://" in done.stderr) == (name == "cluster")
    local, remote = tmp_path / "local", tmp_path / "cluster"
    assert table(remote) == table(local)
    assert files(remote) == files(local)
    kept = [json.loads((folder / "run.json").read_text()) for folder in (local, remote)]
    assert kept[0]["until_decided"] == kept[1]["until_decided"]
    assert kept[0]["until_decided"]["looks"] == [3, 6]
    entries = [json.loads(report(folder, as_json=True)) for folder in (local, remote)]
    assert entries[0] == entries[1]
    # some claims were decided at the first look and others went on, so that the cluster was handed trials twice
    assert {len(entry["looks"]) for entry in entries[0]} == {1, 2}


def test_the_link_to_the_dashboard_is_told(two: dask_cluster.Cluster, capsys: pytest.CaptureFixture[str]) -> None:
    with cluster.connected(two.address):
        told = capsys.readouterr().err
    port = json.loads(two.file.read_text())["services"]["dashboard"]
    assert told.endswith(f", dashboard http://127.0.0.1:{port}/status\n")
    with socket.create_connection(("127.0.0.1", port), timeout=dask_cluster.DEADLINE_S):
        pass  # it is the scheduler's own, and open


def test_a_cluster_that_grows_and_shrinks_by_itself(tmp_path: Path) -> None:
    """It has no worker at the start, and two at the most."""
    trials = [fake_trials.trial(k, seconds=0.2) for k in range(1, 13)]
    batch(tmp_path / "local", trials)
    made = dask_cluster.Cluster(tmp_path)
    try:
        made.start_adaptive(most=2)
        summary = on_cluster(made.address, tmp_path / "cluster", trials)
    finally:
        made.stop()
    assert len(summary.rows) == 12
    assert table(tmp_path / "cluster") == table(tmp_path / "local")


def test_workers_of_another_state_of_the_sources_are_refused(tmp_path: Path) -> None:
    other = tmp_path / "other"
    for package in {path.parent for path in dask_cluster.HOME.glob("*/__init__.py")} - {dask_cluster.HOME / "scripts"}:
        shutil.copytree(package, other / package.name, ignore=shutil.ignore_patterns("__pycache__"))
    with (other / "trials" / "rows.py").open("a") as file:
        file.write("# another state\n")
    made = dask_cluster.Cluster(tmp_path)
    try:
        made.start_scheduler()
        made.start_worker(home=other)
        made.wait_for_workers(1)
        with pytest.raises(InputError, match=r"worker tcp://.* has another version: the project's sources; expected"):
            on_cluster(made.address, tmp_path / "run", [fake_trials.trial(1)])
    finally:
        made.stop()
    assert table(tmp_path / "run") == []


def test_an_address_without_a_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)
    with socket.socket() as nobody:  # bound, and nobody listens
        nobody.bind(("127.0.0.1", 0))
        with pytest.raises(InputError, match=r"no Dask scheduler answered there within 0\.5 s; start one with"):
            cluster.Cluster(f"tcp://127.0.0.1:{nobody.getsockname()[1]}")


ALONE = """
import socket, sys, threading
from flocking.errors import InputError
from trials.batch import cluster

cluster.GREET_S, kept = 0.5, []

def answer(listening):
    while True:
        kept.append(listening.accept()[0])
        kept[-1].sendall(sys.argv[2].encode() * 100)

with socket.create_server(("127.0.0.1", 0)) as listening:
    threading.Thread(target=answer, args=(listening,), daemon=True).start()
    try:
        cluster.Cluster(f"{sys.argv[1]}://127.0.0.1:{listening.getsockname()[1]}")
    except InputError as error:
        print(error)
"""


@pytest.mark.parametrize(
    ("scheme", "certificate", "answer", "told"),
    [
        ("tls", "", "", "Dask's configuration names none; expected distributed.comm.tls.ca-file"),
        ("wss", "", "", "Dask's configuration names none; expected distributed.comm.tls.ca-file"),
        ("tls", "nowhere.pem", "", "names some that cannot be read ([Errno 2] No such file or directory"),
        ("tcp", "", "HTTP/1.0 400 no", "cannot speak to what answers there"),
        ("tcp", "", "", "does not answer as a Dask scheduler does, within 0.5 s; start one with: dask scheduler"),
    ],
)
def test_what_cannot_be_spoken_to_is_told_in_one_line_and_nothing_comes_after_it(
    scheme: str, certificate: str, answer: str, told: str
) -> None:
    """In a process of its own, to its end: a client of Dask that is not closed tells of that when it is removed."""
    tls = {"CA_FILE": certificate, "CLIENT__CERT": certificate, "CLIENT__KEY": certificate}
    given = {f"DASK_DISTRIBUTED__COMM__TLS__{name}": value for name, value in tls.items() if value}
    words = [sys.executable, "-c", ALONE, scheme, answer]
    env = {**dask_cluster.environment(dask_cluster.HOME), **given}
    ended = subprocess.run(words, env=env, capture_output=True, text=True, timeout=dask_cluster.DEADLINE_S)
    assert ended.stderr == ""
    assert told in ended.stdout
    assert ended.stdout.count("\n") == 1


@pytest.mark.parametrize("address", ["", "nowhere", "tcp://", "http://127.0.0.1:8786", "tcp://127.0.0.1", "a b:1"])
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(InputError, match="expected the address of a scheduler, as in tcp://"):
        cluster.Cluster(address)


def test_without_dask_its_installation_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"not installed: pip install 'create-herd\[cluster\]'"):
        cluster.Cluster("tcp://127.0.0.1:8786")


@pytest.mark.parametrize(
    ("name", "its", "fits"),
    [
        ("distributed", "2026.8.0", True),
        ("distributed", "2026.8.1", False),
        ("python", "3.11.9.final.0", True),
        ("python", "3.12.1.final.0", False),
    ],
)
def test_a_scheduler_of_another_version(name: str, its: str, fits: bool) -> None:
    ours = {"distributed": "2026.8.0", "python": "3.11.7.final.0"}
    if fits:
        cluster.check_scheduler("tcp://a:1", {**ours, name: its}, ours)
    else:
        with pytest.raises(InputError, match=f"its scheduler has {name} {its} and this machine {ours[name]}"):
            cluster.check_scheduler("tcp://a:1", {**ours, name: its}, ours)


def test_another_processor_is_warned_of_once(capsys: pytest.CaptureFixture[str]) -> None:
    made = cluster.Cluster.__new__(cluster.Cluster)
    made.address, made.own, made.differing = "tcp://a:1", machine.alike(), set()
    workers = {f"tcp://b:{k}": {**made.own, "cpu": "another"} for k in (1, 2)}
    made.accept(workers)
    made.accept(workers)
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].startswith("note: workers differ from this machine, and results may in their last bits: 2 workers")
    assert said[0].endswith(f"processor {made.own['cpu']} → another")


def test_what_does_not_travel_is_named() -> None:
    trial = fake_trials.trial(1)
    group = dataclasses.replace(trial.groups[0], setup={"body": "mine/robot"})
    with pytest.raises(InputError, match="body 'mine/robot': the texts of users' laws, worlds and schemas go to a"):
        cluster.check_travels([dataclasses.replace(trial, groups=(group,))])
    given = {"setup": {"behaviour": "mine.py"}}, {"world": "mine.toml"}, {"world_parameters": {"parts": "parts.toml"}}
    for values, named in zip(
        given, ("behaviour 'mine.py'", "world 'mine.toml'", "world.parts 'parts.toml'"), strict=True
    ):
        with pytest.raises(InputError, match=named):
            cluster.check_travels([dataclasses.replace(trial, **values)])
    own = dataclasses.replace(trial, setup={**trial.setup, "task": "mine.json"})
    with pytest.raises(InputError, match=r"task 'mine\.json'"):
        cluster.check_travels([own])
    cluster.check_travels([dataclasses.replace(own, task_source="{}")])
    cluster.check_travels([trial, dataclasses.replace(trial, world="mine.toml", world_source="about = ''")])
