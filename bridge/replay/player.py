"""Plays a recording: waits for what is due, and heeds what keys and queries ask for."""

import math
import queue
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, NamedTuple

from bridge.errors import UsageError, nearest
from bridge.machine.clock import SPIN_NS
from bridge.replay.timeline import Timeline
from bridge.scenario.units import quantity
from controller.grid import NS

NAP = 0.005  # seconds, the longest in which nothing is heeded
FURTHEST = 1e9  # [s], of a recorded time


class Order(NamedTuple):
    """Something asked for, and where the answer goes."""

    verb: str
    value: str
    answer: "Future[dict[str, Any]]"


class Player:
    """One replay."""

    def __init__(self, timeline: Timeline, send: Callable[[range], None], now: Callable[[], int] = time.monotonic_ns):
        self.timeline = timeline
        self.sent = 0
        self._send = send
        self._now = now
        self._orders: queue.SimpleQueue[Order] = queue.SimpleQueue()
        self._over = self._closed = False
        self._verbs: dict[str, Callable[[str, int], None]] = {
            "pause": lambda _, now: self.timeline.pause(now),
            "resume": lambda _, now: self.timeline.resume(now),
            "toggle": lambda _, now: (self.timeline.resume if self.timeline.paused else self.timeline.pause)(now),
            "step": lambda _, now: self._emit(self.timeline.step(now)),
            "seek": lambda value, now: self.timeline.seek(_time("seek", value), now),
            "skip": lambda value, now: self.timeline.seek(self.timeline.time(now) + _time("skip", value), now),
            "speed": lambda value, now: self.timeline.set_speed(speed_of(value), now),
            "faster": lambda value, now: self.timeline.set_speed(self.timeline.speed * speed_of(value), now),
            "status": lambda *_: None,
            "quit": lambda *_: self.stop(),
        }

    def ask(self, verb: str, value: str = "") -> "Future[dict[str, Any]]":
        """Ask for something, from any thread; the answer is the status after it, or has an "error"."""
        order = Order(verb, value, Future())
        self._orders.put(order)
        if self._closed:
            self._refuse_orders()
        return order.answer

    def stop(self) -> None:
        """End the replay."""
        self._over = True

    def close(self) -> None:
        """Refuse what nobody will heed any more."""
        self._closed = True
        self._refuse_orders()

    def run(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Play to the end, for ever in a loop, or until stopped."""
        while not self._over and not stopped():
            while not self._orders.empty():
                self._heed(self._orders.get())
            if self.timeline.ended and not self.timeline.paused:
                return
            self._play()

    def status(self) -> dict[str, Any]:
        """Where the replay stands, in seconds of recorded time."""
        line, speed = self.timeline, self.timeline.speed
        return {
            "time": line.time(self._now()) / NS,
            "begin": line.times[0] / NS,
            "end": line.times[-1] / NS,
            "speed": "max" if math.isinf(speed) else speed,
            "paused": line.paused,
            "loops": line.loops,
            "sent": self.sent,
            "left": len(line.times) - line.index,
        }

    def _play(self) -> None:
        """Send what is due, or wait a little for it."""
        due = self.timeline.due(now := self._now())
        if due is None or due - now > SPIN_NS:
            wait = NAP if due is None else min(NAP, (due - now - SPIN_NS) * 1e-9)
            time.sleep(wait)
            return
        while (now := self._now()) < due:
            pass
        self._emit(self.timeline.take(now))

    def _emit(self, indices: range) -> None:
        self._send(indices)
        self.sent += len(indices)

    def _refuse_orders(self) -> None:
        with suppress(queue.Empty):
            while True:
                self._orders.get_nowait().answer.set_result({"error": "the replay has ended"})

    def _heed(self, order: Order) -> None:
        try:
            if order.verb not in self._verbs:
                raise ValueError(f"{order.verb!r} is unknown{nearest(order.verb, self._verbs)}")
            self._verbs[order.verb](order.value, self._now())
            order.answer.set_result(self.status())
        except (ValueError, UsageError) as error:
            order.answer.set_result(self.status() | {"error": str(error)})


def _time(verb: str, text: str) -> int:
    """A time that a verb takes, such as '1.2 s' [ns]. Raises ValueError."""
    seconds = quantity(text, "s")
    if not abs(seconds) < FURTHEST:
        raise ValueError(f"{verb} {text!r}: take seconds, a number below {FURTHEST:g}")
    return round(seconds * NS)


def speed_of(text: str) -> float:
    """A speed as people write it: a number above zero, or max. Raises ValueError."""
    if text.strip() == "max":
        return math.inf
    try:
        speed = float(text)
    except ValueError:
        raise ValueError(f"speed {text!r} is neither a number nor 'max'") from None
    if not speed > 0.0:
        raise ValueError(f"speed {text} must be greater than 0; to stand still there is pause")
    return speed
