"""A robot whose controller is a thread of its own, which its image process reaches by UDP or TCP (`wire`).

Kirchner 2006, section 3.6.7. The controller is a thread with a socket of its own, its own memory and its own stream of
draws; nothing but the bytes on the wire goes between the two. The loop waits for each answer, so that a trial is that
of a controller in process bit for bit as long as none is lost.

A message that is not answered within `LIMIT_S` counts as lost: the robot keeps its command, and goes on to the next.
After `MOST_LOST` in a row the trial fails. Sockets are opened at the first message, and listen on loopback alone unless
the group says otherwise (`link_address`, `link_beyond_loopback`).
"""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import threading
from collections.abc import Sequence
from time import monotonic
from typing import Any, NamedTuple, Protocol

import numpy as np

from flocking.lawparts import MESSAGE_SIZE, Parts
from flocking.types import Floats, Kind
from trials.simulations.robots.wire import (
    MESSAGE,
    MOTION,
    OF_MESSAGE,
    OF_MOTION,
    UDP,
    Asker,
    Controller,
    Counts,
    Frames,
)
from trials.types import Measure

LIMIT_S = 15.0
"""Wall time for an answer, which takes a thousandth of a second."""
MOST_LOST = 3
"""Three times the limit is less than the minute after which a worker that uses no processor time is ended."""
LOOK_S = 0.25
"""How often one who waits for an answer looks whether the controller is still there, and it whether it is to end."""
END_S = 5.0
"""Wall time in which a controller ends, before its socket is closed: it may be at work on a message."""
MOST_BYTES = 65_536

ABOUT = {
    "link_messages": Measure("", "messages from image processes to controllers by UDP or TCP"),
    "link_dropped": Measure("", "what came to either end and was malformed, or came from elsewhere, and was dropped"),
    "link_late": Measure("", "what came to either end after what was sent later, or twice, and was dropped"),
    "link_unanswered": Measure("", "messages that no answer came to: the robot kept its command"),
}


class LinkError(RuntimeError):
    """A controller cannot be reached, or is gone."""


class End(Protocol):
    """One end of a connection."""

    socket: socket.socket

    def send(self, data: bytes) -> None:
        """Sends one frame; an empty one ends the connection."""

    def receive(self) -> bytes | None:
        """The next frame; None where none came yet. Raises `EOFError` where the other end has ended the connection."""


class UdpEnd:
    """An end that sends datagrams to another and takes those that come from it."""

    def __init__(self, own: socket.socket, peer: Any, counts: Counts) -> None:
        self.socket, self.peer, self._counts = own, peer, counts

    def send(self, data: bytes) -> None:
        self.socket.sendto(data, self.peer)

    def receive(self) -> bytes | None:
        try:
            data, source = self.socket.recvfrom(MOST_BYTES)
        except TimeoutError:
            return None
        if source[:2] != self.peer[:2]:
            self._counts.dropped += 1
            return None
        if not data:
            raise EOFError("its socket was closed")
        return data


class TcpEnd:
    """An end of a stream of frames."""

    def __init__(self, own: socket.socket, begin: bytes, size: int, counts: Counts) -> None:
        own.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket = own
        self._frames, self._waiting = Frames(begin, size, counts), list[bytes]()

    def send(self, data: bytes) -> None:
        if data:
            self.socket.sendall(data)
        else:
            self.socket.shutdown(socket.SHUT_WR)

    def receive(self) -> bytes | None:
        if not self._waiting:
            try:
                data = self.socket.recv(MOST_BYTES)
            except TimeoutError:
                return None
            if not data:
                raise EOFError("its connection was closed")
            self._waiting = self._frames.cut(data)
        return self._waiting.pop(0) if self._waiting else None


class Way(NamedTuple):
    """How a controller is reached."""

    kind: str
    """`udp` or `tcp`."""
    host: str


def connected(way: Way, near: Counts, far: Counts) -> tuple[End, End]:
    """The image process's and the controller's end of a new connection at that address. Raises `LinkError`."""
    try:
        ends = _udp(way.host, near, far) if way.kind == UDP else _tcp(way.host, near, far)
    except OSError as error:
        raise LinkError(f"no controller at {way.host} by {way.kind}: {error.strerror or error}") from None
    for end in ends:
        end.socket.settimeout(LOOK_S)
    return ends


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ipaddress.ip_address(host).version == 6 else socket.AF_INET


def _udp(host: str, near: Counts, far: Counts) -> tuple[End, End]:
    with contextlib.ExitStack() as opened:
        image, controller = (opened.enter_context(socket.socket(_family(host), socket.SOCK_DGRAM)) for _ in range(2))
        image.bind((host, 0))
        controller.bind((host, 0))
        opened.pop_all()
    return UdpEnd(image, controller.getsockname(), near), UdpEnd(controller, image.getsockname(), far)


def _tcp(host: str, near: Counts, far: Counts) -> tuple[End, End]:
    with socket.socket(_family(host), socket.SOCK_STREAM) as listener:
        listener.bind((host, 0))
        listener.listen()
        image = socket.create_connection(listener.getsockname()[:2])
        own = image.getsockname()[:2]
        while True:
            controller, source = listener.accept()
            if source[:2] == own:
                break
            controller.close()  # somebody else's
            far.dropped += 1
    return TcpEnd(image, OF_MOTION, MOTION.size, near), TcpEnd(controller, OF_MESSAGE, MESSAGE.size, far)


class Mind(NamedTuple):
    """What a controller has of its own."""

    parts: Parts
    parameters: Floats
    memory: Floats
    rng: np.random.Generator
    draws: int
    dt: float


class Link:
    """Takes the place of a robot's law: tells the controller the message, and waits for the motion."""

    def __init__(self, robot: int, way: Way, mind: Mind) -> None:
        """`robot`: its number, which stands in each message."""

        def control(told: Floats, motion: Floats) -> None:
            mind.parts.control(told, mind.dt, mind.parameters, mind.memory, mind.rng.random(mind.draws), motion)

        self._image = mind.parts.image
        self._way = way
        self.asker, self.controller = Asker(robot), Controller(robot, control)
        self._time = 0.0
        self._told = np.empty(MESSAGE_SIZE)
        self._lost, self._rule = 0, 0.0
        self._ends: tuple[End, End] | None = None
        self._thread: threading.Thread | None = None
        self._failed: Exception | None = None
        self._ended = threading.Event()

    def at(self, time: float) -> Link:
        """The same at that simulated time, s."""
        self._time = time
        return self

    def __call__(self, *entry: Any) -> None:
        """As a law's entry (`lawentry.ENTRY_SIGNATURE`); memory and draws are the controller's. Raises `LinkError`."""
        *seen, _memory, _draws, motion = entry
        self._image(*seen, self._told)
        motion[:] = self._ask(tuple(self._told.tolist()))

    def close(self) -> None:
        """Ends the controller and closes the sockets, whether or not what is sent to it arrives."""
        if self._ends is None or self._thread is None:
            return
        self._ended.set()
        with contextlib.suppress(OSError):
            self._ends[0].send(b"")  # it need not wait until it looks
        self._thread.join(END_S)
        for end in self._ends:
            end.socket.close()
        self._ends = self._thread = None

    def _opened(self) -> End:
        """The near end of a connection to a controller that runs."""
        if self._ends is None:
            self._ends = connected(self._way, self.asker.counts, self.controller.counts)
            self._ended.clear()
            self._thread = threading.Thread(target=self._serve, args=(self._ends[1],), daemon=True)
            self._thread.start()
        return self._ends[0]

    def _serve(self, far: End) -> None:
        """The controller: answers until the connection is ended."""
        try:
            while not self._ended.is_set():
                data = far.receive()
                answer = None if data is None else self.controller.answer(data)
                if answer is not None:
                    far.send(answer)
        except EOFError:
            return
        except Exception as error:
            self._failed = error

    def _ask(self, told: tuple[float, ...]) -> tuple[float, float, float, float]:
        """The controller's motion; the command is kept where it does not answer."""
        end = self._opened()
        try:
            end.send(self.asker.asked(self._time, told))
            motion = self._awaited(end)
        except (OSError, EOFError) as error:
            raise LinkError(f"its controller is gone: {self._failed or error}") from None
        if motion is None:
            self.asker.counts.unanswered += 1
            self._lost += 1
            if self._lost >= MOST_LOST:
                raise LinkError(f"its controller left {self._lost} messages in a row without an answer")
            return float(Kind.HOLD), np.nan, np.nan, self._rule
        self._lost, self._rule = 0, motion[3]
        return motion

    def _awaited(self, end: End) -> tuple[float, float, float, float] | None:
        """The answer to the last message; None where none comes."""
        until = monotonic() + LIMIT_S
        while True:
            data = end.receive()
            motion = None if data is None else self.asker.answered(data)
            if motion is not None:
                return motion
            if self._failed is not None:
                raise LinkError(f"its controller is gone: {self._failed}")
            if monotonic() >= until:
                return None


def counts(links: Sequence[Link]) -> dict[str, float]:
    """The measures of a trial whose robots have these links; none of one that has none."""
    if not links:
        return {}
    ends = [end for link in links for end in (link.asker.counts, link.controller.counts)]
    return {
        "link_messages": float(sum(link.asker.counts.sent for link in links)),
        "link_dropped": float(sum(end.dropped for end in ends)),
        "link_late": float(sum(end.late for end in ends)),
        "link_unanswered": float(sum(link.asker.counts.unanswered for link in links)),
    }
