"""Plays a trial's recording: in Rerun's viewer, or in a browser where there is no display."""

from __future__ import annotations

import importlib.util
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import quote

from flocking.errors import InputError
from trials.batch.asked import ranges
from trials.batch.folders import check_name
from trials.batch.worker import end_with_parent
from trials.commands.webpage import served
from trials.invoked import command

LOOPBACK = "127.0.0.1"
"""The viewer's servers would listen on all addresses by default, where others could reach them."""
STARTING_S = 20.0
"""How long the web server may take to answer."""


def play(folder: Path | None, trial: int | None, web: bool) -> None:
    """Shows the recording of a trial until the viewer is closed or Ctrl-C is pressed.

    `folder`: a run's folder, by default the newest run's; `trial`: from 1, by default the first recorded.
    Without a display, or with `web`, a web viewer is served on the loopback address and its URL printed.
    Raises `InputError` for a trial that was not recorded and for a viewer that does not start.
    """
    check_name(folder)
    path = recording(folder, trial)
    if web or not has_display():
        _serve(path)
    else:
        _show(path)


def recording(folder: Path | None, trial: int | None) -> Path:
    """The file to play. Raises `InputError`, naming the recorded trials, if there is none."""
    if folder is None:
        from trials.batch.folders import newest

        folder = newest()
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder: expected the folder of a run")
    files = sorted((folder / "recordings").glob("*.rrd"))
    recorded = {int(path.stem): path for path in files if path.stem.isascii() and path.stem.isdecimal()}
    if not recorded:
        raise InputError(f"no trial of {folder} was recorded: run it with --record all or --record first")
    if trial is None:
        return recorded[min(recorded)]
    if trial not in recorded:
        spans = ranges(list(recorded), between=", ")
        raise InputError(f"trial {trial} of {folder} was not recorded; recorded: {spans}")
    return recorded[trial]


def has_display() -> bool:
    """Whether a window can open here."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def viewer_command(path: Path, port: int, web_port: int | None) -> list[str]:
    """The viewer's command line: a window, or a web server where `web_port` is given. On the loopback address."""
    command = [*_program(), str(path), "--bind", LOOPBACK, "--port", str(port)]
    if web_port is not None:
        command += ["--serve-web", "--web-viewer-port", str(web_port)]
    return command


def web_address(port: int, web_port: int) -> str:
    """The URL of the viewer with the recording, for the browser."""
    return f"http://{LOOPBACK}:{web_port}/?url={quote(f'rerun+http://{LOOPBACK}:{port}/proxy', safe='')}"


def _show(path: Path) -> None:
    (port,) = _free_ports(1)
    process = _started(viewer_command(path, port, None))
    print(f"Playing {path}; close the window or press Ctrl-C to end.", flush=True)
    if _waited(process) not in (0, -signal.SIGINT, -signal.SIGTERM):
        in_browser = command("play", str(path.parent.parent), "--trial", str(int(path.stem)), "--web")
        raise InputError(f"Rerun's viewer ended with code {process.returncode}: try {in_browser}")


def _serve(path: Path) -> None:
    port, viewer_port, web_port = _free_ports(3)
    process = _started(viewer_command(path, port, viewer_port))
    with served(LOOPBACK, web_port, viewer_port, port):
        try:
            _await(process, viewer_port)
            print(f"Playing {path}; open this in a browser on this machine, Ctrl-C to end:", flush=True)
            print(web_address(port, web_port), flush=True)
        except BaseException as stopped:
            _end(process)
            if isinstance(stopped, KeyboardInterrupt):
                return
            raise
        _waited(process)


def _await(process: subprocess.Popen[bytes], port: int) -> None:
    """Returns when the port answers. Raises `InputError` if it does not in time."""
    until = time.monotonic() + STARTING_S
    while time.monotonic() < until and process.poll() is None:
        try:
            socket.create_connection((LOOPBACK, port), timeout=1.0).close()
            return
        except OSError:
            time.sleep(0.05)
    raise InputError("Rerun's web viewer did not start")


def _waited(process: subprocess.Popen[bytes]) -> int:
    """The viewer's exit code; 0 where Ctrl-C ended it."""
    try:
        return process.wait()
    except KeyboardInterrupt:
        _end(process)
        return 0


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(timeout=3.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _started(command: list[str]) -> subprocess.Popen[bytes]:
    # The viewer sends usage statistics unless the variable CI is set, as on machines for continuous integration.
    quiet = {"CI": "1", "RUST_LOG": os.environ.get("RUST_LOG", "error")}
    return subprocess.Popen(command, env=os.environ | quiet, preexec_fn=end_with_parent)


def _program() -> list[str]:
    """The viewer's own program: the Python wrapper around it would leave it running when the wrapper is ended."""
    found = importlib.util.find_spec("rerun_cli")
    for folder in (found.submodule_search_locations or []) if found else []:
        for name in ("rerun", "rerun.exe"):
            program = Path(folder) / name
            if program.is_file():
                return [str(program)]
    return [sys.executable, "-m", "rerun_cli"]


def _free_ports(count: int) -> list[int]:
    """Ports of the loopback address that are free now."""
    sockets = [socket.socket() for _ in range(count)]
    try:
        for each in sockets:
            each.bind((LOOPBACK, 0))
        return [int(each.getsockname()[1]) for each in sockets]
    finally:
        for each in sockets:
            each.close()
