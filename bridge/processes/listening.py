"""A twin beside a rig for a short while, which says nothing: for a look ahead from what is there now."""

import queue
import time
from collections import deque
from typing import Any, NamedTuple

from bridge.errors import RunError
from bridge.loop.ahead import Change, Past, changes_of
from bridge.loop.follower import FollowerSide
from bridge.machine.process import Stop
from bridge.scenario import Scenario, changed
from bridge.scenario.untrusted import parsed_json
from bridge.wire.bus import Bus
from bridge.wire.codec import decode, ready
from bridge.wire.link import Link
from controller.grid import NS
from twin.estimation.quantities import Standing
from twin.estimation.settings import Settings

HEARD = ("command", "event", "measurement")
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

    Raises RunError where it is silent or nothing is found out.
    """
    stop, inbox = Stop(), queue.SimpleQueue()
    with Bus(link, rig, "viewer", blocking=False) as bus:
        ready(*HEARD)
        listening = stop.listen()
        told = bus.ask("scenario", link.patience, listening)
        if told is None:
            raise RunError(f"no plant of rig {rig!r} answers: start one first, or name its address with --connect")
        answer = parsed_json(told)
        scenario = changed(answer["scenario"], [], f"the scenario of rig {rig!r}")
        side, recent = FollowerSide(scenario, settings), deque(maxlen=REMEMBERED)
        changes = [Change(c["text"], int(c["command"]), int(c["apply_at"])) for c in answer.get("changed", [])]
        for topic in HEARD:
            bus.subscribe(topic, lambda sample, topic=topic: inbox.put((topic, sample.payload.to_bytes())))
        deadline, begun = time.monotonic() + link.patience + SLOWEST * LONGEST * seconds, -1
        while time.monotonic() < deadline and not listening():
            try:
                topic, payload = inbox.get(timeout=0.1)
            except queue.Empty:
                continue
            begun = _take(side, topic, payload, recent, changes, begun)
            if begun >= 0 and heard_enough(side, (side.now - begun) / NS, seconds):
                break
    if not known(side):
        raise RunError(
            f"rig {rig!r}: after {max(0, side.now - begun) / NS:.3g} s it is not known well enough; listen longer with "
            "--listen-for, or see what `hydrotwin follow` says"
        )
    return Heard(side, scenario, Past(list(recent), changes))


def known(side: FollowerSide) -> bool:
    """Is there an estimate to go on from?"""
    return side.latest is not None and side.latest.standing == Standing.FOLLOWING


def heard_enough(side: FollowerSide, passed: float, seconds: float) -> bool:
    """Has it listened for as long as asked for and knows the rig now, or for so long that it will not [s]?"""
    return passed >= (seconds if known(side) else LONGEST * seconds)


def _take(side: FollowerSide, topic: str, payload: bytes, recent: deque[Any], changes: list[Change], begun: int) -> int:
    """When the first measurement was taken [ns], -1 before it."""
    try:
        message = decode(payload, topic)
    except ValueError:
        return begun
    if topic == "command":
        side.take(message)
    elif topic == "event":
        side.heed(message)
        changes += changes_of(message)
    else:
        recent.append(message)
        side.hear(message)
        return message.stamp if begun < 0 else begun
    return begun
