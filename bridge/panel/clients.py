"""The pages that are open: what goes to each, and what is dropped when one cannot follow."""

import asyncio
import json
import math
from typing import Any

from bridge.panel.doors import Guest

WAITING = 200  # messages for one page, 10 s of frames; a page that is further behind has to come anew


class Client:
    """One open page."""

    def __init__(self, guest: Guest) -> None:
        self.guest = guest
        self.resting = False  # nobody sees it now: it gets no frames
        self.lost = False
        self._queue: asyncio.Queue[str | None] = asyncio.Queue(WAITING)

    def send(self, text: str) -> None:
        """Send soon."""
        try:
            self._queue.put_nowait(text)
        except asyncio.QueueFull:
            self.lost = True

    async def next(self) -> str | None:
        """The next message; None when the page has to come anew."""
        return None if self.lost else await self._queue.get()


class Clients:
    """All of them."""

    def __init__(self) -> None:
        self._open: set[Client] = set()

    def add(self, client: Client) -> None:
        """One has come."""
        self._open.add(client)

    def remove(self, client: Client) -> None:
        """One has gone."""
        self._open.discard(client)

    def tell(self, kind: str, content: dict[str, Any]) -> None:
        """The same for all; frames only for those that somebody sees."""
        if not self._open:
            return
        text = packed(kind, content)
        for client in self._open:
            if not (client.resting and kind == "frame"):
                client.send(text)

    def seen(self) -> bool:
        """Does anybody look at a page now?"""
        return any(not client.resting for client in self._open)


def packed(kind: str, content: dict[str, Any]) -> str:
    """A message for a page: JSON, which knows no NaN."""
    try:
        return json.dumps({"type": kind, **content}, allow_nan=False, separators=(",", ":"))
    except ValueError:
        return json.dumps({"type": kind, **_finite(content)}, separators=(",", ":"))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
