"""A Dask cluster that exists already, to which batches send their trials in place of this machine's processes.

Connects, checks what the cluster consists of, and says it. `hands.py` sends the trials, `remote.py` runs them.
"""

from __future__ import annotations

import asyncio
import logging
import pickle
import re
import sys
import warnings
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from flocking.errors import InputError
from flocking.found import is_path
from trials.batch import machine, remote
from trials.batch.patience import STILL_S
from trials.batch.worker import one_line
from trials.simulations import watch
from trials.types import Trial

CONNECT_S = 5.0
"""Wall time in which a scheduler must take a connection, and give each of its answers."""
GREET_S = 15.0
"""Wall time in which it must have given all of those with which a connection begins: Dask itself waits without end for
the first of them."""
ASK_S = 30.0
"""Wall time in which workers are to say what they are, before the first trial."""
CLOSE_S = 2.0
"""Wall time for taking leave of a scheduler."""
EXTRA = "pip install 'create-herd[cluster]'"
ENCRYPTED = ("tls://", "wss://")
_ADDRESS = re.compile(r"((tcp|tls|ws|wss)://)?(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):[0-9]{1,5}")


class Cluster:
    """A connection to a scheduler, which can be opened anew."""

    def __init__(self, address: str) -> None:
        """Connects. Raises `InputError` where no scheduler answers, or one of another version."""
        self.address = address
        self.own = machine.alike()
        self.differing: set[str] = set()
        """Differences between workers and this machine that were said."""
        self.client: Any = _client(address)

    def reopen(self) -> None:
        """Connects anew. Raises `InputError` as long as no scheduler answers."""
        self.close()
        self.client = _client(self.address)

    def close(self) -> None:
        """Cancels what is outstanding and takes leave; a scheduler that does not answer is left alone."""
        with suppress(Exception):
            self.client.close(timeout=CLOSE_S)

    def submit(self, chunk: remote.Chunk, key: tuple[str, int], **where: Any) -> Any:
        """The future of a chunk. Each chunk is one piece of bytes: Dask does not look into it."""
        return self.client.submit(remote.run_chunk, pickle.dumps(chunk), key=key, pure=False, **where)

    def schedule(self, coroutine: Any) -> None:
        """Has a coroutine run beside this thread."""
        asyncio.run_coroutine_threadsafe(coroutine, self.client.loop.asyncio_loop)

    def accept(self, workers: Mapping[str, Mapping[str, Any]]) -> None:
        """Says in one line how workers (their `machine.alike` by address) differ from this machine, each way once.

        Raises `InputError` for one of another version of create-herd.
        """
        found = defaultdict[str, list[str]](list)
        for address, made in workers.items():
            differences = machine.differences(self.own, made)
            if machine.is_other_version(self.own, made):
                raise InputError(
                    f"--cluster {self.address}: worker {address} has another version: {'; '.join(differences)}; "
                    f"expected create-herd {self.own['versions']['create-herd']} with the same sources on all workers"
                )
            if differences:
                found["; ".join(differences)].append(address)
        new = {words: of for words, of in found.items() if words not in self.differing}
        if new:
            self.differing |= set(new)
            told = "; ".join(
                f"{_count(len(of), 'worker')} ({of[0]}{' …' * (len(of) > 1)}): {w}" for w, of in new.items()
            )
            _say(f"workers differ from this machine, and results may in their last bits: {told}")


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """A cluster, whose workers were checked; says what it consists of.

    Raises `InputError` for an address without a scheduler, for one of another version, and for workers of another
    version of create-herd.
    """
    with _quiet():
        cluster = Cluster(address)
        try:
            _greet(cluster)
            yield cluster
        finally:
            cluster.close()


def check_travels(trials: Sequence[Trial]) -> None:
    """Raises `InputError` for trials that take a user's own file of which they do not hold the text."""
    for trial in trials:
        own: dict[str, Any] = {} if trial.formation_source else {"formation": trial.formation}
        own |= {} if trial.world_source else {"world": trial.world}
        own |= {**trial.setup, **{f"world.{name}": value for name, value in trial.world_parameters.items()}}
        own |= {"task": ""} if trial.task_source else {}
        for group in trial.groups:
            for key, value in {"detection": group.pipeline, **own, **group.setup}.items():
                if isinstance(value, str) and is_path(value):
                    raise InputError(
                        f"{key} {value!r}: the texts of users' laws, worlds and schemas go to a cluster, other files "
                        "do not; expected one of the project's own, or a run without --cluster"
                    )


def _client(address: str) -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError(f"--cluster needs dask.distributed, which is not installed: {EXTRA}") from None
    if not _ADDRESS.fullmatch(address):
        raise InputError(f"--cluster {address!r}: expected the address of a scheduler, as in tcp://192.168.1.5:8786")
    _check_certificates(address)

    class Client(distributed.Client):
        """One that waits no longer than that for what takes its connection and stays silent."""

        def start(self, **given: Any) -> None:
            super().start(callback_timeout=GREET_S, **given)

    client: Any = Client.__new__(Client)
    try:
        with warnings.catch_warnings(action="ignore"):  # versions are compared here
            client.__init__(address, timeout=CONNECT_S, set_as_default=False)
    except OSError as error:
        client.status = "closed"  # else its end waits in vain for a connection that it never had, and prints that
        told = f"no Dask scheduler answered there within {CONNECT_S:g} s"
        if isinstance(error, TimeoutError):
            told = f"what takes the connection there does not answer as a Dask scheduler does, within {GREET_S:g} s"
        raise InputError(f"--cluster {address}: {told}; start one with: dask scheduler") from None
    except Exception as error:
        client.status = "closed"
        raise InputError(
            f"--cluster {address}: cannot speak to what answers there ({one_line(str(error))}); expected a Dask "
            f"scheduler with distributed {distributed.__version__}"
        ) from None
    try:
        theirs = client.sync(client.scheduler.versions, callback_timeout=CONNECT_S)["packages"]
        check_scheduler(address, theirs, distributed.versions.get_versions()["packages"])
    except BaseException as error:
        client.close(timeout=CLOSE_S)
        if isinstance(error, OSError):
            raise InputError(f"--cluster {address}: the scheduler there ceased to answer") from None
        raise
    return client


def _check_certificates(address: str) -> None:
    """Refuses an encrypted address where Dask's configuration has no certificates for it: `InputError`."""
    from distributed.security import Security

    if not address.startswith(ENCRYPTED):
        return
    try:
        context = Security().get_connection_args("client")["ssl_context"]
        why = "" if context is not None else "names none"
    except (OSError, ValueError) as error:  # files that are missing, or hold no certificate
        why = f"names some that cannot be read ({one_line(str(error))})"
    if why:
        raise InputError(
            f"--cluster {address}: it is encrypted, which takes certificates, and Dask's configuration {why}; expected "
            "distributed.comm.tls.ca-file, .client.cert and .client.key in it, or a scheduler at tcp://"
        )


def check_scheduler(address: str, theirs: Mapping[str, Any], ours: Mapping[str, Any]) -> None:
    """Raises `InputError` for a scheduler whose Dask or Python is not ours; Python's last number may differ."""
    for name in ("distributed", "python"):
        its, own = (str(each.get(name)).split(".") for each in (theirs, ours))
        if (its[:2], own[:2]) != (own[:2], its[:2]) or (name != "python" and its != own):
            remedy = f"; install it with: pip install distributed=={'.'.join(its)}" if name == "distributed" else ""
            raise InputError(
                f"--cluster {address}: its scheduler has {name} {'.'.join(its)} and this machine {'.'.join(own)}; "
                f"expected the same{remedy}"
            )


def _greet(cluster: Cluster) -> None:
    """Says what a cluster consists of, once its workers have said what they are."""
    client = cluster.client
    threads = client.sync(client.scheduler.ncores, callback_timeout=CONNECT_S)
    _say(
        f"cluster {cluster.address}: {_count(len(threads), 'worker')} with {_count(sum(threads.values()), 'thread')}"
        f"{_dashboard(client)}"
    )
    if threads:
        answers = client.sync(_asked, cluster, list(threads))
        for address, answer in answers.items():
            if isinstance(answer, BaseException):
                raise InputError(
                    f"--cluster {cluster.address}: worker {address} or the scheduler cannot run trials "
                    f"({told(answer)}); expected create-herd {cluster.own['versions']['create-herd']} on scheduler "
                    f"and workers: {EXTRA}"
                )
        cluster.accept({address: answer.made_with for address, answer in answers.items()})
        silent = len(threads) - len(answers)
        if silent:
            _say(f"{_count(silent, 'worker')} did not answer within {ASK_S:g} s and will be checked at the first trial")


async def _asked(cluster: Cluster, workers: Sequence[str]) -> dict[str, Any]:
    """What each worker answers to a chunk without trials, or the error that it meets; without those that are silent."""
    empty = remote.Chunk(cluster.client.id, cluster.own, watch.STEP_LIMIT_S, STILL_S, ())
    futures = {
        worker: cluster.submit(empty, (f"herd-greeting-{cluster.client.id}", number), workers=[worker])
        for number, worker in enumerate(workers)
    }
    asked = {worker: asyncio.ensure_future(future._result()) for worker, future in futures.items()}
    done, _ = await asyncio.wait(asked.values(), timeout=ASK_S)
    found: dict[str, Any] = {}
    for worker, each in asked.items():
        if each not in done:
            each.cancel()
            continue
        try:
            found[worker] = pickle.loads(each.result())
        except BaseException as error:
            found[worker] = error
    return found


def told(error: BaseException) -> str:
    """What went wrong on the cluster, in one line: the cause where Dask gives one."""
    error = error.__cause__ or error
    return one_line(f"{type(error).__name__}: {error}")


def _dashboard(client: Any) -> str:
    try:
        return f", dashboard {client.dashboard_link}"
    except Exception:  # it has none
        return ""


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def _say(text: str) -> None:
    print(f"note: {text}", file=sys.stderr, flush=True)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps Dask's log of a lost connection from the terminal: what matters of it is said in one line."""
    with suppress(ImportError):  # its import gives its client a level of its own; who lacks it is told so later
        import distributed  # noqa: F401
    names = ("distributed", "distributed.client", "distributed.gc", "asyncio", "tornado.application")
    logs = [logging.getLogger(name) for name in names]
    before = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for log, level in zip(logs, before, strict=True):
            log.setLevel(level)
