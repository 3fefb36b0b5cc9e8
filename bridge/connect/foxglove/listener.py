"""What people at Foxglove do: read and set the numbers that may change during a run, and play a replay.

The methods are called in threads of Foxglove's server, by the names that it gives them.
"""

from collections.abc import Callable
from typing import Any

from bridge.connect.asking import Asking
from bridge.errors import RunError, UsageError
from controller.grid import NS

READ_ONLY = "this server was started with --read-only: nothing can be changed through it"
Say = Callable[[str], None]  # to everybody who is connected


class Listener:
    """Answers of one server."""

    def __init__(self, asking: Asking, read_only: bool, say: Say) -> None:
        self._asking = asking
        self._read_only = read_only
        self._say = say

    def __getattr__(self, name: str) -> Any:
        """Of what else Foxglove tells nothing follows."""
        if name.startswith("on_"):
            return lambda *_: None
        raise AttributeError(name)

    def values(self, names: list[str]) -> list[Any]:
        """Parameters with their present values in SI: those named, or all."""
        from foxglove import Parameter, ParameterType

        return [
            Parameter(entry["name"], value=float(entry["value"]), type=ParameterType.Float64)
            for entry in self._asking.parameters()
            if not names or entry["name"] in names
        ]

    def on_get_parameters(self, _client: Any, names: list[str], _request: str | None = None) -> list[Any]:
        """Somebody reads some, or all."""
        return self.values(names)

    def on_set_parameters(self, _client: Any, parameters: list[Any], _request: str | None = None) -> list[Any]:
        """Somebody sets some: all of them or none; a number is SI, a text has its unit. A refusal is told to all."""
        wanted = {parameter.name: parameter.get_value() for parameter in parameters}
        try:
            if self._read_only:
                raise UsageError(READ_ONLY)
            self._asking.order("parameters/set", {"set": wanted})
        except (UsageError, RunError) as error:
            self._say(str(error))
        return self.values(list(wanted))

    def on_playback_control_request(self, asked: Any) -> Any:
        """Somebody plays, pauses, seeks or sets the speed of a replay."""
        from foxglove.websocket import PlaybackCommand

        found = self._asking.replay("speed", repr(asked.playback_speed))
        if asked.seek_time is not None:
            found = self._asking.replay("seek", f"{asked.seek_time / NS!r} s")
        plays = asked.playback_command == PlaybackCommand.Play
        found = self._asking.replay("resume" if plays else "pause") or found
        return playback_state(found, asked.seek_time is not None, asked.request_id)


def playback_state(found: dict[str, Any] | None, sought: bool = False, request: str | None = None) -> Any:
    """What Foxglove's play bar shows of a replay; of one that is gone, that it has ended."""
    from foxglove.websocket import PlaybackState, PlaybackStatus

    if found is None:
        return PlaybackState(PlaybackStatus.Ended, 0, 1.0, sought, request)
    status = PlaybackStatus.Paused if found["paused"] else PlaybackStatus.Playing
    speed = 0.0 if found["speed"] == "max" else float(found["speed"])
    return PlaybackState(status, round(found["time"] * NS), speed, sought, request)
