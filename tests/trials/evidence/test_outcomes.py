"""Outcomes: what they show of the numbers tested."""

from __future__ import annotations

import numpy as np
import pytest

from trials.evidence.outcomes import near


def test_near_shows_the_values_themselves() -> None:
    outcome = near("x", np.array([4.9, 5.0, 5.1]), 5.2, 0.5)
    assert outcome.decision.agrees is True
    assert outcome.shown()[0] == pytest.approx(5.0)
    assert outcome.in_margins()[0] == pytest.approx(-0.4)
