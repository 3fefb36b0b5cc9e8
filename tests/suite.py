"""The whole suite: `python -m tests.suite`, with further options for pytest.

First what the tests share is compiled, once, and Python's sources with it: the tests start some 400 processes. Then
most tests run in WORKERS processes side by side; those that are marked `timed`, because the clock judges them, follow
one after another with the machine for themselves.
"""

import os
import subprocess
import sys
from pathlib import Path

from tests.support.warm import PARTS

WORKERS = 3  # on two processors: tests of real processes wait most of their time
PYTEST = ("-m", "pytest", "-q", "--durations=15")
MARKED = "timed and not endurance"
TESTS = Path(__file__).parent
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
NOTHING_CHOSEN = 5  # pytest's exit code
OTHERS = "not timed and not endurance"


def main(options: list[str]) -> int:
    """0 if all passed."""
    compile_once()
    codes = (
        run(*PYTEST, "-m", OTHERS, "-n", str(WORKERS), "--dist", "worksteal", *options),
        run(*PYTEST, "-m", MARKED, "-n", "1", *files_with("mark.timed"), *options),
    )
    return max(0 if code == NOTHING_CHOSEN and options else code for code in codes)


def files_with(words: str) -> list[str]:
    """The files of tests that hold some words: the others need not be imported."""
    return [str(path) for path in sorted(TESTS.rglob("test_*.py")) if words in path.read_text()]


def compile_once() -> None:
    """What does not compile is for the tests to report."""
    for process in [
        subprocess.Popen([sys.executable, "-m", "tests.support.warm", part], env=ENVIRONMENT) for part in PARTS
    ]:
        process.wait()


def run(*arguments: str) -> int:
    """Its exit code, 1 where it was killed."""
    code = subprocess.run([sys.executable, *arguments], env=ENVIRONMENT).returncode
    return code if code >= 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
