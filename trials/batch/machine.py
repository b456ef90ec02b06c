"""Versions, commit and processor that a run was made with. Equal results are promised only where these are equal."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

PACKAGES = ("create-herd", "mujoco", "numba", "numpy", "scipy", "rerun-sdk")


def made_with() -> dict[str, Any]:
    """Versions, the commit and the state of the sources, the type of the processor."""
    own = alike()
    return {
        "versions": own["versions"],
        "commit": _commit(Path(__file__).resolve().parents[2]),
        "sources": own["sources"],
        "cpu": own["cpu"],
        "system": platform.platform(),
    }


def alike() -> dict[str, Any]:
    """What must be equal for equal results: versions, the sources as they stand on the disk now, the processor."""
    from flocking.compilation import PACKAGES as COMPILED_PACKAGES
    from flocking.compilation import sources_digest

    return {
        "versions": {"python": platform.python_version(), **{name: _version(name) for name in PACKAGES}},
        "sources": sources_digest.__wrapped__((*COMPILED_PACKAGES, "trials", "worlds")),
        "cpu": _cpu(),
    }


def differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """The entries of `made_with` that differ and may change results, in words."""
    old, new = before.get("versions", {}), now["versions"]
    found = [f"{name} {old.get(name)} → {new[name]}" for name in new if old.get(name) != new[name]]
    if before.get("sources") != now["sources"]:
        found.append("the project's sources")
    if before.get("cpu") != now["cpu"]:
        found.append(f"processor {before.get('cpu')} → {now['cpu']}")
    return found


def is_other_version(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether create-herd is of two versions, or two states of its sources, in two answers of `alike`."""
    return _herd_of(one) != _herd_of(other)


def _herd_of(made: Mapping[str, Any]) -> tuple[str, str]:
    return made["versions"]["create-herd"], made["sources"]


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""


def _commit(home: Path) -> str:
    """The commit of the sources, with a + where they were changed since; empty if they are in no repository."""
    if not (home / ".git").exists():
        return ""

    def git(*words: str) -> str:
        return subprocess.run(
            ["git", "-C", str(home), *words], capture_output=True, text=True, timeout=10, check=True
        ).stdout.strip()

    try:
        return git("rev-parse", "HEAD") + ("+" if git("status", "--porcelain", "--untracked-files=no") else "")
    except (OSError, subprocess.SubprocessError):
        return ""


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = {line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")}
    return ", ".join(sorted(names)) or platform.processor() or platform.machine()
