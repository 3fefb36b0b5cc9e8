"""The panel's place on the bus of a rig: what comes from it, and what an operator asks of it."""

import json
import math
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.recording.entries import Entry
from bridge.recording.inbox import WATCHED, inbox, run_of
from bridge.recording.manifest import told_by
from bridge.recording.reader import recording
from bridge.scenario import Scenario
from bridge.wire.access import ORDERS, Role, rights
from bridge.wire.bus import Bus
from bridge.wire.link import Link
from bridge.wire.messages import GOING, Phase
from bridge.wire.status import numbers_of

HEARD = (*WATCHED, "status")
CARD = ("measurement",)  # of a rig that tells nothing of its true state
LEASE = 2.0  # [s] of our silence after which the plant gives us up
PATIENCE = 5.0  # [s] for an answer
RESET = b"\x00\x01\x00\x00\x00"  # an empty message in CDR
SILENT = 3.0  # [s] without a state after which the card is listened to
GONE = 2.0  # [s] without a plant after which its run counts as ended


def may_operate(user: str | None) -> bool:
    """May somebody of that name order something of a rig? None: nobody asks for names."""
    return user is None or (user in list(Role) and set(ORDERS) <= set(rights(Role(user)).queries))


def user_of(config: Path | None) -> str | None:
    """The name that a Zenoh configuration connects with; None without one."""
    if config is None:
        return None
    import zenoh

    with suppress(zenoh.ZError):  # opening the session says what is wrong
        return json.loads(zenoh.Config.from_file(str(config)).get_json("transport/auth/usrpwd/user"))
    return None


class Rig:
    """A rig that runs, until its plant ends."""

    def __init__(self, link: Link, name: str) -> None:
        """Raises LinkError where nobody listens, RunError where no plant answers."""
        self.operates = may_operate(user_of(link.config))
        self.bus = Bus(link, name, "operator" if self.operates else "viewer", blocking=False, lease=LEASE)
        try:
            self._inboxes = [inbox(self.bus, HEARD)]
            self.bus.watch()
            self.bus.announce()
            self.manifest = self._manifest(link.patience)
        except BaseException:
            self.bus.close()
            raise
        self._quiet_since, self._absent_since = time.monotonic(), 0.0
        self.ended: Phase | None = None
        self._reason = ""  # of a failure

    @property
    def run_id(self) -> int:
        """Of the run that was there at first."""
        return int(self.manifest["run_id"])

    @property
    def scenario(self) -> Scenario:
        """What runs."""
        return recording(Path("live"), [], {"run": self.manifest}).scenario()

    def take(self) -> list[Entry]:
        """All that has come since the last time."""
        entries = [entry for box in self._inboxes for entry in box.take()]
        now = time.monotonic()
        runs = {run_of(entry) for entry in entries if entry.topic == "state"}
        if runs - {self.run_id}:
            self.ended = self.ended or Phase.ENDED  # another run has begun in its place
        if runs:
            self._quiet_since = now
        elif now - self._quiet_since > SILENT and len(self._inboxes) == 1:
            self._inboxes.append(inbox(self.bus, CARD))
        return entries

    def heed(self, status: Any) -> None:
        """Take a status: the last one of the plant says how it has ended."""
        if status.role == "plant" and status.run_id == self.run_id and status.phase not in GOING:
            self.ended, self._reason = Phase(status.phase), status.text

    def over(self) -> bool:
        """Has the plant ended, or gone?"""
        here = self.bus.present.get("plant")
        if here is None or here:
            self._absent_since = 0.0
        elif not self._absent_since:
            self._absent_since = time.monotonic()
        return self.ended is not None or bool(self._absent_since and time.monotonic() - self._absent_since > GONE)

    def farewell(self) -> str:
        """How the run came to its end, for people."""
        known = {
            Phase.ENDED: "the run has ended",
            Phase.INTERRUPTED: "the run was stopped",
            Phase.FAILED: "the run failed",
        }
        gone = "the plant is not there any more: it was killed, or the connection to it was lost"
        words = gone if self.ended is None else known[self.ended]
        return f"{words}: {self._reason}" if self._reason else words

    def ask(self, name: str, wanted: Any) -> dict[str, Any]:
        """What the plant answers. Raises RunError where nobody does, UsageError for what it refuses."""
        answer = self.bus.request(name, b"" if wanted is None else json.dumps(wanted).encode(), PATIENCE)
        if answer is None:
            raise RunError(
                f"no plant of rig {self.bus.rig_name!r} answers, or access control keeps the question from it"
            )
        found = json.loads(answer)
        if "refused" in found:
            raise UsageError(found["refused"])
        return found

    def reset(self) -> None:
        """Bring the plant out of its safe state."""
        self.bus.session.put(f"{self.bus.rig_name}/reset", RESET)

    def present(self, role: str) -> bool:
        """Does anybody play a role on this rig?"""
        return bool(self.bus.present.get(role))

    def close(self) -> None:
        """Leave the bus."""
        self.bus.close()

    def _manifest(self, patience: float) -> dict[str, Any]:
        answer = self.bus.ask("scenario", patience)
        if answer is None:
            raise RunError(f"no plant of rig {self.bus.rig_name!r} answers at {self.bus.place}")
        return told_by(answer, self.bus.rig_name)


def told(status: Any) -> dict[str, Any]:
    """A status for the page: the numbers that are finite."""
    numbers = {name: value for name, value in numbers_of(status).items() if math.isfinite(value)}
    return {"role": status.role, "phase": status.phase, "stamp": status.stamp / 1e9, "text": status.text} | numbers
