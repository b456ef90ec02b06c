"""The time series of a trial as one file, enough for every figure: a `TrialResult` as the bytes of an .npz.

Equal results are equal bytes: the times inside the zip are fixed, the order is that of the types' fields.
What differs from run to run (timing) and what only a recording needs (scans, pictures, echoes) stays out.
"""

from __future__ import annotations

import dataclasses
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from flocking.errors import InputError
from trials.types import Contacts, Trial, TrialResult, Updates

FORMAT = 3
HEAD = "result.json"
"""The entry of the zip file with the trial and everything that is no array."""

_LEFT_OUT = ("scans", "pictures", "heard", "timing", "tables")
TABLES = "tables."
"""Before the names of a result's tables."""
_PARTS = {"updates": Updates, "contacts": Contacts}
_TEXTS = ("robot_names", "rules", "measures", "outcome", "reason", "period_m")
_ARRAYS = tuple(
    f.name for f in dataclasses.fields(TrialResult) if f.name not in (*_LEFT_OUT, *_PARTS, *_TEXTS, "trial")
)
_DAMAGE = (
    zipfile.BadZipFile, zlib.error, KeyError, TypeError, AttributeError, ValueError, EOFError, OSError, MemoryError,
    RecursionError, NotImplementedError, RuntimeError, struct.error,
)  # fmt: skip
"""What reading a damaged or a made-up file may raise."""
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
_LEVEL = 1
"""Level of compression. Higher levels save little on noisy floats and cost a trial several percent of its time."""


def pack(result: TrialResult) -> bytes:
    """The result, without scans and timing, as the bytes of an .npz file that `numpy.load` reads as well."""
    out = io.BytesIO()
    _write(result, out)
    return out.getvalue()


def write(result: TrialResult, path: Path) -> None:
    """The same as a file. Raises `OSError` if the disk does not take it."""
    with path.open("wb") as out:
        _write(result, out)


def _write(result: TrialResult, out: IO[bytes]) -> None:
    head = {"format": FORMAT, "trial": result.trial.as_dict()}
    head |= {name: getattr(result, name) for name in _TEXTS}
    head["measures"], head["period_m"] = plain(result.measures), _plain(result.period_m)
    with zipfile.ZipFile(out, "w") as archive:
        _add(archive, HEAD, json.dumps(head, ensure_ascii=False).encode())
        for name, array in _arrays(result):
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, np.ascontiguousarray(array), allow_pickle=False)
            _add(archive, f"{name}.npy", buffer.getvalue())


def unpack(data: bytes) -> TrialResult:
    """The inverse of `pack`; scans are None and timing is empty.

    Raises `InputError` if the bytes are damaged or of a newer version.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            head = _head(archive)
            arrays: dict[str, Any] = {
                name.removesuffix(".npy"): np.lib.format.read_array(io.BytesIO(archive.read(name)), allow_pickle=False)
                for name in archive.namelist()
                if name.endswith(".npy")
            }
        parts: dict[str, Any] = {
            part: kind(**{f.name: arrays[f"{part}.{f.name}"] for f in dataclasses.fields(kind)})
            for part, kind in _PARTS.items()
        }
        return TrialResult(
            trial=Trial.from_dict(head["trial"]),
            **{name: arrays[name] for name in _ARRAYS},
            **parts,
            robot_names=tuple(head["robot_names"]),
            rules=tuple(tuple(rules) for rules in head["rules"]),
            scans=None,
            measures=numbers(head["measures"]),
            outcome=head["outcome"],
            reason=head["reason"],
            period_m=_number(head.get("period_m")),
            timing={},
            tables={name.removeprefix(TABLES): array for name, array in arrays.items() if name.startswith(TABLES)},
        )
    except InputError:
        raise
    except _DAMAGE as error:
        raise InputError(f"damaged series ({error})") from error


def trial_of(path: Path) -> Trial:
    """The trial whose series a file holds. Raises `InputError` if the file is damaged or of another version."""
    try:
        with zipfile.ZipFile(path) as archive:
            return Trial.from_dict(_head(archive)["trial"])
    except InputError:
        raise
    except _DAMAGE as error:
        raise InputError(f"damaged series ({error})") from error


def _head(archive: zipfile.ZipFile) -> Any:
    head = json.loads(archive.read(HEAD))
    if head["format"] != FORMAT:
        raise InputError(f"series of format {head['format']}: this version reads format {FORMAT}")
    return head


def plain(measures: Mapping[str, float]) -> dict[str, float | str | None]:
    """Measures as strict JSON can hold them: nan becomes null, infinities become text."""
    return {name: _plain(float(value)) for name, value in measures.items()}


def numbers(measures: Mapping[str, Any]) -> dict[str, float]:
    """The inverse of `plain`."""
    return {name: _number(value) for name, value in measures.items()}


def _plain(value: float) -> float | str | None:
    if np.isnan(value):
        return None
    return value if np.isfinite(value) else str(value)


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def _arrays(result: TrialResult) -> Iterator[tuple[str, Any]]:
    for name in _ARRAYS:
        yield name, getattr(result, name)
    for part, kind in _PARTS.items():
        for f in dataclasses.fields(kind):
            yield f"{part}.{f.name}", getattr(getattr(result, part), f.name)
    for name, table in result.tables.items():
        yield f"{TABLES}{name}", table


def _add(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    info = zipfile.ZipInfo(name, _ZIP_TIME)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = 0o644 << 16
    archive.writestr(info, data, compresslevel=_LEVEL)
