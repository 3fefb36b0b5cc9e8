"""The panel's own state: the rig that is watched, the run that was started, and what all pages are told of both."""

import asyncio
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import RunError, UsageError
from bridge.panel.clients import Client, Clients, packed
from bridge.panel.facts import facts_of, plots_plain
from bridge.panel.numbers import for_page
from bridge.panel.own_run import STARTING, OwnRun, Wish
from bridge.panel.picture import Picture, picture_of
from bridge.panel.rig import Rig
from bridge.panel.run import Run
from bridge.scenario import Scenario
from bridge.wire.link import Link

FRAME = 0.05  # [s], from frame to frame
STATE = 0.5  # [s], from one word on safety and timing to the next
AGAIN = 0.3  # [s], from one attempt to find a plant to the next
LEARNING = 0.5  # [s] after a change before its number is asked for
CHANGING = ("changed", "fault", "reset")  # kinds of events after which numbers may be others


class Place(NamedTuple):
    """What a panel is for."""

    rig_name: str | None  # of a rig that runs; None: of the run that it starts itself
    link: Link
    wish: Wish


class Station:
    """One panel."""

    def __init__(self, place: Place, folder: Path, environment: Mapping[str, str]) -> None:
        self.place = place
        self.clients = Clients()
        self.own: OwnRun | None = None
        self.run: Run | None = None
        self.rig: Rig | None = None
        self.note = "" if place.rig_name else "choose a scenario and press Start"
        self.busy = ""  # what is being done that takes its time
        self._folder, self._environment = folder, environment
        self._picture: Picture | None = None
        self._facts: dict[str, Any] = {}
        self._numbers: list[dict[str, Any]] = []
        self._logged = 0
        self._state_due = self._learn_due = self._again_due = 0.0
        self._given_up = 0.0  # when a run of ours that never spoke counts as failed

    async def work(self) -> None:
        """Pump until cancelled."""
        while True:
            begun = time.monotonic()
            await self._turn()
            await asyncio.sleep(max(0.005, FRAME + begun - time.monotonic()))

    async def _turn(self) -> None:
        if self.rig is None:
            await self._find()
        else:
            self._pump(self.rig)
        if self.rig is not None and self._learn_due and time.monotonic() >= self._learn_due:
            self._learn_due = 0.0
            await self._learn(self.rig)
        if time.monotonic() >= self._state_due:
            self._state_due = time.monotonic() + STATE
            if self.run is not None:
                self.run.judging.look(ended=self.rig is None)
            self.clients.tell("state", self.state())
        if self.rig is not None and self.rig.over():
            await self._leave(self.rig.farewell())

    async def start(self, wish: Wish) -> None:
        """Start a run of our own. Raises UsageError for a scenario that cannot be run."""
        if self.place.rig_name:
            raise UsageError("this panel watches a rig that was started elsewhere: start and stop it there")
        if self.own is not None or self.busy:
            raise UsageError("a run is going on: stop it first")
        self.busy, self.run = f"starting {wish.scenario}; a drive's first start compiles", None
        self.clients.tell("state", self.state())
        try:
            own = await asyncio.to_thread(OwnRun, wish, self._folder, self._environment)
            self._picture = await asyncio.to_thread(picture_of, own.scenario)
        except BaseException:
            self.busy = ""
            raise
        self.own, self._given_up = own, time.monotonic() + STARTING  # its plant waits for us

    async def stop(self) -> None:
        """End the run of our own."""
        if self.own is None:
            raise UsageError("no run of this panel is going on")
        self.busy = "stopping"
        await asyncio.to_thread(self.own.stop)
        if self.rig is not None:
            await asyncio.sleep(4 * FRAME)  # last words are on their way
            self._pump(self.rig)
            await self._leave("the run was stopped")

    async def close(self) -> None:
        """End all that is ours."""
        if self.own is not None:
            await asyncio.to_thread(self.own.stop)
        if self.rig is not None:
            self.rig.close()

    def greet(self, client: Client) -> None:
        """Tell a page that has come all that the others know."""
        self.clients.add(client)
        if self.run is not None:
            client.send(packed("run", self._facts))
            begin = max(0.0, self.run.time - 30.0)
            client.send(packed("history", {"curves": self.run.detail(begin, self.run.time), "events": self.run.events}))
            client.send(packed("numbers", {"numbers": self._numbers}))
        client.send(packed("state", self.state()))

    def state(self) -> dict[str, Any]:
        """How it stands, for all pages."""
        run, rig, own = self.run, self.rig, self.own
        return {
            "live": rig is not None,
            "own": self.place.rig_name is None,
            "may": rig.operates if rig else True,
            "note": self.note or (own and own.failed()) or "",
            "busy": self.busy,
            "status": run.status if run else {},
            "timing": run.timing() if run else {},
            "time": run.time if run else 0.0,
            "bands": run.judging.plain() if run else None,
            "roles": [role for role in ("controller", "recorder", "follower") if rig and rig.present(role)],
            "recording": str(own.recording) if own and own.recording and own.going("record") else None,
        }

    async def _find(self) -> None:
        """Look for the plant; a run of ours that has failed meanwhile says why."""
        if (self.own is None and not self.place.rig_name) or time.monotonic() < self._again_due:
            return
        if self.own is not None and (fault := self.own.failed()):
            await self._leave(fault)
            return
        link, name = self.place.link, self.place.rig_name
        if self.own is not None:
            link, name = self.own.link, self.own.scenario.rig_name
        try:
            self.rig = await asyncio.to_thread(Rig, link, name or "rig")
            await self._begin(self.rig)
        except (RunError, UsageError) as error:
            self._again_due = time.monotonic() + AGAIN
            if self.own is None:
                self.note = str(error)
            elif time.monotonic() > self._given_up:
                await self._leave(f"the plant has not answered within {STARTING:g} s: {error}")

    async def _begin(self, rig: Rig) -> None:
        """A run that was found."""
        run = Run(rig, self.own.scenario if self.own else None)
        if self.own is None:
            self._picture = await asyncio.to_thread(_picture, rig.scenario)
        self.run, self.note, self.busy, self._logged = run, "", "", 0
        self._facts = facts_of(run, self._picture)
        self._learn_due = time.monotonic()
        self.clients.tell("run", self._facts)

    def _pump(self, rig: Rig) -> None:
        if self.run is None or self.run.rig is not rig:
            return
        part = self.run.take(rig.take(), self.clients.seen())
        if len(self.run.logged) != self._logged:
            self._logged = len(self.run.logged)
            self._facts |= {"plots": plots_plain(self.run)}
            self.clients.tell("plots", {"plots": self._facts["plots"]})
        if any(event["kind"] in CHANGING for event in part.get("events", [])):
            self._learn_due = time.monotonic() + LEARNING
        if any(part.values()):
            self.clients.tell("frame", part)

    async def _learn(self, rig: Rig) -> None:
        """Ask for the numbers that may change."""
        with suppress(RunError, UsageError):
            found = await asyncio.to_thread(rig.ask, "parameters", None)
            self._numbers = for_page(found["parameters"], rig.scenario)
            self.clients.tell("numbers", {"numbers": self._numbers})

    async def _leave(self, words: str) -> None:
        """The run is over."""
        own, rig, self.own, self.rig = self.own, self.rig, None, None
        self.busy, self.note = "", words
        if rig is not None:
            await asyncio.to_thread(rig.close)
        if own is not None:
            await asyncio.to_thread(own.stop)
            if own.recording is not None:
                self.note += f"; its recording: {own.recording}"
        self._state_due = 0.0


def _picture(scenario: Scenario) -> Picture | None:
    """None for a rig of which no circuit can be made here."""
    with suppress(UsageError):
        return picture_of(scenario)
    return None
