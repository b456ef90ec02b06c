"""Which tests come first, and the terminal that they see."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SLOW = (
    "trials/batch/test_cluster.py",
    "trials/commands/test_cli.py",
    "flocking/kinematic/test_agreement.py",
    "trials/commands/test_until_decided.py",
    "flocking/test_laws.py",
    "flocking/kinematic/test_failures.py",
    "trials/commands/test_sensitivity.py",
    "test_packaging.py",
    "trials/batch/test_laws_that_fail.py",
    "generation/searches/test_searches.py",
    "flocking/kinematic/test_freshness.py",
    "trials/studies/test_experiments.py",
    "trials/commands/test_bench.py",
)
"""Files that take longest: they start first, so that at the end nobody waits for one of them (`make test`)."""

os.environ["TERM"] = "xterm"
for name in ("COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
    os.environ.pop(name, None)
"""Rich draws by these, in this process and in those that it starts: they are not the caller's."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files in the order of `SLOW`, then all others as they are found."""
    rank = {HERE / name: place for place, name in enumerate(SLOW)}
    items.sort(key=lambda item: rank.get(item.path, len(rank)))
