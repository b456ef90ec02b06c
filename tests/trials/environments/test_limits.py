"""Code of the user's own: what waits for ever is ended, what works is not, and no timer is left behind."""

from __future__ import annotations

import os
import signal
import time

import pytest

from flocking.errors import InputError
from trials.environments.limits import limited


def work(seconds: float) -> None:
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def test_what_sleeps_is_ended_and_the_timers_are_off_afterwards() -> None:
    before = signal.getsignal(signal.SIGALRM), signal.getsignal(signal.SIGVTALRM)
    with (
        pytest.raises(InputError, match=r"mine waited for something that did not come within 0\.2 s"),
        limited("mine", 10.0, 0.2),
    ):
        time.sleep(600.0)
    assert signal.getitimer(signal.ITIMER_REAL) == signal.getitimer(signal.ITIMER_VIRTUAL) == (0.0, 0.0)
    assert (signal.getsignal(signal.SIGALRM), signal.getsignal(signal.SIGVTALRM)) == before


def test_what_has_worked_since_it_was_last_looked_at_is_not_waiting() -> None:
    with limited("mine", 60.0, 1000.0):
        for _ in range(3):
            work(0.05)
            os.kill(os.getpid(), signal.SIGALRM)
        with pytest.raises(InputError, match="did not come"):
            os.kill(os.getpid(), signal.SIGALRM)  # nothing was done since


def test_what_works_too_long_is_ended() -> None:
    with pytest.raises(InputError, match=r"mine did not return within 0\.1 s of processor time"), limited("mine", 0.1):
        work(600.0)
