"""The whole suite in less time: `python -m tests.suite`.

Most of it runs in two processes side by side. What is judged by the clock is listed in TIMED and has the machine for
itself afterwards.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO

FOLDER = Path(__file__).parent
TIMED = ("foreign_controller", "loop", "network", "processes", "recorder", "replay", "view_live")


def main() -> int:
    """0 if all passed."""
    timed = sorted(str(FOLDER / "bridge" / f"test_{name}.py") for name in TIMED)
    others = sorted(str(path) for path in FOLDER.rglob("test_*.py") if str(path) not in timed)
    with tempfile.TemporaryFile("w+") as words:
        halves = [_pytest(others[0::2]), _pytest(others[1::2], words)]
        try:
            codes = [half.wait() for half in halves]
        finally:
            for half in halves:
                half.terminate()
        words.seek(0)
        print(words.read(), flush=True)
    return int(any([*codes, _pytest(timed).wait()]))


def _pytest(files: list[str], words: IO[str] | None = None) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pytest", "-q", *files]
    return subprocess.Popen(command, stdout=words, stderr=words)


if __name__ == "__main__":
    sys.exit(main())
