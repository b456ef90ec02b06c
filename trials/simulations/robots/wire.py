"""What goes between a robot's image process and its controller: bytes, who answers them, and what is dropped.

Kirchner 2006, section 3.6.7: ω, the closure rate, |d| and β are sent by UDP or TCP, and a distance of 111.1, which
cannot be measured, says that no cone is in view. What it leaves open is ours. Network byte order, IEEE doubles, SI:

    message, 56 bytes   "HRDm", robot (4), sequence (8), time (s), omega, closure, distance, bearing: 8 bytes each
    motion, 44 bytes    "HRDc", robot (4), sequence (8), time (s), kind (2), rule (2), x, y: 8 bytes each

A sequence number counts a robot's messages from 1, and the time is the simulated one of its sensing; the motion has
those of the message that it answers. What has another length or beginning, is another robot's, or holds what cannot be
is malformed. A message is late whose sequence number is not above that of the last one taken, or whose time lies before
its; a motion whose number is below that of the last message. Both are dropped and counted. No clock takes part.
"""

from __future__ import annotations

import ipaddress
import math
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats

IN_PROCESS, UDP, TCP = LINKS = ("in-process", "udp", "tcp")
NO_CONE = 111.1
"""Says in a distance's place that nobody is in view: a mere code, and no length. In process it is nan."""
MESSAGE, MOTION = struct.Struct("!4sIQ5d"), struct.Struct("!4sIQdHHdd")
OF_MESSAGE, OF_MOTION = b"HRDm", b"HRDc"


class Message(NamedTuple):
    """A message as it was sent."""

    sequence: int
    time: float
    told: tuple[float, float, float, float]
    """ω, closure rate, distance (nan: nobody in view), bearing."""


class Answer(NamedTuple):
    """A motion as it was sent."""

    sequence: int
    time: float
    motion: tuple[float, float, float, float]
    """Kind, x, y, rule."""


@dataclass
class Counts:
    """What came of the messages of one end."""

    sent: int = 0
    dropped: int = 0
    """What came in and was malformed, or came from elsewhere."""
    late: int = 0
    """What came in after what was sent later, or twice."""
    unanswered: int = 0


def address(text: str) -> str:
    """`text` if it is an IP address. Raises `InputError`."""
    try:
        return str(ipaddress.ip_address(text))
    except ValueError:
        raise InputError(f"link_address = {text!r}: expected an IP address, as 127.0.0.1 or ::1") from None


def is_loopback(text: str) -> bool:
    """Whether what is sent to that IP address stays on this machine."""
    return ipaddress.ip_address(text).is_loopback


def is_of_one_machine(text: str) -> bool:
    """Whether that IP address can be one machine's: 0.0.0.0 and :: stand for all of its own, multicast for many's."""
    its = ipaddress.ip_address(text)
    its = getattr(its, "ipv4_mapped", None) or its
    return not (its.is_unspecified or its.is_multicast)


def encoded_message(robot: int, sequence: int, time: float, told: tuple[float, ...]) -> bytes:
    """A message as bytes. Raises `ValueError` for one that holds nan elsewhere than in the distance."""
    omega, closure, distance, bearing = told
    if any(map(math.isnan, (omega, closure, bearing))):
        raise ValueError(f"its message holds nan: {told}")
    if math.isnan(distance):
        distance = NO_CONE
    elif distance == NO_CONE:  # truly
        distance = math.nextafter(NO_CONE, math.inf)
    return MESSAGE.pack(OF_MESSAGE, robot, sequence, time, omega, closure, distance, bearing)


def decoded_message(robot: int, data: bytes) -> Message | None:
    """The message of that robot that the bytes hold; None if they are malformed."""
    if len(data) != MESSAGE.size:
        return None
    kind, whose, sequence, time, omega, closure, distance, bearing = MESSAGE.unpack(data)
    if kind != OF_MESSAGE or whose != robot or not math.isfinite(time):
        return None
    if any(map(math.isnan, (omega, closure, bearing))) or not distance >= 0.0:
        return None
    return Message(sequence, time, (omega, closure, math.nan if distance == NO_CONE else distance, bearing))


def encoded_motion(robot: int, sequence: int, time: float, motion: Floats) -> bytes:
    """A motion (4,) as bytes. Raises `ValueError` for one whose kind or rule is no number from 0 on."""
    kind, x, y, rule = motion.tolist()
    try:
        return MOTION.pack(OF_MOTION, robot, sequence, time, int(kind), int(rule), x, y)
    except (struct.error, OverflowError):
        raise ValueError(f"its motion has kind {kind:g} and rule {rule:g}") from None


def decoded_motion(robot: int, data: bytes) -> Answer | None:
    """The motion of that robot that the bytes hold; None if they are malformed."""
    if len(data) != MOTION.size:
        return None
    found, whose, sequence, time, kind, rule, x, y = MOTION.unpack(data)
    if found != OF_MOTION or whose != robot or not math.isfinite(time):
        return None
    return Answer(sequence, time, (float(kind), x, y, float(rule)))


@dataclass
class Controller:
    """The far end: what it makes of messages. Its memory and its draws are its own."""

    robot: int
    control: Callable[[Floats, Floats], None]
    """(message (4,), motion out (4,))."""
    counts: Counts = field(default_factory=Counts)
    _sequence: int = 0
    _time: float = -math.inf
    _motion: Floats = field(default_factory=lambda: np.zeros(4))

    def answer(self, data: bytes) -> bytes | None:
        """The motion that answers a message; None for bytes that are dropped."""
        message = decoded_message(self.robot, data)
        if message is None:
            self.counts.dropped += 1
            return None
        if message.sequence <= self._sequence or message.time < self._time:
            self.counts.late += 1
            return None
        self._sequence, self._time = message.sequence, message.time
        self.control(np.array(message.told), self._motion)
        self.counts.sent += 1
        return encoded_motion(self.robot, message.sequence, message.time, self._motion)


@dataclass
class Asker:
    """The near end: numbers messages, and tells the motion that answers the last one from all else."""

    robot: int
    counts: Counts = field(default_factory=Counts)
    _sequence: int = 0

    def asked(self, time: float, told: tuple[float, ...]) -> bytes:
        """The next message."""
        self._sequence += 1
        self.counts.sent += 1
        return encoded_message(self.robot, self._sequence, time, told)

    def answered(self, data: bytes) -> tuple[float, float, float, float] | None:
        """The motion that answers the last message; None for bytes that are dropped."""
        answer = decoded_motion(self.robot, data)
        if answer is None or answer.sequence > self._sequence:
            self.counts.dropped += 1
            return None
        if answer.sequence < self._sequence:
            self.counts.late += 1
            return None
        return answer.motion


class Frames:
    """A stream of bytes cut into frames of one size that begin alike; what lies between them is dropped and counted."""

    def __init__(self, begin: bytes, size: int, counts: Counts) -> None:
        self._begin, self._size, self._counts = begin, size, counts
        self._bytes = b""

    def cut(self, data: bytes) -> list[bytes]:
        """The frames that are whole with these bytes."""
        self._bytes += data
        found: list[bytes] = []
        while True:
            at = self._bytes.find(self._begin)
            if at < 0:  # what may yet become a beginning stays
                at = len(self._bytes) - self._begun()
            if at > 0:
                self._counts.dropped += 1
                self._bytes = self._bytes[at:]
            if len(self._bytes) < self._size:
                return found
            found.append(self._bytes[: self._size])
            self._bytes = self._bytes[self._size :]

    def _begun(self) -> int:
        """How many of the last bytes are a part of a beginning."""
        longest = min(len(self._begin) - 1, len(self._bytes))
        return next((n for n in range(longest, 0, -1) if self._begin.startswith(self._bytes[-n:])), 0)
