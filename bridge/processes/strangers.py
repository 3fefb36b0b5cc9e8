"""Whom a plant does not expect: controllers that run another scenario, told of once each, and a second plant."""

import queue
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from bridge.errors import RunError
from bridge.scenario.sameness import DIGEST
from bridge.wire.codec import decode
from bridge.wire.intake import Turned, Waiting
from bridge.wire.limits import STRANGERS, Excess
from bridge.wire.status import numbers_of

LONGEST_WORDS = 500  # characters of what a stranger says it runs


class Strangers:
    """Of one plant; `hear` is called in Zenoh's thread, `new` in the plant's."""

    def __init__(self, digest: int, turned: Turned) -> None:
        self._digest = digest  # of the plant's own scenario
        self._turned = turned
        self._waiting = Waiting("stranger", turned, STRANGERS)
        self._met: set[int] = set()  # their processes

    def hear(self, payload: bytes) -> None:
        """A status of somebody: does a controller run another scenario?"""
        with suppress(ValueError):
            status = decode(payload, "status")
            digest = numbers_of(status).get(DIGEST) if status.role == "controller" else None
            if digest is not None and round(digest) != self._digest and status.pid not in self._met:
                self._meet(status)

    def _meet(self, status: Any) -> None:
        if len(self._met) >= STRANGERS:
            self._turned.add("stranger", Excess.WAITING)
            return
        self._met.add(status.pid)
        self._waiting.put(f"controller {status.pid} runs {status.text[:LONGEST_WORDS] or 'another scenario'}")

    def new(self) -> Iterator[str]:
        """Whom it has met since it was asked last, in words."""
        while True:
            try:
                yield self._waiting.get_nowait()
            except queue.Empty:
                return


def second_plant(rig_name: str, others: list[str]) -> RunError:
    """For a plant of a rig that has one."""
    return RunError(
        f"rig {rig_name!r} has a plant already (process {', '.join(others)}): stop it, or give this "
        "one a name of its own with --set rig_name=NAME"
    )
