"""`hydrotwin foxglove RIG`: a rig that runs, or is replayed, served to Foxglove until Ctrl-C, one run after another."""

import time
from typing import Any, NamedTuple

from bridge.connect.asking import Asking
from bridge.connect.foxglove.channels import HEARD, Channels
from bridge.connect.foxglove.listener import Listener, playback_state
from bridge.connect.foxglove.services import services
from bridge.errors import RunError, UsageError
from bridge.machine.priority import stand_back
from bridge.machine.process import Stop
from bridge.recording.entries import Entry
from bridge.recording.inbox import inbox, run_of
from bridge.scenario import check
from bridge.wire.bus import Bus
from bridge.wire.codec import decode
from bridge.wire.link import Link
from bridge.wire.messages import PACKAGE, TOPICS, EventKind
from controller.grid import NS

PERIOD = 0.02  # [s] from look to look at what has come
SHOWN = 0.2  # [s] from one word on where a replay stands to the next
LEASE = 2.0  # [s] of our silence after which the plant gives us up: until then it may wait for us
LOOPBACK = ("127.0.0.1", "::1", "localhost")


class Serving(NamedTuple):
    """Where the server is, and what may be done through it."""

    host: str
    port: int  # 0: any that is free
    read_only: bool


def require_foxglove() -> None:
    """Raise UsageError when Foxglove's SDK is not installed."""
    try:
        import foxglove  # noqa: F401
    except ImportError:
        raise UsageError("Foxglove's SDK is not installed: pip install 'hydrotwin[foxglove]'") from None


def serve(link: Link, rig: str, options: Serving) -> None:
    """Serve a rig until Ctrl-C. Raises UsageError, LinkError, or RunError where no plant answers."""
    require_foxglove()
    stop = Stop()
    with Bus(link, rig, "viewer", blocking=False, lease=LEASE) as bus:
        bridge = FoxgloveServer(bus, options)
        stop.listen()
        bridge.run(stop, link.patience)


class FoxgloveServer:
    """One server, and the rig behind it."""

    def __init__(self, bus: Bus, options: Serving) -> None:
        self._bus = bus
        self._options = options
        self._asking = Asking(bus)
        self._server: Any = None
        self._listener: Any = Listener(self._asking, options.read_only, self._say)
        self._inbox = inbox(bus, HEARD)
        self._run_id = 0
        self._replays = False
        self._channels: Channels | None = None
        self._due = 0.0  # when it is next said where a replay stands

    @property
    def address(self) -> str | None:
        """Where it serves; None before it does."""
        return None if self._channels is None else f"ws://{self._options.host}:{self._server.port}"

    def run(self, stop: Stop, patience: float) -> None:
        """Serve until stopped."""
        manifest = self._first_run(stop, patience)
        if manifest is None:
            return
        self._server = self._started(manifest)
        stand_back()
        try:
            self._begin(manifest)
            print(self._words(), flush=True)
            while not stop():
                time.sleep(PERIOD)
                self._pass_on(self._inbox.take())
                self._show_replay()
        finally:
            self._server.stop()
        if self._inbox.left_out:
            print(f"{self._inbox.left_out} messages were left out: they came faster than they could be passed on")

    def _first_run(self, stop: Stop, patience: float) -> dict[str, Any] | None:
        manifest = self._asking.run(patience, stop)
        if manifest is None and not stop():
            raise RunError(f"no plant of rig {self._bus.rig_name!r} answers: start one first, or name another rig")
        return manifest

    def _started(self, manifest: dict[str, Any]) -> Any:
        import foxglove

        self._context = foxglove.Context()
        self._replays = "replay_of" in manifest
        stands = self._asking.replay("status") if self._replays else None
        bounds = None if stands is None else (round(stands["begin"] * NS), round(stands["end"] * NS))
        capability, offered = foxglove.Capability, not self._options.read_only
        try:
            return foxglove.start_server(
                name=f"hydrotwin: {self._bus.rig_name}",
                host=self._options.host,
                port=self._options.port,
                context=self._context,
                capabilities=[capability.Time, capability.Parameters, *([capability.Services] if offered else [])],
                services=services(self._bus.rig_name, self._asking) if offered else None,
                supported_encodings=["json"],
                server_listener=self._listener,
                playback_time_range=bounds,
            )
        except (RuntimeError, OSError, ValueError) as error:
            raise RunError(
                f"cannot serve on {self._options.host}:{self._options.port}: {error}; choose others with --host, --port"
            ) from None

    def _begin(self, manifest: dict[str, Any]) -> None:
        """Another run: channels of its scenario, and Foxglove forgets what it has drawn."""
        if self._channels is not None:
            self._channels.close()
            self._server.clear_session()
        self._run_id = int(manifest["run_id"])
        self._channels = Channels(
            self._bus.rig_name, check(manifest["scenario"], "the plant's scenario"), self._context
        )

    def _pass_on(self, entries: list[Entry]) -> None:
        assert self._channels is not None
        if any(entry.topic == "measurement" and run_of(entry) != self._run_id for entry in entries):
            manifest = self._asking.run()
            if manifest is not None and int(manifest["run_id"]) != self._run_id:
                self._begin(manifest)
        own = [entry for entry in entries if not _is_ours(entry) or run_of(entry) == self._run_id]
        for entry in sorted(own, key=lambda entry: entry.log_time):
            self._channels.log(entry)
        if own:
            self._server.broadcast_time(max(entry.log_time for entry in own))
        if any(map(_changes, own)):
            self._server.publish_parameter_values(self._listener.values([]))

    def _show_replay(self) -> None:
        if self._replays and time.monotonic() >= self._due:
            self._due = time.monotonic() + SHOWN
            self._server.broadcast_playback_state(playback_state(self._asking.replay("status")))

    def _say(self, text: str) -> None:
        from foxglove import StatusLevel

        if self._server is not None:
            self._server.publish_status(text, StatusLevel.Error)

    def _words(self) -> str:
        host = self._options.host
        open_to_all = (
            []
            if host in LOOPBACK or self._options.read_only
            else [f"everybody who reaches {host} may change the rig; --read-only prevents that"]
        )
        return "\n".join((str(self.address), str(self._server.app_url()), *open_to_all, "Ctrl-C ends it"))


def _is_ours(entry: Entry) -> bool:
    """Does a message begin with the run that it belongs to?"""
    return TOPICS[entry.topic].type.startswith(PACKAGE)


def _changes(entry: Entry) -> bool:
    """Does a message say that a number has changed?"""
    return entry.topic == "event" and decode(entry.data, "event").kind == EventKind.CHANGED
