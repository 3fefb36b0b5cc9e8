"""A rig's keys on Zenoh: publish and subscribe by the table of messages, and know who is there.

Lockstep: reliable, blocking, one priority, so that a publisher's messages stay in order. Real time: what does not fit
is dropped, and the loop's own messages go first.
"""

import os
import struct
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

import numpy as np
import zenoh

from bridge.wire.codec import Status, encode, ready
from bridge.wire.intake import Desk, Door, Turned
from bridge.wire.limits import FASTEST, RATES, TOKENS, Excess
from bridge.wire.link import Link, open_session
from bridge.wire.messages import TOPICS, Outgoing, Phase, Topic, encoding

STAMP = struct.Struct("<qQ")  # attachment: log time, sequence
PEOPLE = ("viewer", "operator")  # roles that do not look at the length of each message as it comes
Receiver = Callable[[Any], None]  # takes a Zenoh sample


def claimed_type(sample: Any) -> str:
    """The message type that a sample says it is; empty when it says nothing."""
    return str(sample.encoding).partition(";")[2]


def stamp_of(sample: Any) -> tuple[int, int] | None:
    """Log time and sequence that our processes attach; None for somebody else's message."""
    attachment = sample.attachment
    raw = b"" if attachment is None else attachment.to_bytes()
    return STAMP.unpack(raw) if len(raw) == STAMP.size else None


class Bus:
    """One process's place on the bus of a rig. Use as a context manager."""

    def __init__(
        self,
        link: Link,
        rig_name: str,
        role: str,
        blocking: bool,
        lease: float | None = None,
        turned: Turned | None = None,
    ) -> None:
        self.rig_name = rig_name
        self.place = f"listening on {link.listen}" if link.listen else f"connected to {link.connect or link.config}"
        self.role = role
        self.turned = turned or Turned()  # what arrived and was turned away
        self.session = open_session(link, lease=lease, only_short=role in PEOPLE)
        self.present: dict[str, set[str]] = {}
        self.changed = threading.Condition()
        self._publishers: dict[str, Any] = {}
        self._declared: list[Any] = []
        self._desks: list[Desk] = []
        self._status = 0
        self._blocking = blocking
        self.speak_as(role)
        self._last_words = self._declare(TOPICS["status"], blocking=True)

    def __enter__(self) -> "Bus":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Leave the bus. Where somebody takes nothing any more, Zenoh gives up closing in order after a while."""
        with suppress(zenoh.ZError):
            self.session.close()
        for desk in self._desks:
            desk.close()

    def speak_as(self, role: str) -> None:
        """Publish what a role publishes, too."""
        for topic in TOPICS.values():
            if topic.publisher in (role, "all") and topic.name not in self._publishers:
                ready(topic.name)
                self._publishers[topic.name] = self._declare(topic, self._blocking)

    def publish(self, message: Outgoing, payload: bytes | None = None) -> None:
        """Send one message."""
        stamp = STAMP.pack(message.log_time, message.sequence)
        self._publishers[message.topic].put(encode(message.message) if payload is None else payload, attachment=stamp)

    def publish_status(
        self, run_id: int, stamp: int, phase: Phase, values: dict[str, float], text: str = "", final: bool = False
    ) -> None:
        """Say how this process is doing; the last word waits for its readers, others do not."""
        names, numbers = list(values), [float(value) for value in values.values()]
        status = Status(
            run_id=run_id,
            sequence=self._status,
            stamp=stamp,
            role=self.role,
            phase=phase,
            pid=os.getpid(),
            names=names,
            values=np.array(numbers),
            text=text,
        )
        publisher = self._last_words if final else self._publishers["status"]
        publisher.put(encode(status), attachment=STAMP.pack(stamp, self._status))
        self._status += 1

    def subscribe(self, topic: str, receiver: Receiver, rate: float | None = None) -> None:
        """Call `receiver(sample)` in Zenoh's own thread for each message that is not too long.

        rate: messages per second that are let in in real time, another one than the table of limits has.
        """
        door = Door(topic, self.turned, None if self._blocking else rate or RATES.get(topic, FASTEST))

        def let_in(sample: Any) -> None:
            if door.admits(len(sample.payload)):
                receiver(sample)

        handler = zenoh.handlers.Callback(let_in, indirect=False)
        self._declared.append(self.session.declare_subscriber(f"{self.rig_name}/{topic}", handler))

    def answer(self, name: str, reply: Callable[[], bytes]) -> None:
        """Answer queries for a name below the rig's."""
        self.serve(name, lambda _: reply())

    def serve(self, name: str, reply: Callable[[bytes], bytes]) -> None:
        """Answer queries with a payload for a name below the rig's, in a thread that may wait."""
        key = f"{self.rig_name}/{name}"
        desk = Desk(name, self.turned, key, reply)
        self._desks.append(desk)
        handler = zenoh.handlers.Callback(desk.take, indirect=False)
        self._declared.append(self.session.declare_queryable(key, handler))

    def request(self, name: str, payload: bytes, patience: float) -> bytes | None:
        """The answer to a query with a payload, None when nobody gives one in `patience` seconds."""
        for reply in self.session.get(f"{self.rig_name}/{name}", payload=payload, timeout=patience):
            if reply.ok is not None:
                return reply.ok.payload.to_bytes()
        return None

    def ask(self, name: str, patience: float, stopped: Callable[[], bool] = lambda: False) -> bytes | None:
        """The first answer to a query, None when nobody gives one in `patience` seconds."""
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline and not stopped():
            for reply in self.session.get(f"{self.rig_name}/{name}", timeout=1.0):
                if reply.ok is not None:
                    return reply.ok.payload.to_bytes()
            time.sleep(0.02)
        return None

    def announce(self) -> None:
        """Tell the others that this process is ready; its subscriptions are known before that."""
        key = f"{self.rig_name}/alive/{self.role}/{os.getpid()}"
        self._declared.append(self.session.liveliness().declare_token(key))

    def others(self, role: str) -> list[str]:
        """Who plays a role on this rig already, by process ids."""
        found = self.session.liveliness().get(f"{self.rig_name}/alive/{role}/*", timeout=1.0)
        return [str(reply.ok.key_expr).rpartition("/")[2] for reply in found if reply.ok is not None]

    def watch(self) -> None:
        """Keep `present` up to date: role -> process ids."""

        def on_token(sample: Any) -> None:
            role, pid = str(sample.key_expr).split("/")[-2:]
            with self.changed:
                self._note_token(role, pid, sample.kind == zenoh.SampleKind.PUT)
                self.changed.notify_all()

        handler = zenoh.handlers.Callback(on_token, indirect=False)
        key = f"{self.rig_name}/alive/**"
        self._declared.append(self.session.liveliness().declare_subscriber(key, handler, history=True))

    def _note_token(self, role: str, pid: str, alive: bool) -> None:
        if not alive:
            self.present.get(role, set()).discard(pid)
        elif sum(map(len, self.present.values())) < TOKENS:
            self.present.setdefault(role, set()).add(pid)
        else:
            self.turned.add("sign of life", Excess.WAITING)

    def await_roles(self, roles: Iterable[str], patience: float, stopped: Callable[[], bool]) -> list[str]:
        """Wait until each role is present; returns those still missing."""
        return self._await(lambda: [role for role in roles if not self.present.get(role)], patience, stopped)

    def await_leaving(self, roles: Iterable[str], patience: float) -> list[str]:
        """Wait until each role has left; returns those still here."""
        return self._await(lambda: [role for role in roles if self.present.get(role)], patience, lambda: False)

    def _await(self, missing: Callable[[], list[str]], patience: float, stopped: Callable[[], bool]) -> list[str]:
        deadline = time.monotonic() + patience
        with self.changed:
            while (absent := missing()) and time.monotonic() < deadline and not stopped():
                self.changed.wait(0.05)
        return absent

    def _declare(self, topic: Topic, blocking: bool) -> Any:
        urgent = topic.express and not blocking
        control = zenoh.CongestionControl
        return self.session.declare_publisher(
            f"{self.rig_name}/{topic.name}",
            encoding=encoding(topic.type),
            congestion_control=control.BLOCK if blocking else control.DROP,
            priority=zenoh.Priority.REAL_TIME if urgent else zenoh.Priority.DATA,
            express=urgent,
            reliability=zenoh.Reliability.RELIABLE,
        )
