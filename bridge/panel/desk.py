"""What a page may ask for, and what comes of it."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.panel.clients import Client
from bridge.panel.doors import Guest
from bridge.panel.own_run import OwnRun, Wish, startable
from bridge.panel.rig import Rig
from bridge.panel.station import Station

FREE = ("detail", "rest")  # what those may ask for, too, who only watch
LONGEST = 120.0  # [s] that a page may look at in one piece
Answer = dict[str, Any]


class Desk:
    """Answers what pages ask for."""

    def __init__(self, station: Station) -> None:
        self._station = station
        self._acts: dict[str, Callable[[Client, Answer], Awaitable[Answer]]] = {
            "detail": self._detail,
            "rest": self._rest,
            "set": self._set,
            "fault": self._fault,
            "reset": self._reset,
            "start": self._start,
            "stop": self._stop,
            "record": self._record,
            "follow": self._follow,
        }

    async def answer(self, client: Client, asked: Any) -> Answer:
        """What comes of a message of a page: `done`, or `refused` with the reason."""
        number = asked.get("id") if isinstance(asked, dict) else None
        try:
            if not isinstance(asked, dict) or str(asked.get("do")) not in self._acts:
                raise UsageError(f"send a table whose `do` is one of {', '.join(self._acts)}")
            self._allow(client, asked["do"])
            return {"id": number, "done": await self._acts[asked["do"]](client, asked)}
        except (UsageError, RunError) as error:
            return {"id": number, "refused": str(error)}

    def _allow(self, client: Client, what: str) -> None:
        if what in FREE:
            return
        if client.guest is not Guest.OPERATOR:
            raise UsageError(f"{what}: this page may only watch; an operator's address ends with another token")
        if self._station.rig is not None and not self._station.rig.operates:
            raise UsageError(f"{what}: this panel is connected as one who may only watch; use operator.json5")

    @property
    def _rig(self) -> Rig:
        if self._station.rig is None:
            raise UsageError("no plant is running")
        return self._station.rig

    @property
    def _own(self) -> OwnRun:
        if self._station.own is None:
            raise UsageError(
                "this panel has started no run: record and follow beside the rig, with the verbs of that name"
            )
        return self._station.own

    async def _detail(self, client: Client, asked: Answer) -> Answer:
        begin, end = asked.get("begin"), asked.get("end")
        if not isinstance(begin, int | float) or not isinstance(end, int | float) or not 0 < end - begin <= LONGEST:
            raise UsageError(f"detail: from {begin!r} to {end!r}: two times, at most {LONGEST:g} s apart")
        return {"curves": self._station.run.detail(begin, end) if self._station.run else {}}

    async def _rest(self, client: Client, asked: Answer) -> Answer:
        client.resting = bool(asked.get("resting"))
        return {}

    async def _set(self, client: Client, asked: Answer) -> Answer:
        wanted = {"set": asked.get("changes"), "over": asked.get("over", "0 s")}
        return await asyncio.to_thread(self._rig.ask, "parameters/set", wanted)

    async def _fault(self, client: Client, asked: Answer) -> Answer:
        return await asyncio.to_thread(self._rig.ask, "fault", asked.get("fault"))

    async def _reset(self, client: Client, asked: Answer) -> Answer:
        await asyncio.to_thread(self._rig.reset)
        return {}

    async def _start(self, client: Client, asked: Answer) -> Answer:
        wish, known = self._station.place.wish, startable(self._station.place.wish.scenario)
        name = asked.get("scenario", wish.scenario)
        if name not in known:
            raise UsageError(f"{name!r:.100} cannot be started from a page; there are {', '.join(known)}")
        changes = wish.changes if name == wish.scenario else ()
        await self._station.start(Wish(name, changes, bool(asked.get("endless", True)), wish.priority))
        return {}

    async def _stop(self, client: Client, asked: Answer) -> Answer:
        await self._station.stop()
        return {}

    async def _record(self, client: Client, asked: Answer) -> Answer:
        if not asked.get("on", True):
            self._own.end("record")
            return {}
        return {"recording": str(self._own.record())}

    async def _follow(self, client: Client, asked: Answer) -> Answer:
        if not asked.get("on", True):
            self._own.end("follow")
        else:
            self._own.follow()
        return {}
