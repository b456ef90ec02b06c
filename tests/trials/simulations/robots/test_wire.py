"""The bytes between image process and controller: what they hold, and what is dropped as malformed or late."""

from __future__ import annotations

import math
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from flocking.types import Floats
from trials.simulations.robots import wire
from trials.simulations.robots.wire import Asker, Controller, Counts, Frames

numbers = st.floats(allow_nan=False)
TOLD = (0.25, -0.1, 1.5, 0.3)


def controller(robot: int = 3) -> Controller:
    def control(told: Floats, motion: Floats) -> None:
        motion[:] = 4.0, told[0], told[2], 1.0

    return Controller(robot, control)


class TestEncoding:
    @settings(deadline=None)
    @given(st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1), st.floats(0, 1e9), numbers, numbers, numbers)
    def test_a_message_comes_out_bit_for_bit(
        self, robot: int, sequence: int, time: float, omega: float, closure: float, bearing: float
    ) -> None:
        for distance in (0.0, 1e-300, 1.5, 111.0):
            told = (omega, closure, distance, bearing)
            data = wire.encoded_message(robot, sequence, time, told)
            assert len(data) == 56
            found = wire.decoded_message(robot, data)
            assert found is not None
            assert struct.pack("4d", *found.told) == struct.pack("4d", *told)
            assert found[:2] == (sequence, time)

    def test_nobody_in_view_is_a_distance_of_111_1_on_the_wire_alone(self) -> None:
        data = wire.encoded_message(0, 1, 0.0, (0.0, 0.0, math.nan, 0.0))
        assert struct.unpack("!d", data[-16:-8]) == (111.1,)
        found = wire.decoded_message(0, data)
        assert found is not None
        assert math.isnan(found.told[2])

    def test_a_true_distance_of_111_1_is_none_that_nobody_has(self) -> None:
        found = wire.decoded_message(0, wire.encoded_message(0, 1, 0.0, (0.0, 0.0, 111.1, 0.0)))
        assert found is not None
        assert found.told[2] == pytest.approx(111.1, rel=1e-15)

    @settings(deadline=None)
    @given(st.integers(0, 5), numbers, numbers, st.integers(0, 300))
    def test_a_motion_comes_out_bit_for_bit(self, kind: int, x: float, y: float, rule: int) -> None:
        data = wire.encoded_motion(2, 7, 0.5, np.array([kind, x, y, rule], dtype=float))
        assert len(data) == 44
        assert wire.decoded_motion(2, data) == (7, 0.5, (kind, x, y, rule))

    def test_byte_order_and_places_are_those_that_are_documented(self) -> None:
        data = wire.encoded_message(258, 259, 2.0, TOLD)
        assert data == b"HRDm" + bytes([0, 0, 1, 2]) + bytes([0] * 6 + [1, 3]) + struct.pack(">5d", 2.0, *TOLD)

    def test_nan_is_not_sent(self) -> None:
        for at in (0, 1, 3):
            told = [*TOLD]
            told[at] = math.nan
            with pytest.raises(ValueError, match="nan"):
                wire.encoded_message(0, 1, 0.0, tuple(told))
        with pytest.raises(ValueError, match="rule -1"):
            wire.encoded_motion(0, 1, 0.0, np.array([4.0, 0.0, 0.0, -1.0]))


MALFORMED = {
    "nothing": b"",
    "short": wire.encoded_message(3, 1, 0.0, TOLD)[:-1],
    "long": wire.encoded_message(3, 1, 0.0, TOLD) + b"\0",
    "another's": wire.encoded_message(4, 1, 0.0, TOLD),
    "no message": b"HRDc" + wire.encoded_message(3, 1, 0.0, TOLD)[4:],
    "a distance below nothing": wire.MESSAGE.pack(b"HRDm", 3, 1, 0.0, 0.0, 0.0, -1.0, 0.0),
    "no distance": wire.MESSAGE.pack(b"HRDm", 3, 1, 0.0, 0.0, 0.0, math.nan, 0.0),
    "no turn": wire.MESSAGE.pack(b"HRDm", 3, 1, 0.0, math.nan, 0.0, 1.0, 0.0),
    "no time": wire.MESSAGE.pack(b"HRDm", 3, 1, math.nan, 0.0, 0.0, 1.0, 0.0),
}


class TestDropped:
    @pytest.mark.parametrize("what", MALFORMED)
    def test_malformed_messages_are_dropped_and_counted_and_change_nothing(self, what: str) -> None:
        far = controller()
        assert far.answer(MALFORMED[what]) is None
        assert (far.counts.dropped, far.counts.late, far.counts.sent) == (1, 0, 0)
        assert far.answer(wire.encoded_message(3, 1, 0.0, TOLD)) is not None

    @settings(deadline=None)
    @given(st.binary(max_size=120))
    def test_no_bytes_are_too_much(self, data: bytes) -> None:
        far, near = controller(), Asker(3)
        assert far.answer(data) is None
        assert near.answered(data) is None
        Frames(b"HRDm", 56, Counts()).cut(data)

    def test_late_is_what_was_overtaken_by_number_or_time(self) -> None:
        far = controller()
        messages = [wire.encoded_message(3, n, time, TOLD) for n, time in ((2, 0.2), (1, 0.1), (2, 0.2), (3, 0.1))]
        assert [far.answer(data) is not None for data in messages] == [True, False, False, False]
        assert (far.counts.dropped, far.counts.late) == (0, 3)
        assert far.answer(wire.encoded_message(3, 9, 0.2, TOLD)) is not None  # some were lost on the way

    def test_only_the_answer_to_the_last_message_counts(self) -> None:
        near, far = Asker(3), controller()
        first, second = far.answer(near.asked(0.1, TOLD)), far.answer(near.asked(0.2, TOLD))
        assert first is not None
        assert second is not None
        assert near.answered(first) is None
        assert near.answered(b"HRDc") is None
        assert near.answered(wire.encoded_motion(3, 9, 0.2, np.zeros(4))) is None  # of what was never asked
        assert near.answered(second) == (4.0, 0.25, 1.5, 1.0)
        assert (near.counts.sent, near.counts.late, near.counts.dropped) == (2, 1, 2)


class TestFrames:
    @settings(deadline=None)
    @given(st.integers(1, 200))
    def test_frames_come_out_however_they_arrive(self, piece: int) -> None:
        sent = [wire.encoded_message(3, n, 0.1 * n, TOLD) for n in range(1, 6)]
        stream, counts = b"".join(sent), Counts()
        frames = Frames(b"HRDm", 56, counts)
        found = [frame for k in range(0, len(stream), piece) for frame in frames.cut(stream[k : k + piece])]
        assert found == sent
        assert counts.dropped == 0

    def test_what_lies_between_is_left_out_and_counted(self) -> None:
        one, other = (wire.encoded_message(3, n, 0.1, TOLD) for n in (1, 2))
        counts = Counts()
        assert Frames(b"HRDm", 56, counts).cut(b"HRD" + one + b"junk H" + other + b"HR") == [one, other]
        assert counts.dropped == 2


class TestAddress:
    @pytest.mark.parametrize("text", ["127.0.0.1", "127.9.9.9", "::1"])
    def test_loopback(self, text: str) -> None:
        assert wire.is_loopback(wire.address(text))

    @pytest.mark.parametrize("text", ["0.0.0.0", "192.168.1.4", "::", "fe80::1"])
    def test_not_loopback(self, text: str) -> None:
        assert not wire.is_loopback(wire.address(text))

    @pytest.mark.parametrize("text", ["", "localhost", "127.0.0.1:80", "127.0.0", "1::2::3"])
    def test_no_address(self, text: str) -> None:
        with pytest.raises(InputError, match="expected an IP address"):
            wire.address(text)
