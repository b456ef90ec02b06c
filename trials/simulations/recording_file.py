"""The file of a recording: it gets its layout and its name when it is opened, and is complete when it is closed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb

from trials.types import Trial

APPLICATION = "create-herd"


@contextmanager
def opened(trial: Trial, path: Path, blueprint: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """A recording to send data to, in place of what is at `path`. Raises `OSError` where it cannot be written whole."""
    strict = rr.strict_mode()
    rr.set_strict_mode(True)  # a wrong call raises; by default it only prints a warning and the data is lost
    try:
        recording = rr.RecordingStream(
            APPLICATION,
            recording_id=recording_id(trial),
            send_properties=False,
        )
        try:
            recording.save(path)
            recording.send_blueprint(blueprint)  # in place of the layout that the viewer may remember
            recording.send_recording_name(f"{trial.experiment} {trial.index}")
            yield recording
            recording.flush()
            recording.disconnect()
        except RuntimeError as error:  # how Rerun reports a full disk or a missing folder
            raise OSError(f"cannot write {path}: {error}") from error
    finally:
        rr.set_strict_mode(strict)
    with path.open("rb") as file:
        file.seek(-min(16, path.stat().st_size), 2)
        if b"FOOT" not in file.read():
            raise OSError(f"cannot write {path}: the file was cut short")


def recording_id(trial: Trial) -> str:
    """The same for equal trials, different for others: the viewer merges recordings of one id."""
    content = json.dumps(trial.as_dict(), sort_keys=True, default=str).encode()
    return f"{trial.experiment}-{trial.index:04d}-{hashlib.blake2b(content, digest_size=6).hexdigest()}"
