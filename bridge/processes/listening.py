"""A twin beside a rig for a short while, which says nothing: for a look ahead from what is there now."""

import queue
import time
from collections import deque
from typing import Any, NamedTuple

from bridge.errors import RunError
from bridge.loop.ahead import Change, Past, changes_of
from bridge.loop.follower import FollowerSide
from bridge.processes.contact import Contact
from bridge.processes.follower import told_by
from bridge.scenario import Scenario, changed
from bridge.scenario.untrusted import parsed_json
from bridge.wire.bus import Bus
from bridge.wire.codec import decode, ready
from bridge.wire.link import Link
from controller.grid import NS
from twin.estimation.quantities import Standing
from twin.estimation.settings import Settings

HEARD = ("command", "event", "measurement", "status")
REMEMBERED = 5000  # measurements that a law may have seen
LONGEST = 5.0  # times as long as asked for, in simulated time, until the rig is known
SLOWEST = 20.0  # times as long as that in wall time, then it gives up


class Heard(NamedTuple):
    """What is known of a rig now."""

    side: FollowerSide
    scenario: Scenario  # as the plant says it
    past: Past  # measurements the newest `REMEMBERED`


def listen(rig: str, link: Link, seconds: float, settings: Settings) -> Heard:
    """Follow a rig for some seconds of simulated time, and on until it is known, up to `LONGEST` times as long.

    Raises RunError where it is silent, ends, or nothing is found out.
    """
    with Bus(link, rig, "viewer", blocking=False) as bus:
        ready(*HEARD)
        told = bus.ask("scenario", link.patience)
        if told is None:
            raise RunError(f"no plant of rig {rig!r} answers: start one first, or name its address with --connect")
        answer = parsed_json(told)
        scenario = changed(answer["scenario"], [], f"the scenario of rig {rig!r}")
        ear = Ear(bus, FollowerSide(scenario, settings), answer.get("changed", []))
        deadline = time.monotonic() + link.patience + SLOWEST * LONGEST * seconds
        while time.monotonic() < deadline and not heard_enough(ear.side, ear.passed, seconds):
            ear.take()
    if not known(ear.side):
        raise RunError(
            f"rig {rig!r}: after {ear.passed:.3g} s it is not known well enough; listen longer with --listen-for, or "
            "see what `hydrotwin follow` says"
        )
    return Heard(ear.side, scenario, Past(list(ear.recent), ear.changes))


class Ear:
    """What comes off the bus, into a twin."""

    def __init__(self, bus: Bus, side: FollowerSide, told: list[Any]) -> None:
        self.side = side
        self.recent: deque[Any] = deque(maxlen=REMEMBERED)
        self.changes = [Change(c["text"], int(c["command"]), int(c["apply_at"])) for c in told]
        self._rig, self._begun, self._tick = bus.rig_name, -1, -1
        self._inbox: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        for topic in HEARD:
            bus.subscribe(topic, lambda sample, topic=topic: self._inbox.put((topic, sample.payload.to_bytes())))
        bus.watch()
        self._contact = Contact(bus, is_expected=True)

    @property
    def passed(self) -> float:
        """Simulated time since the first measurement [s]."""
        return (self.side.now - self._begun) / NS if self._begun >= 0 else 0.0

    def take(self) -> None:
        """The next message, if one comes soon. Raises RunError when the plant has ended or is lost."""
        try:
            topic, payload = self._inbox.get(timeout=0.1)
            message = decode(payload, topic)
        except queue.Empty:
            if self._contact.over(self._tick, f"t = {max(0, self.side.now) / NS:g} s"):
                raise RunError(
                    f"rig {self._rig!r} has ended {self.passed:.3g} s after listening began; of its recording: "
                    "hydrotwin whatif FILE"
                ) from None
            return
        except ValueError:
            return
        if topic == "command":
            self.side.take(message)
        elif topic == "event":
            self.side.heed(message)
            self.changes += changes_of(message)
        elif topic == "status":
            self._contact.heed(message)
            if told := told_by(message):
                self.side.learn(told)
        else:
            self._tick, self._begun = message.tick, message.stamp if self._begun < 0 else self._begun
            self.recent.append(message)
            self.side.hear(message)


def known(side: FollowerSide) -> bool:
    """Is there an estimate to go on from?"""
    return side.latest is not None and side.latest.standing == Standing.FOLLOWING


def heard_enough(side: FollowerSide, passed: float, seconds: float) -> bool:
    """Has it listened for as long as asked for and knows the rig now, or for so long that it will not [s]?"""
    return passed >= (seconds if known(side) else LONGEST * seconds)
