"""Controllers by UDP and TCP: the trial is that of one in process, whatever else comes in on their sockets."""

from __future__ import annotations

import dataclasses
import socket
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flocking import lawentry, lawparts
from flocking.errors import InputError
from flocking.types import Kind
from trials.simulations.robots import checks, fields, link, wire
from trials.simulations.robots.keys import keys_of
from trials.simulations.robots.loop import run_trial
from trials.types import Group, Trial, TrialResult

LAW = "moshtagh-kirchner"
ROBOTS, SECONDS = 3, 3.0


def group(**setup: Any) -> Group:
    """Three Creates that see everything perfectly, near enough to turn away and to stop."""
    return fields.group(LAW, ROBOTS, pipeline="perfect", law_parameters={"start_m_s": 0.35}, **setup)


def trial(**setup: Any) -> Trial:
    return fields.trial("link", 1, [group(**setup)], duration_s=SECONDS)


@pytest.fixture(scope="module")
def in_process() -> TrialResult:
    return run_trial(trial())


def assert_same(found: TrialResult, expected: TrialResult) -> None:
    assert (found.outcome, found.reason) == ("done", "")
    for name in ("times", "poses_w", "odometry", "bumpers"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    for field in dataclasses.fields(found.updates):
        np.testing.assert_array_equal(getattr(found.updates, field.name), getattr(expected.updates, field.name))
    assert found.rules == expected.rules
    measures = {name: value for name, value in found.measures.items() if name not in link.ABOUT}
    np.testing.assert_equal(measures, dict(expected.measures))


Wrap = Callable[[link.End, link.End], None]


def wrapped(monkeypatch: pytest.MonkeyPatch, wrap: Wrap) -> None:
    """Hands both ends of each new connection to `wrap`, which may replace their methods."""
    connected = link.connected

    def opened(*given: Any) -> tuple[link.End, link.End]:
        ends = connected(*given)
        wrap(*ends)
        return ends

    monkeypatch.setattr(link, "connected", opened)


@pytest.mark.parametrize("kind", ["udp", "tcp"])
class TestTrials:
    def test_it_is_the_trial_in_process_bit_for_bit(self, kind: str, in_process: TrialResult) -> None:
        before = threading.active_count()
        found = run_trial(trial(link=kind))
        assert_same(found, in_process)
        assert {name: found.measures[name] for name in link.ABOUT} == {
            "link_messages": len(found.updates.times),
            "link_dropped": 0.0,
            "link_late": 0.0,
            "link_unanswered": 0.0,
        }
        assert threading.active_count() == before
        assert not link.ABOUT.keys() & in_process.measures.keys()
        assert len({int(rule) for rule in found.updates.rules}) > 1

    def test_junk_and_repeats_are_dropped_and_counted_and_change_nothing(
        self, kind: str, in_process: TrialResult, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Before each message comes junk, and after it the same once more; each answer comes twice."""

        def wrap(near: link.End, far: link.End) -> None:
            ask, answer = near.send, far.send

            def asked(data: bytes) -> None:
                if data:
                    ask(b"junk")
                    ask(data)
                ask(data)

            def answered(data: bytes) -> None:
                answer(data)
                answer(data)

            near.send, far.send = asked, answered  # type: ignore[method-assign]

        wrapped(monkeypatch, wrap)
        found = run_trial(trial(link=kind))
        assert_same(found, in_process)
        updates = len(found.updates.times)
        assert found.measures["link_messages"] == updates
        assert found.measures["link_dropped"] == updates
        # of a robot's last answer the second one is not read any more
        assert found.measures["link_late"] == 2 * updates - ROBOTS
        assert found.measures["link_unanswered"] == 0

    def test_a_lost_message_keeps_the_command(self, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(link, "LIMIT_S", 0.0)  # one look, and nobody waits for what was thrown away

        def wrap(near: link.End, far: link.End) -> None:
            ask, take, sent = near.send, near.receive, [0]

            def asked(data: bytes) -> None:
                sent[0] += 1
                if sent[0] != 5 or not data:
                    ask(data)

            def received() -> bytes | None:
                if sent[0] == 5:
                    return None
                near.socket.settimeout(None)
                return take()

            near.send, near.receive = asked, received  # type: ignore[method-assign]

        wrapped(monkeypatch, wrap)
        found = run_trial(trial(link=kind))
        assert (found.outcome, found.measures["link_unanswered"]) == ("done", ROBOTS)
        for robot in range(ROBOTS):
            own = found.updates.robots == robot
            assert found.updates.kinds[own][4] == Kind.HOLD
            np.testing.assert_array_equal(found.updates.commands[own][4], found.updates.commands[own][3])
            assert (found.updates.kinds[own] == Kind.HOLD).sum() == 1

    def test_a_controller_that_does_not_answer_ends_the_trial_in_one_line(
        self, kind: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(link, "LIMIT_S", 0.0)

        def wrap(near: link.End, far: link.End) -> None:
            near.receive = lambda: None  # type: ignore[method-assign]

        wrapped(monkeypatch, wrap)
        found = run_trial(trial(link=kind))
        assert found.outcome == "failed"
        assert "its controller left 3 messages in a row without an answer" in found.reason
        assert "\n" not in found.reason

    def test_a_controller_that_fails_ends_the_trial_in_one_line(
        self, kind: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fails(own: Any, data: bytes) -> None:
            raise ValueError("no more")

        monkeypatch.setattr(wire.Controller, "answer", fails)
        found = run_trial(trial(link=kind))
        assert found.outcome == "failed"
        assert f"law {LAW!r} failed for herd-" in found.reason
        assert "its controller is gone: no more" in found.reason


def test_datagrams_from_elsewhere_are_dropped_and_counted(
    in_process: TrialResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process of the machine sends good messages of a high number to a controller, and motions to a robot."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:

        def wrap(near: link.End, far: link.End) -> None:
            ask, answer = near.send, far.send

            def asked(data: bytes) -> None:
                if data:
                    stranger.sendto(wire.encoded_message(0, 1000, 0.0, (2.0, 0.0, 1.0, 0.0)), near.peer)  # type: ignore[attr-defined]
                ask(data)

            def answered(data: bytes) -> None:
                stranger.sendto(data, far.peer)  # type: ignore[attr-defined]
                answer(data)

            near.send, far.send = asked, answered  # type: ignore[method-assign]

        wrapped(monkeypatch, wrap)
        found = run_trial(trial(link="udp"))
    assert_same(found, in_process)
    assert found.measures["link_dropped"] == 2 * len(found.updates.times)


@pytest.mark.parametrize("kind", ["udp", "tcp"])
def test_a_controller_ends_though_it_is_not_told(
    kind: str, in_process: TrialResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The empty datagram, or the end of the stream, never arrives; the controllers end by themselves."""

    def wrap(near: link.End, far: link.End) -> None:
        ask = near.send

        def asked(data: bytes) -> None:
            if data:
                ask(data)

        near.send = asked  # type: ignore[method-assign]

    wrapped(monkeypatch, wrap)
    before = threading.active_count()
    assert_same(run_trial(trial(link=kind)), in_process)
    assert threading.active_count() == before


def test_a_users_own_law_with_the_two_parts(tmp_path: Path, in_process: TrialResult) -> None:
    mine = tmp_path / "mine.py"
    mine.write_text(Path(str(lawentry.module_of(LAW).__file__)).read_text())
    values = {**lawentry.load(LAW).create, "start_m_s": 0.35}
    group = fields.group(str(mine), ROBOTS, pipeline="perfect", law_parameters=values, link="udp")
    found = run_trial(fields.trial("link", 1, [group], duration_s=SECONDS))
    assert_same(found, in_process)


@pytest.mark.parametrize("kind", ["udp", "tcp"])
def test_by_ipv6(kind: str, in_process: TrialResult) -> None:
    try:
        with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as tried:
            tried.bind(("::1", 0))
    except OSError:
        pytest.skip("this machine has no IPv6 loopback")
    assert_same(run_trial(trial(link=kind, link_address="::1")), in_process)


class TestRefused:
    @pytest.mark.parametrize("law", ["vicsek", "kirchner-urges-sum"])
    def test_a_law_without_a_message(self, law: str) -> None:
        with pytest.raises(InputError) as refused:
            checks.check(fields.trial("link", 1, [fields.group(law, 2, pipeline="perfect", link="udp")]))
        said = str(refused.value)
        assert f"herd.link = 'udp': law {law!r} has no message to a controller" in said
        assert LAW in said
        assert "\n" not in said
        with pytest.raises(InputError, match="has no message"):
            lawparts.load(lawentry.load(law))

    @pytest.mark.parametrize("address", ["0.0.0.0", "::", "::ffff:0.0.0.0", "224.0.0.1"])
    def test_an_address_that_is_no_machines_own(self, address: str) -> None:
        with pytest.raises(InputError) as refused:
            checks.check(trial(link="udp", link_address=address, link_beyond_loopback=True))
        said = str(refused.value)
        assert f"herd.link_address = {address!r} is no machine's own" in said
        assert "expected an address of this machine" in said
        assert "\n" not in said

    @pytest.mark.parametrize("address", ["192.0.2.7", "2001:db8::1"])
    def test_an_address_that_is_not_loopback_without_the_flag(self, address: str) -> None:
        with pytest.raises(InputError) as refused:
            checks.check(trial(link="udp", link_address=address))
        said = str(refused.value)
        assert f"herd.link_address = {address!r} is not loopback" in said
        assert "herd.link_beyond_loopback=true" in said
        assert "\n" not in said
        checks.check(trial(link="udp", link_address=address, link_beyond_loopback=True))

    @pytest.mark.parametrize(("key", "value"), [("link", "sctp"), ("link_address", "localhost")])
    def test_what_is_no_link_and_no_address(self, key: str, value: str) -> None:
        with pytest.raises(InputError, match=key):
            checks.check(trial(**{"link": "udp", key: value}))

    def test_an_address_that_this_machine_does_not_have_ends_the_trial_in_one_line(self) -> None:
        for kind in ("udp", "tcp"):
            found = run_trial(trial(link=kind, link_address="192.0.2.7", link_beyond_loopback=True))
            assert found.outcome == "failed"
            assert f"no controller at 192.0.2.7 by {kind}" in found.reason


def test_addresses_are_shown_only_where_there_is_a_link() -> None:
    for setup, shown in (({}, False), ({"link": "tcp"}, True)):
        values = keys_of(trial(**setup), group(**setup))[0].values()
        assert "link" in values
        assert ("link_address" in values) == shown
