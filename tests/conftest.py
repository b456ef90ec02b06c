"""Which tests come first."""

from __future__ import annotations

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


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files in the order of `SLOW`, then all others as they are found."""
    rank = {HERE / name: place for place, name in enumerate(SLOW)}
    items.sort(key=lambda item: rank.get(item.path, len(rank)))
