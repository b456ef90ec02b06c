"""Member detections, one a file, and what each gives of the members it detects."""

from __future__ import annotations

from types import ModuleType

from flocking import found

INFERRED = frozenset({"velocities", "headings"})
"""What association makes of positions."""
OF_ITSELF = frozenset({"compass", "goal", "contacts"})
"""What a robot knows without any detection."""


def all_pipelines() -> dict[str, ModuleType]:
    """All member detections by name."""
    return {name: found.load(__name__, name, "pipeline") for name in found.modules(__name__)}


def given_by(pipeline: ModuleType) -> frozenset[str]:
    """What a pipeline gives: its `GIVES`, or positions and bearings where it does not say."""
    return frozenset(getattr(pipeline, "GIVES", {"positions", "bearings", "obstacles"}))
