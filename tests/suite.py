"""The whole suite in half the time: `python -m tests.suite`.

Tests that run the loop in real time wait most of the time. What only computes fills the gaps beside them, last in line
for the processors, so that it makes nobody late.
"""

import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import IO

FOLDER = Path(__file__).parent
TIMED = ("foreign_controller", "loop", "network", "processes", "recorder", "replay", "view_live")


def main() -> int:
    """Both halves; the words of the second follow those of the first. 0 if both passed."""
    timed = sorted(str(FOLDER / f"test_{name}.py") for name in TIMED)
    others = sorted(str(path) for path in FOLDER.glob("test_*.py") if str(path) not in timed)
    with tempfile.TemporaryFile("w+") as words, _pytest(others, words, _last_in_line) as beside:
        try:
            first, second = _pytest(timed).wait(), beside.wait()
        finally:
            beside.terminate()
        words.seek(0)
        print(words.read(), flush=True)
    return int(bool(first or second))


def _pytest(files: list[str], words: IO[str] | None = None, before: object = None) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pytest", "-q", *sys.argv[1:], *files]
    return subprocess.Popen(command, stdout=words, stderr=words, start_new_session=words is not None, preexec_fn=before)  # type: ignore[arg-type]


def _last_in_line() -> None:
    """Linux shares processors by session first, and by niceness within."""
    os.nice(19)
    with suppress(OSError):
        Path("/proc/self/autogroup").write_text("19")


if __name__ == "__main__":
    sys.exit(main())
