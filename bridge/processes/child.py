"""One child process, with its output kept."""

import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

from bridge.machine.children import python
from bridge.machine.process import NOTE

GRACE = 2.0  # seconds from being asked to end to being killed


class Child:
    """A process of ours, with its words kept."""

    def __init__(self, role: str, arguments: list[str], folder: Path, environment: Mapping[str, str]) -> None:
        """environment: of `guarded`, which ends the process when we are gone."""
        self.role = role
        self.words = folder / f"{role}.log"
        self._sent: set[signal.Signals] = set()
        command = python("-m", "bridge", role, *arguments)
        with self.words.open("wb") as log:
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment, start_new_session=True
            )

    def ended(self) -> bool:
        """Is it gone?"""
        return self.process.poll() is not None

    def fault(self) -> str | None:
        """What it says of its failure; None when it has not failed."""
        code = self.process.poll()
        if not code:
            return None
        words = self.words.read_text(errors="replace").strip().splitlines()
        how = f"was killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
        return f"the {self.role} (pid {self.process.pid}) {how}" + (f": {words[-1]}" if words else "")

    def killed(self) -> bool:
        """Has somebody else ended it by a signal?"""
        code = self.process.poll()
        return code is not None and code < 0 and -code not in self._sent

    def notes(self) -> list[str]:
        """What it has to say that is not a failure."""
        lines = self.words.read_text(errors="replace").splitlines()
        return [f"{self.role}: {line.removeprefix(NOTE)}" for line in lines if line.startswith(NOTE)]

    def ask(self) -> None:
        """Ask it to end: a recorder closes its file then."""
        if not self.ended():
            self.process.send_signal(signal.SIGCONT)
            self._send(signal.SIGTERM)

    def end(self) -> None:
        """Make sure that it is gone, within GRACE."""
        self.ask()
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._send(signal.SIGKILL)
            self.process.wait()

    def _send(self, number: signal.Signals) -> None:
        self._sent.add(number)
        self.process.send_signal(number)
