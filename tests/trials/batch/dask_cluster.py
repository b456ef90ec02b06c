"""A Dask scheduler and workers as processes of their own on the loopback, at ports that the system chooses."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

TESTS, HOME = Path(__file__).parents[1], Path(__file__).parents[3]
DEADLINE_S = 120.0
"""Wall time after which a process that was started counts as broken: nothing is judged by it."""


_ADAPTIVE = """
import json, sys, time
from distributed import LocalCluster

if __name__ == "__main__":
    made = LocalCluster(
        n_workers=0, threads_per_worker=1, host="127.0.0.1", scheduler_port=0, dashboard_address="127.0.0.1:0"
    )
    made.adapt(minimum=0, maximum=int(sys.argv[2]), interval="100ms", wait_count=2)
    with open(sys.argv[1], "w") as file:
        json.dump({"address": made.scheduler_address}, file)
    while True:
        time.sleep(1.0)
"""


class Cluster:
    """The processes of a cluster. A worker's process is that of its nanny where it has one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []
        self.started = 0

    def start_scheduler(self, port: int = 0, script: str | None = None) -> None:
        self.file.unlink(missing_ok=True)
        what = ["-m", "dask", "scheduler"] if script is None else ["-c", script, "scheduler"]
        options = ["--host", "127.0.0.1", "--port", str(port), "--scheduler-file", str(self.file)]
        options += ["--dashboard-address", "127.0.0.1:0"]
        self.scheduler = self._start([*what, *options])
        wait_for(lambda: self.file.exists() and self.file.stat().st_size > 0, self.scheduler)

    def start_worker(self, nanny: bool = False, home: Path = HOME) -> subprocess.Popen[bytes]:
        options = ["--host", "127.0.0.1", "--nthreads", "1", "--scheduler-file", str(self.file), "--no-dashboard"]
        options += ["--local-directory", str(self.folder), "--nanny" if nanny else "--no-nanny"]
        self.workers.append(self._start(["-m", "dask", "worker", *options], home))
        return self.workers[-1]

    def start_adaptive(self, most: int) -> None:
        """A scheduler that starts and ends workers itself, by how much there is to do."""
        self.scheduler = self._start(["-c", _ADAPTIVE, str(self.file), str(most)])
        wait_for(lambda: self.file.exists() and self.file.stat().st_size > 0, self.scheduler)

    def wait_for_workers(self, count: int) -> None:
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=DEADLINE_S)

    @property
    def address(self) -> str:
        return str(json.loads(self.file.read_text())["address"])

    @property
    def port(self) -> int:
        return int(self.address.rsplit(":", 1)[1])

    def stop(self) -> None:
        for process in [*self.workers, *filter(None, [self.scheduler])]:
            for child in psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []:
                child.kill()
            process.kill()
            process.wait()

    def _start(self, words: list[str], home: Path = HOME) -> subprocess.Popen[bytes]:
        self.started += 1
        with (self.folder / f"{self.started}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, *words], stdout=log, stderr=log, env=environment(home), cwd=self.folder
            )


def environment(home: Path) -> Mapping[str, str]:
    """Of the processes: they find the project of that folder, and the trials of tests. A task may be lost once."""
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(home), str(TESTS)]),
        "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
    }


def wait_for(holds: Any, process: subprocess.Popen[bytes] | None = None) -> None:
    """Waits until `holds()`, as long as the process lives."""
    end = time.monotonic() + DEADLINE_S
    while not holds():
        assert process is None or process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.05)


@contextmanager
def cluster(folder: Path, workers: int, nanny: bool = False) -> Iterator[Cluster]:
    """A cluster with workers of one thread."""
    made = Cluster(folder)
    try:
        made.start_scheduler()
        for _ in range(workers):
            made.start_worker(nanny)
        made.wait_for_workers(workers)
        yield made
    finally:
        made.stop()
