"""What somebody asks of a loop that runs: on its way in, taken between two ticks, and the answer."""

import json
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from typing import Any

from bridge.errors import ScenarioError, UsageError
from bridge.loop.plant import PlantSide

LONGEST = 64_000  # bytes of a query
TAKING = 2.0  # seconds for the loop to take what somebody asks
Act = Callable[[PlantSide], dict[str, Any]]  # does what is asked; raises ScenarioError where it cannot be


class Order:
    """Something to do between two ticks, and where the answer goes."""

    def __init__(self, act: Act) -> None:
        self._act = act
        self.answer: Future[dict[str, Any]] = Future()

    def take(self, side: PlantSide) -> None:
        """In the loop: do it, or say why not."""
        if not self.answer.set_running_or_notify_cancel():
            return  # whoever asked has been told that the plant does not answer
        try:
            done = self._act(side)
        except ScenarioError as error:
            self.answer.set_result({"refused": str(error)})
        else:
            self.answer.set_result(done)


def answer_to(payload: bytes, asked: Callable[[bytes], Act], hand_in: Callable[[Order], None]) -> bytes:
    """Outside the loop: check what somebody asks, hand it in and wait; the answer, as JSON."""
    try:
        order = Order(asked(payload))
    except UsageError as error:
        return json.dumps({"refused": str(error)}).encode()
    hand_in(order)
    try:
        return json.dumps(order.answer.result(TAKING)).encode()
    except (TimeoutError, CancelledError):
        order.answer.cancel()
        return json.dumps({"refused": "the plant does not take it now: it waits, or has ended"}).encode()


def parsed(payload: bytes) -> Any:
    """The JSON of a query. Raises UsageError."""
    if len(payload) > LONGEST:
        raise UsageError(f"a query of {len(payload)} bytes; at most {LONGEST}")
    try:
        return json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"not JSON: {error}") from None
