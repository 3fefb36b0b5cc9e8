"""`hydrotwin ros RIG`: the topics of a rig on the keys of rmw_zenoh, and commands and orders back, until Ctrl-C.

What a controller needs passes in Zenoh's own threads, so that one among the nodes has the shortest way; everything else
waits in rings, so that the plant never waits for this process.
"""

import json
import os
import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import zenoh

from bridge.connect.asking import Asking
from bridge.connect.ros.naming import Kind, Node, Type, attached, identity, key, publishers_of
from bridge.connect.ros.types import CLOCK, STRING, bridge_type, clock, string, text_of, type_of
from bridge.errors import RunError, UsageError
from bridge.machine.process import Stop
from bridge.recording.inbox import inbox
from bridge.scenario import check
from bridge.scenario.channels import layout_of
from bridge.scenario.untrusted import parsed_json
from bridge.wire.bus import STAMP, Bus, stamp_of
from bridge.wire.codec import decode
from bridge.wire.intake import Waiting
from bridge.wire.limits import MESSAGE
from bridge.wire.link import Link, open_session
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, Mode

NODE = "hydrotwin"  # and the rig's name
COMMAND, RESET = "command", "reset"
SETTING, ANSWER = "parameters/set", "parameters/answer"  # JSON as text, both ways
HEARD = tuple(topic.name for topic in TOPICS.values() if topic.publisher != "anybody")
DIRECT = ("measurement", CHANNELS_TOPIC, COMMAND)  # passed on at once
CLOCK_PERIOD = 10_000_000  # [ns] of simulated time, from one /clock to the next at least
WAITING_ORDERS = 100  # settings that wait to be passed on; more are dropped
PERIOD = 0.01  # [s] from look to look at what waits
SETTLING = 0.5  # [s] that a node has to subscribe, too, once it publishes commands: only then the plant hears of it
LEASE = 2.0  # [s] of our silence after which the plant gives us up: until then its last word may wait for us


class RosSide(NamedTuple):
    """Where the nodes are."""

    domain: int
    router: str | None  # a router that is there
    listen: str  # where this process is the router itself, if not


class Outlet:
    """A publisher among the nodes, with its token."""

    def __init__(self, session: Any, node: Node, number: int, topic: str, type_: Type, blocking: bool) -> None:
        control = zenoh.CongestionControl
        token = node.endpoint(Kind.PUBLISHER, number, topic, type_)
        self._who = identity(token)
        self._sequence = 0
        self._lock = threading.Lock()
        self._publisher = session.declare_publisher(
            key(node.domain, topic, type_),
            encoding="application/cdr",
            congestion_control=control.BLOCK if blocking else control.DROP,
            reliability=zenoh.Reliability.RELIABLE,
        )
        self._token = session.liveliness().declare_token(token)

    def put(self, payload: Any, time_ns: int) -> None:
        """Publish a message of a time [ns]; rmw_zenoh counts from 1."""
        with self._lock:
            self._sequence += 1
            self._publisher.put(payload, attachment=attached(self._sequence, time_ns, self._who))


class RosBridge:
    """One rig among the nodes."""

    def __init__(self, bus: Bus, session: Any, domain: int, manifest: dict[str, Any]) -> None:
        self._bus = bus
        self._session = session
        self._asking = Asking(bus)
        self._blocking = manifest["mode"] == Mode.LOCKSTEP
        self._layout = layout_of(check(manifest["scenario"], "the plant's scenario"))
        self.node = Node(domain, str(session.info.zid()), f"{NODE}_{bus.rig_name.replace('/', '_')}")
        self.passed: Counter[str] = Counter()  # messages to the nodes, per topic
        self.taken: Counter[str] = Counter()  # messages from the nodes, per topic
        self._numbers = iter(range(1, 1 << 31))
        self._orders = Waiting("order", bus.turned, WAITING_ORDERS)
        self._lock = threading.Lock()
        self._commanders: set[str] = set()  # tokens of nodes that publish commands
        self._come = 0.0  # when the first of them came [s, monotonic]
        self._present: Any = None  # the sign of life of a controller, while there is one among the nodes
        self._due = -CLOCK_PERIOD
        self._held: list[Any] = [session.liveliness().declare_token(self.node.token())]
        self._clock = self._outlet("clock", bridge_type(CLOCK), rooted=True)
        self._answers = self._outlet(ANSWER, bridge_type(STRING))
        self._inbox = inbox(bus, [name for name in HEARD if name not in DIRECT])
        self._outlets = {name: self._outlet(name, type_of(name, self._layout)) for name in self._shown()}

    def _shown(self) -> list[str]:
        return [name for name in HEARD if name != CHANNELS_TOPIC or self._layout]

    def join(self) -> None:
        """Pass messages on, both ways."""
        for name in self._outlets.keys() & set(DIRECT):
            self._hear(self._bus.session, f"{self._bus.rig_name}/{name}", self._passing(name, self._outlets[name]))
        self._subscription(COMMAND, type_of(COMMAND, self._layout), self._command)
        self._subscription(RESET, type_of(RESET, self._layout), lambda _: self._asking.reset())
        self._subscription(SETTING, bridge_type(STRING), self._orders.put)
        watched = publishers_of(self.node.domain, f"{self._bus.rig_name}/{COMMAND}")
        handler = zenoh.handlers.Callback(self._commander, indirect=False)
        self._held.append(self._session.liveliness().declare_subscriber(watched, handler, history=True))

    def run(self, stop: Callable[[], bool]) -> None:
        """Pass on what waits, and answer orders, until stopped."""
        while not stop():
            time.sleep(PERIOD)
            self._tell_of_commanders()
            for entry in self._inbox.take():
                self._outlets[entry.topic].put(entry.data, entry.log_time)
                self.passed[entry.topic] += 1
            if not self._orders.empty():
                self._answers.put(string(self._obeyed(self._orders.get())), time.time_ns())

    def _outlet(self, name: str, type_: Type, rooted: bool = False) -> Outlet:
        topic = name if rooted else f"{self._bus.rig_name}/{name}"
        return Outlet(self._session, self.node, next(self._numbers), topic, type_, self._blocking)

    def _subscription(self, name: str, type_: Type, take: Callable[[bytes], None]) -> None:
        topic = f"{self._bus.rig_name}/{name}"
        token = self.node.endpoint(Kind.SUBSCRIPTION, next(self._numbers), topic, type_)

        def heard(sample: Any) -> None:
            if len(sample.payload) <= MESSAGE:
                self.taken[name] += 1
                take(sample.payload.to_bytes())

        self._hear(self._session, key(self.node.domain, topic, type_), heard)
        self._held.append(self._session.liveliness().declare_token(token))

    def _hear(self, session: Any, name: str, heard: Callable[[Any], None]) -> None:
        """Not what this session has sent itself: commands pass both ways."""
        handler = zenoh.handlers.Callback(heard, indirect=False)
        self._held.append(session.declare_subscriber(name, handler, allowed_origin=zenoh.Locality.REMOTE))

    def _passing(self, name: str, outlet: Outlet) -> Callable[[Any], None]:
        def on_message(sample: Any) -> None:
            stamp = stamp_of(sample)
            now = stamp[0] if stamp else 0
            if name == "measurement":
                self._tell_time(now)
            outlet.put(sample.payload, now)
            self.passed[name] += 1

        return on_message

    def _tell_time(self, now: int) -> None:
        if now < self._due - CLOCK_PERIOD or now >= self._due:  # a replay may go back
            self._due = now + CLOCK_PERIOD
            self._clock.put(clock(now), now)

    def _command(self, payload: bytes) -> None:
        """On its way to the plant, which judges it; with the stamp that our own controllers attach."""
        try:
            command = decode(payload, COMMAND)
        except ValueError:
            stamp = None  # let the plant refuse, count and record it
        else:
            stamp = STAMP.pack(command.sample_stamp, command.sequence)
        self._bus.session.put(
            f"{self._bus.rig_name}/{COMMAND}",
            payload,
            encoding=f"application/cdr;{TOPICS[COMMAND].type}",
            attachment=stamp,
            congestion_control=zenoh.CongestionControl.BLOCK if self._blocking else zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.DATA if self._blocking else zenoh.Priority.REAL_TIME,
            express=not self._blocking,
        )

    def _commander(self, sample: Any) -> None:
        """A node that publishes commands has come or gone."""
        token = str(sample.key_expr)
        if self.node.session in token:
            return
        with self._lock:
            if sample.kind == zenoh.SampleKind.PUT:
                self._come = self._come if self._commanders else time.monotonic()
                self._commanders.add(token)
            else:
                self._commanders.discard(token)

    def _tell_of_commanders(self) -> None:
        """Give the plant the sign of life of a controller while there is one."""
        with self._lock:
            settled = bool(self._commanders) and time.monotonic() - self._come > SETTLING
        if settled and self._present is None:
            name = f"{self._bus.rig_name}/alive/controller/{os.getpid()}"
            self._present = self._bus.session.liveliness().declare_token(name)
        elif not settled and self._present is not None:
            self._present.undeclare()
            self._present = None

    def _obeyed(self, payload: bytes) -> str:
        """What an order comes to, as JSON."""
        try:
            wanted = parsed_json(text_of(payload))
            if not isinstance(wanted, dict):
                raise ValueError('send {"set": {"controller.gain": "1.5 V/%"}}')
            return json.dumps(self._asking.order(SETTING, wanted))
        except (ValueError, UsageError, RunError) as error:
            return json.dumps({"refused": str(error)})


def bridge(link: Link, rig: str, side: RosSide) -> None:
    """Bridge a rig until Ctrl-C. Raises LinkError, UsageError, or RunError where no plant answers."""
    stop = Stop()
    nodes = Link(None if side.router else side.listen, side.router, None, link.patience)
    with Bus(link, rig, "viewer", blocking=True, lease=LEASE) as bus:
        manifest = Asking(bus).run(link.patience)
        if manifest is None:
            raise RunError(f"no plant of rig {rig!r} answers: start one first, or name another rig")
        with open_session(nodes, None if side.router else "router") as session:
            bridged = RosBridge(bus, session, side.domain, manifest)
            bridged.join()
            stop.listen()
            print(f"/{rig} is at {side.router or side.listen}, ROS_DOMAIN_ID={side.domain}\nCtrl-C ends it", flush=True)
            bridged.run(stop)
            counts = sum(bridged.passed.values()), sum(bridged.taken.values())
            print("{} messages to the nodes, {} from them".format(*counts))
