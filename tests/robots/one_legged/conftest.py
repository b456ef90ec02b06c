"""A minute of running that several tests look at."""

from __future__ import annotations

import pytest

from tests.robots.one_legged.running import Steady


@pytest.fixture(scope="session")
def steady() -> Steady:
    return Steady()
