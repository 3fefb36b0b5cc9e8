"""How a scenario is run."""

from pathlib import Path
from typing import NamedTuple

from bridge.machine.priority import Priority
from bridge.wire.messages import Mode

SLOW = "did not exit within"  # how a fault reads that follows from another one


class RunOptions(NamedTuple):
    """What a person chooses in addition to the scenario; in one process only mode and recording count."""

    mode: Mode
    recording: Path
    speed: float = 1.0  # simulated over wall time, in real time
    priority: Priority = Priority.AUTO
    patience: float = 10.0  # seconds the plant waits for a partner, in lockstep for each command
    external: bool = False  # the controller is somebody else's: wait for it, do not start ours
    listen: str | None = None  # the plant's endpoint; None: a free one on loopback
