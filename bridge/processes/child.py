"""One child process, with its output kept."""

import signal
import subprocess
import sys
from pathlib import Path

from bridge.machine.process import NOTE


class Child:
    """A process of ours, with its words kept."""

    def __init__(self, role: str, arguments: list[str], folder: Path) -> None:
        self.role = role
        self.words = folder / f"{role}.log"
        with self.words.open("wb") as log:
            command = [sys.executable, "-m", "bridge", role, *arguments, "--supervised"]
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
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
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        return f"the {self.role} (pid {self.process.pid}) ended with {how}" + (f": {words[-1]}" if words else "")

    def notes(self) -> list[str]:
        """What it has to say that is no failure."""
        lines = self.words.read_text(errors="replace").splitlines()
        return [f"{self.role}: {line.removeprefix(NOTE)}" for line in lines if line.startswith(NOTE)]

    def end(self) -> None:
        """Make sure that it is gone."""
        if not self.ended():
            self.process.send_signal(signal.SIGCONT)
            self.process.kill()
        self.process.wait()
