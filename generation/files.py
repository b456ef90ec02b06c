"""Environments as files: one documented, versioned JSON format (docs/environments.md).

    {
      "format": 1,
      "unit": "m",
      "reflectance": 0.8,
      "workspace": [{"kind": "polygon", "corners": [[-4, -4], [4, -4], [4, 4], [-4, 4]], "free": "inside"}],
      "construct": [{"kind": "segment", "x0": 0, "y0": -1, "x1": 0, "y1": 1}],
      "markers": {"start": {"kind": "point", "x": -2, "y": 0, "heading_rad": 0}},
      "origin": {}
    }

Lengths are in the file's unit, which is converted here; what is written is in metres, and is read back exactly.
"""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError, unknown_name
from generation.checking import checked, checked_places
from generation.environment import REFLECTANCE, Environment, Mark
from generation.primitives import KINDS, Point, Polygon, Polyline, kind_of

FORMAT = 1
"""Version of the format that is written, and the only one that is read."""
LARGEST_BYTES = 50_000_000
"""Of a file. A choice: some four times the largest environment that there can be."""
UNITS: dict[str, tuple[float, float]] = {
    "m": (1.0, 1.0), "km": (1000.0, 1.0), "dm": (1.0, 10.0), "cm": (1.0, 100.0), "mm": (1.0, 1000.0),
    "in": (254.0, 10_000.0), "ft": (3048.0, 10_000.0), "yd": (9144.0, 10_000.0),
}  # fmt: skip
"""By name, a unit of length in metres as a fraction: by it, the nearest number to the true length is found."""
_KEYS = ("format", "unit", "reflectance", "workspace", "construct", "markers", "origin")
_OF_PLACES: dict[type, tuple[str, int]] = {Polyline: ("points", 2), Polygon: ("corners", 3)}
_LEFT_OUT = ("free", "heading_rad")
"""Attributes that a file may leave out."""


def read(path: str | os.PathLike[str]) -> Environment:
    """The environment of a JSON file. What was mended is told by `warnings`. Raises `InputError`."""
    environment, told = read_mended(path)
    for line in told:
        warnings.warn(line, stacklevel=2)
    return environment


def read_mended(path: str | os.PathLike[str]) -> tuple[Environment, list[str]]:
    """The environment of a JSON file, and a line for each thing in it that was mended. Raises `InputError`."""
    return from_json_mended(text_of(path), str(path))


def text_of(path: str | os.PathLike[str]) -> str:
    """The text of an environment's file. Raises `InputError` where it cannot be read, or is too large."""
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_BYTES + 1)
        if len(data) > LARGEST_BYTES:
            raise InputError(f"environment file {str(path)!r} is larger than {LARGEST_BYTES // 1_000_000} MB")
        return data.decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"environment file {str(path)!r} does not exist; expected a JSON file") from None
    except UnicodeDecodeError:
        raise InputError(f"environment file {str(path)!r} is no text; expected JSON in UTF-8") from None
    except OSError as error:
        raise InputError(f"environment file {str(path)!r} cannot be read: {error.strerror or error}") from None


def write(environment: Environment, path: str | os.PathLike[str]) -> None:
    """Writes an environment whole, or not at all. Raises `InputError` for one that cannot be, `OSError` for a disk."""
    text = to_json(environment)
    handle, temporary = tempfile.mkstemp(dir=Path(path).absolute().parent, prefix=".environment-", suffix=".json")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def from_json(text: str, where: str = "environment") -> Environment:
    """The environment that JSON text describes; `where` is what errors name. Raises `InputError`."""
    return from_json_mended(text, where)[0]


def from_json_mended(text: str, where: str = "environment") -> tuple[Environment, list[str]]:
    """The environment that JSON text describes, and a line for each thing in it that was mended. Raises `InputError`.

    `where`: what the text is, as errors and lines name it.
    """
    told: list[str] = []
    data = _parsed(text, where, told)
    if "format" not in data:
        raise InputError(f'{where} has no format: expected an environment, with "format": {FORMAT}')
    if type(data["format"]) is not int or data["format"] != FORMAT:
        raise InputError(f"{where}: format {_short(data['format'])}: expected {FORMAT}, the only one there is")
    if "unit" not in data:
        raise InputError(f'{where} has no unit of length: expected "unit": {" or ".join(UNITS)}')
    if not isinstance(data["unit"], str) or data["unit"] not in UNITS:
        raise InputError(f"{where}: {unknown_name('unit of length', data['unit'], UNITS)}")
    for key in data:
        if key not in _KEYS:
            told.append(f"{where}: {_short(key)} is nothing that an environment has, and was left out")
    scale = UNITS[data["unit"]]
    parts: dict[str, tuple[Any, ...]] = {}
    for part in ("workspace", "construct"):
        listed = data.get(part, [])
        if not isinstance(listed, list):
            raise InputError(f"{where}: {part} = {_short(listed)}: expected a list of primitives")
        parts[part] = tuple(
            _mark(entry, f"{where}: {part} {number + 1}", scale, KINDS, told) for number, entry in enumerate(listed)
        )
    markers = _object(data.get("markers", {}), f"{where}: markers")
    found = Environment(
        parts["workspace"],
        parts["construct"],
        {
            name: _mark(entry, f"{where}: marker {name!r}", scale, {"point": Point, **KINDS}, told)
            for name, entry in markers.items()
        },
        data.get("reflectance", REFLECTANCE),
        _object(data.get("origin", {}), f"{where}: origin"),
    )
    mended, more = checked(found, where)
    return mended, told + more


def to_json(environment: Environment) -> str:
    """An environment as JSON text, in metres and radians, one primitive a line. Raises `InputError`.

    `from_json` gives it back exactly.
    """
    environment, _ = checked(environment)
    lists = {
        part: [_line(primitive) for primitive in getattr(environment, part)] for part in ("workspace", "construct")
    }
    markers = [f"{json.dumps(name)}: {_line(mark)}" for name, mark in environment.markers.items()]
    try:
        origin = json.dumps(dict(environment.origin), default=_plain, allow_nan=False)
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(f"an environment's origin cannot be written: {' '.join(str(error).split())}") from None
    lines = [
        f'"format": {FORMAT}',
        '"unit": "m"',
        f'"reflectance": {json.dumps(environment.reflectance)}',
        *(f'"{part}": {_block("[]", lines)}' for part, lines in lists.items()),
        f'"markers": {_block("{}", markers)}',
        f'"origin": {origin}',
    ]
    return "{\n  " + ",\n  ".join(lines) + "\n}\n"


def _parsed(text: str, where: str, told: list[str]) -> dict[str, Any]:
    def pairs(found: list[tuple[str, Any]]) -> dict[str, Any]:
        made = dict(found)
        if len(made) < len(found):
            names = [name for name, _ in found]
            twice = next(name for name in names if names.count(name) > 1)
            raise InputError(f"{where}: {_short(twice)} is given twice")
        return made

    def constant(name: str) -> Any:
        raise InputError(f"{where}: {name}: expected finite numbers")

    try:
        data = json.loads(text, object_pairs_hook=pairs, parse_constant=constant)
    except InputError:
        raise
    except json.JSONDecodeError as error:
        raise InputError(
            f"{where} is no JSON: {error.msg}, line {error.lineno} column {error.colno}; "
            'expected an environment, with "format": 1'
        ) from None
    except (ValueError, RecursionError):  # thousands of digits or of brackets
        raise InputError(
            f'{where} is nested or long beyond reason; expected an environment, with "format": 1'
        ) from None
    return _object(data, where)


def _object(data: Any, where: str) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise InputError(f"{where} is {_short(data)}: expected a JSON object, in {{ }}")
    return data


def _mark(entry: Any, what: str, scale: tuple[float, float], kinds: Mapping[str, Any], told: list[str]) -> Mark:
    given = dict(_object(entry, what))
    kind = given.pop("kind", None)
    if not isinstance(kind, str) or kind not in kinds:
        raise InputError(f"{what}: {unknown_name('kind', kind, kinds)}")
    made, values = kinds[kind], {}
    for field in made._fields:
        key = field.removesuffix("_m")
        if key not in given:
            if key in _LEFT_OUT:
                continue
            raise InputError(f"{what} ({kind}) lacks {key!r}; expected {', '.join(map(_key, made._fields))}")
        value = given.pop(key)
        if made in _OF_PLACES and key == _OF_PLACES[made][0]:
            pairs = _in_metres_all(value, scale)
            values[field] = checked_places(pairs, f"{what}: {key}", _OF_PLACES[made][1])
        else:
            values[field] = _in_metres(value, scale) if field.endswith("_m") else value
    for key in given:
        told.append(f"{what}: {_short(key)} is nothing that a {kind} has, and was left out")
    found: Mark = made(**values)
    return found


def _key(field: str) -> str:
    return field.removesuffix("_m")


def _in_metres(value: Any, scale: tuple[float, float]) -> Any:
    """A number in metres; anything else as it is, to be refused where it is checked."""
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > 1e300:
        return value
    return float(value) * scale[0] / scale[1]


def _in_metres_all(value: Any, scale: tuple[float, float]) -> Any:
    if not isinstance(value, list):
        return value
    return [[_in_metres(each, scale) for each in pair] if isinstance(pair, list) else pair for pair in value]


def _line(mark: Mark) -> str:
    values = {"kind": kind_of(mark), **{_key(field): value for field, value in mark._asdict().items()}}
    return json.dumps(values, allow_nan=False)


def _block(brackets: str, lines: list[str]) -> str:
    if not lines:
        return brackets
    return brackets[0] + "\n    " + ",\n    ".join(lines) + f"\n  {brackets[1]}"


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is nothing that JSON has")


def _short(value: object) -> str:
    text = " ".join(repr(value)[:200].split())
    return text if len(text) <= 60 else f"{text[:57]}..."
