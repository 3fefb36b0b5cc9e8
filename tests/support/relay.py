"""A bad network between two processes on loopback, where the kernel has none: a relay that delays, drops and cuts.

Over TCP nothing is lost and nothing overtakes: what comes waits for its turn, and a cut holds everything back until it
is mended. Over UDP each datagram passes at once, or never.
"""

import queue
import random
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NamedTuple

LARGEST = 65536  # [bytes] that are read at once
HOST = "127.0.0.1"


class Delay(NamedTuple):
    """Of what passes one way, evenly distributed, as `tc netem delay TIME SPREAD`."""

    time: float = 0.0  # [s]
    spread: float = 0.0  # [s], to either side


NO_DELAY = Delay()


class BadNetwork:
    """What the relay does at the moment; may be changed while it runs."""

    def __init__(self, seed: int = 0, delay: Delay = NO_DELAY) -> None:
        self.delay = delay
        self.loss = 0.0  # share of the datagrams
        self.dropped = self.passed = 0
        self._random = random.Random(seed)
        self._whole = threading.Event()
        self._whole.set()

    def cut(self, seconds: float) -> None:
        """Let nothing pass for some time."""
        self._whole.clear()
        time.sleep(seconds)
        self._whole.set()

    def due(self) -> float:
        """When something that has come now may leave, on the monotonic clock."""
        luck = 2.0 * self._random.random() - 1.0
        return time.monotonic() + max(0.0, self.delay.time + self.delay.spread * luck)

    def passes(self) -> bool:
        """Does a datagram pass?"""
        well = self._whole.is_set() and self._random.random() >= self.loss
        self.passed, self.dropped = self.passed + well, self.dropped + (not well)
        return well

    def await_whole(self) -> None:
        """Return when nothing is cut."""
        self._whole.wait()


@contextmanager
def relayed(endpoint: str, network: BadNetwork) -> Iterator[str]:
    """An endpoint that leads to another one (tcp/127.0.0.1:PORT or udp/...) through a bad network."""
    protocol, _, rest = endpoint.partition("/")
    target = (HOST, int(rest.rpartition(":")[2]))
    opened: list[socket.socket] = []
    door = socket.socket(socket.AF_INET, socket.SOCK_STREAM if protocol == "tcp" else socket.SOCK_DGRAM)
    opened.append(door)
    door.bind((HOST, 0))
    serve = _serve_tcp if protocol == "tcp" else _serve_udp
    threading.Thread(target=serve, args=(door, target, network, opened), daemon=True).start()
    try:
        yield f"{protocol}/{HOST}:{door.getsockname()[1]}"
    finally:
        network.delay, network.loss = NO_DELAY, 1.0
        for one in opened:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()


def _serve_tcp(door: socket.socket, target: tuple[str, int], network: BadNetwork, opened: list[socket.socket]) -> None:
    with suppress(OSError):
        door.listen()
        while True:
            near, _ = door.accept()
            try:
                far = socket.create_connection(target, 5.0)
            except OSError:
                near.close()
                continue
            for one in (near, far):
                one.settimeout(None)
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            opened += [near, far]
            for source, sink in ((near, far), (far, near)):
                way: queue.SimpleQueue[tuple[float, bytes]] = queue.SimpleQueue()
                threading.Thread(target=_take_in, args=(source, way, network), daemon=True).start()
                threading.Thread(target=_hand_on, args=(sink, way, network), daemon=True).start()


def _take_in(source: socket.socket, way: "queue.SimpleQueue[tuple[float, bytes]]", network: BadNetwork) -> None:
    data = b"begin"
    while data:
        try:
            data = source.recv(LARGEST)
        except OSError:
            data = b""
        way.put((network.due(), data))


def _hand_on(sink: socket.socket, way: "queue.SimpleQueue[tuple[float, bytes]]", network: BadNetwork) -> None:
    with suppress(OSError):
        while True:
            due, data = way.get()
            time.sleep(max(0.0, due - time.monotonic()))
            network.await_whole()
            if not data:
                sink.shutdown(socket.SHUT_WR)
                return
            sink.sendall(data)


def _serve_udp(door: socket.socket, target: tuple[str, int], network: BadNetwork, opened: list[socket.socket]) -> None:
    behind: dict[tuple[str, int], socket.socket] = {}  # by the address of the client
    with suppress(OSError):
        while True:
            data, client = door.recvfrom(LARGEST)
            if client not in behind:
                behind[client] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                behind[client].connect(target)
                opened.append(behind[client])
                threading.Thread(target=_answer, args=(door, client, behind[client], network), daemon=True).start()
            if network.passes():
                with suppress(ConnectionError):
                    behind[client].send(data)


def _answer(door: socket.socket, client: tuple[str, int], back: socket.socket, network: BadNetwork) -> None:
    while True:
        try:
            data = back.recv(LARGEST)
        except ConnectionError:
            continue
        except OSError:
            return
        if not data:
            return
        if network.passes():
            with suppress(OSError):
                door.sendto(data, client)
