"""run.json: what was asked for and with what it ran. It may come from anywhere: everything in it is checked."""

from __future__ import annotations

import hashlib
import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flocking.errors import InputError, has_controls
from flocking.found import is_path
from trials.batch.folders import RUN, reading
from trials.evidence.looks import MOST
from trials.types import Group, Trial

FORMAT = 3
"""Of run.json and of the tables (`PRAGMA user_version`)."""


TEXTS = "texts"
"""Of run.json: the texts of users' files by their digests."""
_SOURCES = ("law_source", "world_source", "formation_source", "task_source")


def text_digest(text: str) -> str:
    """A short text that is the same for equal texts alone."""
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def digest(trial: Trial) -> str:
    """A short text that is the same for equal trials alone."""
    content = json.dumps(trial.as_dict(), sort_keys=True)
    return text_digest(content)


def read(folder: Path) -> dict[str, Any]:
    """The content of a run's run.json, checked. Raises `InputError` for a folder without one, or a damaged one."""
    path = folder / RUN
    if not path.is_file():
        raise InputError(f"{folder} is not the folder of a run: it has no {RUN}")
    with reading(path):
        data = path.read_bytes()
    try:
        run = json.loads(data)
        version = run["format"]
        if version != FORMAT:
            raise InputError(_of_another_version(path, run, version))
        run = _with_texts(run)
        _check_text({name: value for name, value in run.items() if name != "trials"})
        for name, kind in _OF_RUN.items():
            if not isinstance(run.get(name), (kind, type(None))):
                raise TypeError(f"{name} = {run[name]!r}: expected {kind.__name__}")
        if not all(isinstance(note, str) for note in run.get("notes") or ()):
            raise TypeError("notes: expected a list of texts")
        for trial in run["trials"]:
            _check_types(Trial.from_dict(trial))
            _check_text({**trial, "groups": [{**group, "law_source": ""} for group in trial["groups"]]})
        if run.get("until_decided") is not None:
            _check_plan(run["until_decided"])
            if run["until_decided"]["looks"][-1] != run.get("repeats"):
                raise ValueError(f"looks = {run['until_decided']['looks']}: expected {run.get('repeats')} at the last")
        _learn(run)
        return {**run, "experiment": str(run["experiment"])}
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, MemoryError) as error:
        raise InputError(f"{path} is damaged ({type(error).__name__}: {error}); nothing was changed") from error


def _learn(run: Mapping[str, Any]) -> None:
    """Takes in what the users' laws of a run declare."""
    laws = {group["law_source"]: group["law"] for trial in run["trials"] for group in trial["groups"]}
    for source, name in laws.items():
        if source:
            from flocking.lawentry import learn

            learn(name, source, run["laws"][text_digest(source)])


def _check_plan(plan: Mapping[str, Any]) -> None:
    """Raises `ValueError` for a plan of a run until decided that was never laid down."""
    looks, seconds, levels = plan["looks"], plan["seconds"], plan["levels"]
    sound = all(type(look) is int for look in looks) and looks == sorted(set(looks)) and looks and looks[0] >= 1
    if not sound or len(looks) > MOST:
        raise ValueError(f"looks = {looks!r}: expected at most {MOST} increasing numbers of repeats")
    numbers = [levels["two-sided"], levels["one-sided"], levels["of the whole"], seconds or 1.0]
    if not all(isinstance(number, int | float) and number > 0.0 for number in numbers):
        raise ValueError(f"levels = {levels!r}, seconds = {seconds!r}: expected numbers above 0")
    for claim in plan["claims"]:
        [(outcome["label"], outcome["threshold"], outcome["margin"]) for outcome in claim["outcomes"]]
        str(claim["claim"])


def _check_text(value: Any) -> None:
    """Raises `ValueError` for text that would act on a terminal when it is printed."""
    if isinstance(value, str):
        if has_controls(value):
            raise ValueError(f"text with control characters, {value[:40]!r}")
    elif isinstance(value, Mapping):
        for key, each in value.items():
            _check_text(key)
            _check_text(each)
    elif isinstance(value, list):
        for each in value:
            _check_text(each)


_WHOLE, _TEXT, _TABLE = int, str, Mapping
_TYPES: dict[type, dict[str, type]] = {
    Trial: {
        "world_source": _TEXT, "formation_source": _TEXT, "task_source": _TEXT,
        "experiment": _TEXT, "repeat": _WHOLE, "simulation": _TEXT, "world": _TEXT, "formation": _TEXT, "index": _WHOLE,
        "seed": _WHOLE, "world_parameters": _TABLE, "formation_parameters": _TABLE, "setup": _TABLE,
        "conditions": _TABLE,
    },
    Group: {
        "law": _TEXT, "count": _WHOLE, "pipeline": _TEXT, "name": _TEXT, "selection": _TEXT, "law_source": _TEXT,
        "law_parameters": _TABLE, "pipeline_parameters": _TABLE, "spread": _TABLE, "setup": _TABLE,
    },
}  # fmt: skip


_OF_RUN: dict[str, type] = {
    "experiment": _TEXT, "command": _TEXT, "repeats": _WHOLE, "seed": _WHOLE, "settings": _TABLE, "sweep": _TABLE,
    "record": _TEXT, "scans": _TEXT, "started": _TEXT, "versions": _TABLE, "commit": _TEXT, "sources": _TEXT,
    "cpu": _TEXT, "system": _TEXT, "laws": _TABLE, "trials": list, "until_decided": _TABLE,
    "conditions": _TABLE, "notes": list, "only": _TEXT, "law": _TEXT, "pipeline": _TEXT, "body": _TEXT, "world": _TEXT,
}  # fmt: skip


def _check_types(trial: Trial) -> None:
    """Raises `TypeError` for a value of a type that no trial has."""
    for kept in (trial, *trial.groups):
        for name, kind in _TYPES[type(kept)].items():
            value = getattr(kept, name)
            if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
                raise TypeError(f"{name} = {value!r}: expected {kind.__name__}")
            if isinstance(value, Mapping):
                for key, each in value.items():
                    if not isinstance(each, bool | int | float | str):
                        raise TypeError(f"{key} = {each!r}: expected a number, text, true or false")


def _of_another_version(path: Path, run: Mapping[str, Any], version: object) -> str:
    versions = run.get("versions")
    made = str(versions.get("create-herd", "")) if isinstance(versions, Mapping) else ""
    commit = str(run.get("commit", ""))[:12].rstrip("+")
    who = f"create-herd {made}" if made else "another version"
    return (
        f"{path} has format {version!r} and this version reads {FORMAT}: report and resume it with {who}"
        f"{f', commit {commit}' if commit else ''}"
    )


def _without_texts(trial: Mapping[str, Any], texts: dict[str, str]) -> dict[str, Any]:
    """A trial with the digests of its texts in their place; adds these to `texts`."""
    short = dict(trial)
    if "groups" in trial:
        short["groups"] = [_without_texts(group, texts) for group in trial["groups"]]
    for name in _SOURCES:
        if trial.get(name):
            own = text_digest(trial[name])
            texts[own] = trial[name]
            short[name] = {"text": own}
    return short


def _with_texts(run: Mapping[str, Any]) -> dict[str, Any]:
    """The run with the texts of its trials in their places; one of an earlier version has them there already.

    Raises `KeyError` for a digest without its text.
    """
    texts = run.get(TEXTS) or {}

    def filled(kept: Mapping[str, Any]) -> dict[str, Any]:
        own = {name: texts[kept[name]["text"]] for name in _SOURCES if isinstance(kept.get(name), Mapping)}
        groups = {"groups": [filled(group) for group in kept["groups"]]} if "groups" in kept else {}
        return {**kept, **own, **groups}

    return {**{name: value for name, value in run.items() if name != TEXTS}, "trials": list(map(filled, run["trials"]))}


def own_experiment(run: Mapping[str, Any]) -> str | None:
    """The path of a user's own experiment, as the run's command had it; None for one of the project."""
    try:
        words = shlex.split(str(run.get("command", "")))
    except ValueError:
        return None
    return next((word for word in words[2:3] if is_path(word)), None)


def text_of(run: Mapping[str, Any]) -> str:
    """The text of run.json: indented, with each trial on one line, and each text of users' files once.

    Trials have `{"text": DIGEST}` in a text's place, and `texts` has it by that digest.
    """
    texts: dict[str, str] = {}
    short = [_without_texts(trial, texts) for trial in run["trials"]]
    kept = {name: value for name, value in run.items() if name != "trials"} | ({TEXTS: texts} if texts else {})
    head = json.dumps(kept, indent=2, ensure_ascii=False)
    trials = ",\n".join(f"    {json.dumps(trial, ensure_ascii=False)}" for trial in short)
    return f'{head[:-2]},\n  "trials": [\n{trials}\n  ]\n}}\n'
